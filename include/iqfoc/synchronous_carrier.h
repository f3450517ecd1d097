/*
 * Synchronous carrier: the length of the next carrier period, so that an electrical turn has a whole number of periods and the valleys
 * are at fixed angles. For drives with fewer than some 20 carrier periods per turn, where a fixed carrier makes subharmonics. If the
 * number is a multiple of three, the phases are alike; if it is odd, there are no even harmonics with a symmetric carrier.
 *
 *     speed = |movement| period_ticks/ticks          the level changes by this alone: up at `on`, down below `off`
 *     e     = N (angle + movement) - phase         at the next valley: carrier periods, -1/2 ... 1/2, in the direction of rotation
 *     next  = ticks (1 - c)/(N |movement|)         c = gain e, held to +-share_max
 *
 * `ticks` is the length of the cycle that begins, and `next` that of the cycle after it. With gain 1 and c within its limit, the valley
 * after the next one is at its angle. An error of the speed or a rounded length is an error e of the next call.
 *
 *     ticks = iqfoc_synchronous_carrier_step(&carrier, angle, sample.speed);     in the valley's interrupt, ahead of the handler
 *     iqfoc_synchronous_carrier_set(&base, ticks, &set[n]);                      n = 0, 1, 2, 0, ...
 *     iqfoc_cycle_offer(&cycle, &set[n]);                                        in force from the next valley on
 *     iqfoc_cycle_valley(&cycle, &sample, now);
 *     iqfoc_synchronous_carrier_keep_flux(&carrier, &cycle);
 *
 * The cycle holds the set of the cycle that ended, that of the one that begins, and the offered one. Three sets in turn are enough.
 *
 * The caller owns the state; one context at a time may call its functions.
 */
#ifndef IQFOC_SYNCHRONOUS_CARRIER_H
#define IQFOC_SYNCHRONOUS_CARRIER_H

#include "cycle.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_SYNCHRONOUS_LEVELS_MAX 8

/* Range of N. With three periods per turn, a period that is corrected would exceed the largest movement in a cycle, 1/3 turn. */
#define IQFOC_SYNCHRONOUS_PERIODS_MIN 9
#define IQFOC_SYNCHRONOUS_PERIODS_MAX 99

/* Longest carrier period, ticks. */
#define IQFOC_SYNCHRONOUS_TICKS_MAX UINT32_C(16777215)

/* A range of speed with one number of periods. Speeds: magnitude, turns per `period_ticks`. */
typedef struct iqfoc_synchronous_level {
    int32_t
        periods; /* N per turn: an odd multiple of three, 9 ... 99; 0: a fixed carrier of `period_ticks` */
    iq24_t on;   /* from the level before, at this speed and above: 0 ... 1; level 0: not used */
    iq24_t off;  /* back to the level before, below this speed: 0 ... on, on excluded; level 0: not used */
} iqfoc_synchronous_level_t;

/* Fixed while it runs. */
typedef struct iqfoc_synchronous_config {
    const iqfoc_synchronous_level_t *level; /* `on` and `off` rise from level to level */
    int32_t levels;                         /* 1 ... IQFOC_SYNCHRONOUS_LEVELS_MAX */
    uint32_t period_ticks;                  /* of the fixed carrier: ticks_min ... ticks_max */
    uint32_t ticks_min; /* shortest period: 1 ... ticks_max; what the interrupts and the inverter allow */
    uint32_t ticks_max; /* longest period: at most IQFOC_SYNCHRONOUS_TICKS_MAX */
    iq24_t gain;        /* share of e that the next period corrects: 0 < gain <= 1 */
    iq24_t share_max;   /* largest correction, share of a period: 0 < share_max <= 1/4 */
    iq24_t phase;       /* N times the angle of a valley: carrier periods, any (the low 24 bits count) */
} iqfoc_synchronous_config_t;

/* The state. All fields may be read. */
typedef struct iqfoc_synchronous_carrier {
    const iqfoc_synchronous_config_t *config;
    int32_t level;  /* 0 ... levels - 1 */
    uint32_t ticks; /* result of the last step: length of the cycle that begins at the next valley */
    iq24_t speed;   /* of the last step: turns per period_ticks, 0 ... 128 */
    iq24_t error;   /* e of the last step: carrier periods, -1/2 ... 1/2; 0 with a fixed carrier */
    iqfoc_dq_t
        mean_off; /* D of the cycle that begins, current: |component| <= 1; 0 unless its length is new */
    iqfoc_dq_t mean_off_next; /* of the next one */
} iqfoc_synchronous_carrier_t;

