/* Observer of angle and speed (include/iqfoc/tracker.h). */
#include "iqfoc/tracker.h"

#include <stddef.h>

/* 1/3 turn per cycle in Q32; and a change of all that in one cycle. */
#define TURNS_MAX        (IQFOC_ROTOR_SPEED_MAX * INT32_C(256))
#define ACCELERATION_MAX (INT32_C(1) << 29)

iqfoc_error_t iqfoc_tracker_init(iqfoc_tracker_t *tracker, const iqfoc_tracker_config_t *config)
{
    if (tracker == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!iq24_within(config->k1, 1, IQ24_ONE) || !iq24_within(config->k2, 1, IQ24_ONE) ||
        !iq24_within(config->k3, 0, IQ24_ONE) || !iq24_within(config->far_max, 1, IQ24_ONE / 2)) {
        return IQFOC_ERROR_TRACKER;
    }
    tracker->config = config;
    iqfoc_tracker_restart(tracker);
    return IQFOC_OK;
}

void iqfoc_tracker_restart(iqfoc_tracker_t *tracker)
{
    const iqfoc_tracker_t fresh = {tracker->config, 0, 0, 0, 0, 0, 0, false};
    *tracker = fresh;
}

/* Any whole turns drop out: turns of 2^24 become turns of 2^32. */
static int32_t q32_of(iq24_t theta)
{
    return iq24_wrap((int64_t)theta * 256);
}

static int32_t held(int64_t x, int32_t most)
{
    return x > most ? most : x < -most ? -most : (int32_t)x;
}

/* Range: |gain| <= 2^24 and |e| <= 2^31: the product is within 2^55. */
static int64_t share(iq24_t gain, int32_t e)
{
    return iq24_asr64(IQ24_MUL64(gain, e) + IQ24_ACC_HALF, 24);
}

/* Range: |speed| < 2^30.5 and |acceleration| <= 2^29: their sums are within int64 by far, then wrapped or held. */
static void advance(iqfoc_tracker_t *t)
{
    t->theta_q32 = iq24_wrap((int64_t)t->theta_q32 + t->speed_q32 + iq24_asr32(t->acceleration_q32, 1));
    t->speed_q32 = held((int64_t)t->speed_q32 + t->acceleration_q32, TURNS_MAX);
}

/* Without a speed of its own yet: the first measurement is the angle, the next one's distance the speed. */
static void acquire(iqfoc_tracker_t *t, int32_t measured, iq24_t instant)
{
    const int32_t moved = iq24_wrap((int64_t)measured - t->theta_q32);
    t->speed_q32 = t->seen == 0 ? 0 : held(moved, TURNS_MAX);
    t->theta_q32 = iq24_wrap(measured - iq24_asr64(IQ24_MUL64(t->speed_q32, instant), 24));
    t->seen++;
}

void iqfoc_tracker_step(iqfoc_tracker_t *tracker, iq24_t theta, iq24_t instant, bool valid)
{
    iqfoc_tracker_t *t = tracker;
    const iqfoc_tracker_config_t *config = t->config;
    const int32_t measured = q32_of(theta);
    if (valid && t->seen < 2) {
        acquire(t, measured, instant);
        t->missing = 0;
        return;
    }
    advance(t);
    const int64_t predicted = t->theta_q32 + iq24_asr64(IQ24_MUL64(t->speed_q32, instant), 24);
    const int32_t e = iq24_wrap(measured - predicted);
    const iq24_t error = iq24_asr32(e, 8);
    if (!valid || !iq24_within(error, -config->far_max, config->far_max)) {
        t->missing += t->missing < UINT32_MAX ? 1 : 0;
        t->seen = t->seen < 2 ? 0 : t->seen; /* a speed wants two measurements one cycle apart */
        t->lost = t->lost || t->missing > config->lost_max;
        return;
    }
    t->missing = 0;
    t->error = error;
    t->theta_q32 = iq24_wrap(t->theta_q32 + share(config->k1, e));
    t->speed_q32 = held(t->speed_q32 + share(config->k2, e), TURNS_MAX);
    t->acceleration_q32 = held(t->acceleration_q32 + share(config->k3, e), ACCELERATION_MAX);
}
