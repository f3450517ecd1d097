/*
 * One span of a synchronous machine at constant speed and voltage, solved exactly in double precision: the
 * reference for include/iqfoc/predictor_exact.h and predictor_salient.h. Derivation:
 * docs/exact-prediction.md.
 *
 * Vectors are complex: stationary frame, rotor frame where the name ends in _dq. No form divides by
 * resistance or speed: an ideal winding, standstill and reverse are ordinary points. Nothing here is shared
 * with the switching-level plant, which the tests hold it against.
 */
#ifndef SIM_HOST_MODEL_EXACT_H
#define SIM_HOST_MODEL_EXACT_H

#include "papers.h"

/*
 * Non-salient, stationary frame. span_s: the time predicted over, any part of a cycle or more; theta_mid_rad:
 * the rotor in the middle of it. m->T_s is not used. To 1e-13 of the terms for rho <= 2 and |phi| <= 2 pi.
 */
double complex exact_predict(const papers_machine *m, double complex i_A, double complex u_V, double span_s,
                             double theta_mid_rad, double omega_rad_s);

/* The mean of the current over the span, stationary frame. */
double complex exact_mean(const papers_machine *m, double complex i_A, double complex u_V, double span_s,
                          double theta_mid_rad, double omega_rad_s);

/* Any machine, rotor frame: the maps of exact_map.h. */
typedef struct exact_salient {
    double R_ohm, L_d_H, L_q_H, psi_f_Wb;
} exact_salient;

/* End of the span (seen from the rotor there) and mean over it (seen from the turning rotor). */
typedef struct exact_span {
    double complex end_dq_A, mean_dq_A;
} exact_span;

/* i_dq_A, u_dq_V: seen from the rotor at the start of the span. */
exact_span exact_salient_span(const exact_salient *m, double complex i_dq_A, double complex u_dq_V,
                              double span_s, double omega_rad_s);

#endif
