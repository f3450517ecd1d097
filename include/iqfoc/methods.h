/*
 * By which methods the control cycle works (iqfoc/cycle_steps.h), and what those beyond the papers' need.
 *
 * A drive names its methods in a constant and gives it to the steps; what is not named is not compiled:
 *
 *     static const iqfoc_methods_t methods = {IQFOC_MODEL_EXACT, IQFOC_FEEDBACK_EXACT_MEAN, IQFOC_CONTROL_PI,
 *                                             IQFOC_MODULATION_PWM, true};
 */
#ifndef IQFOC_METHODS_H
#define IQFOC_METHODS_H

#include "error.h"
#include "extension.h"
#include "flux_predictor.h"
#include "predictor_exact.h"
#include "predictor_salient.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How the current at the next valley is predicted. */
typedef enum iqfoc_model {
    IQFOC_MODEL_QUASI_DISCRETE, /* 2019 (12): predictor.h; saturation by `extended` */
    IQFOC_MODEL_EXACT,          /* predictor_exact.h; data.exact */
    IQFOC_MODEL_SALIENT,        /* predictor_salient.h; data.salient, made for the speed by a slower task */
    IQFOC_MODEL_FLUX,           /* flux_predictor.h: salient and saturating; data.flux, data.acting */
    IQFOC_MODEL_EULER           /* 2019 (3), for comparison */
} iqfoc_model_t;

/* Which current the controller is fed with. */
typedef enum iqfoc_feedback {
    /* The sample at the carrier peak, turned by its own angle: usual practice. */
    IQFOC_FEEDBACK_MIDPOINT,
    /* 2016 (10) over the cycle that ended at the last valley: one cycle old. */
    IQFOC_FEEDBACK_CORRECTED_MEAN,
    /* 2019 (10), corrected by 2016 (10), over the cycle from the last valley. */
    IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    /* The model's own mean over that cycle; models exact (data.exact_mean) and salient (data.salient_mean). */
    IQFOC_FEEDBACK_EXACT_MEAN,
    /* The mean with what PWM's ripple adds (mean_modulated.h); models without saliency. */
    IQFOC_FEEDBACK_MODULATED_MEAN
} iqfoc_feedback_t;

/* What makes the voltage of the current's error. */
typedef enum iqfoc_control {
    IQFOC_CONTROL_PI,               /* current_control.h, at the peak */
    IQFOC_CONTROL_DEADBEAT,         /* deadbeat.h, at the valley, from the model's prediction; no feedback */
    IQFOC_CONTROL_DEADBEAT_LEARNING /* the same with a learnt drift (deadbeat_drift.h); data.learning */
} iqfoc_control_t;

/* How the voltage is made. */
typedef enum iqfoc_modulation {
    IQFOC_MODULATION_PWM,      /* centre-aligned, min/max zero sequence */
    IQFOC_MODULATION_SIX_STEP, /* the active inverter state nearest to the voltage, for the whole interval */
    /* Up to six-step without a bump (overmodulation.h); PI keeps the axes apart by the reference then. */
    IQFOC_MODULATION_OVER
} iqfoc_modulation_t;

typedef struct iqfoc_methods {
    iqfoc_model_t model;
    iqfoc_feedback_t feedback;
    iqfoc_control_t control;
    iqfoc_modulation_t modulation;
    bool extended; /* what a diagnosis found is put right: samples, dead time, saturation; data.extension */
} iqfoc_methods_t;

/*
 * Belongs to a set of parameters, with all that it points to. NULL and 0 where the method is not used.
 */
typedef struct iqfoc_methods_data {
    const iqfoc_exact_law_t *exact; /* iqfoc_exact_prediction over a whole cycle */
    const iqfoc_exact_law_t *exact_mean;
    const iqfoc_salient_t *salient; /* iqfoc_salient_at_speed over a whole cycle: end, and mean */
    const iqfoc_salient_t *salient_mean;
    const iqfoc_flux_predictor_t *flux;
    const iqfoc_extension_t *acting; /* what the flux predictor makes of the voltage; saturation */
    const iqfoc_extension_t *extension;
    /* Deadbeat: iqfoc_deadbeat_inverse of the model's k_u; 1/16 ... 64. Both do not follow saturation by themselves:
     * a slower task offers a set for the inductance at the present current, as for data.exact. */
    iq24_t k_u_inverse;
    iq24_t k_psi;    /* deadbeat: of the valley's reference; 0 ... 8, 0 to control the valleys' current */
    iq24_t learning; /* gain of the drift, 0 ... 1 */
} iqfoc_methods_data_t;

#ifdef __cplusplus
}
#endif

#endif
