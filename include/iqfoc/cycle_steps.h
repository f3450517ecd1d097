/*
 * The steps of the control cycle (iqfoc/cycle.h), inline, for the methods that a drive names.
 *
 *     static const iqfoc_methods_t methods = {...};                          iqfoc/methods.h
 *     iqfoc_cycle_valley_by(methods, &cycle, &sample, now);                  in the valley's interrupt
 *     command = iqfoc_cycle_peak_by(methods, &cycle, &sample, mid, now);     in the peak's interrupt
 *
 * `methods` is a constant, so the compiler decides each question about a method and leaves out the code of all other
 * methods. Given a variable, the same code decides at run time: a simulator then has all methods in one program.
 *
 * The valley: guard, prediction error, mean of the cycle that ended | prediction | mean of the cycle that begins |
 * deadbeat control. The peak: guard, 1/u_dc | feedback | PI | angle | modulation.
 */
#ifndef IQFOC_CYCLE_STEPS_H
#define IQFOC_CYCLE_STEPS_H

#include "cycle.h"
#include "cycle_check.h"
#include "cycle_guard.h"
#include "cycle_predict.h"
#include "extension.h"
#include "mean_current.h"
#include "transform.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Mean current over the cycle that ends at this valley, from the samples of both valleys and the mean of the phase
 * currents. A port that averages gives that mean; otherwise it is the sample at mid-cycle, which is exact for a
 * current that changes linearly.
 */
static inline iqfoc_dq_t iqfoc_cycle_corrected_mean(const iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample,
                                                    iqfoc_ab_t i)
{
    const iqfoc_ab_t i_mean = sample->has_mean ? iqfoc_clarke3(sample->i_mean) : cycle->i_peak;
    const iqfoc_ab_t delta = {iq24_sub_wrap(i.alpha, cycle->i_valley.alpha),
                              iq24_sub_wrap(i.beta, cycle->i_valley.beta)};
    const iq24_t theta_mid = iq24_add_wrap(cycle->theta_valley, iq24_asr32(cycle->rotor.speed, 1));
    return iqfoc_mean_current_correct(i_mean, delta, &cycle->rotor, iq24_sincos(theta_mid));
}

/*
 * True if the mean of the cycle that begins is known at its valley, and with it the voltage that PI requests. The
 * peak then computes only angle and modulation, which shortens the time from the last sample to the duties.
 */
IQFOC_STEP bool iqfoc_cycle_controls_early(const iqfoc_methods_t m)
{
    return m.control == IQFOC_CONTROL_PI && m.feedback != IQFOC_FEEDBACK_MIDPOINT &&
           m.feedback != IQFOC_FEEDBACK_CORRECTED_MEAN;
}

/*
 * The voltage of the PI controller and its decoupling. In overmodulation the decoupling uses the reference: the
 * feedback has the harmonics of six-step, which the decoupling would multiply by the reactance and return as voltage.
 *
 * Range: both parts are within 8, and their sum is held to 8, as in the other branch.
 */
IQFOC_STEP iqfoc_dq_t iqfoc_cycle_pi_voltage(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                             const iqfoc_cycle_config_t *config, iq24_t speed)
{
    if (m.modulation == IQFOC_MODULATION_OVER) {
        const iqfoc_dq_t u =
            iqfoc_current_control_step(&cycle->control, &config->gains, cycle->i_ref, cycle->i_dq);
        const iqfoc_dq_t apart = iqfoc_current_control_decoupling(&config->gains, cycle->i_ref, speed);
        const iqfoc_dq_t sum = {iq24_clamp(u.d + apart.d, IQ24(-8.0), IQ24(8.0)),
                                iq24_clamp(u.q + apart.q, IQ24(-8.0), IQ24(8.0))};
        return sum;
    }
    return iqfoc_current_control_voltage(&cycle->control, &config->gains, cycle->i_ref, cycle->i_dq, speed);
}

