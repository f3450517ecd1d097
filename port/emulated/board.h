/*
 * The services of both emulated boards for the drive: a free-running clock, and the carrier's two interrupts.
 */
#ifndef PORT_EMULATED_BOARD_H
#define PORT_EMULATED_BOARD_H

#include <stdint.h>

/* A free-running clock, wraps at 2^32. BOARD_HZ ticks a second (port/<target>/board_clock.h). */
uint32_t board_ticks(void);

/*
 * Starts the carrier: a valley now and every two half periods, a peak in between. Interrupts are on from
 * here. Returns the ticks of the first valley. half_ticks: at least some ten microseconds.
 */
uint32_t board_carrier_start(uint32_t half_ticks);
void board_carrier_stop(void);

/* Holds all interrupts back; what arrives meanwhile is taken once afterwards. Returns what restore needs. */
uint32_t board_interrupts_off(void);
void board_interrupts_restore(uint32_t before);

/* The program's handlers. The peak's has the higher priority: it interrupts the valley's. */
void board_valley_interrupt(void);
void board_peak_interrupt(void);

#endif
