/* Pulse modes (include/iqfoc/pulse_mode.h). */
#include "iqfoc/pulse_mode.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"
#include "iqfoc/valley_reference.h"

#include "held.h"
#include "pattern_place.h"

#include <stddef.h>

static const iqfoc_pattern_row_t six_step_row = {1, 0, {0}};
const iqfoc_pattern_t iqfoc_pattern_six_step = {&six_step_row, 1, 0, IQ24_ONE, IQ24_ONE};

/* ---- Set-up ---- */

static iqfoc_error_t tables_error(const iqfoc_pulse_config_t *c)
{
    iqfoc_error_t error = IQFOC_OK;
    for (int32_t n = 1; n < c->levels && error == IQFOC_OK; n++) {
        iqfoc_pattern_modulator_t any;
        error = iqfoc_pattern_init(&any, c->level[n].table, 0);
    }
    return error;
}

static bool levels_valid(const iqfoc_pulse_config_t *c)
{
    bool valid = c->level[0].table == NULL;
    iq24_t on = IQFOC_PATTERN_CONTROL_SPEED_MIN;
    iq24_t off = 0;
    for (int32_t n = 1; n < c->levels; n++) {
        const iqfoc_pulse_level_t *level = &c->level[n];
        valid = valid && iq24_within(level->on, on, IQFOC_PATTERN_SPEED_MAX) && level->off >= off &&
                level->off < level->on && iq24_within(level->index_on, 0, IQ24(2.0)) &&
                iq24_within(level->index_off, 0, level->index_on);
        on = level->on;
        off = level->off;
    }
    return valid;
}

iqfoc_error_t iqfoc_pulse_mode_init(iqfoc_pulse_mode_t *mode, const iqfoc_pulse_config_t *config)
{
    if (mode == NULL || config == NULL || config->level == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!iq24_within(config->levels, 2, IQFOC_PULSE_LEVELS_MAX) || !levels_valid(config) ||
        config->period_ticks < 1 || config->period_ticks > IQFOC_PULSE_TICKS_MAX) {
        return IQFOC_ERROR_PULSE_MODE;
    }
    const iqfoc_error_t error = tables_error(config);
    if (error == IQFOC_OK) {
        const iqfoc_pulse_mode_t fresh = {config, 0, 0, 0, 0, PATTERN_FAR_Q48};
        *mode = fresh;
    }
    return error;
}

/* ---- The level ---- */

void iqfoc_pulse_mode_step(iqfoc_pulse_mode_t *mode, iqfoc_pattern_control_t *control, iq24_t speed,
                           iq24_t index)
{
    const iqfoc_pulse_config_t *c = mode->config;
    mode->speed = iq24_clamp(speed, -IQFOC_PATTERN_SPEED_MAX, IQFOC_PATTERN_SPEED_MAX);
    const bool patterns = mode->level > 0 && mode->wanted > 0;
    if (patterns && control->modulator.table != c->level[mode->wanted].table) {
        return; /* the change is not over */
    }
    if (patterns) {
        mode->level = mode->wanted;
    }
    const iqfoc_pulse_level_t *here = &c->level[mode->level];
    const iq24_t speed_abs = iq24_abs_sat(mode->speed);
    int32_t next = mode->level;
    if (mode->level + 1 < c->levels && speed_abs >= here[1].on && index >= here[1].index_on) {
        next++;
    } else if (mode->level > 0 && (speed_abs < here->off || index < here->index_off)) {
        next--;
    }
    if (next == mode->wanted) {
        return;
    }
    mode->wanted = next;
    mode->waited = 0;
    mode->nearest_q48 = PATTERN_FAR_Q48;
    if (mode->level > 0 && next > 0 && next != mode->level) {
        iqfoc_pattern_control_change(control, c->level[next].table);
    }
}

/* ---- The hand-over ---- */

static bool is_near(iqfoc_pulse_mode_t *mode, iq24_acc_t cost_q48, iq24_t speed)
{
    mode->waited = iq24_min(mode->waited + iq24_abs_sat(speed), IQ24(3.0));
    return pattern_near(&mode->nearest_q48, cost_q48, mode->waited > IQ24_ONE);
}

/* A period of the carrier, in control cycles of the patterns. */
static iq24_t cycles_of(const iqfoc_pulse_mode_t *mode, uint32_t ticks)
{
    const iq24_t cycles = iq24_div((iq24_t)ticks, (iq24_t)mode->config->period_ticks);
    /*@ assert pulse_cycles: 0 <= cycles; */
    return cycles;
}

/* A leg at the end of a centred pulse. */
static iqfoc_pattern_leg_t leg_after(iq24_t high, iq24_t cycles)
{
    iqfoc_pattern_leg_t leg = {high < IQ24_ONE ? -1 : 1, IQFOC_PATTERN_TIME_MAX};
    if (high > 0 && high < IQ24_ONE) {
        leg.since = iq24_min(iq24_mul_sat((IQ24_ONE - high) / 2, cycles), IQFOC_PATTERN_TIME_MAX);
    }
    return leg;
}

