/*
 * Setting up the STM32F405, in this order: clock, carrier, encoder, converters, pins, run.
 *
 * Pins: PA8, PA9, PA10 high sides; PB13, PB14, PB15 low sides; PB12 break, active low; PC0, PC1, PC2 the low-side
 * shunts of A, B, C; PC3 DC link; PB6, PB7 encoder, PB8 its index.
 *
 * This has not run on silicon. The checks in check/ hold it to what the reference manual says.
 */
#ifndef BOARD_H
#define BOARD_H

#include "stm32f405.h"

#include <stdbool.h>

#define BOARD_CLOCK_HZ UINT32_C(168000000) /* of TIM1 */
#define BOARD_TICK_HZ  UINT32_C(84000000)  /* of TIM2, iqfoc_hal_now */

/* 168 MHz from the internal oscillator. False if it does not answer. */
bool board_clock_start(const stm32f405_chip_t *chip);

/*
 * TIM1, stopped: the legs are high around the counter's zero, which is the carrier's peak; its top is the valley,
 * where compare values act and the converters are triggered. Outputs off. dead_ticks: 0 ... 127 of 6 ns.
 */
void board_carrier_start(const stm32f405_chip_t *chip, uint32_t half_ticks, uint32_t dead_ticks);

/* TIM4 counts the encoder's edges modulo counts_per_turn and captures at the index; TIM2 is the clock. */
void board_encoder_start(const stm32f405_chip_t *chip, uint32_t counts_per_turn);

/* Three converters, a shunt each, triggered together; ADC1 also takes the DC link, then interrupts. */
void board_converters_start(const stm32f405_chip_t *chip);

void board_pins_start(const stm32f405_chip_t *chip);

/*
 * Lets the carrier run, outputs off. False if the update event is not at the counter's top, or none comes: the
 * manual ties that to the order of writes (17.3.3), so it is looked at rather than believed.
 */
bool board_run(const stm32f405_chip_t *chip);

#endif
