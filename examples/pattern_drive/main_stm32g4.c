/*
 * The drive with five pulses on an STM32G474, whose timer plays the edges (hal_stm32g4_edges.h). For a machine that turns already, at 39 to 625
 * Hz: a first drive needs the carrier below that (iqfoc/pulse_mode.h).
 */
#include "chip.h"
#include "example_board.h"
#include "hal_stm32g4_edges.h"
#include "pattern_drive.h"

#define HALF  STM32G4_HALF_TICKS(PATTERN_DRIVE_HZ)
#define SPANS 32
#define SPAN  ((2 * HALF + SPANS - 1) / SPANS) /* 6.3 us, longer than dead time and least on-time */

STM32G4_CCM_CONST static const stm32g4_chip_t chip = STM32G4_CHIP;
STM32G4_CCM_CONST static const hal_stm32g4_board_t board = STM32G4_EXAMPLE_BOARD(HALF);
static hal_stm32g4_edges_t edges;
static pattern_drive_t drive;
static iqfoc_hal_t hal;

void adc1_2_handler(void);

/* Both converters have sampled. */
STM32G4_CCM void adc1_2_handler(void)
{
    stm32g4_write(&chip.adc1->ISR, ADC_ISR_JEOS);
    if (hal_stm32g4_edges_at_valley(&hal)) {
        pattern_drive_valley(&drive, &hal);
    } else {
        pattern_drive_peak(&drive, &hal);
    }
}

int main(void)
{
    if (stm32g4_clock_start(&chip) != STM32G4_OK ||
        stm32g4_encoder_start(&chip, board.counts_per_turn) != STM32G4_OK ||
        stm32g4_converters_start(&chip) != STM32G4_OK ||
        hal_stm32g4_edges_start(&hal, &chip, &board, &edges, SPANS, 1000) != STM32G4_OK ||
        !pattern_drive_start(&drive, 2 * HALF, SPAN, IQ24(0.1))) {
        return 1;
    }
    stm32g4_pins_start(&chip); /* last: no pin drives a gate before the timer holds it low */
    stm32g4_run(&chip);
    for (;;) {
        __asm volatile("wfi");
    }
}
