/* Torque to duties up to six-step, as firmware (torque_drive.h). */
#include "torque_drive.h"

#include "params_host.h"

#include "iqfoc/overmodulation.h"

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

bool torque_drive_init(torque_drive *d, const motor *m, const torque_limits *limits, iqfoc_methods_t methods,
                       error *e)
{
    /* The methods below stand in for these two. */
    const scenario_control control = {.feedback = FEEDBACK_QUASI_DISCRETE_MEAN,
                                      .modulation = MODULATION_PWM,
                                      .bandwidth_Hz = limits->bandwidth_Hz};
    iqfoc_cycle_config_t config;
    memset(d, 0, sizeof *d);
    d->methods = methods;
    d->cycle = drive_firmware_by(&d->host, methods);
    return reference_from_motor(m, limits, &d->reference_config, e) &&
           config_from_motor(m, &control, &config, e) && d->cycle.start(d->cycle.context, &config, e);
}

/* The largest voltage that the reference may have asked for, per unit. */
static iq24_t voltage_limit(const torque_drive *d, const iqfoc_sample_t *sample)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(sample->turns);
    const iq24_t limit = d->methods.modulation == IQFOC_MODULATION_OVER ? iqfoc_overmodulation_limit(&rotor)
                                                                        : IQFOC_OVERMODULATION_CIRCLE;
    return iq24_mul_round(limit, sample->u_dc);
}

/* The reference looks at the voltage that the cycle asked for last, and the cycle takes what it says. */
static bool at_valley(void *context, iqfoc_dq_t torque, const iqfoc_sample_t *sample, error *e)
{
    torque_drive *d = context;
    const iqfoc_dq_t i_ref = iqfoc_reference_step(&d->reference, &d->reference_config, torque.q,
                                                  d->host.cycle.u_dq, voltage_limit(d, sample));
    return d->cycle.valley(d->cycle.context, i_ref, sample, e);
}

static bool at_peak(void *context, iqfoc_dq_t torque, const iqfoc_sample_t *sample, drive_answer *answer,
                    error *e)
{
    torque_drive *d = context;
    (void)torque;
    return d->cycle.peak(d->cycle.context, d->host.cycle.i_ref, sample, answer, e);
}

drive_firmware torque_drive_firmware(torque_drive *d)
{
    const drive_firmware firmware = {.context = d, .valley = at_valley, .peak = at_peak};
    return firmware;
}
