/* Deadbeat control in the library's cycle (deadbeat_drive.h). */
#include "deadbeat_drive.h"

#include "extension_host.h"
#include "params_host.h"

#include <string.h>

bool deadbeat_drive_init(deadbeat_drive *d, const motor *assumed, iqfoc_model_t model, double learning,
                         bool extended, error *e)
{
    /* The methods below stand in for these two; the gains are not used. */
    const scenario_control control = {.feedback = FEEDBACK_MIDPOINT, .modulation = MODULATION_PWM};
    const iqfoc_methods_t methods = {model, IQFOC_FEEDBACK_MIDPOINT,
                                     learning > 0.0 ? IQFOC_CONTROL_DEADBEAT_LEARNING
                                                    : IQFOC_CONTROL_DEADBEAT,
                                     IQFOC_MODULATION_PWM, extended};
    iqfoc_cycle_config_t config;
    memset(d, 0, sizeof *d);
    if (!config_from_motor(assumed, &control, &config, e) || !winding_from_motor(assumed, &d->winding, e) ||
        (extended && !extension_from_motor(assumed, &d->extension, e))) {
        return false;
    }
    d->law = iqfoc_exact_prediction(&d->winding, IQ24_ONE);
    config.trips = 0;
    config.data.exact = &d->law;
    config.data.extension = extended ? &d->extension : NULL;
    config.data.k_u_inverse =
        iqfoc_deadbeat_inverse(model == IQFOC_MODEL_EXACT ? d->law.k_u_q26 : config.predictor.k_u * 4);
    config.data.k_psi = config.predictor.k_psi;
    config.data.learning = iq24_from_double(learning);
    d->cycle = drive_firmware_by(&d->host, methods);
    return d->cycle.start(d->cycle.context, &config, e);
}

/* A winding's constant times `factor`, in the constant's own format. Each ends at 2^30: rho at 1 in Q30, k_u
 * at 16 in Q26, k_psi at 8 in Q27. Range: 0 <= x <= 2^30 and 0 <= factor <= 2, the product below 2^55. */
static int32_t raised(int32_t x, iq24_t factor)
{
    const int64_t product = (IQ24_MUL64(x, factor) + (INT64_C(1) << 23)) >> 24;
    return product < (INT64_C(1) << 30) ? (int32_t)product : INT32_C(1) << 30;
}

/* The slower task: parameters for the inductance at the valley's current, offered once the last ones are in force. */
static void follow_saturation(deadbeat_drive *d)
{
    iqfoc_cycle_t *const cycle = &d->host.cycle;
    if (d->extension.saturation == 0 || !iqfoc_cycle_taken(cycle)) {
        return;
    }
    /* L_0/L(|i|), 1 ... 2, is what the library makes of a coefficient of 1. */
    const iqfoc_predictor_t one = {.k_psi = IQ24_ONE};
    const iq24_t factor = iqfoc_extension_saturate(&d->extension, &one, cycle->i_valley).k_psi;
    const iqfoc_exact_winding_t winding = {raised(d->winding.rho_q30, factor),
                                           raised(d->winding.k_u_q26, factor),
                                           raised(d->winding.k_psi_q27, factor)};
    iqfoc_cycle_config_t *const set = &d->spare[d->free];
    iqfoc_exact_law_t *const law = &d->spare_law[d->free];
    *law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    *set = d->host.config;
    set->data.exact = law;
    set->data.k_u_inverse = iqfoc_deadbeat_inverse(law->k_u_q26);
    set->data.k_psi = (winding.k_psi_q27 + 4) >> 3;
    if (iqfoc_cycle_offer_by(d->host.methods, cycle, set) == IQFOC_OK) {
        d->free = 1 - d->free;
    }
}

static bool at_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    deadbeat_drive *d = context;
    if (!d->cycle.valley(d->cycle.context, i_ref, sample, e)) {
        return false;
    }
    follow_saturation(d);
    return true;
}

static bool at_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                    error *e)
{
    deadbeat_drive *d = context;
    return d->cycle.peak(d->cycle.context, i_ref, sample, answer, e);
}

drive_firmware deadbeat_drive_firmware(deadbeat_drive *d)
{
    const drive_firmware firmware = {.context = d, .valley = at_valley, .peak = at_peak};
    return firmware;
}
