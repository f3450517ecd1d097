/*
 * The smallest drive on an STM32G474.
 */
#include "chip.h"
#include "example_board.h"
#include "first_drive.h"
#include "hal_stm32g4_inline.h"

STM32G4_CCM_CONST static const stm32g4_chip_t chip = STM32G4_CHIP;
STM32G4_CCM_CONST static const hal_stm32g4_board_t board =
    STM32G4_EXAMPLE_BOARD(STM32G4_HALF_TICKS(FIRST_DRIVE_PWM_HZ));
static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;

void adc1_2_handler(void);

/* Both converters have sampled. */
STM32G4_CCM void adc1_2_handler(void)
{
    hal_stm32g4_interrupt(first_drive_methods, &cycle, &hal);
}

int main(void)
{
    if (!stm32g4_example_start(&chip, &board) || !first_drive_start(&cycle, STM32G4_CLOCK_HZ, IQ24(0.1))) {
        return 1;
    }
    stm32g4_example_run(&hal, &chip, &board);
}
