/*
 * The methods of the control cycle (iqfoc/cycle_steps.h), and the data for those beyond the papers'.
 *
 * A drive names its methods in a constant and gives it to the steps; other methods are not compiled:
 *
 *     static const iqfoc_methods_t methods = {IQFOC_MODEL_EXACT, IQFOC_FEEDBACK_EXACT_MEAN, IQFOC_CONTROL_PI,
 *                                             IQFOC_MODULATION_PWM, true};
 */
#ifndef IQFOC_METHODS_H
#define IQFOC_METHODS_H

#include "error.h"
#include "extension.h"
#include "flux_map.h"
#include "flux_predictor.h"
#include "predictor_exact.h"
#include "predictor_salient.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Prediction of the current at the next valley. */
typedef enum iqfoc_model {
    IQFOC_MODEL_QUASI_DISCRETE, /* 2019 (12): predictor.h; saturation by `extended` */
    IQFOC_MODEL_EXACT,          /* predictor_exact.h; data.exact */
    IQFOC_MODEL_SALIENT,        /* predictor_salient.h; data.salient, made for the speed by a slower task */
    IQFOC_MODEL_FLUX,           /* flux_predictor.h: salient and saturating; data.flux, data.acting */
    IQFOC_MODEL_EULER,          /* 2019 (3), for comparison */
    IQFOC_MODEL_FLUX_MAP /* flux_map.h: iron that loses much of its inductance; data.flux_map, data.acting */
} iqfoc_model_t;

/* Feedback of the controller. */
typedef enum iqfoc_feedback {
    /* The sample at the carrier peak in the frame of its own angle: usual practice. */
    IQFOC_FEEDBACK_MIDPOINT,
    /* 2016 (10) over the cycle that ended at the last valley: one cycle old. */
    IQFOC_FEEDBACK_CORRECTED_MEAN,
    /* 2019 (10), corrected by 2016 (10), over the cycle from the last valley. */
    IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    /* The model's own mean over that cycle; models exact (data.exact_mean) and salient (data.salient_mean). */
    IQFOC_FEEDBACK_EXACT_MEAN,
    /* The mean including PWM's ripple (mean_modulated.h); models without saliency. */
    IQFOC_FEEDBACK_MODULATED_MEAN
} iqfoc_feedback_t;

/* The current controller. */
typedef enum iqfoc_control {
    IQFOC_CONTROL_PI,               /* current_control.h, at the peak */
    IQFOC_CONTROL_DEADBEAT,         /* deadbeat.h, at the valley, from the model's prediction; no feedback */
    IQFOC_CONTROL_DEADBEAT_LEARNING /* deadbeat with disturbance observer (deadbeat_drift.h); data.learning */
} iqfoc_control_t;

/* The modulator. */
typedef enum iqfoc_modulation {
    IQFOC_MODULATION_PWM,      /* centre-aligned, min/max zero sequence */
    IQFOC_MODULATION_SIX_STEP, /* the active inverter state nearest to the voltage, for the whole interval */
    /* Smooth transition to six-step (overmodulation.h); PI then decouples the axes by the reference. */
    IQFOC_MODULATION_OVER
} iqfoc_modulation_t;

typedef struct iqfoc_methods {
    iqfoc_model_t model;
    iqfoc_feedback_t feedback;
    iqfoc_control_t control;
    iqfoc_modulation_t modulation;
    bool extended; /* corrects the results of a diagnosis: samples, dead time, saturation; data.extension */
} iqfoc_methods_t;

/* Part of a set of parameters, with all data that it points to. NULL and 0 if the method is not used. */
typedef struct iqfoc_methods_data {
    const iqfoc_exact_law_t *exact; /* iqfoc_exact_prediction over a whole cycle */
    const iqfoc_exact_law_t *exact_mean;
    const iqfoc_salient_t *salient; /* iqfoc_salient_at_speed over a whole cycle: end, and mean */
    const iqfoc_salient_t *salient_mean;
    const iqfoc_flux_predictor_t *flux;
    const iqfoc_extension_t
        *acting; /* corrections of voltage and saturation for flux predictor and flux map */
    const iqfoc_extension_t *extension;
    /*
     * Deadbeat: iqfoc_deadbeat_inverse of the model's k_u; 1/16 ... 64. It does not follow saturation, nor does
     * k_psi: a slower task offers a set for the inductance at the present current, as for data.exact.
     */
    iq24_t k_u_inverse;
    iq24_t k_psi; /* deadbeat: of the sampling-instant set-point, 0 ... 8; 0 controls the valleys' current */
    iq24_t learning; /* observer gain of the disturbance estimate, 0 ... 1 */
    const iqfoc_flux_map_t *flux_map;
} iqfoc_methods_data_t;

#ifdef __cplusplus
}
#endif

#endif
