/*
 * The drive without an angle sensor on an STM32G474: from standstill to 3000 rpm.
 */
#include "chip.h"
#include "example_board.h"
#include "hal_stm32g4_inline.h"
#include "sensorless_drive.h"

STM32G4_CCM_CONST static const stm32g4_chip_t chip = STM32G4_CHIP;
STM32G4_CCM_CONST static const hal_stm32g4_board_t board =
    STM32G4_EXAMPLE_BOARD(STM32G4_HALF_TICKS(SENSORLESS_DRIVE_PWM_HZ));
static sensorless_drive_t drive;
static iqfoc_hal_t hal;

void adc1_2_handler(void);

/* Both converters have sampled. */
STM32G4_CCM void adc1_2_handler(void)
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
    if (!stm32g4_example_start(&chip, &board) || !sensorless_drive_begin(&drive, STM32G4_CLOCK_HZ)) {
        return 1;
    }
    drive.target = SENSORLESS_DRIVE_TURNS(3000.0);
    stm32g4_example_run(&hal, &chip, &board);
}
