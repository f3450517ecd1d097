/*
 * The board of the STM32G474 examples, which the benchmark's handler has too: what the sensors' counts are worth.
 */
#ifndef PORT_STM32G4_EXAMPLE_BOARD_H
#define PORT_STM32G4_EXAMPLE_BOARD_H

#include "hal_stm32g4.h"

/* 2048 counts are 2.5 times the rated peak current, 4096 counts 1.6 times the nominal DC link; a 1024-line encoder. */
#define STM32G4_EXAMPLE_BOARD(half)                                                                          \
    {                                                                                                        \
        .half_ticks = (half), .i_offset_a = 2048, .i_offset_b = 2048, .i_per_count = IQ24(2.5 / 2048),       \
        .u_dc_per_count = IQ24(1.6 / 4096), .counts_per_turn = 4096, .pole_pairs = 3, .theta_offset = 0      \
    }

#endif
