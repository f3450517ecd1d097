/* An encoder that is read late: its angle at the valley, and at the peak, from the tracker. */
#include "around.h"

#include "iqfoc/encoder.h"
#include "iqfoc/tracker.h"

#include <stddef.h>

/* The index' angle is known from an earlier alignment: iqfoc_encoder_index_theta. The index' interrupt, or the
 * timer's capture, calls iqfoc_encoder_index. */
static const iqfoc_encoder_config_t config = {
    .counts_per_turn = 4096, .pole_pairs = 3, .slip_max = 4, .index_known = true, .index_theta = IQ24(0.137)};
static const iqfoc_tracker_config_t tracking = IQFOC_TRACKER_GAINS(400.0, 2e-4, IQ24(0.1), 50);
static iqfoc_encoder_t encoder;
static iqfoc_tracker_t tracker;

void around_encoder_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal, uint32_t count, iq24_t at)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    if (tracker.config == NULL) {
        (void)iqfoc_encoder_init(&encoder, &config);
        (void)iqfoc_tracker_init(&tracker, &tracking);
    }
    iqfoc_tracker_step(&tracker, iqfoc_encoder_theta(&encoder, count), at, true);
    sample.theta = iqfoc_tracker_theta(&tracker, sample.instant);
    sample.speed = iqfoc_tracker_speed(&tracker);
    /* No torque before the index was seen, none without the sensor. */
    cycle->enabled = cycle->enabled && encoder.referenced && !tracker.lost;
    iqfoc_cycle_valley(cycle, &sample, now);
}
