/*
 * The smallest drive on an STM32G474: set up, run, and nothing left to do outside the interrupt.
 */
#include "board.h"
#include "chip.h"
#include "example_board.h"
#include "first_drive.h"
#include "hal_stm32g4_inline.h"

#define HALF_TICKS (STM32G4_CLOCK_HZ / FIRST_DRIVE_PWM_HZ / 2)

static const stm32g4_chip_t chip = STM32G4_CHIP;

static const hal_stm32g4_board_t board = STM32G4_EXAMPLE_BOARD(HALF_TICKS);

static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;

void adc1_2_handler(void);

/* Both converters have sampled. */
void adc1_2_handler(void)
{
    hal_stm32g4_interrupt(first_drive_methods, &cycle, &hal);
}

int main(void)
{
    if (stm32g4_clock_start(&chip) != STM32G4_OK ||
        stm32g4_carrier_start(&chip, HALF_TICKS, 1000) != STM32G4_OK ||
        stm32g4_encoder_start(&chip, board.counts_per_turn) != STM32G4_OK ||
        stm32g4_converters_start(&chip) != STM32G4_OK ||
        !first_drive_start(&cycle, STM32G4_CLOCK_HZ, IQ24(0.1))) {
        return 1;
    }
    hal_stm32g4_start(&hal, &chip, &board);
    stm32g4_pins_start(&chip); /* last: no pin drives a gate before the timer holds it low */
    stm32g4_run(&chip);
    for (;;) {
        __asm volatile("wfi");
    }
}
