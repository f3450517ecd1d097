/*
 * The papers' predictors as coefficients of the exact predictor's step. A controller with an iqfoc_exact_t then works
 * with any of the three predictors.
 *
 * All three are i' = a i + k_u u - j (w_real + j w_imag) e^(j theta_m), theta_m at mid-cycle. With w = k_psi phi:
 *
 *     standard, 2019 (3):         a = 1 - k_r,   w e^(-j phi/2), as its EMF has the angle of the cycle's start
 *     quasi-discrete, 2019 (12):  a = 1 - k_r,   w s1
 *     exact:                      a = E,         w G                                     (predictor_exact.h)
 *
 * cos(phi/2) = s1 - phi s2 and sin(phi/2) = phi s1/2, so that the rotor's numbers suffice. w is a product of two Q24
 * numbers in Q26, iq24_mul_shift(a, b, 22): within +-16.8 and so below 2^31; error 1/8 LSB. All functions only read
 * their arguments: any context.
 */
#ifndef IQFOC_PREDICTOR_FORM_H
#define IQFOC_PREDICTOR_FORM_H

#include "predictor.h"
#include "predictor_exact.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The common part of both. Range: |1 - k_r| <= 1 and k_u <= 16, below 2^31 in Q26. Exact. */
static inline iqfoc_exact_t iqfoc_form_of(const iqfoc_predictor_t *predictor, int32_t w_real_q26,
                                          int32_t w_imag_q26)
{
    const iqfoc_exact_t form = {(IQ24_ONE - predictor->k_r) * 4, predictor->k_u * 4, w_real_q26, w_imag_q26};
    return form;
}

/*
 * The standard prediction. iqfoc_exact_step with it and the angle at mid-cycle gives what
 * iqfoc_predictor_euler gives with the angle at the start.
 *
 * Ranges as in predictor.h. Largest difference of the two, of 200000 drawn (tests/unit/library/test_deadbeat.c): 3
 * LSB where |k_psi phi| <= 1, 30 LSB where it is 16.8, its most.
 */
static inline iqfoc_exact_t iqfoc_form_euler(const iqfoc_predictor_t *predictor, const iqfoc_rotor_t *rotor)
{
    const iq24_t w = iq24_mul_round(predictor->k_psi, rotor->phi);
    const iq24_t sin_half = iq24_asr32(rotor->phi_s1, 1);
    return iqfoc_form_of(predictor, iq24_mul_shift(w, rotor->s1 - rotor->phi_s2, 22),
                         -iq24_mul_shift(w, sin_half, 22));
}

/* The quasi-discrete prediction, as iqfoc_predictor_quasi_discrete. Ranges as there; difference 1 LSB. */
static inline iqfoc_exact_t iqfoc_form_quasi_discrete(const iqfoc_predictor_t *predictor,
                                                      const iqfoc_rotor_t *rotor)
{
    return iqfoc_form_of(predictor, iq24_mul_shift(predictor->k_psi, rotor->phi_s1, 22), 0);
}

#ifdef __cplusplus
}
#endif

#endif
