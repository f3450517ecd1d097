/* Lost phases and sensors (include/iqfoc/supervision.h). */
#include "iqfoc/supervision.h"

#include <stddef.h>

#define WINDOW_MAX (UINT32_C(1) << 24)

static bool count_fits(uint32_t count, uint32_t least)
{
    return count >= least && count <= UINT32_C(1) << 20;
}

iqfoc_error_t iqfoc_supervision_init(iqfoc_supervision_t *supervision,
                                     const iqfoc_supervision_config_t *config)
{
    if (supervision == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!iq24_within(config->i_least, 1, IQ24(16.0)) || !iq24_within(config->share, 1, IQ24_ONE / 2) ||
        !count_fits(config->window_min, 6) || !count_fits(config->windows_bad, 1) ||
        !iq24_within(config->sum_max, 1, IQ24(16.0)) || !count_fits(config->sums_bad, 1)) {
        return IQFOC_ERROR_SUPERVISION;
    }
    supervision->config = config;
    iqfoc_supervision_clear(supervision);
    return IQFOC_OK;
}

void iqfoc_supervision_clear(iqfoc_supervision_t *supervision)
{
    const iqfoc_supervision_t fresh = {supervision->config, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    *supervision = fresh;
}

static void window_begin(iqfoc_supervision_t *s)
{
    s->sum_a = 0;
    s->sum_b = 0;
    s->sum_c = 0;
    s->angle = 0;
    s->cycles = 0;
}

static int64_t larger(int64_t x, int64_t y)
{
    return x > y ? x : y;
}

/*
 * The phases that are lost by this window, as bits. Means are compared as sums.
 *
 * Range: at most 2^24 cycles of |i| <= 2^31: sums within 2^55. share <= 2^23 would take one of them beyond
 * int64: the largest is divided by 2^16 first, which changes the limit by less than 2^-8 of an LSB of i.
 */
static uint32_t lost_phases(const iqfoc_supervision_t *s)
{
    const int64_t largest = larger(larger(s->sum_a, s->sum_b), s->sum_c);
    if (largest < (int64_t)s->config->i_least * (int64_t)s->cycles) {
        return 0;
    }
    const int64_t limit = iq24_asr64(iq24_asr64(largest, 16) * s->config->share, 8);
    return (s->sum_a < limit ? UINT32_C(1) : 0) | (s->sum_b < limit ? UINT32_C(2) : 0) |
           (s->sum_c < limit ? UINT32_C(4) : 0);
}

static void watch_phases(iqfoc_supervision_t *s, iqfoc_abc_t i, iq24_t speed)
{
    s->sum_a += iq24_abs_sat(i.a);
    s->sum_b += iq24_abs_sat(i.b);
    s->sum_c += iq24_abs_sat(i.c);
    s->angle += speed;
    s->cycles++;
    const bool turned = s->angle >= IQ24_ONE / 2 || s->angle <= -IQ24_ONE / 2;
    if (turned && s->cycles >= s->config->window_min) {
        const uint32_t lost = lost_phases(s);
        const uint32_t bad = lost == 0 ? 0 : s->bad_windows + 1;
        s->bad_windows = bad <= s->config->windows_bad ? bad : s->config->windows_bad;
        if (s->bad_windows == s->config->windows_bad && (s->status & IQFOC_STATUS_LOST_PHASE) == 0) {
            s->status |= IQFOC_STATUS_LOST_PHASE;
            s->phase = lost;
        }
        window_begin(s);
    } else if (s->cycles >= WINDOW_MAX) {
        window_begin(s);
    }
}

/* Range: |a + b + c| <= 3 2^31, in 64 bits. Both counts stop at their limits. */
static void watch_sum(iqfoc_supervision_t *s, iqfoc_abc_t i)
{
    const int64_t sum = (int64_t)i.a + i.b + i.c;
    if (sum <= s->config->sum_max && sum >= -s->config->sum_max) {
        s->bad_sums = 0;
        return;
    }
    s->bad_sums += s->bad_sums < s->config->sums_bad ? 1 : 0;
    if (s->bad_sums >= s->config->sums_bad) {
        s->status |= IQFOC_STATUS_LOST_CURRENT_SENSOR;
    }
}

uint32_t iqfoc_supervision_step(iqfoc_supervision_t *supervision, iqfoc_abc_t i, iq24_t speed, bool running)
{
    if (running) {
        watch_phases(supervision, i, speed);
    } else {
        window_begin(supervision);
        supervision->bad_windows = 0;
    }
    watch_sum(supervision, i);
    return supervision->status;
}
