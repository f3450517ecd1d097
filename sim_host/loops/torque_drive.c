/* Torque to duties up to six-step, as firmware (torque_drive.h). */
#include "torque_drive.h"

#include "params_host.h"

#include "iqfoc/overmodulation.h"
#include "iqfoc/transform.h"

#include <math.h>
#include <string.h>

#define FILTER_CYCLES 64 /* of the voltage's share before six-step */
#define FILTER_STATES 8  /* of i_d in six-step */
/* The carrier resumes after i_q has been this near for so many states: not during a reversal. */
#define SETTLED        IQ24(0.05)
#define SETTLED_STATES 24

static bool reference_from_motor(const motor *m, const torque_limits *limits, iqfoc_reference_config_t *c,
                                 iqfoc_reference_link_t *link, error *e)
{
    const per_unit base = per_unit_of(m);
    const double omega_rad_s = motor_speed_rad_s(m, m->n_max_rpm);
    const double link_gain = IQFOC_RAW_REFERENCE_LINK_GAIN(m->L_d_H, base.I_A, base.U_V, omega_rad_s,
                                                           2.0 / VEC_PI * limits->u_dc_V);
    const double gain = limits->weakening_per_s * base.T_s * link_gain;
    c->saliency = iq24_from_double(IQFOC_RAW_REFERENCE_SALIENCY(m->L_d_H, m->L_q_H, m->psi_f_Wb, base.I_A));
    c->i_max = iq24_from_double(limits->i_max_A / base.I_A);
    c->i_d_min = iq24_from_double(limits->i_d_min_A / base.I_A);
    c->gain = iq24_from_double(gain);
    c->share = iq24_from_double(limits->share);
    link->gain = iq24_from_double(link_gain);
    const iqfoc_error_t refused = iqfoc_reference_check(c);
    return refused == IQFOC_OK ||
           error_input(e, m->path, 0, 0, "the reference refuses its parameters: %d", (int)refused);
}

/*
 * The angle's integrator. i_q answers to the voltage's angle by U/(omega L) per radian and a state lasts a sixth of
 * a turn, so that the gain for a bandwidth is the same at every speed.
 */
static void timer_from_motor(torque_drive *d, const motor *m, const torque_limits *limits)
{
    const per_unit base = per_unit_of(m);
    const double u_V = 2.0 / VEC_PI * limits->u_dc_V;
    d->may_use_timer = limits->timer_Hz > 0.0;
    d->i_d_to_timer = iq24_from_double(limits->i_d_to_timer_A / base.I_A);
    d->i_d_to_carrier = iq24_from_double(limits->i_d_to_carrier_A / base.I_A);
    d->six_config.gain = iq24_from_double(VEC_TWO_PI * limits->timer_Hz * m->L_q_H * base.I_A / (6.0 * u_V));
    d->six_config.angle_min = 0;
    d->six_config.angle_max = IQ24(0.5);
}

bool torque_drive_init(torque_drive *d, const motor *m, const torque_limits *limits, iqfoc_methods_t methods,
                       error *e)
{
    /* The methods name feedback and modulation: the configuration leaves both at 0. */
    const scenario_control control = {
        .feedback = FEEDBACK_MIDPOINT, .modulation = MODULATION_PWM, .bandwidth_Hz = limits->bandwidth_Hz};
    iqfoc_cycle_config_t config;
    memset(d, 0, sizeof *d);
    d->methods = methods;
    d->cycle = drive_firmware_by(&d->host, methods);
    timer_from_motor(d, m, limits);
    return reference_from_motor(m, limits, &d->reference_config, &d->link, e) &&
           config_from_motor(m, &control, &config, e) && d->cycle.start(d->cycle.context, &config, e);
}

/* The largest voltage that the reference may have asked for, per unit. */
static iq24_t voltage_limit(const torque_drive *d, const iqfoc_sample_t *sample)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(sample->speed);
    const iq24_t limit = d->methods.modulation == IQFOC_MODULATION_OVER ? iqfoc_overmodulation_limit(&rotor)
                                                                        : IQFOC_OVERMODULATION_CIRCLE;
    return iq24_mul_round(limit, sample->u_dc);
}

/* The reference looks at the voltage that the cycle asked for last, and the cycle takes what it says. */
static bool at_valley(void *context, iqfoc_dq_t torque, const iqfoc_sample_t *sample, error *e)
{
    torque_drive *d = context;
    const iqfoc_dq_t u = d->host.cycle.u_dq;
    const iq24_t u_limit =
        iqfoc_reference_link(&d->reference, &d->link, &d->reference_config, u, voltage_limit(d, sample));
    const iqfoc_dq_t i_ref = iqfoc_reference_step(&d->reference, &d->reference_config, torque.q, u, u_limit);
    return d->cycle.valley(d->cycle.context, i_ref, sample, e);
}

