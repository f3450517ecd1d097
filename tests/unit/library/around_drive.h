/*
 * A switching-level drive with an unloaded shaft, behind the host's HAL, for tests of the drive services. The test
 * puts its own sensors between the samples and the handlers.
 *
 *     iqfoc_sample_t s = around_valley(d);   change s.i, s.theta, s.speed
 *     around_valley_handler(d, &s);
 *     s = around_peak(d);                    likewise
 *     around_peak_handler(d, &s);
 */
#ifndef TESTS_UNIT_AROUND_DRIVE_H
#define TESTS_UNIT_AROUND_DRIVE_H

#include "hal_host.h"

#include "iqfoc/hal.h"

typedef struct around_drive {
    motor motor;
    per_unit base;
    plant plant;
    iqfoc_hal_t hal;
    iqfoc_cycle_config_t config;
    iqfoc_cycle_t cycle;
    double duty[3];      /* in force in this cycle */
    plant_point truth;   /* at the last valley or peak */
    plant_point valley;  /* at the last valley */
    double mean_dq_A[2]; /* true mean current of the last whole cycle, seen from the rotor */
} around_drive;

/* The 2019 paper's drive at 5 kHz on this DC link; inertia and friction of a shaft that settles in 0.3 s. */
plant_config around_plant(double u_dc_V);

/* Motor, plant and cycle made ready; the cycle is not enabled. */
void around_begin(around_drive *d, const plant_config *truth);
/* The same for another motor, without a cycle. */
void around_begin_motor(around_drive *d, const motor *m, const plant_config *truth);

iqfoc_sample_t around_valley(around_drive *d);
void around_valley_handler(around_drive *d, const iqfoc_sample_t *sample);
iqfoc_sample_t around_peak(around_drive *d);
void around_peak_handler(around_drive *d, const iqfoc_sample_t *sample);
/* The command that was handed to the HAL acts from the next valley on; around_peak_handler does this too. */
void around_take_command(around_drive *d);

/* True electrical angle in turns, any number; true speed in turns per cycle. */
double around_turns(const around_drive *d);
double around_speed(const around_drive *d);

/* Difference of two angles in turns: -0.5 ... 0.5. */
double around_off(iq24_t theta, double turns);

/* What an encoder's counter shows now: modulo counts, 0 at zero_turns of the shaft's turn. */
uint32_t around_encoder(const around_drive *d, uint32_t counts, double zero_turns);

#endif
