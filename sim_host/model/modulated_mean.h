/*
 * The mean over a PWM cycle of the current as seen from the turning rotor, ripple included: what the 2016
 * paper leaves to future work. Double precision, the reference for include/iqfoc/mean_modulated.h;
 * derivation: docs/mean-under-modulation.md.
 *
 * Centre-aligned PWM, one duty per leg and cycle, constant speed. Vectors are complex: stationary frame,
 * rotor frame where the name ends in _dq.
 */
#ifndef SIM_HOST_MODEL_MODULATED_MEAN_H
#define SIM_HOST_MODEL_MODULATED_MEAN_H

#include "exact.h"

/* What the inverter and the rotor do in one cycle. */
typedef struct modulated_cycle {
    double T_s, u_dc_V;
    double duty[3];
    double theta_rad, omega_rad_s; /* the rotor at the start, electrical */
} modulated_cycle;

/*
 * The exact current at the end of the cycle and its mean as seen from the rotor, from the current at its
 * start: from one edge to the next, added up.
 */
exact_span modulated_exact(const exact_salient *m, const modulated_cycle *c, double complex i_start_A);

/*
 * The vector of the duties whose length is the ripple's: sum over the legs of (2/3) axis d [s1(d phi) -
 * s1(phi)]/phi^2, (2/3) axis d (1 - d^2)/24 for small phi. Stationary frame, no unit. To 1e-15 for |phi| <= 2
 * pi.
 */
double complex modulated_ripple_vector(const double duty[3], double phi_rad);

/*
 * What the ripple adds to the mean seen from the rotor of a machine without resistance:
 * -j phi (u_dc T/L) e^(-j theta_m) times that vector, each axis with its own L. To first order in R T/L the
 * factor is (R T/L - j phi): the ripple's mean in the stationary frame.
 */
double complex modulated_ripple_dq(const exact_salient *m, const modulated_cycle *c);

/*
 * The mean seen from the rotor from the samples at the start and the end of the cycle, the duties and the
 * speed: for machines without saliency; to first order in R T/L.
 */
double complex modulated_from_samples(const papers_machine *m, const modulated_cycle *c,
                                      double complex i_start_A, double complex i_end_A);

#endif
