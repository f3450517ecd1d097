/* Six-step by a timer (include/iqfoc/cycle_six_step.h). */
#include "iqfoc/cycle_six_step.h"

#include "iqfoc/cycle_guard.h"
#include "iqfoc/mean_current.h"

#include <stddef.h>

#define SECTOR_LEAST INT32_C(27962)   /* 1/600 turn: a timer can still be set */
#define SECTOR_MOST  INT32_C(5592405) /* 1/3: two sectors, where the angle was just taken back */
#define TWO_OVER_PI  INT32_C(10680707)

/* The angle without whole turns, -1/2 ... 1/2. */
static iq24_t within_turn(iq24_t angle)
{
    const int32_t part = (int32_t)((uint32_t)angle & UINT32_C(0x00FFFFFF));
    return part < IQ24_ONE / 2 ? part : part - IQ24_ONE;
}

static bool fit(const iqfoc_six_step_config_t *c)
{
    return iq24_within(c->gain, 0, IQ24_ONE) && c->angle_min >= -IQ24_ONE / 2 &&
           c->angle_min < c->angle_max && c->angle_max <= IQ24_ONE / 2;
}

/* The angle held to the configuration's limits. */
static iq24_acc_t held(const iqfoc_six_step_config_t *c, iq24_acc_t angle)
{
    const iq24_acc_t least = iq24_acc_mul(c->angle_min, IQ24_ONE);
    const iq24_acc_t most = iq24_acc_mul(c->angle_max, IQ24_ONE);
    return angle < least ? least : angle > most ? most : angle;
}

static iqfoc_six_step_command_t safe(iqfoc_cycle_t *cycle, uint32_t ticks)
{
    const iqfoc_six_step_command_t command = {iqfoc_cycle_stopped(cycle), SECTOR_LEAST, ticks};
    return command;
}

/*
 * The command of the present state, and how long it lasts.
 *
 * Range: the state's far border is (2 state + 1)/12 or (2 state - 1)/12 of a turn, 5 + 1/2 sixths at most; angles
 * wrap at 128 turns, which are whole. movement/|speed| saturates at 128 cycles, and a period is below 2^31 ticks: the
 * product is below 2^62.
 *
 */
static iqfoc_six_step_command_t standing(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle, iq24_t theta,
                                         iq24_t speed)
{
    const bool back = speed < 0;
    const iq24_t border = (six->state * IQ24_ONE + (back ? -IQ24_ONE / 2 : IQ24_ONE / 2)) / 6;
    const iq24_t rest = within_turn(iq24_sub_wrap(border, iq24_add_wrap(theta, iq24_acc_round(six->angle))));
    iqfoc_six_step_command_t next;
    next.command.duties = iqfoc_six_step_duties(six->state);
    next.command.gates = true;
    next.movement = iq24_clamp(back ? -rest : rest, SECTOR_LEAST, SECTOR_MOST);
    const iq24_t cycles = iq24_div(next.movement, iq24_max(iq24_abs_sat(speed), 1));
    const uint64_t ticks = (uint64_t)cycles * cycle->config->period_ticks >> 24;
    next.ticks = ticks < UINT32_MAX ? (uint32_t)ticks : UINT32_MAX;
    cycle->u_now = iqfoc_six_step_voltage(six->state, six->u_dc);
    cycle->u_ab = cycle->u_now;
    return next;
}

static void take(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iqfoc_ab_t i)
{
    six->theta_begin = sample->theta;
    six->i_begin = i;
    six->u_dc = iq24_clamp(sample->u_dc, IQFOC_CYCLE_U_DC_MIN, IQFOC_CYCLE_U_DC_MAX);
    cycle->phase = IQFOC_CYCLE_DUE_NOTHING;
    cycle->i_valley = i;
    cycle->theta_valley = sample->theta;
}

