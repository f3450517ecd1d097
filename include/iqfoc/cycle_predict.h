/*
 * The second half of the valley's step (iqfoc/cycle_steps.h): prediction of the cycle that begins, its mean, and
 * deadbeat control, which needs no later sample. Only iqfoc_cycle_valley_by calls it.
 */
#ifndef IQFOC_CYCLE_PREDICT_H
#define IQFOC_CYCLE_PREDICT_H

#include "cycle.h"
#include "deadbeat_drift.h"
#include "extension.h"
#include "flux_map.h"
#include "flux_predictor.h"
#include "iq24_sincos.h"
#include "mean_current.h"
#include "mean_modulated.h"
#include "predictor_exact.h"
#include "predictor_form.h"
#include "predictor_salient.h"
#include "transform.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Values that several methods use at a valley. */
typedef struct iqfoc_valley {
    iqfoc_ab_t i;
    iq24_t theta;
    iq24_sincos_t q30; /* of the angle at mid-cycle, Q30 */
    int32_t w_q26;     /* EMF of the quasi-discrete prediction, if a method needs it */
    int32_t s1_q30;    /* of the speed */
    int32_t s2_q30;
    iqfoc_exact_t exact; /* deadbeat, and the exact model: the cycle's coefficients */
} iqfoc_valley_t;

/* Sine and cosine at mid-cycle in IQ24. */
static inline iq24_sincos_t iqfoc_valley_sc_mid(const iqfoc_valley_t *valley)
{
    const iq24_sincos_t sc = {iq24_asr32(valley->q30.sin + 32, 6), iq24_asr32(valley->q30.cos + 32, 6)};
    return sc;
}

/* Methods that need all values of the rotor's movement, those that need s1, and those that need s2 as well. */
IQFOC_STEP bool iqfoc_wants_rotor(const iqfoc_methods_t m)
{
    return (m.control != IQFOC_CONTROL_PI && m.model != IQFOC_MODEL_EXACT) ||
           m.feedback == IQFOC_FEEDBACK_MODULATED_MEAN || m.model == IQFOC_MODEL_EULER || m.extended;
}

IQFOC_STEP bool iqfoc_wants_s2(const iqfoc_methods_t m)
{
    return m.feedback == IQFOC_FEEDBACK_CORRECTED_MEAN || m.feedback == IQFOC_FEEDBACK_EXACT_MEAN;
}

IQFOC_STEP bool iqfoc_wants_s1(const iqfoc_methods_t m)
{
    return m.control != IQFOC_CONTROL_PI || iqfoc_wants_s2(m);
}

/* Methods that need the EMF of the quasi-discrete prediction. */
IQFOC_STEP bool iqfoc_wants_emf(const iqfoc_methods_t m)
{
    return m.feedback == IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN ||
           (m.model == IQFOC_MODEL_QUASI_DISCRETE && m.control == IQFOC_CONTROL_PI);
}

/*
 * The rotor's movement from the polynomials; rounded to IQ24 if a method needs it.
 *
 * EMF as iqfoc_predictor_emf, from turns s1 in Q30: |x s1| <= 0.276, times 2 pi in Q28 leaves phi s1 in Q26,
 * |phi s1| <= 1.74; times k_psi <= 8 within 2^54. Error of w: floors, 0.25 LSB, and 0.35 LSB per unit of
 * k_psi.
 */
IQFOC_STEP void iqfoc_cycle_rotor(const iqfoc_methods_t m, iqfoc_cycle_t *cycle, iqfoc_valley_t *valley,
                                  const iqfoc_sample_t *sample, iq24_t speed)
{
    const iqfoc_rotor_shape_t shape = iqfoc_rotor_shape(speed);
    valley->s1_q30 = shape.p1_q30;
    valley->s2_q30 = iq24_mul_high(shape.x_q32, shape.p2_q30);
    cycle->rotor.speed = speed;
    if (iqfoc_wants_rotor(m)) {
        cycle->rotor = iqfoc_rotor_of_shape(speed, &shape);
    } else if (iqfoc_wants_s1(m)) {
        cycle->rotor.s1 = iqfoc_rotor_s1(&shape);
        if (iqfoc_wants_s2(m)) {
            cycle->rotor.s2 = iqfoc_rotor_s2(&shape);
        }
    }
    if (iqfoc_wants_emf(m)) {
        const int32_t x_s1_q30 = iq24_mul_high(shape.x_q32, shape.p1_q30);
        const int32_t phi_s1_q26 = iq24_mul_high(x_s1_q30, IQFOC_Q28_2_PI);
        valley->w_q26 = iq24_shift_wrap(IQ24_MUL64(cycle->config->predictor.k_psi, phi_s1_q26), 24);
    }
    /* |sample->instant| <= 1, and the angle's sum wraps at 128 turns, which are whole. */
    valley->theta = iq24_sub_wrap(sample->theta, iq24_mul_high(shape.x_q32, sample->instant));
    if (m.control == IQFOC_CONTROL_DEADBEAT_LEARNING) { /* here, where fewest values are held in registers */
        iqfoc_deadbeat_learn(&cycle->drift, cycle->config->data.learning, cycle->error, valley->theta);
    }
    valley->q30 = iq24_sincos_q30_inline(iq24_add_wrap(valley->theta, iq24_asr32(speed, 1)));
    cycle->theta_valley = valley->theta;
}

