/*
 * Exact prediction and exact mean of the dq current of a salient machine (L_d != L_q), over a whole control cycle or
 * any part of one. A non-salient machine is a special case.
 *
 * In the rotor's frame, current, voltage and a constant form a linear system with constant coefficients. The voltage
 * turns backwards there, because it is constant in the stationary frame (docs/exact-prediction.md):
 *
 *     x = [i_d, i_q, u_d, u_q, 1],   x' = M x,   x(1) = e^M x(0),   mean of x = (e^M - 1)/M x(0)
 *
 * Each component of the current at the end, and of its mean, is a sum of five terms: ten coefficients in all. They
 * depend on the speed; a slower task computes them from the machine's constants. No division by resistance, speed or
 * L_d - L_q.
 *
 *     static const iqfoc_salient_machine_t machine = IQFOC_SALIENT_MACHINE(R, L_D, L_Q, PSI, T, I_B, U_DC);
 *     iqfoc_salient_at_speed(&machine, turns, IQ24_ONE, &end, &mean);              when the speed changes
 *     i_next_dq = iqfoc_salient_step(&end, i_dq, u_dq);                            every cycle
 *
 * Frames: i_dq and u_dq are in the rotor frame at the start of the span (one sine serves both), the end in the rotor
 * frame at the end. The mean is that of the current as seen from the turning rotor. All functions only read their
 * arguments: any context may call them. A task must not write coefficients that an interrupt reads: it fills a second
 * set and offers it (iqfoc_cycle_offer).
 */
#ifndef IQFOC_PREDICTOR_SALIENT_H
#define IQFOC_PREDICTOR_SALIENT_H

#include "params.h"
#include "predictor_exact.h"
#include "rotor.h"
#include "vector.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The machine, per unit and cycle; finer than IQ24 for the same reason as iqfoc_exact_winding_t. */
typedef struct iqfoc_salient_machine {
    int32_t rho_d_q30;   /* R T/L_d; 0 <= rho <= 1 */
    int32_t rho_q_q30;   /* R T/L_q */
    int32_t k_d_q26;     /* T U_b/(L_d I_b); 0 < k <= 16 */
    int32_t k_q_q26;     /* T U_b/(L_q I_b) */
    int32_t k_psi_d_q27; /* psi_f/(L_d I_b); 0 <= k_psi <= 8; 0 for a reluctance machine */
    int32_t k_psi_q_q27; /* psi_f/(L_q I_b) */
    int32_t q_to_d_q27;  /* L_q/L_d; 1/8 ... 8 */
    int32_t d_to_q_q27;  /* L_d/L_q */
} iqfoc_salient_machine_t;

#define IQFOC_MAX_SALIENCY 8.0

/* iqfoc_salient_machine_t of physical values, checked; in the order of its members. */
#define IQFOC_SALIENT_MACHINE(R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V)                                \
    {                                                                                                        \
        IQFOC_EXACT_CHECKED(IQFOC_RAW_K_R(R_ohm, L_d_H, T_s), 30, 0.0, IQFOC_MAX_K_R),                       \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_R(R_ohm, L_q_H, T_s), 30, 0.0, IQFOC_MAX_K_R),                   \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_U(L_d_H, T_s, I_b_A, U_b_V), 26, 6e-8, IQFOC_MAX_K_U),           \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_U(L_q_H, T_s, I_b_A, U_b_V), 26, 6e-8, IQFOC_MAX_K_U),           \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_PSI(psi_Wb, L_d_H, I_b_A), 27, 0.0, IQFOC_MAX_K_PSI),            \
            IQFOC_EXACT_CHECKED(IQFOC_RAW_K_PSI(psi_Wb, L_q_H, I_b_A), 27, 0.0, IQFOC_MAX_K_PSI),            \
            IQFOC_EXACT_CHECKED((L_q_H) / (L_d_H), 27, 1.0 / IQFOC_MAX_SALIENCY, IQFOC_MAX_SALIENCY),        \
            IQFOC_EXACT_CHECKED((L_d_H) / (L_q_H), 27, 1.0 / IQFOC_MAX_SALIENCY, IQFOC_MAX_SALIENCY)         \
    }

/* Coefficients of one component of the result, Q26. */
typedef struct iqfoc_salient_row {
    int32_t i_d_q26;
    int32_t i_q_q26;
    int32_t u_d_q26;
    int32_t u_q_q26;
    int32_t constant_q26; /* the magnet's part */
} iqfoc_salient_row_t;

/* Ten coefficients: of the end of a span, or of the mean over it, at one speed. */
typedef struct iqfoc_salient {
    iqfoc_salient_row_t d;
    iqfoc_salient_row_t q;
} iqfoc_salient_t;

/*
 * The coefficients at a speed, for the end of a span and for the mean over it. Either may be NULL.
 *
 * speed: IQ24 turns per whole control cycle whatever the span, |speed| <= IQFOC_ROTOR_SPEED_MAX; a larger one
 * is taken as that limit. span: IQ24 share of a control cycle, 0 < span <= 1. machine: within the ranges
 * above. For a slower task: 1500 instructions on a Cortex-M4 at low speed, 3400 at most (docs/bench.md).
 * Error: within that of iqfoc_salient_step.
 */
void iqfoc_salient_at_speed(const iqfoc_salient_machine_t *machine, iq24_t speed, iq24_t span,
                            iqfoc_salient_t *end, iqfoc_salient_t *mean);

/* One component; see iqfoc_salient_step. */
static inline iq24_t iqfoc_salient_component(const iqfoc_salient_row_t *row, iqfoc_dq_t i, iqfoc_dq_t u)
{
    int64_t sum = IQ24_MAC64(INT64_C(1) << 25, row->constant_q26, IQ24_ONE);
    sum = IQ24_MAC64(sum, row->i_d_q26, i.d);
    sum = IQ24_MAC64(sum, row->i_q_q26, i.q);
    sum = IQ24_MAC64(sum, row->u_d_q26, u.d);
    sum = IQ24_MAC64(sum, row->u_q_q26, u.q);
    return iq24_shift_wrap(sum, 26);
}

/*
 * The dq current at the end of the span, or its mean over it, by the coefficients given.
 *
 * i: dq current at the start, per unit, |component| <= 8; u: dq voltage at the start, |u| <= 2. Out:
 * |component| <= 121: no overflow in that range, beyond it the result wraps.
 * Largest error against the exact solution for the physical machine, the integers i, u and speed as given
 * (tests/unit/library/test_predictor_salient.c), of 200000 drawn: 2.2 LSB at the end and 1.4 for the mean where rho
 * <= 0.1, k <= 3, k_psi <= 3, L_q/L_d 0.5 ... 3 and |i| <= 1.5; 18 and 9 LSB over the whole range. With the
 * motors of data/motors/: 1.4 LSB at SFFR 3 to 200.
 *
 * Range: |i| 8 + 8 L_q/L_d <= 72, |k u| <= 32 and the magnet's 16.8 together are below 121; in Q50 below
 * 2^57.
 */
static inline iqfoc_dq_t iqfoc_salient_step(const iqfoc_salient_t *salient, iqfoc_dq_t i, iqfoc_dq_t u)
{
    const iqfoc_dq_t next = {iqfoc_salient_component(&salient->d, i, u),
                             iqfoc_salient_component(&salient->q, i, u)};
    return next;
}

#ifdef __cplusplus
}
#endif

#endif
