/*
 * Checks that a set of parameters has the data of a drive's methods, before the cycle starts with it or it is
 * offered:
 *
 *     iqfoc_cycle_init_by(methods, &cycle, &config)      when the drive starts
 *     iqfoc_cycle_offer_by(methods, &cycle, &config)     while the drive runs
 *
 * If `methods` is a constant, only the checks of the named methods are compiled. The ready-made cycle needs none of
 * these checks: iqfoc_cycle_init and iqfoc_cycle_offer.
 */
#ifndef IQFOC_CYCLE_CHECK_H
#define IQFOC_CYCLE_CHECK_H

#include "cycle.h"
#include "cycle_predict.h"

#ifdef __cplusplus
extern "C" {
#endif

/* True if each method is of its enumeration and all can be combined. */
IQFOC_STEP bool iqfoc_methods_agree(const iqfoc_methods_t m)
{
    const bool plain =
        m.model == IQFOC_MODEL_QUASI_DISCRETE || m.model == IQFOC_MODEL_EXACT || m.model == IQFOC_MODEL_EULER;
    const bool salient = m.model == IQFOC_MODEL_SALIENT;
    const bool fed = m.feedback == IQFOC_FEEDBACK_MIDPOINT || m.feedback == IQFOC_FEEDBACK_CORRECTED_MEAN ||
                     (plain && (m.feedback == IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN ||
                                m.feedback == IQFOC_FEEDBACK_MODULATED_MEAN)) ||
                     ((salient || m.model == IQFOC_MODEL_EXACT) && m.feedback == IQFOC_FEEDBACK_EXACT_MEAN);
    const bool controlled =
        m.control == IQFOC_CONTROL_PI ||
        (plain && (m.control == IQFOC_CONTROL_DEADBEAT || m.control == IQFOC_CONTROL_DEADBEAT_LEARNING));
    return (plain || salient || m.model == IQFOC_MODEL_FLUX || m.model == IQFOC_MODEL_FLUX_MAP) && fed &&
           controlled &&
           (m.modulation == IQFOC_MODULATION_PWM || m.modulation == IQFOC_MODULATION_SIX_STEP ||
            m.modulation == IQFOC_MODULATION_OVER);
}

/* True if all data that the methods need are present. */
IQFOC_STEP bool iqfoc_methods_have(const iqfoc_methods_t m, const iqfoc_methods_data_t *data)
{
    const bool mean = m.feedback == IQFOC_FEEDBACK_EXACT_MEAN;
    return (m.model != IQFOC_MODEL_EXACT || (data->exact != 0 && (!mean || data->exact_mean != 0))) &&
           (m.model != IQFOC_MODEL_SALIENT || (data->salient != 0 && (!mean || data->salient_mean != 0))) &&
           (m.model != IQFOC_MODEL_FLUX || (data->flux != 0 && data->acting != 0)) &&
           (m.model != IQFOC_MODEL_FLUX_MAP || (data->flux_map != 0 && data->acting != 0)) &&
           (!m.extended || data->extension != 0);
}

/* True if the configuration's own fields name no other method: they are 0 or the same. */
IQFOC_STEP bool iqfoc_methods_named_once(const iqfoc_methods_t m, const iqfoc_cycle_config_t *config)
{
    return (config->feedback == IQFOC_FEEDBACK_MIDPOINT || config->feedback == m.feedback) &&
           (config->modulation == IQFOC_MODULATION_PWM || config->modulation == m.modulation);
}

/*
 * Returns IQFOC_OK or the first error. config: not NULL.
 *
 * - IQFOC_ERROR_METHODS: methods that cannot be combined, or a number for deadbeat control outside the range of
 *   iqfoc_methods_data_t
 * - IQFOC_ERROR_CHOICE: `feedback` or `modulation` of the configuration names another method
 * - IQFOC_ERROR_NULL: a pointer is missing
 * - the errors of iqfoc_flux_predictor_check, iqfoc_flux_map_check and iqfoc_extension_check
 *
 */
IQFOC_STEP iqfoc_error_t iqfoc_cycle_check(const iqfoc_methods_t m, const iqfoc_cycle_config_t *config)
{
    const iqfoc_methods_data_t *data = &config->data;
    if (!iqfoc_methods_agree(m)) {
        return IQFOC_ERROR_METHODS;
    }
    if (!iqfoc_methods_named_once(m, config)) {
        return IQFOC_ERROR_CHOICE;
    }
    if (!iqfoc_methods_have(m, data)) {
        return IQFOC_ERROR_NULL;
    }
    if (m.control != IQFOC_CONTROL_PI && !(iq24_within(data->k_u_inverse, IQ24(0.0625), IQ24(64.0)) &&
                                           iq24_within(data->k_psi, 0, IQ24(8.0)))) {
        return IQFOC_ERROR_METHODS;
    }
    if (m.control == IQFOC_CONTROL_DEADBEAT_LEARNING && !iq24_within(data->learning, 0, IQ24_ONE)) {
        return IQFOC_ERROR_METHODS;
    }
    if (m.model == IQFOC_MODEL_FLUX) {
        const iqfoc_error_t unfit = iqfoc_flux_predictor_check(data->flux);
        if (unfit != IQFOC_OK) {
            return unfit;
        }
    }
    if (m.model == IQFOC_MODEL_FLUX_MAP) {
        const iqfoc_error_t unfit = iqfoc_flux_map_check(data->flux_map);
        if (unfit != IQFOC_OK) {
            return unfit;
        }
    }
    if (m.extended) {
        return iqfoc_extension_check(data->extension);
    }
    return IQFOC_OK;
}

/*
 * iqfoc_cycle_init for these methods. The object is unchanged if methods or set are refused. Ahead of the first
 * interrupt only.
 */
IQFOC_STEP iqfoc_error_t iqfoc_cycle_init_by(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                             const iqfoc_cycle_config_t *config)
{
    const iqfoc_error_t unfit = config != 0 ? iqfoc_cycle_check(m, config) : IQFOC_ERROR_NULL;
    return unfit != IQFOC_OK ? unfit : iqfoc_cycle_init_named(cycle, config);
}

/* iqfoc_cycle_offer for these methods; the cycle is unchanged on an error. From any task. */
IQFOC_STEP iqfoc_error_t iqfoc_cycle_offer_by(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                              const iqfoc_cycle_config_t *config)
{
    const iqfoc_error_t unfit = config != 0 ? iqfoc_cycle_check(m, config) : IQFOC_ERROR_NULL;
    return unfit != IQFOC_OK ? unfit : iqfoc_cycle_offer_named(cycle, config);
}

#ifdef __cplusplus
}
#endif

#endif
