/*
 * Setting up the STM32G474: clock, pins, carrier, converters, encoder, in this order.
 *
 * Pins: PA8, PA9, PA10 high sides; PB13, PB14, PB15 low sides; PB12 break, active low; PC0, PC1 currents of
 * phases A and B; PC2 DC link; PB6, PB7 encoder.
 *
 * This has not run on silicon. tests/target/test_stm32g4.c checks the sequence and every bit named here
 * against the reference manual's wording.
 */
#ifndef PORT_STM32G4_BOARD_H
#define PORT_STM32G4_BOARD_H

#include "stm32g474.h"

/* Negative: what did not answer or does not fit. */
typedef enum stm32g4_error {
    STM32G4_OK = 0,
    STM32G4_ERROR_CLOCK = -1,     /* oscillator, PLL or switch not ready in time */
    STM32G4_ERROR_DEAD_TIME = -2, /* not between 0 and 1008 steps of 5.88 ns: 5.93 us */
    STM32G4_ERROR_CARRIER = -3,   /* half period not within 100 ... 65534 ticks */
    STM32G4_ERROR_CONVERTER = -4, /* calibration or start of a converter did not end */
    STM32G4_ERROR_EDGES = -6,     /* spans of a cycle not even, 8 ... 32, or not 340 ... 65535 ticks long */
    STM32G4_ERROR_ENCODER = -5    /* counts per revolution not within 4 ... 65536 */
} stm32g4_error_t;

/*
 * A function that link.ld puts into CCM SRAM, and a constant: the interrupt's, which then runs without the flash's wait states. The
 * start-up copies both there.
 */
#define STM32G4_CCM       __attribute__((section(".ccm.text")))
#define STM32G4_CCM_CONST __attribute__((section(".ccm.rodata")))

/* 170 MHz from the internal oscillator: 16 MHz / 4 * 85 / 2. */
stm32g4_error_t stm32g4_clock_start(const stm32g4_chip_t *chip);

void stm32g4_pins_start(const stm32g4_chip_t *chip);

/*
 * DTG code of the shortest dead time that is not shorter than asked for. ns: 0 ... 5929. Negative if it does
 * not fit. 29.6.20; t_DTS is one clock, 5.88 ns.
 */
int32_t stm32g4_dead_time_code(uint32_t ns);

/*
 * TIM1, stopped: centre-aligned, legs high around the peak, shadow registers that act at the valley only,
 * triggers for the converters one tick before valley and peak, outputs off, dead time locked. half_ticks:
 * clocks from valley to peak.
 */
stm32g4_error_t stm32g4_carrier_start(const stm32g4_chip_t *chip, uint32_t half_ticks, uint32_t dead_time_ns);

/* ADC1 and ADC2, calibrated and waiting for the carrier; ADC1 interrupts after both have sampled. */
stm32g4_error_t stm32g4_converters_start(const stm32g4_chip_t *chip);

/*
 * TIM4 counts all four edges of the encoder, modulo counts_per_turn of the shaft; TIM2 is
 * the free-running clock.
 */
stm32g4_error_t stm32g4_encoder_start(const stm32g4_chip_t *chip, uint32_t counts_per_turn);

/* Lets the carrier run. Outputs stay off until the HAL gets a command with gates. */
void stm32g4_run(const stm32g4_chip_t *chip);

#endif