/* Predictors in the rotor frame or by flux linkage, with their own angles. Sets i_dq for the salient mean. */
IQFOC_STEP iqfoc_ab_t iqfoc_cycle_predict_salient(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                                  const iqfoc_valley_t *valley, iqfoc_ab_t u)
{
    const iqfoc_methods_data_t *data = &cycle->config->data;
    const iq24_sincos_t start = iq24_sincos(valley->theta);
    const iq24_sincos_t end = iq24_sincos(iq24_add_wrap(valley->theta, cycle->rotor.speed));
    if (m.model == IQFOC_MODEL_FLUX) {
        return iqfoc_flux_predictor_step(data->flux, data->acting, valley->i, u, start, end);
    }
    if (m.model == IQFOC_MODEL_FLUX_MAP) {
        return iqfoc_flux_map_step(data->flux_map, data->acting, valley->i, u, start, end);
    }
    const iqfoc_dq_t i_dq = iqfoc_park(valley->i, start);
    const iqfoc_dq_t u_dq = iqfoc_park(u, start);
    if (m.feedback == IQFOC_FEEDBACK_EXACT_MEAN) {
        cycle->i_dq = iqfoc_salient_step(data->salient_mean, i_dq, u_dq);
    }
    return iqfoc_park_inverse(iqfoc_salient_step(data->salient, i_dq, u_dq), end);
}

/* Coefficients of an exact law at this speed. */
IQFOC_STEP iqfoc_exact_t iqfoc_cycle_exact(const iqfoc_exact_law_t *law, const iqfoc_cycle_t *cycle)
{
    return iqfoc_exact_at_speed_inline(law, cycle->rotor.speed);
}

/* Prediction for a machine without saliency, at this speed and current. */
IQFOC_STEP iqfoc_ab_t iqfoc_cycle_predict_plain(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                                iqfoc_valley_t *valley, iqfoc_ab_t u)
{
    const iqfoc_cycle_config_t *config = cycle->config;
    if (m.model == IQFOC_MODEL_EXACT) {
        valley->exact = iqfoc_cycle_exact(config->data.exact, cycle);
        return iqfoc_exact_step(&valley->exact, valley->i, u, iqfoc_valley_sc_mid(valley));
    }
    const iqfoc_predictor_t *predictor = &config->predictor;
    iqfoc_predictor_t saturated;
    if (m.extended && config->data.extension->saturation != 0) {
        saturated = iqfoc_extension_saturate(config->data.extension, predictor, valley->i);
        predictor = &saturated;
        valley->w_q26 = iq24_mul_shift(saturated.k_psi, cycle->rotor.phi_s1, 22);
    }
    if (m.control != IQFOC_CONTROL_PI || m.model == IQFOC_MODEL_EULER) {
        valley->exact = m.model == IQFOC_MODEL_EULER ? iqfoc_form_euler(predictor, &cycle->rotor)
                                                     : iqfoc_form_quasi_discrete(predictor, &cycle->rotor);
        return iqfoc_exact_step(&valley->exact, valley->i, u, iqfoc_valley_sc_mid(valley));
    }
    return iqfoc_predictor_step_q30(predictor, valley->i, u, valley->w_q26, valley->q30);
}

