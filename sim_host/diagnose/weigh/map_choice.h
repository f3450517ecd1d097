/*
 * A flux map that no derivative proposes, by trial.
 *
 * Where nothing falls yet, the fall of both axes with I_sat moves the flux as terms of fourth order do: a quadratic form does not
 * distinguish the two. And iron that loses much of its inductance follows neither; it is made of parts that saturate
 * (model/flux_map.h), whose shapes show only where the parts are large.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_MAP_CHOICE_H
#define SIM_HOST_DIAGNOSE_WEIGH_MAP_CHOICE_H

#include "diagnose/identify/fit_data.h"

/*
 * A state, fitted, that holds a map of terms alone: the same with I_sat, fitted, if that is worth its parameters. Then, if its
 * saturation or map takes much flux at the recorded currents: a map of one part, or of two, if its score is better. One part is fitted without
 * the other causes, which the wrong map may have made; the search finds them again. Two parts are also fitted from the flux of the state,
 * with its other causes. Other states stay. False: out of memory.
 */
bool map_choose(fit_data *d, fit_state *s, hypothesis_set allowed, int refine_steps);

#endif
