/*
 * Finds a start value for the fit of the iron's time constant. While no iron loss is fitted, the derivative by the time constant is
 * zero.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_BRANCH_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_BRANCH_CHOICE_H

#include "fit_data.h"

/*
 * If neither the state nor the motor file has an iron loss, tries some time constants and leaves in *s the one with which an iron
 * loss would reduce the error most. False: out of memory.
 */
bool branch_choose(fit_data *d, fit_state *s);

#endif