/*
 * The angle at which six-step keeps i_q. Its voltage is a little longer than the carrier's, and the d component,
 * which i_q needs, stays the same. A filter removes the DC link's ripple, which is in both parts of that share.
 */
static void follow_share(torque_drive *d, const iqfoc_sample_t *sample)
{
    const double d_pu = iq24_to_double(d->host.cycle.u_dq.d);
    const double asked = hypot(d_pu, iq24_to_double(d->host.cycle.u_dq.q));
    const double made = fmin(asked, iq24_to_double(voltage_limit(d, sample)));
    const double six_step = 2.0 / VEC_PI * iq24_to_double(sample->u_dc);
    const double share = asked > 0.0 ? d_pu / asked * made / six_step : 0.0;
    d->d_share += (share - d->d_share) / FILTER_CYCLES;
}

/* From the next valley on, half a cycle after this peak: the sample as it will be there. */
static void to_timer(torque_drive *d, const iqfoc_sample_t *sample, drive_answer *answer)
{
    iqfoc_cycle_t *cycle = &d->host.cycle;
    iqfoc_sample_t at_valley = *sample;
    at_valley.theta = iq24_add_wrap(sample->theta, iq24_asr32(sample->speed, 1));
    at_valley.i = iqfoc_clarke_inverse(cycle->i_next);
    const iqfoc_six_step_command_t next = iqfoc_cycle_six_step_begin(
        &d->six, cycle, &d->six_config, iq24_from_double(acos(d->d_share) / VEC_TWO_PI), &at_valley);
    *answer = drive_answer_of_state(cycle, &next);
    d->timer_runs = true;
    d->may_go = 0;
    d->i_d = cycle->i_ref.d;
}

/* Weakening for the voltage that the carrier lacks against six-step: over the d axis' reactance. */
static iq24_t carrier_weakening(const torque_drive *d, const iqfoc_sample_t *sample)
{
    const iq24_t lacks = iq24_mul_round(IQ24(2.0 / VEC_PI), sample->u_dc) - voltage_limit(d, sample);
    const iq24_t reactance = iq24_mul_round(sample->speed, d->host.config.gains.x_d);
    return iq24_div(lacks, iq24_max(iq24_abs_sat(reactance), 1));
}

/*
 * The end of a state. When the carrier resumes, the new state serves as its first cycle, with duties of 0 and 1,
 * while the first command is calculated. That cycle is shorter than a sixth of a turn.
 */
static bool at_switching(torque_drive *d, iq24_t i_q, const iqfoc_sample_t *sample, drive_answer *answer,
                         error *e)
{
    iqfoc_cycle_t *cycle = &d->host.cycle;
    cycle->i_ref.q = i_q;
    const iqfoc_six_step_command_t next = iqfoc_cycle_six_step_switch(&d->six, cycle, sample, sample->time);
    *answer = drive_answer_of_state(cycle, &next);
    d->i_d += (cycle->i_dq.d - d->i_d) / FILTER_STATES;
    const bool settled = iq24_abs_sat(i_q - cycle->i_dq.q) < SETTLED;
    d->may_go = settled && d->i_d > d->i_d_to_carrier ? d->may_go + 1 : 0;
    if (d->may_go > SETTLED_STATES) {
        cycle->i_ref.d = d->i_d;
        d->reference.weakening = iq24_acc_mul(iq24_min(d->i_d - carrier_weakening(d, sample), 0), IQ24_ONE);
        iqfoc_cycle_six_step_end(&d->six, cycle, sample->speed);
        answer->interval_s = 0.0;
        d->timer_runs = false;
    }
    return next.command.gates || error_failure(e, 0, "six-step: the firmware stopped the drive");
}

static bool at_peak(void *context, iqfoc_dq_t torque, const iqfoc_sample_t *sample, drive_answer *answer,
                    error *e)
{
    torque_drive *d = context;
    if (d->timer_runs) {
        return at_switching(d, torque.q, sample, answer, e);
    }
    const bool ok = d->cycle.peak(d->cycle.context, d->host.cycle.i_ref, sample, answer, e);
    if (!ok || !d->may_use_timer) {
        return ok;
    }
    follow_share(d, sample);
    if (d->host.cycle.i_ref.d < d->i_d_to_timer) {
        to_timer(d, sample, answer);
    }
    return true;
}

double torque_drive_voltage(const torque_drive *d, double u_dc)
{
    const iqfoc_dq_t u = d->host.cycle.u_dq;
    return d->timer_runs ? 2.0 / VEC_PI : hypot(iq24_to_double(u.d), iq24_to_double(u.q)) / u_dc;
}

drive_firmware torque_drive_firmware(torque_drive *d)
{
    const drive_firmware firmware = {.context = d, .valley = at_valley, .peak = at_peak};
    return firmware;
}