/* Deprecated name of version 0.1. The next version has only the name above. */
#define iqfoc_cycle_asked iqfoc_cycle_pi_voltage

/* At the carrier valley; see iqfoc_cycle_valley. From the valley's interrupt only. */
IQFOC_STEP bool iqfoc_cycle_valley_by(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                      const iqfoc_sample_t *sample, uint32_t now)
{
    iqfoc_sample_t corrected;
    if (m.extended) {
        corrected = *sample;
        iqfoc_extension_sample(cycle->next->data.extension, &corrected);
        sample = &corrected;
    }
    const iqfoc_cycle_config_t *const ended = cycle->config;
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    iq24_t speed = sample->speed;
    bool whole = true;
    /* First: no valley is due, or the sample is clipped. */
    if (IQ24_RARE((cycle->phase | (uint32_t)sample->clipped << 31) > INT32_MAX) ||
        IQ24_RARE(iqfoc_ticks_since(cycle->valley_time, sample->time) >
                  ended->period_ticks + ended->tolerance_ticks) ||
        iqfoc_guard_scalars(ended, sample, now) != 0 || iqfoc_guard_current(ended, i) != 0) {
        whole = iqfoc_cycle_report_valley(cycle, sample, now);
        speed = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    }
    /*@ assert guard_speed: -5592405 <= speed <= 5592405; */
    cycle->phase = IQFOC_CYCLE_DUE_PEAK;
    cycle->valley_time = sample->time;
    iqfoc_ab_t expected;
    IQ24_LOAD_PAIR(expected.alpha, expected.beta, cycle->i_next.alpha, cycle->i_next.beta);
    const iqfoc_ab_t miss = {iq24_sub_wrap(i.alpha, expected.alpha), iq24_sub_wrap(i.beta, expected.beta)};
    cycle->error = miss;
    if (m.feedback == IQFOC_FEEDBACK_CORRECTED_MEAN) {
        cycle->corrected = whole;
        if (whole) {
            cycle->i_corrected_dq = iqfoc_cycle_corrected_mean(cycle, sample, i);
        }
    }
    const iqfoc_cycle_config_t *const config = cycle->next;
    cycle->config = config;
    cycle->next = cycle->offered;
    cycle->i_valley = i;
    iqfoc_cycle_predict(m, cycle, sample, i, speed);
    if (iqfoc_cycle_controls_early(m)) {
        cycle->u_dq = iqfoc_cycle_pi_voltage(m, cycle, config, speed);
    }
    return cycle->tripped;
}

/*
 * One Newton step towards 1/u: r (2 - u r).
 *
 * Range: 0.5 <= u <= 1.5. In Q27, p = u r is floored and 2 - p held to at least 0.5. From r = 1 on r stays
 * within 0.5 ... 2: where p <= 1.5, r (2 - u r) has its least value, 0.5, at the ends of that; where p is more,
 * r is above 1 and is halved; and it is at most 1/u <= 2 but for p's floor, a quarter of an LSB. So p >= 0.25,
 * and 2 - p below 2 fits Q30. The relative error e becomes e^2 a cycle: after a step of 10 % in u_dc it is 1 %,
 * then 0.01 %, then below 1 LSB.
 */
static inline iq24_t iqfoc_cycle_inverse_followed(iq24_t r, iq24_t u)
{
    const int32_t p_q27 = iq24_mul_high(u * 64, r * 32);
    const int32_t factor_q27 = iq24_max((INT32_C(2) << 27) - p_q27, INT32_C(1) << 26);
    const iq24_t next = iq24_mul_high_round(r * 32, factor_q27);
    /*@ assert newton: 8192000 <= next <= 33751040; */
    return next;
}

