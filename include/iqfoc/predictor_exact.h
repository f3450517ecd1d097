/*
 * Exact prediction and exact mean of the current of a non-salient machine, both axes (all phases) at once, over a
 * whole control cycle or any part of one.
 *
 * The resistance stays in the differential equation, while the quasi-discrete model keeps R i at its first value
 * (docs/exact-prediction.md):
 *
 *     i' = E i + (1 - E)/rho k_u u - j k_psi phi G e^(j theta_m)
 *     rho = R t/L,   E = e^-rho,   z = rho + j phi,   G = e^(-rho/2) sinh(z/2)/(z/2)
 *
 * t is the duration of the span, phi the angle covered in it and theta_m the rotor angle at its middle; u is constant
 * over the span. The mean has the same form with other coefficients, so that one step serves both. Neither the form
 * nor its coefficients divide by R or by the speed: R = 0 and standstill are ordinary arguments.
 *
 * Three stages, each computed as seldom as possible:
 *
 *     static const iqfoc_exact_winding_t winding = IQFOC_EXACT_WINDING(R, L, PSI, T, I_B, U_DC);
 *     law = iqfoc_exact_prediction(&winding, IQ24_ONE);                      once, or when R changes
 *     exact = iqfoc_exact_at_speed(&law, speed);                             when the speed changes
 *     i_next = iqfoc_exact_step(&exact, i, u, iq24_sincos(theta_mid));       every cycle
 *
 * Other spans: IQ24(0.5) and the sample at the carrier's peak predict the next valley; the computation delay as a
 * share of the cycle predicts the current at which a result acts. All functions only read their arguments: any
 * context may call them.
 */
#ifndef IQFOC_PREDICTOR_EXACT_H
#define IQFOC_PREDICTOR_EXACT_H

#include "iq24_math.h"
#include "params.h"
#include "rotor.h"
#include "vector.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The machine, per unit and cycle. Finer than IQ24, because a coefficient's rounding is multiplied by the
 * current: half an LSB of rho alone would be half an LSB of error per unit of current.
 */
typedef struct iqfoc_exact_winding {
    int32_t rho_q30;   /* R T/L; 0 <= rho <= 1 */
    int32_t k_u_q26;   /* T U_b/(L I_b); 0 < k_u <= 16 */
    int32_t k_psi_q27; /* psi_f/(L I_b); 0 <= k_psi <= 8; 0 for an RL load */
} iqfoc_exact_winding_t;

/* x in Q(bits), to nearest, as a constant; x >= 0. */
#define IQFOC_EXACT_Q(x, bits) IQ24_CAST_(int32_t, IQ24_RAISED_(x, bits) + 0.5)
/* The same; it does not compile if x is outside low ... high (params.h). */
#define IQFOC_EXACT_CHECKED(x, bits, low, high) (IQFOC_EXACT_Q(x, bits) / IQFOC_WITHIN_(x, low, high))

/* iqfoc_exact_winding_t of physical values, checked: rho, k_u, k_psi. */
#define IQFOC_EXACT_WINDING(R_ohm, L_H, psi_Wb, T_s, I_b_A, U_b_V)                                           \
    {                                                                                                        \
        IQFOC_EXACT_CHECKED(IQFOC_RAW_K_R(R_ohm, L_H, T_s), 30, 0.0, IQFOC_MAX_K_R),                         \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_U(L_H, T_s, I_b_A, U_b_V), 26, 6e-8, IQFOC_MAX_K_U),             \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_PSI(psi_Wb, L_H, I_b_A), 27, 0.0, IQFOC_MAX_K_PSI)               \
    }

#define IQFOC_EXACT_TERMS 6

/*
 * The coefficients of a winding and a span for every speed. With x in turns per cycle and w = (2 x)^2,
 *
 *     k_psi phi Re G = x real(w),     k_psi phi Im G = w imag(w),
 *
 * both polynomials with the lowest power first.
 */
typedef struct iqfoc_exact_law {
    int32_t stays_q26; /* of i: 0.36 ... 1 */
    int32_t k_u_q26;   /* of u: 0 ... 16 */
    int32_t real_q25[IQFOC_EXACT_TERMS];
    int32_t imag_q25[IQFOC_EXACT_TERMS];
} iqfoc_exact_law_t;

/* The coefficients at one speed, for a step. Q26 holds them to a quarter of IQ24's rounding, and +-32. */
typedef struct iqfoc_exact {
    int32_t stays_q26;
    int32_t k_u_q26;
    int32_t w_real_q26; /* k_psi phi Re G: -16.8 ... 16.8 */
    int32_t w_imag_q26; /* k_psi phi Im G: 0 ... 4 */
} iqfoc_exact_t;

/*
 * The law of the current at the end of a span, and that of its mean over the span (stationary frame).
 *
 * span: IQ24 share of a control cycle, 0 < span <= 1. winding: within the ranges above. Set-up, or a slower
 * task that follows the resistance: some 850 instructions on a Cortex-M4. Error: within that of
 * iqfoc_exact_step.
 */
iqfoc_exact_law_t iqfoc_exact_prediction(const iqfoc_exact_winding_t *winding, iq24_t span);
iqfoc_exact_law_t iqfoc_exact_mean(const iqfoc_exact_winding_t *winding, iq24_t span);

