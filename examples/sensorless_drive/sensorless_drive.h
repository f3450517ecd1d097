/*
 * A speed-controlled drive without an angle sensor: align, turn open loop, then run on the observed angle. The same on every
 * target. Its numbers are those of the 2019 paper's motor: replace them in sensorless_drive.c by your motor's.
 */
#ifndef EXAMPLES_SENSORLESS_DRIVE_H
#define EXAMPLES_SENSORLESS_DRIVE_H

#include "iqfoc/hal.h"
#include "iqfoc/sensorless.h"
#include "iqfoc/speed_control.h"

#define SENSORLESS_DRIVE_PWM_HZ 5000
#define SENSORLESS_DRIVE_PAIRS  3

/* Electrical turns per cycle of a speed in rpm, a constant. */
#define SENSORLESS_DRIVE_TURNS(rpm) IQ24((rpm) / 60.0 * SENSORLESS_DRIVE_PAIRS / SENSORLESS_DRIVE_PWM_HZ)

typedef struct sensorless_drive {
    iqfoc_cycle_t cycle;
    iqfoc_sensorless_t angle;
    iq24_t
        target; /* speed once the angle is observed, turns per cycle; beyond +-SENSORLESS_DRIVE_TURNS(400) */
    iqfoc_speed_control_t speed;
} sensorless_drive_t;

/* Ready to start from standstill, enabled. ticks_per_second: of the port's clock. False if a configuration was refused. */
bool sensorless_drive_begin(sensorless_drive_t *drive, uint32_t ticks_per_second);

/* The interrupts' handlers. A build may give them a section, for faster memory. */
#ifndef SENSORLESS_DRIVE_FAST
#define SENSORLESS_DRIVE_FAST
#endif
void sensorless_drive_valley(sensorless_drive_t *drive, iqfoc_hal_t *hal);
void sensorless_drive_peak(sensorless_drive_t *drive, iqfoc_hal_t *hal);

#endif
