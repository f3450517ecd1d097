/* An angle that turns by itself: the rotor is aligned, then drawn along, up to 2 % of a turn a cycle; and from there on. */
#include "around.h"

#include "iqfoc/start.h"

#include <stddef.h>

static const iqfoc_start_config_t config = {.i_align = IQ24(0.4),
                                            .ramp_cycles = 2000,
                                            .hold_cycles = 4000,
                                            .speed_end = IQ24(0.02),
                                            .run_up_cycles = 20000};
static iqfoc_start_t start;

void around_start_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    if (start.config == NULL && iqfoc_start_init(&start, &config) != IQFOC_OK) {
        cycle->enabled = false;
        return;
    }
    iqfoc_start_step(&start, 0);
    cycle->i_ref = start.i_ref;
    sample.theta = iqfoc_start_theta(&start, sample.instant);
    sample.speed = start.speed;
    iqfoc_cycle_valley(cycle, &sample, now);
}

void around_start_peak(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_peak(hal, &sample);
    sample.theta = iqfoc_start_theta(&start, sample.instant);
    sample.speed = start.speed;
    const iqfoc_command_t command = iqfoc_cycle_peak(cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
    iqfoc_hal_write(hal, &command);
}

void around_start_hand_over(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    iqfoc_start_step(&start, sample.theta);
    iqfoc_cycle_hand_over(cycle, start.theta, &sample);
    iqfoc_cycle_valley(cycle, &sample, now);
}
