/*
 * The drive without an angle sensor on an STM32G474: from standstill to 3000 rpm.
 */
#include "board.h"
#include "chip.h"
#include "example_board.h"
#include "hal_stm32g4_inline.h"
#include "sensorless_drive.h"

#define HALF_TICKS (STM32G4_CLOCK_HZ / SENSORLESS_DRIVE_PWM_HZ / 2)

static const stm32g4_chip_t chip = STM32G4_CHIP;

static const hal_stm32g4_board_t board = STM32G4_EXAMPLE_BOARD(HALF_TICKS);

static sensorless_drive_t drive;
static iqfoc_hal_t hal;

void adc1_2_handler(void);

/* Both converters have sampled. */
void adc1_2_handler(void)
{
    stm32g4_write(&chip.adc1->ISR, ADC_ISR_JEOS);
    if (hal_stm32g4_at_valley(&hal)) {
        sensorless_drive_valley(&drive, &hal);
    } else {
        sensorless_drive_peak(&drive, &hal);
    }
}

int main(void)
{
    if (stm32g4_clock_start(&chip) != STM32G4_OK ||
        stm32g4_carrier_start(&chip, HALF_TICKS, 1000) != STM32G4_OK ||
        stm32g4_converters_start(&chip) != STM32G4_OK || !sensorless_drive_begin(&drive, STM32G4_CLOCK_HZ)) {
        return 1;
    }
    drive.target = SENSORLESS_DRIVE_TURNS(3000.0);
    hal_stm32g4_start(&hal, &chip, &board);
    stm32g4_pins_start(&chip); /* last: no pin drives a gate before the timer holds it low */
    stm32g4_run(&chip);
    for (;;) {
        __asm volatile("wfi");
    }
}
