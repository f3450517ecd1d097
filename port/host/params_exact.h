/*
 * A motor file as the constants of the exact predictors: what params_host.h is for the papers' predictors.
 */
#ifndef PORT_HOST_PARAMS_EXACT_H
#define PORT_HOST_PARAMS_EXACT_H

#include "params_host.h"

#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_salient.h"

/* L is the mean of L_d and L_q. False, with the file and the key named, where a value does not fit. */
bool winding_from_motor(const motor *m, iqfoc_exact_winding_t *winding, error *e);

bool salient_from_motor(const motor *m, iqfoc_salient_machine_t *machine, error *e);

#endif
