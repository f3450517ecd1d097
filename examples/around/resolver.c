/* A resolver of one pole pair on a motor of three, sampled with the currents. */
#include "around.h"

#include "iqfoc/resolver.h"
#include "iqfoc/tracker.h"

#include <stddef.h>

static const iqfoc_resolver_t resolver = {.gain_sin = IQ24(1.0 / 0.8),
                                          .gain_cos = IQ24(1.0 / 0.8),
                                          .amplitude_min = IQ24(0.8),
                                          .amplitude_max = IQ24(1.2),
                                          .ratio = 3,
                                          .theta_0 = IQ24(0.21)};
static const iqfoc_tracker_config_t tracking = IQFOC_TRACKER_GAINS(250.0, 2e-4, IQ24(0.1), 25);
static iqfoc_tracker_t tracker;

void around_resolver_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal, iq24_t sine, iq24_t cosine)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    if (tracker.config == NULL && (iqfoc_resolver_check(&resolver) != IQFOC_OK ||
                                   iqfoc_tracker_init(&tracker, &tracking) != IQFOC_OK)) {
        cycle->enabled = false;
        return;
    }
    const iqfoc_resolver_angle_t angle = iqfoc_resolver_read(&resolver, sine, cosine);
    iqfoc_tracker_step(&tracker, angle.theta, sample.instant, angle.valid);
    sample.theta = iqfoc_tracker_theta(&tracker, sample.instant);
    sample.speed = iqfoc_tracker_speed(&tracker);
    cycle->enabled = cycle->enabled && !tracker.lost;
    iqfoc_cycle_valley(cycle, &sample, now);
}
