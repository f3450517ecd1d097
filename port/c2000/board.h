/*
 * Setting up an F28004x or F2837xD: clock, carrier, encoder, converters, pins, run, in this order.
 *
 * Pins: GPIO0 and GPIO1 the high and the low side of leg A, GPIO2 and GPIO3 of B, GPIO4 and GPIO5 of C;
 * GPIO10 and GPIO11 the encoder; GPIO12 the break line, active low. The analog channels are the board's.
 *
 * This has not run on silicon, nor was it compiled by TI's compiler. tests/target/test_c2000.c checks each
 * bit and the order with a bank of memory.
 */
#ifndef PORT_C2000_BOARD_H
#define PORT_C2000_BOARD_H

#include "c2000.h"

/* Negative: what did not answer or does not fit. */
typedef enum c2000_error {
    C2000_OK = 0,
    C2000_ERROR_CLOCK = -1,     /* the PLL does not lock */
    C2000_ERROR_DEAD_TIME = -2, /* more than 163830 ns */
    C2000_ERROR_CARRIER = -3,   /* half period not within 100 ... 65534 ticks of 10 ns */
    C2000_ERROR_ENCODER = -4,   /* counts per revolution not within 4 ... 65536 */
    C2000_ERROR_CHANNEL = -5    /* an analog channel is not within 0 ... 15 */
} c2000_error_t;

/* Inputs of the converters: A takes phase A's current and the DC link, B takes phase B's current. */
typedef struct c2000_channels {
    uint16_t i_a;  /* ADCINAx */
    uint16_t u_dc; /* ADCINAx */
    uint16_t i_b;  /* ADCINBx */
} c2000_channels_t;

/*
 * The flash's wait states and the family's clock from the internal oscillator, watchdog off. Call it from RAM
 * on the target, as C2000_RAM_FUNCTION places it: it changes how flash is read.
 */
c2000_error_t c2000_clock_start(const c2000_chip_t *chip);

/*
 * ePWM1, 2, 3, stopped at the valley: up-down count, legs high around the period, compare values that act
 * together at zero alone, conversions triggered at zero and at period, dead time, outputs tripped to low.
 */
c2000_error_t c2000_carrier_start(const c2000_chip_t *chip, uint32_t half_ticks, uint32_t dead_time_ns);

/* eQEP1 counts all four edges, modulo counts_per_turn of the shaft; CPU timer 1 is the free-running clock. */
c2000_error_t c2000_encoder_start(const c2000_chip_t *chip, uint32_t counts_per_turn);

/*
 * Converters A and B, powered and waiting for the carrier; both sample the currents at the same instant. The
 * trims are those that the boot ROM loaded. Wait 500 us before the first conversion: c2000_run comes after
 * c2000_pins_start, which waits.
 */
c2000_error_t c2000_converters_start(const c2000_chip_t *chip, const c2000_channels_t *channels);

/* Waits 500 us for the converters. The outputs stay tripped. */
void c2000_pins_start(const c2000_chip_t *chip);

/* Addresses of the two handlers, for ADCA1 and ADCA2. */
void c2000_interrupts_start(const c2000_chip_t *chip, uint32_t valley_handler, uint32_t peak_handler);

/* Lets the carrier run from its valley. Outputs stay off until the HAL gets a command with gates. */
void c2000_run(const c2000_chip_t *chip);

/* A function that the linker command files put into RAM; the start-up copies it there. */
#if defined(__TMS320C28XX__)
#define C2000_RAM_FUNCTION __attribute__((ramfunc))
#else
#define C2000_RAM_FUNCTION
#endif

#endif
