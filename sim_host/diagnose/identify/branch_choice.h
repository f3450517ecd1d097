/*
 * Where the fit of an iron's time constant begins: its derivative says nothing while no iron loss is fitted.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_BRANCH_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_BRANCH_CHOICE_H

#include "fit_data.h"

/* While none is fitted, nor known to the motor file, the time constant with which one would pay most is found by trial and left
 * in *s. False: out of memory. */
bool branch_choose(fit_data *d, fit_state *s);

#endif
