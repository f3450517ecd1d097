/*
 * Observer of angle and speed: from an angle that is measured once a cycle it gives angle and speed at any instant.
 * The model is a shaft with constant acceleration.
 *
 *     theta += speed + acceleration/2,   speed += acceleration                          one cycle on
 *     e = measured - (theta + instant speed)                                            -1/2 ... 1/2 turn
 *     theta += k1 e,   speed += k2 e,   acceleration += k3 e
 *
 * IQFOC_TRACKER_GAINS puts all three poles at one place p. It filters noise and quantisation with that bandwidth, and
 * neither a constant speed nor a constant acceleration leaves an error. With k3 = 0 (IQFOC_TRACKER_GAINS_2) an
 * acceleration a leaves an error of about a/k2, and the speed has less noise.
 *
 * A measurement that is missing or differs by more than far_max is not used: the tracker then extrapolates. After
 * more than lost_max such measurements in a row the sensor is lost.
 *
 * All functions share one state: call them from the cycle's interrupts.
 */
#ifndef IQFOC_TRACKER_H
#define IQFOC_TRACKER_H

#include "error.h"
#include "rotor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* p of a bandwidth times the cycle, w T in rad: 1/(1 + w T), and the gains with two or three poles there. */
#define IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s) (1.0 / (1.0 + (w_rad_s) * (T_s)))
#define IQFOC_RAW_TRACKER_K1_3(p)            (1.0 - (p) * (p) * (p))
#define IQFOC_RAW_TRACKER_K2_3(p)            (1.5 * (1.0 - (p)) * (1.0 - (p)) * (1.0 + (p)))
#define IQFOC_RAW_TRACKER_K3_3(p)            ((1.0 - (p)) * (1.0 - (p)) * (1.0 - (p)))
#define IQFOC_RAW_TRACKER_K1_2(p)            (1.0 - (p) * (p))
#define IQFOC_RAW_TRACKER_K2_2(p)            ((1.0 - (p)) * (1.0 - (p)))

/* Initialisers of iqfoc_tracker_config_t for a bandwidth in rad/s. */
#define IQFOC_TRACKER_GAINS(w_rad_s, T_s, far_max, lost_max)                                                 \
    {                                                                                                        \
        IQ24(IQFOC_RAW_TRACKER_K1_3(IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s))),                                  \
            IQ24(IQFOC_RAW_TRACKER_K2_3(IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s))),                              \
            IQ24(IQFOC_RAW_TRACKER_K3_3(IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s))), far_max, lost_max            \
    }
#define IQFOC_TRACKER_GAINS_2(w_rad_s, T_s, far_max, lost_max)                                               \
    {                                                                                                        \
        IQ24(IQFOC_RAW_TRACKER_K1_2(IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s))),                                  \
            IQ24(IQFOC_RAW_TRACKER_K2_2(IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s))), 0, far_max, lost_max         \
    }

typedef struct iqfoc_tracker_config {
    iq24_t k1;         /* 0 < k1 <= 1 */
    iq24_t k2;         /* 0 < k2 <= 1 */
    iq24_t k3;         /* 0 ... 1 */
    iq24_t far_max;    /* a measurement with |e| above this value is not used: 0 < x <= 1/2 turn */
    uint32_t lost_max; /* this many missing measurements in a row are tolerated; UINT32_MAX: any number */
} iqfoc_tracker_config_t;

/* Angles in Q32: a turn is 2^32, and a wrap of the number is a whole turn. */
typedef struct iqfoc_tracker {
    const iqfoc_tracker_config_t *config;
    int32_t theta_q32;        /* at the last valley */
    int32_t speed_q32;        /* per cycle */
    int32_t acceleration_q32; /* per cycle^2 */
    iq24_t error;             /* e of the last step with a measurement */
    uint32_t missing;         /* missing measurements in a row */
    uint32_t seen;            /* measurements used, up to 2 */
    bool lost;                /* sticky: iqfoc_tracker_restart resets it */
} iqfoc_tracker_t;

/* config must outlive it. IQFOC_ERROR_TRACKER: a field out of its range. */
iqfoc_error_t iqfoc_tracker_init(iqfoc_tracker_t *tracker, const iqfoc_tracker_config_t *config);

/* Clears the state: the next measurement sets the angle, the next two set the speed. */
void iqfoc_tracker_restart(iqfoc_tracker_t *tracker);

/*
 * Once a cycle, in its valley's interrupt. theta: the measured electrical angle, turns, with any number of whole
 * turns; instant: when it was measured, cycles after this valley, -1 ... 1 (0: with the currents); valid: false if nothing
 * was measured. The speed is held to +-1/3 turn per cycle, as everywhere.
 *
 * Largest error of one step against double arithmetic, of 400000 drawn: 2 units of 2^-32 turns each; exact
 * in the measurement. An e below 2^-33/k3 turns does not move the acceleration any more: 10 LSB at 1/18 of
 * 1/T in bandwidth.
 */
void iqfoc_tracker_step(iqfoc_tracker_t *tracker, iq24_t theta, iq24_t instant, bool valid);

/*
 * The electrical angle `instant` cycles after the last valley, -8 ... 8: turns, -1/2 <= theta < 1/2. Largest
 * error 1 LSB of the tracker's own.
 */
static inline iq24_t iqfoc_tracker_theta(const iqfoc_tracker_t *tracker, iq24_t instant)
{
    return iqfoc_rotor_theta_of_q32(tracker->theta_q32, tracker->speed_q32, instant);
}

/* The filtered speed, turns per cycle: |speed| <= IQFOC_ROTOR_SPEED_MAX. Error 0.5 LSB of the tracker's own. */
static inline iq24_t iqfoc_tracker_speed(const iqfoc_tracker_t *tracker)
{
    return iqfoc_rotor_speed_of_q32(tracker->speed_q32);
}

/* Deprecated name of version 0.1. The next version has only the name above. */
#define iqfoc_tracker_turns iqfoc_tracker_speed

#ifdef __cplusplus
}
#endif

#endif