/*
 * A law's coefficients at a speed.
 *
 * speed: IQ24 turns per whole control cycle whatever the span, |speed| <= IQFOC_ROTOR_SPEED_MAX; a larger one
 * is taken as that limit. w_real is odd and w_imag even in the speed, to the last bit. Largest error of
 * 300000 drawn: w_real and w_imag 0.8 LSB of IQ24 over the whole range of windings, 0.4 for k_psi <= 2.
 * Cortex-M4: 54 instructions.
 */
iqfoc_exact_t iqfoc_exact_at_speed(const iqfoc_exact_law_t *law, iq24_t speed);

/*
 * The same inline, for a cycle that computes them at each valley; |speed| <= IQFOC_ROTOR_SPEED_MAX.
 *
 * Range: w <= 4/9. Each bracket of the polynomials is within Q25's 64 (src/predictor_exact.c), the products rounded
 * once. w_real is rounded to nearest, ties away from zero, as it is odd.
 */
static inline iqfoc_exact_t iqfoc_exact_at_speed_inline(const iqfoc_exact_law_t *law, iq24_t speed)
{
    const int32_t x_q32 = speed * 256;
    const int32_t w_q32 = iq24_shift_wrap(IQ24_MUL64(x_q32, x_q32), 30);
    const int32_t *r = law->real_q25;
    const int32_t *i = law->imag_q25;
    int32_t real = iq24_mac_high_round(r[4], r[5], w_q32);
    int32_t imag = iq24_mac_high_round(i[4], i[5], w_q32);
    real = iq24_mac_high_round(r[3], real, w_q32);
    imag = iq24_mac_high_round(i[3], imag, w_q32);
    real = iq24_mac_high_round(r[2], real, w_q32);
    imag = iq24_mac_high_round(i[2], imag, w_q32);
    real = iq24_mac_high_round(r[1], real, w_q32);
    imag = iq24_mac_high_round(i[1], imag, w_q32);
    real = iq24_mac_high_round(r[0], real, w_q32);
    imag = iq24_mac_high_round(i[0], imag, w_q32);
    const int64_t half = (INT64_C(1) << 22) + iq24_asr32(speed, 31);
    const iqfoc_exact_t exact = {law->stays_q26, law->k_u_q26,
                                 iq24_shift_wrap(IQ24_MAC64(half, speed, real), 23),
                                 iq24_mul_shift(w_q32, imag, 31)};
    return exact;
}

/* The current at the end without a voltage, before it is rounded: Q50. Ranges as iqfoc_exact_step. */
static inline void iqfoc_exact_unrounded(const iqfoc_exact_t *exact, iqfoc_ab_t i, iq24_sincos_t sc_mid,
                                         int64_t *alpha, int64_t *beta)
{
    const int64_t half = INT64_C(1) << 25;
    *alpha = IQ24_MAC64(half, i.alpha, exact->stays_q26);
    *beta = IQ24_MAC64(half, i.beta, exact->stays_q26);
    *alpha = IQ24_MAC64(*alpha, sc_mid.sin, exact->w_real_q26);
    *beta = IQ24_MAC64(*beta, sc_mid.cos, -exact->w_real_q26);
    *alpha = IQ24_MAC64(*alpha, sc_mid.cos, exact->w_imag_q26);
    *beta = IQ24_MAC64(*beta, sc_mid.sin, exact->w_imag_q26);
}

/*
 * The current at the end of the span, or its mean over it, by the law from which `exact` was computed.
 *
 * i: current at the start of the span, per unit, |component| <= 32. u: the voltage in the span, at most 2 a
 * component. sc_mid: of the rotor angle at the middle of the span. Out: |component| <= 81: no overflow in
 * that range, beyond it the result wraps. Largest error against the exact solution for the physical machine,
 * the integers i, u, angle and speed as given (tests/unit/library/test_predictor_exact.c), of 300000 drawn: 3.5 LSB
 * at the end and 2.7 for the mean where rho <= 0.1, k_u <= 3, k_psi <= 3 and |i| <= 1.5; 12 and 10 LSB over
 * the whole range. With the motors of data/motors/: 1.5 LSB at SFFR 3 to 200.
 *
 * Range: |E i| <= 32, |k_u u| <= 32 and |w| <= 16.8 together are below 80.8; in Q50 that is below 2^57.
 * Error: one rounding, 0.5 LSB; the sine's 0.51 LSB times |w|; an eighth of an LSB per unit of current.
 */
static inline iqfoc_ab_t iqfoc_exact_step(const iqfoc_exact_t *exact, iqfoc_ab_t i, iqfoc_ab_t u,
                                          iq24_sincos_t sc_mid)
{
    int64_t alpha;
    int64_t beta;
    iqfoc_exact_unrounded(exact, i, sc_mid, &alpha, &beta);
    alpha = IQ24_MAC64(alpha, u.alpha, exact->k_u_q26);
    beta = IQ24_MAC64(beta, u.beta, exact->k_u_q26);
    const iqfoc_ab_t next = {iq24_shift_wrap(alpha, 26), iq24_shift_wrap(beta, 26)};
    return next;
}

/* The same without a voltage: two products fewer than with u = 0. */
static inline iqfoc_ab_t iqfoc_exact_left_alone(const iqfoc_exact_t *exact, iqfoc_ab_t i,
                                                iq24_sincos_t sc_mid)
{
    int64_t alpha;
    int64_t beta;
    iqfoc_exact_unrounded(exact, i, sc_mid, &alpha, &beta);
    const iqfoc_ab_t next = {iq24_shift_wrap(alpha, 26), iq24_shift_wrap(beta, 26)};
    return next;
}

#ifdef __cplusplus
}
#endif

#endif
