/*
 * HAL of the emulated boards (port/emulated/hal_emulated.h).
 */
#include "hal_emulated.h"

#include "board.h"

static const iqfoc_command_t gates_off = {{{0, 0, 0}, IQ24_ONE}, false};

void hal_emulated_start(iqfoc_hal_t *hal, uint32_t half_ticks, uint32_t first_valley)
{
    small_drive_start(&hal->drive);
    hal->half_ticks = half_ticks;
    hal->next_time = first_valley;
    hal->next_is_valley = true;
    hal->shadow = gates_off;
    hal->active = gates_off;
    hal->valley = small_drive_sample(&hal->drive);
    hal->valley.time = first_valley - 2 * half_ticks;
    hal->peak = hal->valley;
    hal->peak.time = first_valley - half_ticks;
}

/* Valley or peak: the drive has come to here, the converters sample, at a valley the shadow registers act. */
static void instant(iqfoc_hal_t *hal)
{
    small_drive_advance_half(&hal->drive, &hal->active);
    if (hal->next_is_valley) {
        small_drive_begin_cycle(&hal->drive);
        hal->active = hal->shadow;
        hal->valley = small_drive_sample(&hal->drive);
        hal->valley.at = 0;
        hal->valley.time = hal->next_time;
    } else {
        hal->peak = small_drive_sample(&hal->drive);
        hal->peak.at = IQ24_ONE / 2;
        hal->peak.time = hal->next_time;
    }
    hal->next_is_valley = !hal->next_is_valley;
    hal->next_time += hal->half_ticks;
}

/*
 * The peak's handler may interrupt the valley's anywhere; registers of a chip would not mind,
 * this drive would.
 */
static void catch_up(iqfoc_hal_t *hal)
{
    const uint32_t before = board_interrupts_off();
    while ((int32_t)(board_ticks() - hal->next_time) >= 0) {
        instant(hal);
    }
    board_interrupts_restore(before);
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    catch_up(hal);
    *sample = hal->valley;
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    catch_up(hal);
    *sample = hal->peak;
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    catch_up(hal);
    hal->shadow = *command;
    if (!command->gates) {
        hal->active = *command;
    }
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    (void)hal;
    return board_ticks();
}
