/*
 * A stand-in for motor and inverter on an emulated board: integers only, the same bits on every machine.
 *
 * It is no model to learn from (the simulator's is): voltage averaged over half a carrier period, one Euler
 * step each, 12-bit converters, speed and references after a fixed plan. What it must do is give the firmware
 * something to control that reacts to every bit of its commands.
 */
#ifndef PORT_EMULATED_SMALL_DRIVE_H
#define PORT_EMULATED_SMALL_DRIVE_H

#include "iqfoc/cycle.h"

#include <stdbool.h>
#include <stdint.h>

/* The firmware's configuration for it: the drive of 2019 at 5 kHz, corrected quasi-discrete mean. */
extern const iqfoc_cycle_config_t small_drive_config;

typedef struct small_drive {
    iqfoc_ab_t i;   /* per unit */
    iq24_t theta;   /* turns */
    iq24_t speed;   /* electrical speed, turns per control cycle */
    uint32_t cycle; /* number of the control cycle */
} small_drive_t;

/* At standstill, without current. */
void small_drive_start(small_drive_t *drive);

/* Lets half a carrier period pass under the command that the inverter holds. */
void small_drive_advance_half(small_drive_t *drive, const iqfoc_command_t *command);

/* What the converters give at this instant. `instant` and `time` are the caller's to fill in. */
iqfoc_sample_t small_drive_sample(const small_drive_t *drive);

/*
 * The plan: speed up to 0.12 turns a cycle to both sides, through standstill, and steps of the reference.
 * To be called at each valley, which begins a new cycle.
 */
void small_drive_begin_cycle(small_drive_t *drive);
iqfoc_dq_t small_drive_reference(uint32_t cycle);

#endif