bool iqfoc_pulse_mode_to_pattern(iqfoc_pulse_mode_t *mode, iqfoc_pattern_control_t *control,
                                 const iqfoc_cycle_t *cycle, iqfoc_abc_t high, iq24_t u_dc,
                                 iqfoc_pattern_edges_t edges[3])
{
    if (mode->level != 0 || mode->wanted == 0) {
        return false;
    }
    const iq24_t cycles = cycles_of(mode, cycle->config->period_ticks);
    const iqfoc_pattern_leg_t leg[3] = {leg_after(high.a, cycles), leg_after(high.b, cycles),
                                        leg_after(high.c, cycles)};
    iqfoc_pattern_control_restart(control, mode->config->level[1].table, u_dc);
    iqfoc_pattern_control_aim(control, cycle->i_ref, mode->speed);
    iqfoc_pattern_control_begin(control, cycle->i_next,
                                iq24_add_wrap(cycle->theta_valley, cycle->rotor.speed), leg, edges);
    if (!is_near(mode, pattern_cost_q48(control, edges), cycle->rotor.speed)) {
        return false;
    }
    mode->level = 1;
    return true;
}

/* Range: |r i_ref| <= 64, |v| <= 1/2 and the decoupling within 8: 73, and over s1 >= 0.8269, 88. */
static iqfoc_dq_t steady(const iqfoc_pattern_control_t *control, const iqfoc_current_control_gains_t *gains,
                         iqfoc_dq_t i_ref, const iqfoc_rotor_t *rotor)
{
    const iqfoc_dq_t apart = iqfoc_current_control_decoupling(gains, i_ref, rotor->speed);
    const iq24_t d = iq24_mul_round(control->r, i_ref.d) - control->v.d + apart.d;
    const iq24_t q = iq24_mul_round(control->r, i_ref.q) - control->v.q + apart.q;
    const iqfoc_dq_t u = {held_to_8(iq24_div(d, rotor->s1)), held_to_8(iq24_div(q, rotor->s1))};
    return u;
}

/*
 * h over the period. Range: i_next is within 8 sqrt(2) and i_ref/s1^2 within 11.7, so that the difference is within 23.1. x/2 pi <= 15.3
 * and emf 0.4625/2 pi <= 7.1.
 */
static iqfoc_dq_t flux_apart(const iqfoc_current_control_gains_t *gains, iqfoc_dq_t i, iqfoc_dq_t i_ref,
                             const iqfoc_rotor_t *rotor)
{
    const iq24_t radian = IQ24(0.15915494309189533577);
    const iq24_t gain = iqfoc_valley_gain(iq24_mul_round(rotor->s1, rotor->s1));
    const iq24_t x = iq24_mul_round(gains->x_d, radian);
    const iq24_t magnet = iq24_mul_round(iq24_mul_round(gains->emf, radian), gain - IQ24_ONE);
    const iq24_t d = iq24_mul_sat(x, i.d - iq24_mul_round(gain, i_ref.d));
    const iq24_t q = iq24_mul_sat(x, i.q - iq24_mul_round(gain, i_ref.q));
    const iqfoc_dq_t h = {held_to_8(iq24_sub_sat(d, magnet)), held_to_8(q)};
    return h;
}

bool iqfoc_pulse_mode_to_carrier(iqfoc_pulse_mode_t *mode, iqfoc_pattern_control_t *control,
                                 iqfoc_cycle_t *cycle, const iqfoc_cycle_config_t *set, iqfoc_ab_t i,
                                 iq24_t theta, iq24_t u_dc, iqfoc_pattern_edges_t edges[3],
                                 iqfoc_duties_t *duties)
{
    bool may_fall = true; /* each leg that is high, at this valley */
    for (int32_t k = 0; k < 3; k++) {
        const iqfoc_pattern_leg_t *leg = &control->modulator.leg[k];
        may_fall = may_fall && (leg->level < 0 || leg->since >= control->modulator.least);
    }
    iqfoc_pattern_control_step(control, i, theta, u_dc, edges);
    if (mode->wanted != 0) {
        return false;
    }
    const iq24_t cycles = cycles_of(mode, set->period_ticks);
    const iq24_t speed =
        iq24_clamp(iq24_mul_sat(mode->speed, cycles), -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
    const iqfoc_dq_t i_ref = cycle->i_ref;
    const iqfoc_dq_t h = flux_apart(&set->gains, iqfoc_park(control->i_next, control->sc), i_ref, &rotor);
    /* The first voltage makes h good within the period, before its d component is torque: that counts half. */
    if (!is_near(mode, pattern_square_q48(h.d / 2, h.q), mode->speed) || !may_fall) {
        return false;
    }
    const iqfoc_dq_t u = steady(control, &set->gains, i_ref, &rotor);
    const iq24_t half = iq24_asr32(speed, 1);
    const iqfoc_ab_t less = iqfoc_park_inverse(h, iq24_sincos(-half));
    cycle->u_dq.d = held_to_8(u.d - less.alpha);
    cycle->u_dq.q = held_to_8(u.q - less.beta);
    const iqfoc_ab_t u_ab = iqfoc_park_inverse(cycle->u_dq, iq24_sincos(iq24_add_wrap(control->theta, half)));
    cycle->u_dc_inverse = iq24_div(IQ24_ONE, u_dc);
    *duties = iqfoc_modulate(u_ab, cycle->u_dc_inverse, set->span_max);
    cycle->u_ab = iqfoc_modulated_voltage(duties->high, u_dc);
    cycle->config = set;
    cycle->next = set;
    cycle->offered = set;
    cycle->phase = IQFOC_CYCLE_DUE_NOTHING;
    mode->level = 0;
    return true;
}

void iqfoc_pulse_mode_resume(const iqfoc_pattern_control_t *control, iqfoc_cycle_t *cycle)
{
    const iqfoc_current_control_gains_t *gains = &cycle->config->gains;
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(cycle->rotor.speed);
    cycle->u_dq = steady(control, gains, cycle->i_ref, &rotor);
    iqfoc_current_control_preset(&cycle->control, gains, cycle->u_dq, cycle->i_ref, rotor.speed);
}
