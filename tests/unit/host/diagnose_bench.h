/*
 * A bench for the diagnosis' tests: a machine integrated by Runge-Kutta in many steps a cycle, in stationary
 * phase quantities, which shares no line with the averaged model. Averaged voltages, no switching: what
 * switching does is the blind tests' business.
 */
#ifndef TESTS_UNIT_DIAGNOSE_BENCH_H
#define TESTS_UNIT_DIAGNOSE_BENCH_H

#include "data/motor.h"
#include "data/recording.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct bench {
    motor m; /* what the machine is; extensions are its effects: resistance, flux, sensors, angle, voltage */
    double noise_A;              /* rms of each current sensor */
    double unlogged_ripple;      /* share of the voltage at 300 Hz that no column knows */
    double R_iron_ohm;           /* eddy currents in parallel with the winding's flux; 0: none */
    double tau_iron_s;           /* by which they come late */
    double missed_share;         /* of the cycles: the last command acts on */
    double swing, swing_Hz;      /* share by which each run's speed swings, and how fast */
    double speed_filter_s;       /* time constant of a filter ahead of the speed column; 0: none */
    double fault_share, fault_A; /* of the rows: the sensor of fault_phase (0 is a) shows so much more */
    int fault_phase;
    double filter_s; /* time constant of a filter ahead of the current sensors; 0: none */
    double bend_d, bend_q,
        bend_cross;         /* iron that saturates (current_of), at the rated current: parts of it */
    double mean_C, swing_K; /* temperature: recorded where it swings */
    double cogging_V;       /* along q, at the ninth order of the angle: no cause of the list does that */
    double product_V_A2;    /* along d, in proportion to i_d i_q: neither does this */
    bool two_sensors;
    unsigned long seed;
} bench;

/* The next number, near enough to normal, of variance 1. */
double bench_normal(uint64_t *state);

/* The motor of these tests: salient, 4 kHz. */
motor bench_motor(void);

enum { BENCH_RUNS = 6, BENCH_ROWS = 1500 };

/* Records BENCH_RUNS operating points, both directions, with small steps in the voltage. Free with
 * recording_free. */
recording bench_record(const bench *b);

#endif
