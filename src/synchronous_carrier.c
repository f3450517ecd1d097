/* Synchronous carrier (include/iqfoc/synchronous_carrier.h). */
#include "iqfoc/synchronous_carrier.h"

#include "iqfoc/rotor.h"
#include "iqfoc/transform.h"
#include "iqfoc/valley_reference.h"

#include "held.h"

#include <stddef.h>

#define MASK (IQ24_ONE - 1)

/* An odd multiple of three: 3 more than a multiple of 6. */
static bool periods_valid(int32_t periods)
{
    return periods == 0 ||
           (iq24_within(periods, IQFOC_SYNCHRONOUS_PERIODS_MIN, IQFOC_SYNCHRONOUS_PERIODS_MAX) &&
            periods % 6 == 3);
}

static bool levels_valid(const iqfoc_synchronous_config_t *c)
{
    bool valid = periods_valid(c->level[0].periods);
    iq24_t on = 0;
    iq24_t off = 0;
    for (int32_t n = 1; n < c->levels; n++) {
        const iqfoc_synchronous_level_t *level = &c->level[n];
        valid = valid && periods_valid(level->periods) && iq24_within(level->on, on, IQ24_ONE) &&
                level->off >= off && level->off < level->on;
        on = level->on;
        off = level->off;
    }
    return valid;
}

static bool times_valid(const iqfoc_synchronous_config_t *c)
{
    return c->ticks_min > 0 && c->ticks_min <= c->period_ticks && c->period_ticks <= c->ticks_max &&
           c->ticks_max <= IQFOC_SYNCHRONOUS_TICKS_MAX;
}

iqfoc_error_t iqfoc_synchronous_carrier_init(iqfoc_synchronous_carrier_t *carrier,
                                             const iqfoc_synchronous_config_t *config)
{
    if (carrier == NULL || config == NULL || config->level == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!iq24_within(config->levels, 1, IQFOC_SYNCHRONOUS_LEVELS_MAX) || !levels_valid(config) ||
        !times_valid(config) || !iq24_within(config->gain, 1, IQ24_ONE) ||
        !iq24_within(config->share_max, 1, IQ24(0.25))) {
        return IQFOC_ERROR_CARRIER;
    }
    const iqfoc_synchronous_carrier_t fresh = {config, 0, config->period_ticks, 0, 0, {0, 0}, {0, 0}};
    *carrier = fresh;
    return IQFOC_OK;
}

/* ticks times a factor of 0 ... 128, to the nearest: below 2^32 times 2^7. */
static uint64_t times(uint32_t ticks, iq24_t factor)
{
    return ((uint64_t)ticks * (uint32_t)factor + (UINT64_C(1) << 23)) >> 24;
}

static uint32_t held(uint64_t ticks, uint32_t low, uint32_t high)
{
    return ticks < low ? low : ticks > high ? high : (uint32_t)ticks;
}

/* e: the angle's low 24 bits are below a turn, so that N of them stay below 99 turns; half a period more and less centres the rest. */
static iq24_t error_of(int32_t periods, iq24_t phase, iq24_t angle)
{
    const iq24_t place = iq24_sub_wrap(periods * (angle & MASK), phase);
    return (iq24_add_wrap(place, IQ24(0.5)) & MASK) - IQ24(0.5);
}

