/*
 * The library's HAL on an emulated board: the small drive behind converters and shadow registers.
 *
 * As on a chip, what is sampled at valley and peak does not wait for the interrupt: the drive's state is
 * brought up to the board's clock whenever the HAL is called, half a period at a time, and each instant's
 * sample replaces the one before it. A command stays in the shadow registers until the next valley.
 *
 * iqfoc_hal_write_edges: the drive gets, for each half period, the share of the ticks that a leg is high, exactly. The boards' carrier has
 * one length: edges for a cycle of another one turn the gates off.
 */
#ifndef PORT_EMULATED_HAL_EMULATED_H
#define PORT_EMULATED_HAL_EMULATED_H

#include "iqfoc/hal.h"

#include "small_drive.h"

struct iqfoc_hal {
    small_drive_t drive;
    uint32_t half_ticks;
    uint32_t next_time; /* ticks of the next valley or peak */
    bool next_is_valley;
    iqfoc_sample_t valley; /* what the converters hold */
    iqfoc_sample_t peak;
    iqfoc_command_t shadow; /* written by the firmware */
    iqfoc_command_t active; /* what the inverter does */
    bool by_edges;          /* the last write was one of edges */
    bool edges_wait;        /* for the next valley */
    bool edges_act;
    iqfoc_edges_t edges_shadow;
    iqfoc_edges_t edges; /* of this cycle */
};

/* first_valley: as board_carrier_start gives it. */
void hal_emulated_start(iqfoc_hal_t *hal, uint32_t half_ticks, uint32_t first_valley);

#endif
