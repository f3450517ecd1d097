/*
 * Exact current and flux prediction of an induction machine in the stationary frame, with the rotor flux in place of
 * the magnet.
 *
 * The inverse-gamma circuit, per unit and cycle (docs/induction.md):
 *
 *     di/ds = k_u u - rho_s i - dp/ds              p: rotor flux over L_sigma I_b
 *     dp/ds = rho_r i - (a - j phi) p              phi: angle that the rotor covers in a cycle
 *
 * is linear in x = [i, p, u] with complex, constant coefficients: end and mean of a span are sums of three
 * complex products each. The coefficients follow the speed; the library makes them in a slower task as for
 * salient machines. No division by speed or resistance.
 *
 * A step returns the flux of the current model. With measured currents its error decays with the rotor's time
 * constant, so that iqfoc_induction_step is predictor and flux observer in one.
 *
 * predictor.h is an alternative: with k_psi = |p|, and the flux's angle and speed in place of the rotor's, its
 * formulas hold for an induction machine in field orientation.
 */
#ifndef IQFOC_INDUCTION_H
#define IQFOC_INDUCTION_H

#include "params.h"
#include "predictor_exact.h"
#include "ripple.h"
#include "rotor.h"
#include "vector.h"

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The machine; finer than IQ24 for the same reason as iqfoc_exact_winding_t. */
typedef struct iqfoc_induction_machine {
    int32_t rho_s_q30; /* R_s T/L_sigma; 0 <= rho_s <= 0.5 */
    int32_t rho_r_q30; /* R_r T/L_sigma; 0 <= rho_r <= 0.5 */
    int32_t a_q30;     /* R_r T/L_m; 0 <= a <= 0.1 */
    int32_t k_u_q26;   /* T U_b/(L_sigma I_b); 0 < k_u <= 16 */
} iqfoc_induction_machine_t;

/* iqfoc_induction_machine_t of the inverse-gamma circuit, checked: rho_s, rho_r, a, k_u. */
#define IQFOC_INDUCTION_MACHINE(R_s_ohm, R_r_ohm, L_sigma_H, L_m_H, T_s, I_b_A, U_b_V)                       \
    {                                                                                                        \
        IQFOC_EXACT_CHECKED(IQFOC_RAW_K_R(R_s_ohm, L_sigma_H, T_s), 30, 0.0, 0.5),                           \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_R(R_r_ohm, L_sigma_H, T_s), 30, 0.0, 0.5),                       \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_R(R_r_ohm, L_m_H, T_s), 30, 0.0, 0.1),                           \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_U(L_sigma_H, T_s, I_b_A, U_b_V), 26, 6e-8, IQFOC_MAX_K_U)        \
    }

/* A complex coefficient, Q26. */
typedef struct iqfoc_induction_factor {
    int32_t re_q26;
    int32_t im_q26;
} iqfoc_induction_factor_t;

/* Coefficients of one result. */
typedef struct iqfoc_induction_row {
    iqfoc_induction_factor_t of_i;
    iqfoc_induction_factor_t of_flux;
    iqfoc_induction_factor_t of_u;
    iqfoc_induction_factor_t of_ripple; /* see iqfoc_induction_with_ripple */
} iqfoc_induction_row_t;

/* At a speed and span. */
typedef struct iqfoc_induction {
    iqfoc_induction_row_t i;      /* current at the end */
    iqfoc_induction_row_t flux;   /* rotor flux at the end */
    iqfoc_induction_row_t i_mean; /* mean current over the span */
} iqfoc_induction_t;

/* Per unit: current, and rotor flux over L_sigma I_b. */
typedef struct iqfoc_induction_state {
    iqfoc_ab_t i;
    iqfoc_ab_t flux;
} iqfoc_induction_state_t;

/*
 * The coefficients. speed: the rotor's electrical speed, IQ24 turns per whole control cycle, |speed| <=
 * IQFOC_ROTOR_SPEED_MAX, a larger one is taken as that limit. span: IQ24 share of a cycle, 0 < span <= 1.
 * machine: within the ranges above. For a slower task: some 3500 instructions on a Cortex-M4 at the most
 * (docs/bench.md). Error: within that of a step.
 */
iqfoc_induction_t iqfoc_induction_at_speed(const iqfoc_induction_machine_t *machine, iq24_t speed,
                                           iq24_t span);

