/* Interrupt handlers: the bodies of hal.h, with a port that gives any sample. */
#include "any_drive.h"

#include "iqfoc/hal.h"

#include "first_drive.h"

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    (void)hal;
    *sample = any_sample();
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    (void)hal;
    *sample = any_sample();
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    (void)hal;
    (void)command;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    (void)hal;
    return any_count(0, UINT32_MAX);
}

/* The interrupts' bodies of hal.h, ready made and for named methods: any set that is not refused, any sample whatever. */
void prove_interrupts(void)
{
    const iqfoc_cycle_config_t set = any_set();
    iqfoc_cycle_t cycle;
    iqfoc_hal_t *hal = 0;
    if (iqfoc_cycle_init(&cycle, &set) == IQFOC_OK) {
        while (any_bool()) {
            cycle.enabled = any_bool();
            cycle.i_ref = any_dq(IQ24(32.0));
            if (any_bool()) {
                iqfoc_isr_valley(&cycle, hal);
                iqfoc_isr_peak(&cycle, hal);
            } else {
                iqfoc_isr_valley_by(first_drive_methods, &cycle, hal);
                iqfoc_isr_peak_by(first_drive_methods, &cycle, hal);
            }
        }
    }
}
