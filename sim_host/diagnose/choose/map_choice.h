/*
 * The whole flux map, grown from its terms.
 *
 * Where nothing falls yet, the fall of both axes with I_sat moves the flux as terms of fourth order do: derivatives do not
 * distinguish the two, and no quadratic form proposes the fall. It is tried.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_MAP_CHOICE_H
#define SIM_HOST_DIAGNOSE_CHOOSE_MAP_CHOICE_H

#include "diagnose/identify/fit_data.h"

/*
 * A state, fitted, that holds a map of terms alone: the same with I_sat, fitted, if that is worth its parameters.
 * Other states stay. False: out of memory.
 */
bool map_choose(fit_data *d, fit_state *s, hypothesis_set allowed, int refine_steps);

#endif
