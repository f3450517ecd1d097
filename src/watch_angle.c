/* Watch of the angle sensor (include/iqfoc/watch_angle.h). */
#include "iqfoc/watch_angle.h"

#include "iqfoc/iq24_math.h"

#include "angle.h"

#include <stddef.h>

#define BLOCK_CYCLES_LEAST 64
#define BLOCK_CYCLES_MOST  32767
#define NAMING_BLOCKS      4
/* Electrical turns until a start of the observer has decayed: 25 rad, with 4 to 6 rad to 1/e. */
#define WAIT_TURNS 4
/* Valleys with the gates on, after which the observer runs (sensorless.h). */
#define ON_VALLEYS 3U

static bool limits_good(iq24_t limit, iq24_t alarm)
{
    return iq24_within(limit, 4, IQ24(0.5)) && iq24_within(alarm, 4, IQ24(0.5));
}

static void clear_block(iqfoc_watch_angle_t *w)
{
    for (int32_t k = 0; k < 3; k++) {
        w->sum[k] = 0;
    }
    w->count = 0;
}

static void wait_again(iqfoc_watch_angle_t *w)
{
    clear_block(w);
    w->path = 0;
    w->wait = WAIT_TURNS;
}

void iqfoc_watch_angle_reset(iqfoc_watch_angle_t *w)
{
    for (int32_t k = 0; k < 3; k++) {
        w->x[k] = 0;
        w->up[k] = 0;
        w->down[k] = 0;
    }
    w->base = 0;
    w->theta = 0;
    w->turn = 0;
    w->first = 0;
    w->moved = 0;
    w->blocks = 0;
    w->naming = 0;
    w->fault = IQFOC_WATCH_ANGLE_NONE;
    w->alarm = IQFOC_WATCH_ANGLE_NONE;
    w->amount = 0;
    wait_again(w);
}

iqfoc_error_t iqfoc_watch_angle_init(iqfoc_watch_angle_t *w, const iqfoc_watch_angle_config_t *config)
{
    if (w == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const bool good = config->pole_pairs >= 1 && config->pole_pairs <= 64 &&
                      iq24_within(config->speed_min, 1, IQFOC_ROTOR_SPEED_MAX) &&
                      limits_good(config->mean_limit, config->mean_alarm) &&
                      limits_good(config->swing_limit, config->swing_alarm);
    if (!good) {
        return IQFOC_ERROR_WATCH_ANGLE;
    }
    w->config = config;
    w->mechanical = iq24_div(1, config->pole_pairs);
    iqfoc_watch_angle_reset(w);
    return IQFOC_OK;
}

/* Moves the shaft to the observed angle: path, and the electrical turn of the revolution. Range: path is within 64 here. */
static void move_shaft(iqfoc_watch_angle_t *w, iq24_t theta)
{
    const iq24_t by = angle_less_turns((int64_t)theta - w->theta);
    const iq24_t end = w->theta + by;
    if (end >= IQ24(0.5)) {
        w->turn = w->turn + 1 < w->config->pole_pairs ? w->turn + 1 : 0;
    } else if (end < IQ24(-0.5)) {
        w->turn = w->turn > 0 ? w->turn - 1 : w->config->pole_pairs - 1;
    } else {
        /* the same turn */
    }
    w->path += by;
    w->theta = theta;
}

/* Range: |difference from base| <= 1/2, so that each product is too. */
static void add_cycle(iqfoc_watch_angle_t *w, iq24_t difference)
{
    const iq24_t shaft = iq24_mul_round(w->turn * IQ24_ONE + w->theta, w->mechanical);
    const iq24_sincos_t s_q30 = iq24_sincos_q30_inline(shaft);
    const iq24_t d = angle_less_turns((int64_t)difference - w->base);
    w->sum[0] += d;
    w->sum[1] += iq24_mul_shift(d, s_q30.cos, 30);
    w->sum[2] += iq24_mul_shift(d, s_q30.sin, 30);
    w->count++;
}

/* sum/count, times 2^(8 - bits). Range: |sum| < 2^38 and bits >= 7, so the numerator is below 2^31; count * 2^16 as well. */
static iq24_t over_count(const iqfoc_watch_angle_t *w, int64_t sum, uint32_t bits)
{
    const iq24_t x = iq24_div(iq24_sat(iq24_asr64(sum, bits)), w->count * 65536);
    return iq24_clamp(x, -IQ24_ONE, IQ24_ONE);
}

/* Range: |x| <= 1, and limits, sums below 1. */
static void add_excess(iq24_t *sum, iq24_t x, iq24_t limit, iq24_t alarm)
{
    const iq24_t rise = iq24_min(x - limit, alarm / 4);
    *sum = iq24_clamp(*sum + rise, 0, alarm);
}

static void give_name(iqfoc_watch_angle_t *w)
{
    if (w->moved > 2 * w->config->mean_limit) {
        w->fault = IQFOC_WATCH_ANGLE_SLIP;
        w->amount = angle_less_turns((int64_t)w->x[0] - w->first);
    } else if (w->alarm == IQFOC_WATCH_ANGLE_OFFSET) {
        w->fault = w->alarm;
        w->amount = w->x[0];
    } else {
        w->fault = w->alarm;
        w->amount = iq24_sqrt(iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(w->x[1], w->x[1]), w->x[2], w->x[2])));
    }
}

