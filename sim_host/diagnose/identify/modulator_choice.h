/*
 * Which modulator made the duties of a recording that has voltages only, by likelihood: it says when the legs switch, and which do
 * not, and so have no dead time.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_MODULATOR_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_MODULATOR_CHOICE_H

#include "fit_data.h"

/* What tells one edge from another: a dead time, a filter of the sensors that still sees the last ones, iron that is fast. */
enum { EDGES_BY_DEAD_TIME = 1, EDGES_BY_SENSOR_LAG = 2, EDGES_BY_IRON = 4 };

/*
 * Gives the rows of a recording without duties the edges of the modulator under which those effects together (EDGES_BY_, one at
 * least), as they stand in *s or as they would begin, leave least, and clearly less than *s does; *changed: another one than they
 * had. False: out of memory.
 * `least`: the share of what is left that another modulator must take off. Where those effects do not stand yet, structure that is no
 * edge makes one look better by a part in fifty; the right one takes a tenth.
 */
bool modulator_choose(fit_data *d, const fit_state *s, unsigned by, double least, bool *changed);

#endif