/* One result; see iqfoc_induction_step. */
static inline iqfoc_ab_t iqfoc_induction_result(const iqfoc_induction_row_t *row,
                                                const iqfoc_induction_state_t *x, iqfoc_ab_t u)
{
    const int64_t half = INT64_C(1) << 25;
    int64_t alpha = IQ24_MAC64(half, row->of_i.re_q26, x->i.alpha);
    int64_t beta = IQ24_MAC64(half, row->of_i.re_q26, x->i.beta);
    alpha = IQ24_MAC64(alpha, -row->of_i.im_q26, x->i.beta);
    beta = IQ24_MAC64(beta, row->of_i.im_q26, x->i.alpha);
    alpha = IQ24_MAC64(alpha, row->of_flux.re_q26, x->flux.alpha);
    beta = IQ24_MAC64(beta, row->of_flux.re_q26, x->flux.beta);
    alpha = IQ24_MAC64(alpha, -row->of_flux.im_q26, x->flux.beta);
    beta = IQ24_MAC64(beta, row->of_flux.im_q26, x->flux.alpha);
    alpha = IQ24_MAC64(alpha, row->of_u.re_q26, u.alpha);
    beta = IQ24_MAC64(beta, row->of_u.re_q26, u.beta);
    alpha = IQ24_MAC64(alpha, row->of_u.im_q26, -u.beta);
    beta = IQ24_MAC64(beta, row->of_u.im_q26, u.alpha);
    const iqfoc_ab_t result = {iq24_shift_wrap(alpha, 26), iq24_shift_wrap(beta, 26)};
    return result;
}

/*
 * Current and flux at the end of the span.
 *
 * x: at its start, per unit, |i| <= 8 and |flux| <= 16, vectors' lengths. u: the voltage in the span, |u|
 * <= 2. Out: per unit, |i| <= 81, |flux| <= 24: no overflow in that range, beyond it the result wraps.
 * Largest error against the exact solution for the physical machine, the integers x, u and speed as given
 * (tests/unit/library/test_induction.c), of 200000 drawn: 3 LSB, mean 2 LSB, where rho <= 0.1, k_u <= 4, |i| <= 1.5
 * and |flux| <= 4; 12 and 7 LSB over the whole range.
 *
 * Range: |dp/ds| <= |i|/2 + 2.1 |p| bounds what flows from flux to current: |i'| <= 8 + 38 + 32 and a little;
 * in Q50 below 2^57.
 */
static inline iqfoc_induction_state_t iqfoc_induction_step(const iqfoc_induction_t *induction,
                                                           iqfoc_induction_state_t x, iqfoc_ab_t u)
{
    const iqfoc_induction_state_t next = {iqfoc_induction_result(&induction->i, &x, u),
                                          iqfoc_induction_result(&induction->flux, &x, u)};
    return next;
}

/* The mean current over the span, stationary frame; ranges and error as above. */
static inline iqfoc_ab_t iqfoc_induction_mean(const iqfoc_induction_t *induction, iqfoc_induction_state_t x,
                                              iqfoc_ab_t u)
{
    return iqfoc_induction_result(&induction->i_mean, &x, u);
}

/*
 * A result of the functions above plus the effect of PWM's pulses. Without this term the prediction by the mean
 * voltage has an error of up to 1 %, most of it in the flux: the ripple flows in the rotor too, and the observer sums
 * it up.
 *
 * row: of the result, over a whole cycle. even: the result. v: iqfoc_ripple_vector of the cycle's duties,
 * square 0. To the second moment of the pulses: at most 5 % of what this adds is left
 * (tests/unit/library/test_induction_table.c). Rounding: 1 LSB more.
 */
static inline iqfoc_ab_t iqfoc_induction_with_ripple(const iqfoc_induction_row_t *row, iqfoc_ab_t even,
                                                     iqfoc_ab_t v)
{
    const int64_t half = INT64_C(1) << 25;
    int64_t alpha = IQ24_MAC64(half, row->of_ripple.re_q26, v.alpha);
    int64_t beta = IQ24_MAC64(half, row->of_ripple.re_q26, v.beta);
    alpha = IQ24_MAC64(alpha, -row->of_ripple.im_q26, v.beta);
    beta = IQ24_MAC64(beta, row->of_ripple.im_q26, v.alpha);
    const iqfoc_ab_t result = {iq24_add_wrap(even.alpha, iq24_shift_wrap(alpha, 26)),
                               iq24_add_wrap(even.beta, iq24_shift_wrap(beta, 26))};
    return result;
}

#ifdef __cplusplus
}
#endif

#endif
