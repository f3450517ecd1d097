/*
 * The board of the STM32G474 examples, which the benchmark's handler has too: what a count of each sensor means, and the way from
 * reset to the first interrupt.
 */
#ifndef PORT_STM32G4_EXAMPLE_BOARD_H
#define PORT_STM32G4_EXAMPLE_BOARD_H

#include "board.h"
#include "hal_stm32g4.h"

/* 2048 counts are 2.5 times the rated peak current, 4096 counts 1.6 times the nominal DC link; a 1024-line encoder. */
#define STM32G4_EXAMPLE_BOARD(half)                                                                          \
    {                                                                                                        \
        .half_ticks = (half), .i_offset_a = 2048, .i_offset_b = 2048, .i_per_count = IQ24(2.5 / 2048),       \
        .u_dc_per_count = IQ24(1.6 / 4096), .counts_per_turn = 4096, .pole_pairs = 3, .theta_offset = 0      \
    }

/* Half a carrier period at this frequency, in ticks of the clock. */
#define STM32G4_HALF_TICKS(pwm_hz) (STM32G4_CLOCK_HZ / (pwm_hz) / 2)

/* Clock, carrier with 1 us of dead time, encoder, converters. Nothing runs yet. */
static inline bool stm32g4_example_start(const stm32g4_chip_t *chip, const hal_stm32g4_board_t *board)
{
    return stm32g4_clock_start(chip) == STM32G4_OK &&
           stm32g4_carrier_start(chip, board->half_ticks, 1000) == STM32G4_OK &&
           stm32g4_encoder_start(chip, board->counts_per_turn) == STM32G4_OK &&
           stm32g4_converters_start(chip) == STM32G4_OK;
}

/* From here on everything happens in the interrupt. */
static inline void stm32g4_example_run(iqfoc_hal_t *hal, const stm32g4_chip_t *chip,
                                       const hal_stm32g4_board_t *board)
{
    hal_stm32g4_start(hal, chip, board);
    stm32g4_pins_start(chip); /* last: no pin drives a gate before the timer holds it low */
    stm32g4_run(chip);
    for (;;) {
        __asm volatile("wfi");
    }
}

#endif
