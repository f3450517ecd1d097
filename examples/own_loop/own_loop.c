/*
 * A loop of your own out of the library's parts: those that iqfoc_cycle does not call, each with the drive that it is
 * for. Runs on the PC and on both emulated targets, and checks where two ways must lead to the same.
 *
 * Exit status 0: they do; else the number of the part that does not.
 */
#include "iqfoc/iqfoc.h"

#include <stddef.h>

#define T_S 2e-4               /* control cycle, s */
#define U_B 750.0              /* nominal DC link, V */
#define I_B IQFOC_I_BASE(10.5) /* from the rated current, A rms */

static const iqfoc_predictor_t predictor = IQFOC_PREDICTOR(0.75, 5.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_salient_machine_t machine =
    IQFOC_SALIENT_MACHINE(0.75, 5.2e-3, 5.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_flux_predictor_t flux_predictor =
    IQFOC_FLUX_PREDICTOR(0.75, 5.2e-3, 5.2e-3, 0.134, T_S, I_B, U_B);

static bool near(iq24_t x, iq24_t y, iq24_t margin)
{
    return iq24_abs_sat(iq24_sub_sat(x, y)) <= margin;
}

static bool near_dq(iqfoc_dq_t x, iqfoc_dq_t y, iq24_t margin)
{
    return near(x.d, y.d, margin) && near(x.q, y.q, margin);
}

/* Two current sensors and a floating star point: the third current follows, and a multiplication is saved. */
static bool two_sensors(void)
{
    const iqfoc_abc_t three = {IQ24(0.4), IQ24(-0.1), IQ24(-0.3)};
    const iqfoc_ab_t of_two = iqfoc_clarke2(three.a, three.b);
    const iqfoc_ab_t of_three = iqfoc_clarke3(three);
    return near(of_two.alpha, of_three.alpha, 2) && near(of_two.beta, of_three.beta, 2);
}

/*
 * Six-step in steady state: the mean that a port has oversampled, corrected by one gain of the speed (2016 (9)) where
 * no samples at the ends of the interval are at hand for 2016 (10).
 */
static bool six_step_mean(void)
{
    const iq24_t speed = IQ24(1.0 / 6.0); /* a control interval is a sixth of a turn */
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
    const iq24_sincos_t mid = iq24_sincos(0);
    /* The current turns by a sixth in the interval: half of it each side of its mean, across it by 2 tan(30 deg). */
    const iqfoc_ab_t mean = {IQ24(0.9), 0};
    const iqfoc_ab_t delta = {0, IQ24(0.9 * 1.1547005383792515)};
    return near_dq(iqfoc_mean_current_correct_steady(mean, iqfoc_rotor_steady_gain(speed), mid),
                   iqfoc_mean_current_correct(mean, delta, &rotor, mid), 8);
}

/* Six-step by a timer instead of a carrier: ticks until the next state is due. */
static bool six_step_timer(void)
{
    const iq24_t angle = IQ24(0.05); /* in state 0, which ends at 1/12 turn */
    const iq24_t speed = IQ24(0.01); /* a cycle */
    const int32_t period_ticks = 34000;
    const iq24_t cycles = iq24_div(iqfoc_six_step_remaining(angle, speed), speed);
    const int32_t ticks = iq24_asr32(iq24_mul_round(cycles, period_ticks * 64), 6);
    return ticks >= 113330 && ticks <= 113336; /* (1/12 - 0.05)/0.01 cycles */
}

/*
 * The mean under PWM, ripple included: for a machine without saliency in one function, for any machine by the salient
 * predictor's mean and the ripple's part. Both know the same drive here.
 */
static bool mean_with_ripple(void)
{
    const iq24_t speed = IQ24(1.0 / 12.5);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
    const iqfoc_abc_t high = {IQ24(0.75), IQ24(0.4), IQ24(0.25)};
    const iqfoc_ab_t u = iqfoc_clarke3(high);
    const iqfoc_ab_t i = {IQ24(0.2), IQ24(0.6)};
    const iq24_sincos_t start = iq24_sincos(0);
    const iq24_sincos_t mid = iq24_sincos(speed / 2);
    const iqfoc_mean_modulated_t modulated = iqfoc_mean_modulated_at_speed(&predictor, &rotor);
    const iqfoc_ripple_t ripple = iqfoc_ripple_at_speed(&machine, &rotor);
    iqfoc_salient_t end;
    iqfoc_salient_t mean;
    iqfoc_salient_at_speed(&machine, speed, IQ24_ONE, &end, &mean);

    const iqfoc_dq_t i_dq = iqfoc_park(i, start);
    const iqfoc_dq_t u_dq = iqfoc_park(u, start);
    const iqfoc_ab_t i_next = iqfoc_park_inverse(iqfoc_salient_step(&end, i_dq, u_dq), iq24_sincos(speed));
    const iqfoc_dq_t smooth = iqfoc_salient_step(&mean, i_dq, u_dq);
    const iqfoc_dq_t seen = iqfoc_ripple_seen(&ripple, high, IQ24_ONE, mid);
    const iqfoc_dq_t sum = {iq24_add_wrap(smooth.d, seen.d), iq24_add_wrap(smooth.q, seen.q)};
    return near_dq(iqfoc_mean_modulated(&modulated, i, i_next, high, IQ24_ONE, mid), sum, IQ24(2e-4));
}

/* Constants that were computed at run time, from a parameter store say, are checked once before they are used. */
static bool checked_constants(void)
{
    iqfoc_flux_predictor_t damaged = flux_predictor;
    damaged.l_q = 0;
    return iqfoc_flux_predictor_check(&flux_predictor) == IQFOC_OK &&
           iqfoc_flux_predictor_check(&damaged) == IQFOC_ERROR_INDUCTANCE_Q;
}

/* After a trip: what was wrong is read, then cleared, and the drive may be enabled again. */
static bool restart(void)
{
    static iqfoc_cycle_config_t config;
    static iqfoc_cycle_t cycle;
    config.predictor = predictor;
    config.span_max = IQ24_ONE;
    config.current_limit = IQ24(2.0);
    config.trips = IQFOC_STATUS_OVERCURRENT;
    config.time_unchecked = true; /* this program has no timer */
    if (iqfoc_cycle_init(&cycle, &config) != IQFOC_OK) {
        return false;
    }
    cycle.enabled = true;
    iqfoc_sample_t sample = {
        {IQ24(3.0), IQ24(-1.5), IQ24(-1.5)}, {0, 0, 0}, 0, 0, IQ24_ONE, 0, 0, false, false};
    iqfoc_cycle_valley(&cycle, &sample, 0);
    const bool tripped = cycle.tripped && (cycle.status & IQFOC_STATUS_OVERCURRENT) != 0;
    iqfoc_cycle_clear(&cycle);
    return tripped && !cycle.tripped && cycle.status == 0;
}

/* A recording's end: the background sends until the last frame is out, then the line may be put to another use. */
static bool recording(void)
{
    static iq24_t watched = IQ24(0.25);
    static const iqfoc_recorder_channel_t channel =
        IQFOC_RECORDER_IQ24(&watched, IQFOC_RECORDER_I_ALPHA, I_B, 26);
    static iqfoc_recorder_config_t config;
    static iqfoc_recorder_t recorder;
    static int32_t memory[32];
    config.channels[0] = channel;
    config.channel_count = 1;
    config.decimation = 1;
    config.period_mantissa = 1;
    if (iqfoc_recorder_init(&recorder, &config, memory, 32) != IQFOC_OK) {
        return false;
    }
    iqfoc_recorder_arm(&recorder);
    iqfoc_recorder_take(&recorder, 0);
    iqfoc_recorder_stop(&recorder);
    int32_t sent = 0;
    while (!iqfoc_recorder_finished(&recorder)) {
        sent += iqfoc_recorder_octet(&recorder) >= 0; /* to the line */
    }
    return sent > 0;
}

int main(void)
{
    static bool (*const parts[])(void) = {two_sensors,       six_step_mean, six_step_timer, mean_with_ripple,
                                          checked_constants, restart,       recording};
    for (size_t n = 0; n < sizeof parts / sizeof parts[0]; n++) {
        if (!parts[n]()) {
            return (int)n + 1;
        }
    }
    return 0;
}
