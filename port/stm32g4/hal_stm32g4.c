/*
 * HAL of the STM32G474 (hal_stm32g4.h): the four functions as hal.h declares them.
 */
#include "hal_stm32g4_inline.h"

void hal_stm32g4_start(iqfoc_hal_t *hal, const stm32g4_chip_t *chip, const hal_stm32g4_board_t *board)
{
    hal_stm32g4_fresh(hal, chip, board);
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *hal)
{
    return hal_stm32g4_now(hal);
}

void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    hal_stm32g4_read_valley(hal, sample);
}

void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample)
{
    hal_stm32g4_read_peak(hal, sample);
}

void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command)
{
    hal_stm32g4_write(hal, command);
}

bool hal_stm32g4_broken(const iqfoc_hal_t *hal)
{
    return (stm32g4_read(&hal->chip->tim1->SR) & TIM_SR_BIF) != 0;
}

/* Flags of SR are cleared by writing 0 and left alone by writing 1 (29.6.5). */
void hal_stm32g4_clear_break(iqfoc_hal_t *hal)
{
    stm32g4_write(&hal->chip->tim1->SR, ~TIM_SR_BIF);
}
