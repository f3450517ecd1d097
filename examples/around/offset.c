/* Offset calibration ahead of the first command. */
#include "around.h"

#include "iqfoc/offset.h"

#include <stddef.h>

static const iqfoc_offset_limits_t limits = {
    .settle = 500, .count_log2 = 10, .offset_max = IQ24(0.1), .noise_max = IQ24(0.01)};
static iqfoc_offset_t offset; /* zero-initialised: not begun */

bool around_offset_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    if (offset.limits == NULL && iqfoc_offset_init(&offset, &limits) != IQFOC_OK) {
        return false;
    }
    const iqfoc_offset_verdict_t verdict = iqfoc_offset_step(&offset, sample.i);
    sample.i = iqfoc_offset_removed(&offset, sample.i); /* 0 is removed while it is busy */
    iqfoc_cycle_valley(cycle, &sample, now);
    return verdict == IQFOC_OFFSET_GOOD;
}