/* The controller's feedback at the peak, for methods whose mean is not computed at the valley. */
IQFOC_STEP iqfoc_dq_t iqfoc_cycle_feedback(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                           const iqfoc_sample_t *sample)
{
    if (m.feedback == IQFOC_FEEDBACK_CORRECTED_MEAN) {
        if (cycle->corrected) {
            return cycle->i_corrected_dq;
        }
        iqfoc_cycle_set_status(cycle, IQFOC_STATUS_NO_INTERVAL);
    }
    return iqfoc_park(iqfoc_clarke3(sample->i), iq24_sincos_inline(sample->theta));
}

/*
 * u / u_dc to the bits of iqfoc_modulate. PI requests |u| <= 11.4, and 1/u_dc is at most 2.02 (above): 8 u and 32/u_dc
 * fit, and the high word of their product is in Q24.
 */
IQFOC_STEP iqfoc_ab_t iqfoc_cycle_relative(const iqfoc_methods_t m, iqfoc_ab_t u, iq24_t u_dc_inverse)
{
    if (m.control == IQFOC_CONTROL_PI) {
        const iqfoc_ab_t v = {iq24_mul_high(iq24_wrap((int64_t)u.alpha * 8), u_dc_inverse * 32),
                              iq24_mul_high(iq24_wrap((int64_t)u.beta * 8), u_dc_inverse * 32)};
        return v;
    }
    const iqfoc_ab_t v = {iq24_mul_trunc(u.alpha, u_dc_inverse), iq24_mul_trunc(u.beta, u_dc_inverse)};
    return v;
}

/* Duties for u; on return u is the voltage that they produce. */
IQFOC_STEP iqfoc_duties_t iqfoc_cycle_modulated(const iqfoc_methods_t m, iq24_t u_dc_inverse, iq24_t span_max,
                                                iqfoc_ab_t *u, iq24_t u_dc)
{
    iqfoc_duties_t duties = iqfoc_modulate_relative(iqfoc_cycle_relative(m, *u, u_dc_inverse), span_max);
    if (m.modulation == IQFOC_MODULATION_SIX_STEP) {
        const int32_t state = iqfoc_six_step_state(iq24_atan2(u->beta, u->alpha));
        const iq24_t scale = duties.scale;
        duties = iqfoc_six_step_duties(state);
        duties.scale = scale;
        *u = iqfoc_six_step_voltage(state, u_dc);
    } else if (duties.scale < IQ24_ONE) {
        u->alpha = iq24_mul_round(u->alpha, duties.scale);
        u->beta = iq24_mul_round(u->beta, duties.scale);
    }
    return duties;
}

/* Duties up to six-step; on return u is the voltage that they produce. */
IQFOC_STEP iqfoc_duties_t iqfoc_cycle_overmodulated(iqfoc_cycle_t *cycle, iq24_t u_dc_inverse, iqfoc_ab_t *u,
                                                    iq24_t u_dc)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(cycle->rotor.speed);
    const iqfoc_duties_t duties =
        iqfoc_overmodulate(&cycle->over, *u, u_dc_inverse, iqfoc_overmodulation_limit(&rotor));
    *u = iqfoc_modulated_voltage(duties.high, u_dc);
    return duties;
}

