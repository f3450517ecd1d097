/* Torque to duties up to six-step, as firmware (torque_drive.h). */
#include "torque_drive.h"

#include "params_host.h"

#include "iqfoc/mean_current.h"
#include "iqfoc/transform.h"

#include <string.h>

static bool reference_from_motor(const motor *m, const torque_limits *limits, iqfoc_reference_config_t *c,
                                 error *e)
{
    const per_unit base = per_unit_of(m);
    const double omega_rad_s = motor_speed_rad_s(m, m->n_max_rpm);
    const double gain = IQFOC_RAW_REFERENCE_GAIN(limits->weakening_per_s, m->L_d_H, base.T_s, base.I_A,
                                                 base.U_V, omega_rad_s, 2.0 / VEC_PI * limits->u_dc_V);
    c->saliency = iq24_from_double(IQFOC_RAW_REFERENCE_SALIENCY(m->L_d_H, m->L_q_H, m->psi_f_Wb, base.I_A));
    c->i_max = iq24_from_double(limits->i_max_A / base.I_A);
    c->i_d_min = iq24_from_double(limits->i_d_min_A / base.I_A);
    c->gain = iq24_from_double(gain);
    c->share = iq24_from_double(limits->share);
    const iqfoc_error_t refused = iqfoc_reference_check(c);
    return refused == IQFOC_OK ||
           error_input(e, m->path, 0, 0, "the reference refuses its parameters: %d", (int)refused);
}

bool torque_drive_init(torque_drive *d, const motor *m, const torque_limits *limits, error *e)
{
    memset(d, 0, sizeof *d);
    d->modulation = TORQUE_SIX_STEP;
    d->rotor.s1 = IQ24_ONE;
    d->limit = IQFOC_OVERMODULATION_CIRCLE;
    d->u_dc = IQ24_ONE;
    return predictor_from_motor(m, &d->predictor, e) &&
           gains_from_motor(m, limits->bandwidth_Hz, &d->gains, e) &&
           reference_from_motor(m, limits, &d->reference_config, e);
}

/* The voltage of the cycle that begins is known, and with it the cycle's mean. */
static bool at_valley(void *context, iqfoc_dq_t torque, const iqfoc_sample_t *sample, error *e)
{
    torque_drive *d = context;
    (void)torque;
    (void)e;
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    d->rotor = iqfoc_rotor_from_turns(sample->turns);
    const iq24_sincos_t sc_mid = iq24_sincos(sample->theta + iq24_asr32(d->rotor.turns, 1));
    const iq24_t w = iqfoc_predictor_emf(&d->predictor, &d->rotor);
    const iqfoc_ab_t i_next = iqfoc_predictor_step(&d->predictor, i, d->u_next, w, sc_mid);
    d->fed_back = iqfoc_mean_current_seen(i, i_next, w, &d->rotor, sc_mid);
    d->limit = d->modulation == TORQUE_SIX_STEP ? iqfoc_overmodulation_limit(&d->rotor)
                                                : IQFOC_OVERMODULATION_CIRCLE;
    return true;
}

static iqfoc_duties_t modulated(torque_drive *d, iqfoc_ab_t u)
{
    const iq24_t inverse = iq24_div(IQ24_ONE, d->u_dc);
    if (d->modulation == TORQUE_HEXAGON) {
        return iqfoc_modulate(u, inverse, IQ24_ONE);
    }
    return iqfoc_overmodulate(&d->over, u, inverse, d->limit);
}

/*
 * The axes are kept apart by the current asked for, not by the one measured: that has six-step's harmonics,
 * which would be turned by a quarter, enlarged by the reactance and sent back as voltage.
 */
static bool at_peak(void *context, iqfoc_dq_t torque, const iqfoc_sample_t *sample, drive_answer *answer,
                    error *e)
{
    torque_drive *d = context;
    (void)e;
    if (d->midpoint) {
        d->fed_back = iqfoc_park(iqfoc_clarke3(sample->i), iq24_sincos(sample->theta));
    }
    d->u_dc = sample->u_dc;
    d->i_ref = iqfoc_reference_step(&d->reference, &d->reference_config, torque.q, d->u_dq,
                                    iq24_mul_round(d->limit, d->u_dc));
    const iqfoc_dq_t u = iqfoc_current_control_step(&d->control, &d->gains, d->i_ref, d->fed_back);
    const iqfoc_dq_t apart = iqfoc_current_control_decoupling(&d->gains, d->i_ref, d->rotor.turns);
    d->u_dq.d = u.d + apart.d;
    d->u_dq.q = u.q + apart.q;
    /* The middle of the cycle that begins at the next valley is a whole cycle ahead. */
    const iqfoc_ab_t u_ab = iqfoc_park_inverse(d->u_dq, iq24_sincos(sample->theta + d->rotor.turns));
    answer->command.duties = modulated(d, u_ab);
    answer->command.gates = true;
    d->u_next = iqfoc_modulated_voltage(answer->command.duties.high, d->u_dc);
    iqfoc_current_control_limited(&d->control, &d->gains, d->u_dq, answer->command.duties.scale);
    return true;
}

drive_firmware torque_drive_firmware(torque_drive *d)
{
    const drive_firmware firmware = {.context = d, .valley = at_valley, .peak = at_peak};
    return firmware;
}