/* The mean of the cycle that begins, seen from the rotor; see iqfoc_feedback_t. */
IQFOC_STEP void iqfoc_cycle_mean(const iqfoc_methods_t m, iqfoc_cycle_t *cycle, const iqfoc_valley_t *valley,
                                 iqfoc_ab_t i_next, iq24_t u_dc)
{
    if (m.feedback == IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN) {
        cycle->i_dq = iqfoc_mean_current_seen_q30(valley->i, i_next, valley->w_q26, valley->s1_q30,
                                                  valley->s2_q30, valley->q30);
    } else if (m.feedback == IQFOC_FEEDBACK_EXACT_MEAN && m.model == IQFOC_MODEL_EXACT) {
        const iqfoc_exact_t law = iqfoc_cycle_exact(cycle->config->data.exact_mean, cycle);
        const iqfoc_ab_t mean = iqfoc_exact_step(&law, valley->i, cycle->u_now, iqfoc_valley_sc_mid(valley));
        const iqfoc_ab_t delta = {iq24_sub_wrap(i_next.alpha, valley->i.alpha),
                                  iq24_sub_wrap(i_next.beta, valley->i.beta)};
        cycle->i_dq = iqfoc_mean_current_correct(mean, delta, &cycle->rotor, iqfoc_valley_sc_mid(valley));
    } else if (m.feedback == IQFOC_FEEDBACK_MODULATED_MEAN) {
        const iqfoc_mean_modulated_t c =
            iqfoc_mean_modulated_at_speed(&cycle->config->predictor, &cycle->rotor);
        cycle->i_dq =
            iqfoc_mean_modulated(&c, valley->i, i_next, cycle->duties_now, u_dc, iqfoc_valley_sc_mid(valley));
    }
}

/*
 * Deadbeat control as in deadbeat.h and deadbeat_drift.h: the voltage of the cycle after this one.
 *
 * The disturbance estimate shifts both cycles: it is added to the prediction and subtracted from the second cycle's
 * target.
 */
IQFOC_STEP iqfoc_ab_t iqfoc_cycle_deadbeat(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                           const iqfoc_valley_t *valley, iqfoc_ab_t *i_next)
{
    const iqfoc_methods_data_t *data = &cycle->config->data;
    const iq24_t speed = cycle->rotor.speed;
    iqfoc_dq_t drift = {0, 0};
    if (m.control == IQFOC_CONTROL_DEADBEAT_LEARNING) {
        drift = cycle->drift;
        const iqfoc_ab_t moved =
            iqfoc_park_inverse(drift, iq24_sincos_inline(iq24_add_wrap(valley->theta, speed)));
        i_next->alpha = iq24_add_wrap(i_next->alpha, moved.alpha);
        i_next->beta = iq24_add_wrap(i_next->beta, moved.beta);
    }
    const iqfoc_deadbeat_t deadbeat = {valley->exact, data->k_u_inverse,
                                       iqfoc_valley_reference_at(&cycle->rotor, data->k_psi)};
    const iqfoc_dq_t i_valley = iqfoc_valley_reference(&deadbeat.reference, cycle->i_ref);
    const iqfoc_dq_t aim = {iq24_sub_wrap(i_valley.d, drift.d), iq24_sub_wrap(i_valley.q, drift.q)};
    const iq24_t end = iq24_add_wrap(valley->theta, 2 * speed);
    const iqfoc_ab_t target = iqfoc_park_inverse(aim, iq24_sincos_inline(end));
    const iq24_t mid = iq24_add_wrap(valley->theta, iq24_asr32(speed, 1));
    return iqfoc_deadbeat_voltage(&deadbeat, *i_next, target, iq24_sincos_inline(iq24_add_wrap(mid, speed)));
}

/* Prediction, mean and deadbeat control of a valley. speed: held to its limit. */
IQFOC_STEP void iqfoc_cycle_predict(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                    const iqfoc_sample_t *sample, iqfoc_ab_t i, iq24_t speed)
{
    /*
     * Deadbeat control has a model without saliency (cycle_check.h), which sets valley.exact. A compiler that gets the
     * methods in a variable does not see that.
     */
    const iqfoc_exact_t none = {0, 0, 0, 0};
    iqfoc_valley_t valley;
    valley.i = i;
    valley.exact = none;
    valley.w_q26 = 0;
    iqfoc_cycle_rotor(m, cycle, &valley, sample, speed);
    iqfoc_ab_t u;
    IQ24_LOAD_PAIR(u.alpha, u.beta, cycle->u_ab.alpha, cycle->u_ab.beta);
    cycle->u_now = u;
    iqfoc_ab_t i_next =
        m.model == IQFOC_MODEL_SALIENT || m.model == IQFOC_MODEL_FLUX || m.model == IQFOC_MODEL_FLUX_MAP
            ? iqfoc_cycle_predict_salient(m, cycle, &valley, u)
            : iqfoc_cycle_predict_plain(m, cycle, &valley, u);
    if (m.feedback == IQFOC_FEEDBACK_MODULATED_MEAN) {
        cycle->duties_now = cycle->duties_next;
    }
    iqfoc_cycle_mean(m, cycle, &valley, i_next, sample->u_dc);
    if (m.control != IQFOC_CONTROL_PI) {
        cycle->u_ab = iqfoc_cycle_deadbeat(m, cycle, &valley, &i_next);
    }
    cycle->i_next = i_next;
}

#ifdef __cplusplus
}
#endif

#endif