/*
 * Checks the configuration and starts with level 0 and the fixed carrier's period. config and its levels must outlive the object.
 * IQFOC_ERROR_NULL: a pointer is missing, the one to the levels included; IQFOC_ERROR_CARRIER: a value is out of its range. Call it
 * ahead of the first interrupt.
 */
iqfoc_error_t iqfoc_synchronous_carrier_init(iqfoc_synchronous_carrier_t *carrier,
                                             const iqfoc_synchronous_config_t *config);

/*
 * Once a cycle, in the valley's interrupt. Returns the length of the cycle that begins at the next valley, ticks.
 *
 * angle: at this valley, turns, any (the low 24 bits count): of the rotor, or of the voltage, which then has the same shape in each
 * turn. movement: of that angle in the cycle that begins now, held to +-1/3 (IQFOC_ROTOR_SPEED_MAX). The level moves by one level a call.
 * mean_off becomes mean_off_next.
 *
 * Largest error of 400000 drawn, against the lines above in double: e none; the length 0.5 ticks, and 2^-25 of `ticks`, and 2^-24 of
 * itself.
 *
 * Range: N and the angle are below 99 and 1 turn: 99 2^24 is below 2^31. N |movement| is at most 33. The quotient saturates at 128; with a
 * length below 2^24 ticks the product is below 2^55.
 */
uint32_t iqfoc_synchronous_carrier_step(iqfoc_synchronous_carrier_t *carrier, iq24_t angle, iq24_t movement);

/*
 * The set of parameters for a period of `ticks`, from a set for another period.
 *
 *     k_u, k_r, k_i, anti-windup, tolerance, stale and deadline times r          r = ticks/base->period_ticks
 *     x_d, x_q, emf over r                                                       all held to their ranges (cycle.h)
 *
 * All other fields are copied, so the data of methods beyond the papers' remain those of the old period. base: a set that
 * iqfoc_cycle_init accepts, 1 <= period_ticks <= IQFOC_SYNCHRONOUS_TICKS_MAX. ticks: 1 ... the same limit, else held to it. Any
 * context.
 *
 * Largest error of 400000 drawn, against the formula in double: a parameter 1 LSB, and 0.5 LSB times the parameter; a time 0.5 ticks, and
 * 2^-25 of it.
 */
void iqfoc_synchronous_carrier_set(const iqfoc_cycle_config_t *base, uint32_t ticks,
                                   iqfoc_cycle_config_t *set);

/*
 * Keeps flux and voltage at a change of the period. A voltage that is held over a cycle is shorter as seen from the rotor, and the flux at
 * a valley is longer than its mean (valley_reference.h):
 *
 *     u, as seen by the rotor: s1(phi) u           flux at a valley: psi/s1(phi)^2          phi: angle of a cycle
 *     u_dq += (s1(old)/s1(new) - 1) u_dq           the integrators by the same
 *     u_dq += (1/s1(new)^2 - 1/s1(old)^2) psi/T e^(-j phi/2),     psi/T = (x_d i_d + emf, x_q i_q)/(2 pi) at i_ref
 *
 * The second change acts in the first cycle of the new length only. That cycle begins with the flux of the old length, so its mean current
 * is off by D. At its end the flux is right. The controller's answer to D would make an error in the cycles after it, so it is taken back:
 *
 *     D     = (e^(j phi/2) (s1/2 - j s2) - s1^2) (1/s1(new)^2 - 1/s1(old)^2) psi/L          phi, s1, s2: new; held to +-1
 *     u_dq += kp D - j x speed D,     the integrators by ki D                               at the valley at which that cycle begins
 *
 * Without the function, the current is off until the controller has removed the difference.
 *
 * Call it after iqfoc_cycle_valley, in the same interrupt, if the PI controller runs at the valley (all means but
 * IQFOC_FEEDBACK_CORRECTED_MEAN; not the mid-point). It changes u_dq, held to +-8, the integrators and mean_off_next; if the
 * length does not change and mean_off is 0, nothing.
 *
 * Largest error of 400000 drawn with |u_dq| <= 2, |i_ref| <= 2, x <= 8 and emf <= 8, against the formulas in double: u_dq 25 LSB, the
 * integrators 5 LSB, D 150 LSB over x.
 */
void iqfoc_synchronous_carrier_keep_flux(iqfoc_synchronous_carrier_t *carrier, iqfoc_cycle_t *cycle);

#ifdef __cplusplus
}
#endif

#endif