/* At the carrier peak; see iqfoc_cycle_peak. From the peak's interrupt only. */
IQFOC_STEP iqfoc_command_t iqfoc_cycle_peak_by(const iqfoc_methods_t m, iqfoc_cycle_t *cycle,
                                               const iqfoc_sample_t *sample, iq24_t output_mid, uint32_t now)
{
    const iqfoc_cycle_config_t *const config = cycle->config;
    iqfoc_sample_t corrected;
    if (m.extended) {
        corrected = *sample;
        iqfoc_extension_sample(config->data.extension, &corrected);
        sample = &corrected;
    }
    iq24_t speed = sample->speed;
    iq24_t u_dc = sample->u_dc;
    if (IQ24_RARE(cycle->phase != IQFOC_CYCLE_DUE_PEAK) || IQ24_RARE(sample->clipped) ||
        iqfoc_guard_scalars(config, sample, now) != 0 || iqfoc_guard_phases(config, sample->i) != 0) {
        if (!iqfoc_cycle_report_peak(cycle, sample, now)) {
            return iqfoc_cycle_stopped(cycle);
        }
        speed = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
        u_dc = iq24_clamp(u_dc, IQFOC_CYCLE_U_DC_MIN, IQFOC_CYCLE_U_DC_MAX);
    }
    /*@ assert guard_speed: -5592405 <= speed <= 5592405; */
    /*@ assert guard_u_dc: 8388608 <= u_dc <= 25165824; */
    cycle->phase = IQFOC_CYCLE_DUE_VALLEY;
    if (m.feedback == IQFOC_FEEDBACK_CORRECTED_MEAN) {
        cycle->i_peak = iqfoc_clarke3(sample->i);
    }
    const iq24_t u_dc_inverse = iqfoc_cycle_inverse_followed(cycle->u_dc_inverse, u_dc);
    cycle->u_dc_inverse = u_dc_inverse;
    if (m.control == IQFOC_CONTROL_PI && !iqfoc_cycle_controls_early(m)) {
        cycle->i_dq = iqfoc_cycle_feedback(m, cycle, sample);
    }
    if (cycle->enabled <= cycle->tripped) { /* not enabled, or tripped: one comparison for both */
        return iqfoc_cycle_stopped(cycle);
    }
    iqfoc_ab_t u = cycle->u_ab;
    if (m.control == IQFOC_CONTROL_PI) {
        if (!iqfoc_cycle_controls_early(m)) {
            cycle->u_dq = iqfoc_cycle_pi_voltage(m, cycle, config, speed);
        }
        if (IQ24_RARE(cycle->next != config)) {
            output_mid = iqfoc_cycle_output_mid_scaled(cycle, output_mid);
        }
        /* Range: |speed| <= 1/3 and |cycles| <= 9 give at most 3 turns; the sum wraps at 128, which are whole. */
        const iq24_t ahead = iq24_mul_high(256 * speed, iq24_sub_wrap(output_mid, sample->instant));
        iqfoc_dq_t u_dq;
        IQ24_LOAD_PAIR(u_dq.d, u_dq.q, cycle->u_dq.d, cycle->u_dq.q);
        u = iqfoc_park_inverse_high(u_dq, iq24_sincos_q30_inline(iq24_add_wrap(sample->theta, ahead)));
    }
    iqfoc_command_t command;
    command.duties = m.modulation == IQFOC_MODULATION_OVER
                         ? iqfoc_cycle_overmodulated(cycle, u_dc_inverse, &u, u_dc)
                         : iqfoc_cycle_modulated(m, u_dc_inverse, config->span_max, &u, u_dc);
    command.gates = true;
    cycle->u_ab = u;
    if (command.duties.scale < IQ24_ONE) {
        cycle->status |= IQFOC_STATUS_VOLTAGE_LIMIT;
        if (m.control == IQFOC_CONTROL_PI) {
            iqfoc_current_control_limited(&cycle->control, &config->gains, cycle->u_dq, command.duties.scale);
        }
        if ((config->trips & IQFOC_STATUS_VOLTAGE_LIMIT) != 0) {
            iqfoc_cycle_set_status(cycle, IQFOC_STATUS_VOLTAGE_LIMIT);
            return iqfoc_cycle_stopped(cycle);
        }
    }
    if (m.extended) {
        /* The duties act from the next valley on, at the current predicted for it. */
        iqfoc_extension_compensate(config->data.extension, &command.duties,
                                   iqfoc_clarke_inverse(cycle->i_next), u_dc_inverse);
    }
    if (m.feedback == IQFOC_FEEDBACK_MODULATED_MEAN) {
        cycle->duties_next = command.duties.high;
    }
    return command;
}

#ifdef __cplusplus
}
#endif

#endif
