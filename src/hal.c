/*
 * The two interrupt handlers' bodies: read, compute, write (include/iqfoc/hal.h).
 */
#include "iqfoc/hal.h"

/* From the valley to the middle of the cycle in which the peak's command acts. */
#define OUTPUT_MID IQ24(1.5)

void iqfoc_isr_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    iqfoc_cycle_valley(cycle, &sample, now);
}

void iqfoc_isr_peak(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_peak(hal, &sample);
    iqfoc_command_t command = iqfoc_cycle_peak(cycle, &sample, OUTPUT_MID, now);
    if (!iqfoc_cycle_in_time(cycle, &sample, iqfoc_hal_now(hal)) && cycle->tripped) {
        command = iqfoc_cycle_safe(cycle->config);
    }
    iqfoc_hal_write(hal, &command);
}
