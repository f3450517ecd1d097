/*
 * Benchmark code other than single library functions: compositions, and inlined functions in a straight line.
 */
#ifndef BENCH_KERNELS_H
#define BENCH_KERNELS_H

#include "iqfoc/cycle.h"

/*
 * The compiler neither inlines, clones nor merges these functions: the called code is the counted code.
 */
#define BENCH_APART __attribute__((noipa))

/* How many inlined functions the straight lines below hold. */
#define BENCH_LINE 8

/* What moves from cycle to cycle in the compositions. */
typedef struct bench_drive {
    const iqfoc_cycle_config_t *config;
    iqfoc_current_control_t control;
    iqfoc_dq_t i_ref;
    iqfoc_rotor_t rotor; /* of the speed: a slower loop's matter */
    iq24_t u_dc_inverse; /* likewise */
    iqfoc_ab_t u_now;
    iqfoc_ab_t u_next;
    iqfoc_ab_t i_next;
} bench_drive_t;

/*
 * Clarke, sine and cosine, Park, two PI with decoupling and anti-windup, inverse Park. As in the peers'
 * composition one angle serves both Park transforms. scale: what the modulator made of the last voltage.
 */
void bench_current_control(bench_drive_t *drive, iq24_t i_a, iq24_t i_b, iq24_t theta, iq24_t scale);

/*
 * The whole cycle: Clarke, sine and cosine of the angle at mid-cycle, quasi-discrete prediction and mean,
 * correction of the mean (which brings it into the rotor frame: it holds the Park transform), two PI with
 * decoupling, inverse Park, modulation with limiting, anti-windup.
 */
void bench_cycle(bench_drive_t *drive, iq24_t i_a, iq24_t i_b, iq24_t theta_mid, iqfoc_duties_t *duties);

/* BENCH_LINE Park transforms inlined one after the other; operands and results in memory. */
void bench_park_line(const volatile iq24_t *from, volatile iq24_t *to);
void bench_park_inverse_line(const volatile iq24_t *from, volatile iq24_t *to);
void bench_clarke_line(const volatile iq24_t *from, volatile iq24_t *to);

/* The same reads and writes without the transform: subtract its count. */
void bench_four_to_two_line(const volatile iq24_t *from, volatile iq24_t *to);
void bench_two_to_two_line(const volatile iq24_t *from, volatile iq24_t *to);

/* One instruction: the return. */
void bench_nothing(void);

#endif