uint32_t iqfoc_synchronous_carrier_step(iqfoc_synchronous_carrier_t *carrier, iq24_t angle, iq24_t movement)
{
    const iqfoc_synchronous_config_t *c = carrier->config;
    const uint32_t ticks = carrier->ticks;
    const iqfoc_dq_t none = {0, 0};
    carrier->mean_off = carrier->mean_off_next;
    carrier->mean_off_next = none;
    movement = iq24_clamp(movement, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const iq24_t moved = iq24_max(movement, -movement);
    const iq24_t speed = iq24_mul_sat(moved, iq24_div((iq24_t)c->period_ticks, (iq24_t)ticks));
    carrier->speed = speed;
    if (carrier->level + 1 < c->levels && speed >= c->level[carrier->level + 1].on) {
        carrier->level++;
    } else if (carrier->level > 0 && speed < c->level[carrier->level].off) {
        carrier->level--;
    }
    const int32_t periods = c->level[carrier->level].periods;
    carrier->error = 0;
    carrier->ticks = c->period_ticks;
    if (periods > 0) {
        const iq24_t e = error_of(periods, c->phase, iq24_add_wrap(angle, movement));
        const iq24_t ahead = movement < 0 ? -e : e;
        const iq24_t change = iq24_clamp(iq24_mul_round(c->gain, ahead), -c->share_max, c->share_max);
        carrier->error = ahead;
        carrier->ticks =
            held(times(ticks, iq24_div(IQ24_ONE - change, periods * moved)), c->ticks_min, c->ticks_max);
    }
    return carrier->ticks;
}

/* A parameter of the set times a factor, held to its range. */
static iq24_t scaled(iq24_t x, iq24_t factor, iq24_t low, iq24_t high)
{
    return iq24_clamp(iq24_mul_sat(x, factor), low, high);
}

void iqfoc_synchronous_carrier_set(const iqfoc_cycle_config_t *base, uint32_t ticks,
                                   iqfoc_cycle_config_t *set)
{
    const uint32_t new = held(ticks, 1, IQFOC_SYNCHRONOUS_TICKS_MAX);
    const iq24_t longer = iq24_div((iq24_t) new, (iq24_t)base->period_ticks);
    const iq24_t faster = iq24_div((iq24_t)base->period_ticks, (iq24_t) new);
    *set = *base;
    set->predictor.k_u = scaled(base->predictor.k_u, longer, 1, IQ24(16.0));
    set->predictor.k_r = scaled(base->predictor.k_r, longer, 0, IQ24_ONE);
    set->gains.ki_d = scaled(base->gains.ki_d, longer, 0, IQ24(32.0));
    set->gains.ki_q = scaled(base->gains.ki_q, longer, 0, IQ24(32.0));
    set->gains.anti_windup = scaled(base->gains.anti_windup, longer, 0, IQ24_ONE);
    set->gains.x_d = scaled(base->gains.x_d, faster, 0, IQ24(96.0));
    set->gains.x_q = scaled(base->gains.x_q, faster, 0, IQ24(96.0));
    set->gains.emf = scaled(base->gains.emf, faster, 0, IQ24(96.0));
    set->period_ticks = new;
    set->tolerance_ticks = held(times(base->tolerance_ticks, longer), 0, INT32_MAX - new);
    set->stale_ticks = held(times(base->stale_ticks, longer), 0, INT32_MAX);
    set->deadline_ticks = held(times(base->deadline_ticks, longer), 0, INT32_MAX);
}

/* The controller sees a mean that is off by mean_off. Its answer to that is taken back. Range: within 8 + 32 + 32. */
static void take_back_answer(const iqfoc_synchronous_carrier_t *carrier, iqfoc_cycle_t *cycle)
{
    const iqfoc_dq_t off = carrier->mean_off;
    const iqfoc_current_control_gains_t *gains = &cycle->config->gains;
    const iq24_t reactance_d = iq24_mul_round(cycle->rotor.speed, gains->x_d);
    const iq24_t reactance_q = iq24_mul_round(cycle->rotor.speed, gains->x_q);
    iqfoc_current_control_t *control = &cycle->control;
    cycle->u_dq.d =
        held_to_8(cycle->u_dq.d + iq24_mul_round(gains->kp_d, off.d) + iq24_mul_round(reactance_q, off.q));
    cycle->u_dq.q =
        held_to_8(cycle->u_dq.q + iq24_mul_round(gains->kp_q, off.q) - iq24_mul_round(reactance_d, off.d));
    control->integral_d = iqfoc_current_control_hold(iq24_acc_mac(control->integral_d, gains->ki_d, off.d));
    control->integral_q = iqfoc_current_control_hold(iq24_acc_mac(control->integral_q, gains->ki_q, off.q));
}

/* A flux over T as a current, held to +-1. Range: |flux| <= 13.5, and 2 pi times that is 85. */
static iq24_t current_of(iq24_t flux, iq24_t x)
{
    return iq24_clamp(iq24_div(iq24_mul_round(IQ24(6.28318530717958647693), flux), x), -IQ24_ONE, IQ24_ONE);
}

/*
 * The mean voltage of a cycle, as seen from the rotor, is s1 times its vector, and the flux at a valley is the mean over s1^2
 * (valley_reference.h). 1/s1^2 differs by at most 0.4625.
 *
 * Range: s1 is 0.8269 ... 1, so that their quotient is at most 1.21 and u_dq, within 8, at most 9.7. The step is at most 0.074; x i_ref
 * saturates at 128, and so does the flux before it: 9.5, and 13.4 after the rotation.
 */
void iqfoc_synchronous_carrier_keep_flux(iqfoc_synchronous_carrier_t *carrier, iqfoc_cycle_t *cycle)
{
    const iqfoc_cycle_config_t *next = cycle->next;
    const uint32_t ticks = cycle->config->period_ticks;
    take_back_answer(carrier, cycle);
    if (next->period_ticks != ticks) {
        const iq24_t longer = iq24_div((iq24_t)next->period_ticks, (iq24_t)ticks);
        const iq24_t movement = iq24_clamp(iq24_mul_sat(cycle->rotor.speed, longer), -IQFOC_ROTOR_SPEED_MAX,
                                           IQFOC_ROTOR_SPEED_MAX);
        const iqfoc_rotor_t before = iqfoc_rotor_from_speed(cycle->rotor.speed);
        const iqfoc_rotor_t after = iqfoc_rotor_from_speed(movement);
        const iq24_t more = iq24_div(before.s1, after.s1) - IQ24_ONE;
        const iqfoc_dq_t change = {iq24_mul_round(more, cycle->u_dq.d), iq24_mul_round(more, cycle->u_dq.q)};
        cycle->control.integral_d =
            iqfoc_current_control_hold(iq24_acc_mac(cycle->control.integral_d, change.d, IQ24_ONE));
        cycle->control.integral_q =
            iqfoc_current_control_hold(iq24_acc_mac(cycle->control.integral_q, change.q, IQ24_ONE));

        const iq24_t square = iq24_mul_round(after.s1, after.s1);
        const iq24_t apart =
            iqfoc_valley_gain(square) - iqfoc_valley_gain(iq24_mul_round(before.s1, before.s1));
        const iq24_t step = iq24_mul_round(apart, IQ24(0.15915494309189533577));
        const iqfoc_dq_t flux = {iq24_add_sat(iq24_mul_sat(next->gains.x_d, cycle->i_ref.d), next->gains.emf),
                                 iq24_mul_sat(next->gains.x_q, cycle->i_ref.q)};
        const iqfoc_dq_t moved = {iq24_mul_round(step, flux.d), iq24_mul_round(step, flux.q)};
        const iq24_sincos_t back = iq24_sincos(-iq24_asr32(movement, 1));
        const iqfoc_ab_t u = iqfoc_park_inverse(moved, back);
        cycle->u_dq.d = held_to_8(cycle->u_dq.d + change.d + u.alpha);
        cycle->u_dq.q = held_to_8(cycle->u_dq.q + change.q + u.beta);

        /* e^(j phi/2) (s1/2 - j s2) - s1^2 */
        const iq24_sincos_t share = {
            iq24_mul_round(after.s1 / 2, -back.sin) - iq24_mul_round(after.s2, back.cos),
            iq24_mul_round(after.s1 / 2, back.cos) - iq24_mul_round(after.s2, back.sin) - square};
        const iqfoc_ab_t mean = iqfoc_park_inverse(moved, share);
        carrier->mean_off_next.d = current_of(mean.alpha, next->gains.x_d);
        carrier->mean_off_next.q = current_of(mean.beta, next->gains.x_q);
    }
}
