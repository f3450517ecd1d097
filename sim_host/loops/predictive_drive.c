/* Predictive current control as firmware (predictive_drive.h). */
#include "predictive_drive.h"

#include "extension_host.h"
#include "params_host.h"

#include "iqfoc/modulation.h"
#include "iqfoc/predictor_form.h"
#include "iqfoc/transform.h"

#include <string.h>

const char *predictor_kind_text(predictor_kind kind)
{
    static const char *const text[] = {"Euler", "quasi-discrete", "exact"};
    return text[kind];
}

bool predictive_drive_init(predictive_drive *p, const motor *assumed, predictor_kind kind, error *e)
{
    memset(p, 0, sizeof *p);
    p->kind = kind;
    if (!predictor_from_motor(assumed, &p->predictor, e) || !winding_from_motor(assumed, &p->winding, e)) {
        return false;
    }
    p->law = iqfoc_exact_prediction(&p->winding, IQ24_ONE);
    p->k_psi = p->predictor.k_psi;
    return true;
}

bool predictive_drive_extend(predictive_drive *p, const motor *assumed, error *e)
{
    p->extended = extension_from_motor(assumed, &p->extension, e);
    return p->extended;
}

/* A winding's constant times `factor`, in the constant's own format. Each ends at 2^30: rho at 1 in Q30, k_u
 * at 16 in Q26, k_psi at 8 in Q27. Range: 0 <= x <= 2^30 and 0 <= factor <= 2, the product below 2^55. */
static int32_t raised(int32_t x, iq24_t factor)
{
    const int64_t product = (IQ24_MUL64(x, factor) + (INT64_C(1) << 23)) >> 24;
    return product < (INT64_C(1) << 30) ? (int32_t)product : INT32_C(1) << 30;
}

/* The winding's law at the inductance that this current leaves; in a firmware a slower task's matter. */
static void follow_saturation(predictive_drive *p, iqfoc_ab_t i)
{
    /* L_0/L(|i|), 1 ... 2, is what the library makes of a coefficient of 1. */
    const iqfoc_predictor_t one = {.k_psi = IQ24_ONE};
    const iq24_t factor = iqfoc_extension_saturate(&p->extension, &one, i).k_psi;
    const iqfoc_exact_winding_t winding = {raised(p->winding.rho_q30, factor),
                                           raised(p->winding.k_u_q26, factor),
                                           raised(p->winding.k_psi_q27, factor)};
    p->law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    p->k_psi = (winding.k_psi_q27 + 4) >> 3;
}

static iqfoc_exact_t model_at(const predictive_drive *p, const iqfoc_rotor_t *rotor)
{
    switch (p->kind) {
    case PREDICTOR_EULER:
        return iqfoc_form_euler(&p->predictor, rotor);
    case PREDICTOR_QUASI_DISCRETE:
        return iqfoc_form_quasi_discrete(&p->predictor, rotor);
    case PREDICTOR_EXACT:
    default:
        return iqfoc_exact_at_speed(&p->law, rotor->turns);
    }
}

static void choose_by_deadbeat(predictive_drive *p, const iqfoc_sample_t *sample, const iqfoc_rotor_t *rotor)
{
    iqfoc_deadbeat_t deadbeat = {.model = model_at(p, rotor),
                                 .reference = iqfoc_valley_reference_at(rotor, p->k_psi)};
    deadbeat.k_u_inverse = iqfoc_deadbeat_inverse(deadbeat.model.k_u_q26);
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    const iqfoc_ab_t u =
        p->learning > 0 ? iqfoc_deadbeat_drift_step(&p->drift, &deadbeat, p->learning, i, p->u_now, p->i_ref,
                                                    sample->theta, rotor->turns)
                        : iqfoc_deadbeat_step(&deadbeat, i, p->u_now, p->i_ref, sample->theta, rotor->turns);
    p->command.duties = iqfoc_modulate(u, iq24_div(IQ24_ONE, sample->u_dc), IQ24_ONE);
    if (p->extended) {
        /* The legs' losses in the cycle that the duties are for: at its first current. */
        const iq24_t mid = iq24_add_wrap(sample->theta, iq24_asr32(rotor->turns, 1));
        const iqfoc_ab_t i_next = iqfoc_exact_step(&deadbeat.model, i, p->u_now, iq24_sincos(mid));
        iqfoc_extension_compensate(&p->extension, &p->command.duties, iqfoc_clarke_inverse(i_next),
                                   iq24_div(IQ24_ONE, sample->u_dc));
    }
    p->u_next.alpha = iq24_mul_round(u.alpha, p->command.duties.scale);
    p->u_next.beta = iq24_mul_round(u.beta, p->command.duties.scale);
}

static void choose_from_set(predictive_drive *p, const iqfoc_sample_t *sample, const iqfoc_rotor_t *rotor)
{
    const iqfoc_finite_set_t set = {.model = model_at(p, rotor),
                                    .reference = iqfoc_valley_reference_at(rotor, p->k_psi),
                                    .weight = p->weight,
                                    .horizon = p->horizon};
    p->state = iqfoc_finite_set_choose(&set, iqfoc_clarke3(sample->i), p->state, p->i_ref, sample->theta,
                                       rotor->turns, sample->u_dc, &p->nodes);
    const iqfoc_abc_t legs = {(p->state & 1) != 0 ? IQ24_ONE : 0, (p->state & 2) != 0 ? IQ24_ONE : 0,
                              (p->state & 4) != 0 ? IQ24_ONE : 0};
    p->command.duties.high = legs;
    p->command.duties.scale = IQ24_ONE;
}

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    predictive_drive *p = context;
    (void)e;
    p->i_ref = i_ref;
    iqfoc_sample_t corrected = *sample;
    if (p->extended) {
        iqfoc_extension_sample(&p->extension, &corrected);
        follow_saturation(p, iqfoc_clarke3(corrected.i));
    }
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(corrected.turns);
    p->u_now = p->u_next;
    p->decisions++;
    p->command.gates = true;
    if (p->horizon == 0) {
        choose_by_deadbeat(p, &corrected, &rotor);
    } else {
        choose_from_set(p, &corrected, &rotor);
    }
    return true;
}

/* The controller needs the valley's sample only; its command waits until the peak, as the cycle's does. */
static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    (void)i_ref;
    (void)sample;
    (void)e;
    answer->command = ((const predictive_drive *)context)->command;
    return true;
}

drive_firmware predictive_drive_firmware(predictive_drive *p)
{
    const drive_firmware firmware = {p, NULL, take_valley, give_peak};
    return firmware;
}