static void raise_alarm(iqfoc_watch_angle_t *w)
{
    const iqfoc_watch_angle_config_t *c = w->config;
    for (int32_t k = 2; k >= 0; k--) {
        if (iq24_max(w->up[k], w->down[k]) >= (k == 0 ? c->mean_alarm : c->swing_alarm)) {
            w->alarm = k == 0 ? IQFOC_WATCH_ANGLE_OFFSET : IQFOC_WATCH_ANGLE_ECCENTRIC;
            w->naming = NAMING_BLOCKS;
        }
    }
}

/* The end of a block whose start has decayed: true if the fault gets its name. */
static bool end_block(iqfoc_watch_angle_t *w)
{
    const iqfoc_watch_angle_config_t *c = w->config;
    w->x[0] = angle_less_turns(w->base + over_count(w, w->sum[0], 8U));
    w->x[1] = over_count(w, w->sum[1], 7U);
    w->x[2] = over_count(w, w->sum[2], 7U);
    if (w->blocks == 0) {
        w->first = w->x[0];
    }
    w->blocks += w->blocks < UINT32_MAX ? 1U : 0U;
    w->moved = iq24_max(w->moved, iq24_abs_sat(angle_less_turns((int64_t)w->x[0] - w->first)));
    for (int32_t k = 0; k < 3; k++) {
        const iq24_t limit = k == 0 ? c->mean_limit : c->swing_limit;
        const iq24_t alarm = k == 0 ? c->mean_alarm : c->swing_alarm;
        add_excess(&w->up[k], w->x[k], limit, alarm);
        add_excess(&w->down[k], -w->x[k], limit, alarm);
    }
    if (w->naming == 0) {
        raise_alarm(w);
        return false;
    }
    w->naming--;
    if (w->naming == 0) {
        give_name(w);
        return true;
    }
    return false;
}

/* A whole revolution. Range: path is within 64.5 turns. */
static bool end_revolution(iqfoc_watch_angle_t *w)
{
    const int32_t revolution = w->config->pole_pairs * IQ24_ONE;
    bool named = false;
    w->path += w->path < 0 ? revolution : -revolution;
    if (w->count >= BLOCK_CYCLES_LEAST) {
        if (w->wait > 0) {
            w->wait -= w->config->pole_pairs;
        } else {
            named = end_block(w);
        }
        clear_block(w);
    }
    return named;
}

bool iqfoc_watch_angle_step(iqfoc_watch_angle_t *w, const iqfoc_sensorless_t *s)
{
    const iqfoc_observer_t *o = &s->observer;
    const iq24_t theta = iqfoc_observer_theta(o, 0);
    const bool slow = iq24_abs_sat(iqfoc_observer_speed(o)) < w->config->speed_min;
    if (w->fault != IQFOC_WATCH_ANGLE_NONE) {
        return false;
    }
    move_shaft(w, theta);
    if (!o->locked || slow || s->on < ON_VALLEYS || w->count >= BLOCK_CYCLES_MOST) {
        wait_again(w);
        return false;
    }
    if (w->count == 0) {
        w->base = s->difference;
    }
    add_cycle(w, s->difference);
    const int32_t revolution = w->config->pole_pairs * IQ24_ONE;
    return (w->path >= revolution || w->path <= -revolution) && end_revolution(w);
}
