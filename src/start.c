/* Alignment and open-loop angle (include/iqfoc/start.h). */
#include "iqfoc/start.h"

#include "angle.h"

#include <stddef.h>

#define QUARTER    (IQ24_ONE / 4)
#define TOLERANCE  (IQ24_ONE / 16)
#define CYCLES_MAX (UINT32_C(1) << 24)

static bool cycles_fit(uint32_t cycles)
{
    return cycles >= 1 && cycles <= CYCLES_MAX;
}

iqfoc_error_t iqfoc_start_init(iqfoc_start_t *start, const iqfoc_start_config_t *config)
{
    if (start == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!iq24_within(config->i_align, 1, IQ24(16.0)) || !cycles_fit(config->ramp_cycles) ||
        !cycles_fit(config->hold_cycles) ||
        !iq24_within(config->speed_end, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX) ||
        (config->speed_end != 0 && !cycles_fit(config->run_up_cycles))) {
        return IQFOC_ERROR_START;
    }
    const iqfoc_start_t fresh = {config, IQFOC_START_RAISE, IQFOC_START_NOT_YET, 0, QUARTER, 0, {0, 0}, 0, 0};
    *start = fresh;
    return IQFOC_OK;
}

/* whole * done/all, rounded. Range: 0 <= done <= all <= 2^24, so the quotient is within 0 ... 1. */
static iq24_t part(iq24_t whole, uint32_t done, uint32_t all)
{
    return iq24_mul_round(whole, iq24_div((iq24_t)done, (iq24_t)all));
}

/* Verdict from the sensor's travel, less whole turns. */
static iqfoc_start_verdict_t judge(iq24_t before, iq24_t after)
{
    const iq24_t way = angle_less_turns((int64_t)after - before);
    if (iq24_within(way, -QUARTER - TOLERANCE, -QUARTER + TOLERANCE)) {
        return IQFOC_START_GOOD;
    }
    if (iq24_within(way, -TOLERANCE, TOLERANCE)) {
        return IQFOC_START_STUCK;
    }
    if (iq24_within(way, QUARTER - TOLERANCE, QUARTER + TOLERANCE)) {
        return IQFOC_START_REVERSED;
    }
    return IQFOC_START_WRONG_WAY;
}

/* The next stage, once `all` cycles of this one are over. */
static void go_on(iqfoc_start_t *start, uint32_t all, iqfoc_start_stage_t next)
{
    if (start->done >= all) {
        start->stage = next;
        start->done = 0;
    }
}

/* Sets the speed that leads within one cycle to the angle after `done` cycles of TURN. */
static void turn_back(iqfoc_start_t *start)
{
    const iq24_t to = QUARTER - part(QUARTER, start->done, start->config->ramp_cycles);
    start->speed = iq24_sub_wrap(to, start->theta);
}

void iqfoc_start_step(iqfoc_start_t *start, iq24_t sensor_theta)
{
    const iqfoc_start_config_t *config = start->config;
    start->theta = iq24_add_wrap(start->theta, start->speed);
    start->speed = 0;
    start->done += start->done < UINT32_MAX ? 1 : 0;
    switch (start->stage) {
    case IQFOC_START_RAISE:
        start->i_ref.d = part(config->i_align, start->done, config->ramp_cycles);
        go_on(start, config->ramp_cycles, IQFOC_START_HOLD);
        break;
    case IQFOC_START_HOLD:
        start->sensor_before = sensor_theta;
        go_on(start, config->hold_cycles, IQFOC_START_TURN);
        break;
    case IQFOC_START_TURN:
        turn_back(start);
        go_on(start, config->ramp_cycles, IQFOC_START_SETTLE);
        break;
    case IQFOC_START_SETTLE:
        start->sensor_zero = sensor_theta;
        go_on(start, config->hold_cycles, config->speed_end != 0 ? IQFOC_START_RUN_UP : IQFOC_START_ALIGNED);
        if (start->stage != IQFOC_START_SETTLE) {
            start->verdict = judge(start->sensor_before, start->sensor_zero);
        }
        break;
    case IQFOC_START_RUN_UP:
        start->speed = part(config->speed_end, start->done, config->run_up_cycles);
        go_on(start, config->run_up_cycles, IQFOC_START_OPEN_LOOP);
        break;
    case IQFOC_START_OPEN_LOOP:
        start->speed = config->speed_end;
        break;
    case IQFOC_START_ALIGNED:
    default:
        break;
    }
}

/*
 * i e^(j (theta - theta_true)). Range: |i| <= 16, sine and cosine within 1: no wrap. Error: 0.51 LSB of the sine
 * times |i| and the rounding.
 */
iqfoc_dq_t iqfoc_start_handover(const iqfoc_start_t *start, iq24_t theta_true)
{
    const iq24_sincos_t sc = iq24_sincos(iq24_sub_wrap(start->theta, theta_true));
    const iqfoc_dq_t seen = {iq24_mul_round(start->i_ref.d, sc.cos), iq24_mul_round(start->i_ref.d, sc.sin)};
    return seen;
}
