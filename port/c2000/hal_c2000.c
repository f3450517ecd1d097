/*
 * HAL of the F28004x and F2837xD (hal_c2000.h): the four functions as hal.h declares them.
 */
#include "hal_c2000_inline.h"

void hal_c2000_start(iqfoc_hal_t *hal, const c2000_chip_t *chip, const hal_c2000_board_t *board)
{
    const iqfoc_hal_t fresh = {
        .chip = chip,
        .board = board,
        .turns_per_count = ((uint64_t)board->pole_pairs << 40) / board->counts_per_turn,
        .cycles_per_tick = IQ24_ONE / (iq24_t)(2 * board->half_ticks),
        .theta_offset = board->theta_offset,
    };
    *hal = fresh;
}

void hal_c2000_set_offset(iqfoc_hal_t *hal, iqfoc_abc_t offset)
{
    hal->i_zero = offset;
}

void hal_c2000_align(iqfoc_hal_t *hal, iq24_t theta)
{
    const uint32_t count = hal->counts[(hal->next + HAL_SPEED_SPAN - 1) % HAL_SPEED_SPAN];
    hal->theta_offset = iq24_sub_wrap(theta, hal_c2000_speed_of(hal, (int32_t)count));
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    return hal_c2000_now(hal);
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    hal_c2000_read_valley(hal, sample);
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    hal_c2000_read_peak(hal, sample);
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    hal_c2000_write(hal, command);
}

bool hal_c2000_encoder_faulty(const iqfoc_hal_t *hal)
{
    return (c2000_read(hal->chip->eqep + EQEP_QFLG) & QFLG_PHASE) != 0;
}

bool hal_c2000_broken(const iqfoc_hal_t *hal)
{
    return hal->broken || hal_c2000_tripped_by_itself(hal);
}

/* The flags of the sources; the trip itself stays until a command with gates clears it. */
void hal_c2000_clear_break(iqfoc_hal_t *hal)
{
    c2000_unprotect();
    for (uint32_t leg = 0; leg < 3; leg++) {
        (void)c2000_trip(hal->chip->epwm[leg]);
        c2000_write(hal->chip->epwm[leg] + EPWM_TZOSTCLR, TZOST_SOURCES);
    }
    c2000_protect();
    hal->released = false;
    hal->broken = false;
}
