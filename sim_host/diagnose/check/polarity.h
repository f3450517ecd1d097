/*
 * Checks for columns that are negated, exchanged, inverted or counted backwards, before the search for causes, which would fit wrong causes to them.
 *
 * The voltage equation in the middle of each cycle,
 *
 *     u_dq = R i_dq + (L_d di_d/dt - omega L_q i_q, L_q di_q/dt + omega L_d i_d) + omega (-psi_q, psi_d)
 *            + v_dead (sat(i_x / i_knee) of the phases, in dq)
 *
 * is fitted to the recording as it is and with each mistake undone. R, L_d, L_q, psi_d and v_dead are free but not negative, psi_q is
 * free. The motor file is not used, because it may be wrong. Another arrangement is reported if its residual is a small part of the
 * recorded one's. Arrangements that are not distinguishable (at standstill, reversed currents and inverted voltages) are reported
 * together.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_POLARITY_H
#define SIM_HOST_DIAGNOSE_CHECK_POLARITY_H

#include "data/recording.h"

/* False with one line in *e that names the mistake. */
bool check_polarity(const recording *rec, error *e);

#endif
