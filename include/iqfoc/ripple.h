/*
 * Contribution of PWM's ripple to the mean current as seen from the turning rotor.
 *
 * The ripple of centre-aligned PWM is odd about the middle of the cycle: samples at valley and peak do not contain it
 * and its mean is zero. A turning rotor sees the two halves of the ripple at different angles, and their sum is not
 * zero. It follows from the duties in closed form (docs/mean-under-modulation.md); to the second order in the rotor's
 * angle phi
 *
 *     V        = Clarke{ d (1 - d^2) [1 - (phi^2/80)(1 + d^2)] }
 *     i_ripple = (rho - j phi) (k_u u_dc/24) e^(-j theta_m) V
 *
 * with rho = R T/L. Each axis of a salient machine has its own k_u and rho. Add i_ripple to a mean that is computed
 * from the mean voltage only, such as that of predictor_salient.h; mean_modulated.h includes it. All functions only
 * read their arguments: any context.
 */
#ifndef IQFOC_RIPPLE_H
#define IQFOC_RIPPLE_H

#include "predictor_salient.h"
#include "rotor.h"
#include "transform.h"
#include "vector.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One leg's share: d (1 - d^2) [1 - square (1 + d^2)]. 0 <= d <= 1; result 0 ... 0.385. */
static inline iq24_t iqfoc_ripple_of_leg(iq24_t d, iq24_t square)
{
    const iq24_t d2 = iq24_mul_round(d, d);
    const iq24_t bow = d - iq24_mul_round(d, d2);
    return bow - iq24_mul_round(bow, iq24_mul_round(square, IQ24_ONE + d2));
}

/*
 * u_dc V: the ripple's vector in the stationary frame, per unit voltage.
 *
 * high: duties 0 ... 1. square: phi^2/80, 0 ... 0.055. u_dc: the DC link, per unit, 0 ... 2. Out: |component|
 * <= 0.52. Largest error with square as given: 5 LSB at u_dc = 1.5 (of 100000 drawn 4).
 */
static inline iqfoc_ab_t iqfoc_ripple_vector(iqfoc_abc_t high, iq24_t square, iq24_t u_dc)
{
    const iqfoc_abc_t legs = {iqfoc_ripple_of_leg(high.a, square), iqfoc_ripple_of_leg(high.b, square),
                              iqfoc_ripple_of_leg(high.c, square)};
    const iqfoc_ab_t v = iqfoc_clarke3(legs);
    const iqfoc_ab_t scaled = {iq24_mul_round(v.alpha, u_dc), iq24_mul_round(v.beta, u_dc)};
    return scaled;
}

/* A machine's ripple at a speed. IQ24. */
typedef struct iqfoc_ripple {
    iq24_t square;   /* phi^2/80 */
    iq24_t along_d;  /* k_d rho_d/24: 0 ... 0.67 */
    iq24_t across_d; /* k_d phi/24: -1.4 ... 1.4 */
    iq24_t along_q;
    iq24_t across_q;
} iqfoc_ripple_t;

/*
 * For a slower task. machine: within predictor_salient.h's ranges; L_d = L_q is one of them. rotor:
 * of the speed. To the bit: rho in IQ24 and each product to nearest, ties up, quotients by 24 and 80 towards 0.
 */
iqfoc_ripple_t iqfoc_ripple_at_speed(const iqfoc_salient_machine_t *machine, const iqfoc_rotor_t *rotor);

/*
 * The ripple's part of the mean, dq as seen from the turning rotor.
 *
 * high: the cycle's duties. u_dc: per unit, 0 ... 2. sc_mid: of the rotor angle at mid-cycle.
 * Out: |component| <= 1.1. Together with the mean of predictor_salient.h within 0.02 % of the rated current
 * of the drive's true mean, each motor of data/motors/ at SFFR 6 and above; 0.06 % where R T/L is 0.27 (motor 3 of
 * 2016), for resistance counts to first order.
 */
static inline iqfoc_dq_t iqfoc_ripple_seen(const iqfoc_ripple_t *ripple, iqfoc_abc_t high, iq24_t u_dc,
                                           iq24_sincos_t sc_mid)
{
    const iqfoc_dq_t v = iqfoc_park(iqfoc_ripple_vector(high, ripple->square, u_dc), sc_mid);
    const iq24_acc_t d = iq24_acc_mac(IQ24_ACC_HALF, ripple->along_d, v.d);
    const iq24_acc_t q = iq24_acc_mac(IQ24_ACC_HALF, ripple->along_q, v.q);
    const iqfoc_dq_t seen = {iq24_acc_trunc(iq24_acc_mac(d, ripple->across_d, v.q)),
                             iq24_acc_trunc(iq24_acc_mac(q, -ripple->across_q, v.d))};
    return seen;
}

/*
 * ---- Two updates a carrier period ----
 * Over half a period the ripple of a leg is a triangle, zero at both ends, so that their samples do not contain it.
 * Its mean is not zero: it is negative from the valley to the peak and positive after the peak. With phi and rho of
 * the half, to the second order in phi and the first in rho,
 *
 *     b = d (1 - d),   i_ripple = k_u u_dc e^(-j theta_m) { -+(1 - rho/2) Clarke[b (1 - (phi^2/24)(1 - 2 b))]/2
 *                                                          + (j phi - rho) Clarke[b (1 - 2 d)]/12 }
 *
 * Add it to a mean that is computed from the mean voltage only, or subtract it from a measured one; otherwise the
 * controller reacts to the carrier. A firmware with a control cycle of half a carrier period calls the two functions
 * below: the first in its slower task, the second once per cycle.
 */
typedef struct iqfoc_ripple_half {
    iq24_t square;   /* phi^2/24: 0 ... 0.19 */
    iq24_t even_d;   /* k_d (1 - rho_d/2)/2: 0 ... 8 */
    iq24_t along_d;  /* -k_d rho_d/12: -1.4 ... 0 */
    iq24_t across_d; /* k_d phi/12: -2.8 ... 2.8 */
    iq24_t even_q;
    iq24_t along_q;
    iq24_t across_q;
} iqfoc_ripple_half_t;

/*
 * For a slower task. machine, rotor: of control cycles that are half a carrier period. To the bit: rho, rho/2 and
 * each product to nearest, ties up, quotients by 12 and 24 towards 0, the half of an even coefficient down.
 */
iqfoc_ripple_half_t iqfoc_ripple_half_at_speed(const iqfoc_salient_machine_t *machine,
                                               const iqfoc_rotor_t *rotor);

/*
 * The ripple's part of the mean over a half, dq as seen from the turning rotor.
 *
 * high: the half's duties, 0 ... 1. u_dc: per unit, 0 ... 2. to_peak: from the valley to the peak. sc_mid: of
 * the rotor angle at the half's middle. Out: |component| <= 7. Each product is rounded to nearest, the sum of an
 * axis once. Largest error of 400000 drawn, against the formula in double with the same machine and rotor: 28 LSB.
 * The formula itself is within 0.15 % of the rated current of the true mean for the drive of 2019 with ten halves a
 * turn, where the ripple is 31 %.
 */
iqfoc_dq_t iqfoc_ripple_half_seen(const iqfoc_ripple_half_t *ripple, iqfoc_abc_t high, iq24_t u_dc,
                                  bool to_peak, iq24_sincos_t sc_mid);

#ifdef __cplusplus
}
#endif

#endif
