/*
 * Columns that are negated, exchanged, inverted or counted backwards, looked for before any cause is: a search
 * for causes would bend the model around them, for a long time and to no use.
 *
 * The voltage equation in the middle of each cycle,
 *
 *     u_dq = R i_dq + (L_d di_d/dt - omega L_q i_q, L_q di_q/dt + omega L_d i_d) + omega (-psi_q, psi_d)
 *            + v_dead (sat(i_x / i_knee) of the phases, in dq)
 *
 * is fitted to the recording as it is and with each mistake undone, with R, L_d, L_q, psi_d and v_dead free but not
 * negative, as no machine's are, and psi_q free. The motor file is not asked: it may be wrong. An arrangement other
 * than the recorded one is named where it leaves a small part of what the recorded one does. Those that a recording
 * cannot tell apart (at standstill reversed currents are inverted voltages) are named together.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_POLARITY_H
#define SIM_HOST_DIAGNOSE_CHECK_POLARITY_H

#include "data/recording.h"

/* False with one line in *e that names the mistake. */
bool check_polarity(const recording *rec, error *e);

#endif
