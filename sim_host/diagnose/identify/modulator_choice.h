/*
 * Chooses the modulator of a recording that has voltages but no duties, by likelihood. The modulator determines when the legs switch.
 * It also determines which legs do not switch and so have no dead time.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_MODULATOR_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_MODULATOR_CHOICE_H

#include "fit_data.h"

/*
 * Effects that depend on the switching edges: a dead time, a filter of the sensors that still shows the last edges, and a fast iron
 * loss.
 */
enum { EDGES_BY_DEAD_TIME = 1, EDGES_BY_SENSOR_LAG = 2, EDGES_BY_IRON = 4 };

/*
 * Gives the rows the edges of the best modulator; *changed: it is not the one that they had. For recordings without duties.
 *
 * `by`: the effects (EDGES_BY_, at least one) that are fitted under each modulator, from *s or from their start values. Another
 * modulator is taken only if its residual is clearly smaller than that of *s and of the present modulator: by the share `least`, and
 * by 100 in chi square. If the effects are not in *s yet, a residual that has nothing to do with edges makes some modulator look
 * better by 2 %. The right one reduces the residual by 10 %. False: out of memory.
 */
bool modulator_choose(fit_data *d, const fit_state *s, unsigned by, double least, bool *changed);

#endif
