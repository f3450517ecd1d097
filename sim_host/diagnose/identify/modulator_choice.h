/*
 * Which modulator made the duties of a recording that has voltages only, by likelihood: it says which legs do not switch, and
 * so have no dead time.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_MODULATOR_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_MODULATOR_CHOICE_H

#include "fit_data.h"

/*
 * Gives the rows the edges of the modulator under which a dead time, as it stands in *s or as it would begin, leaves least;
 * *changed: another one than they had. False: out of memory.
 */
bool modulator_choose(fit_data *d, const fit_state *s, bool *changed);

#endif
