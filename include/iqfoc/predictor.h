/*
 * One-cycle current prediction of a non-salient machine in the stationary frame, both axes (all phases) at
 * once.
 *
 *     standard (forward Euler), 2019 (3):  i + (T/L)(u - R i) - j (psi phi/L) e^(j theta)
 *     quasi-discrete, 2019 (12):           i + (T/L)(u - R i) - j (psi phi/L) s1 e^(j theta_m)
 *
 * with theta the rotor angle at the start of the cycle, theta_m = theta + phi/2 at its middle, and u constant
 * over the cycle (the mean voltage that the PWM applies). The second lets the EMF turn with the rotor; that
 * is all the difference, and it costs one multiplication by s1. A third of the same shape, exact and for
 * salient machines, belongs in a header of its own: what calls a predictor needs only a current, a voltage
 * and the rotor.
 */
#ifndef IQFOC_PREDICTOR_H
#define IQFOC_PREDICTOR_H

#include "iq24_math.h"
#include "rotor.h"
#include "vector.h"

/*
 * The machine as the predictor sees it: per unit, IQ24, made by iqfoc/params.h (firmware) or the host's
 * parameter conversion. I_b, U_b: the current and voltage base. Each coefficient is rounded to 0.5 LSB.
 */
typedef struct iqfoc_predictor {
    iq24_t k_u;   /* T U_b / (L I_b): per-unit current per per-unit voltage and cycle; 0 < k_u <= 32 */
    iq24_t k_r;   /* R T / L; 0 <= k_r <= 1 */
    iq24_t k_psi; /* 2 pi psi_f / (L I_b): EMF per turn of the rotor; 0 <= k_psi <= 32; 0 for an RL load */
} iqfoc_predictor_t;

/*
 * Standard prediction, 2019 (3): the current at the start of the next cycle.
 *
 * i, u: per unit, |component| <= 32 and <= 2. rotor: the speed. sc: sine and cosine of theta, the angle at
 * the start. Out: saturates at the ends of IQ24. Largest error against the formula in double with the same
 * coefficients and sine: 0.5 LSB + 0.5 LSB per |sin|, |cos| from the rounded k_psi phi.
 */
iqfoc_ab_t iqfoc_predictor_euler(const iqfoc_predictor_t *predictor, iqfoc_ab_t i, iqfoc_ab_t u,
                                 const iqfoc_rotor_t *rotor, iq24_sincos_t sc);

/*
 * Quasi-discrete prediction, 2019 (12). As above, but sc is of theta_m, the angle at the middle of the cycle.
 * Largest error against the formula in double with the same coefficients, s1 and sine: 1.5 LSB.
 */
iqfoc_ab_t iqfoc_predictor_quasi_discrete(const iqfoc_predictor_t *predictor, iqfoc_ab_t i, iqfoc_ab_t u,
                                          const iqfoc_rotor_t *rotor, iq24_sincos_t sc_mid);

#endif