iqfoc_six_step_command_t iqfoc_cycle_six_step_begin(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle,
                                                    const iqfoc_six_step_config_t *config, iq24_t angle,
                                                    const iqfoc_sample_t *sample)
{
    if (config == NULL || !fit(config)) {
        six->config = NULL;
        return safe(cycle, cycle->config->period_ticks);
    }
    six->config = config;
    six->angle = held(config, iq24_acc_mul(within_turn(angle), IQ24_ONE));
    take(six, cycle, sample, iqfoc_clarke3(sample->i));
    six->state = iqfoc_six_step_state(iq24_add_wrap(sample->theta, iq24_acc_round(six->angle)));
    if (!cycle->enabled || cycle->tripped) {
        return safe(cycle, cycle->config->period_ticks);
    }
    return standing(six, cycle, sample->theta, sample->speed);
}

iq24_t iqfoc_cycle_voltage_angle(const iqfoc_cycle_t *cycle)
{
    return within_turn(iq24_atan2(cycle->u_dq.q, cycle->u_dq.d));
}

/*
 * Range: a phase within 15.9 leaves components within 21.2, their change within 42.4: within the range of the
 * correction. Held to a third of a turn, what was covered is in its range too. |i_ref| <= 32 and |mean| <= 64, so the
 * error is within 96 and gain error + angle within 97, below the accumulator's 2^15.
 */
static void control(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, iqfoc_ab_t i)
{
    const iqfoc_ab_t mean = iqfoc_clarke3(sample->i_mean);
    const iqfoc_ab_t delta = {iq24_sub_wrap(i.alpha, six->i_begin.alpha),
                              iq24_sub_wrap(i.beta, six->i_begin.beta)};
    const iq24_t covered = iq24_clamp(within_turn(iq24_sub_wrap(sample->theta, six->theta_begin)),
                                      -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const iq24_sincos_t middle = iq24_sincos(iq24_add_wrap(six->theta_begin, iq24_asr32(covered, 1)));
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(covered);
    cycle->i_dq = six->config->discrete_angle ? iqfoc_park(mean, middle)
                                              : iqfoc_mean_current_correct(mean, delta, &rotor, middle);
    const iq24_t error = iq24_sub_wrap(cycle->i_ref.q, cycle->i_dq.q);
    six->angle = held(six->config, iq24_acc_mac(six->angle, six->config->gain, error));
}

iqfoc_six_step_command_t iqfoc_cycle_six_step_switch(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle,
                                                     const iqfoc_sample_t *sample, uint32_t now)
{
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    if (iqfoc_guard_sample(cycle->config, sample, i, now) > INT32_MAX) {
        iqfoc_cycle_report_sample(cycle, sample, now);
    }
    const bool runs = cycle->enabled && !cycle->tripped;
    if (!sample->has_mean) {
        iqfoc_cycle_set_status(cycle, IQFOC_STATUS_NO_INTERVAL);
    } else if (runs) {
        control(six, cycle, sample, i);
    }
    take(six, cycle, sample, i);
    if (!cycle->enabled || cycle->tripped) {
        return safe(cycle, cycle->config->period_ticks);
    }
    six->state = (six->state + (sample->speed < 0 ? 5 : 1)) % 6;
    return standing(six, cycle, sample->theta, sample->speed);
}

void iqfoc_cycle_six_step_end(const iqfoc_six_step_t *six, iqfoc_cycle_t *cycle, iq24_t speed)
{
    const iq24_t held = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const iq24_t u = iq24_mul_round(TWO_OVER_PI, six->u_dc);
    const iq24_sincos_t sc = iq24_sincos(iq24_acc_round(six->angle));
    cycle->u_dq.d = iq24_mul_round(u, sc.cos);
    cycle->u_dq.q = iq24_mul_round(u, sc.sin);
    iqfoc_current_control_preset(&cycle->control, &cycle->config->gains, cycle->u_dq, cycle->i_ref, held);
    cycle->over.length = TWO_OVER_PI;
    cycle->phase = IQFOC_CYCLE_DUE_NOTHING;
}
