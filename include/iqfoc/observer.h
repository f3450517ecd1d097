/*
 * Observer of rotor angle and speed without an angle sensor, for permanent-magnet machines with or without saliency,
 * down to 3 PWM periods per electrical period. docs/sensorless.md says how a drive starts with it and when it fails.
 *
 * The state is the flux linkage in the stationary frame, where a voltage that is constant over the cycle is integrated
 * exactly at any speed. i_mean: mean current of the cycle, i: current at its end, phi: angle covered in the cycle, rad.
 *
 *     psi'   = psi + u - r i_mean
 *     a      = psi' - l_q i                                active flux: the rotor's angle is arg a
 *     d      = (cos, sin) of theta + speed                 locked: the angle expected; seeking: d = a/|a|
 *     radius = psi_f + (l_d - l_q) i_d,   i_d: part of i along d
 *     off    = radius - a d
 *     psi    = psi' + g off d,   g = min(gain_max, 0.4 |phi|)
 *     e      = d x a/(2 pi radius)                         turns: phase-locked loop; seeking: arg a - (theta + speed)
 *     theta += speed + k1 e,   speed += k2 e
 *
 * Stability at any speed: d turns with the rotor, so a flux error x, seen from the rotor, becomes
 * x' = Rot(-phi) (I - g d d^T) x, with the determinant 1 - g and the trace (2 - g) cos phi. Both eigenvalues are inside
 * the unit circle if |det| < 1 and |trace| < 1 + det: for 0 < g < 2 and each phi that is no multiple of pi. At low speed
 * an error decays to 1/e in 5 rad of rotor movement. The poles of the phase-locked loop do not depend on the speed.
 *
 * The observer is locked or it seeks. Its first step after a start takes the angle from the EMF: a began at 0, so a is now
 * the chord of the magnet's flux over the cycle, across the rotor at the middle of the cycle. psi is then the flux at
 *
 *     theta = arg a - 1/4 + speed/2,   speed < 0: arg a + 1/4 + speed/2
 *
 * After that, while it seeks, g is |phi| within 1/8 ... gain_max, k1 is 3/4 and k2 is 1/4. It is locked after
 * `lock_cycles` cycles in a row with |e| <= angle_max, |off| <= flux_max and |speed| >= speed_min. The lock is lost if a
 * limit of e or off is exceeded in more than `lost_cycles` cycles in a row, or if the speed is below speed_min in more
 * than `slow_cycles` cycles in a row. A sticky bit of `status` tells the reason.
 *
 *     valley:  i_mean = iqfoc_observer_mean(cycle.i_valley, cycle.i_peak, i);
 *              iqfoc_observer_step(&observer, iqfoc_extension_acting(&extension, cycle.u_now, i_mean), i_mean, i);
 *              sample.theta = iqfoc_observer_theta(&observer, 0);  sample.speed = iqfoc_observer_speed(&observer);
 *     peak:    sample.theta = iqfoc_observer_theta(&observer, IQ24(0.5));
 *
 * With two updates a period it steps at each valley and each peak, and a cycle here is half a period.
 *
 * All functions share one state: call them from the cycle's interrupts.
 */
#ifndef IQFOC_OBSERVER_H
#define IQFOC_OBSERVER_H

#include "error.h"
#include "extension_params.h"
#include "flux_predictor.h"
#include "rotor.h"
#include "tracker.h"
#include "vector.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* g of a locked step over the turns per cycle: 0.4 * 2 pi. */
#define IQFOC_OBSERVER_GAIN IQ24(2.5132741228718345)

/* Sticky bits of `status`: the reasons for a lost lock. iqfoc_observer_start resets them. */
#define IQFOC_OBSERVER_LOST_ANGLE UINT32_C(0x1) /* the angle jumps: |e| beyond angle_max */
#define IQFOC_OBSERVER_LOST_FLUX  UINT32_C(0x2) /* the flux has a wrong length: |off| beyond flux_max */
#define IQFOC_OBSERVER_LOST_SLOW                                                                             \
    UINT32_C(0x4) /* too long below speed_min, where no voltage shows the angle */

/* All per unit as in flux_predictor.h: flux in U_b T. */
typedef struct iqfoc_observer_config {
    iqfoc_flux_predictor_t machine; /* psi >= 1/64 and |l_d - l_q| <= 4; k_d, k_q and skew are not used */
    iq24_t
        saturation; /* (I_b/I_sat)^2, 0 ... 4: l_d and l_q over 1 + saturation |i|^2, which is held to 2; 0: none */
    iq24_t gain_max;      /* of the radial correction: 1/8 ... 1 */
    iq24_t k1;            /* of the phase-locked loop once locked: 0 < k1 <= 1 */
    iq24_t k2;            /* 0 < k2 <= 1/4 */
    iq24_t speed_min;     /* turns per cycle, 0 ... IQFOC_ROTOR_SPEED_MAX */
    iq24_t angle_max;     /* 0 < x <= 1/2 turn */
    iq24_t flux_max;      /* 0 < x < 8 */
    uint32_t lock_cycles; /* 1 and more */
    uint32_t lost_cycles; /* UINT32_MAX: lock is never lost for an error */
    uint32_t slow_cycles; /* UINT32_MAX: lock is never lost for a low speed */
} iqfoc_observer_config_t;

/*
 * Initialiser of iqfoc_observer_config_t from physical values (params.h), without saturation. w_rad_s: bandwidth of the
 * phase-locked loop; 0.16/T passes 0.1 degrees of the noise of usual sensors. With the turns x per cycle at the top speed,
 * 0.65 x^(2/3)/T, if that is less, keeps the noise of the speed at 0.02 % of the top speed. speed_min: a twentieth
 * of the top speed is usual, less if R and dead time are well known.
 */
#define IQFOC_OBSERVER_CONFIG(R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V, w_rad_s, speed_min)            \
    {                                                                                                        \
        IQFOC_FLUX_PREDICTOR(R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V), 0, IQ24(0.48),                 \
            IQ24(IQFOC_RAW_TRACKER_K1_2(IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s))),                              \
            IQ24(IQFOC_RAW_TRACKER_K2_2(IQFOC_RAW_TRACKER_POLE(w_rad_s, T_s))), speed_min, IQ24(0.02),       \
            IQFOC_FLUX_PSI((psi_Wb) / 4.0, T_s, U_b_V), 8, 50, 2000                                          \
    }

/* Angles in Q32: a turn is 2^32, and a wrap of the number is a whole turn. */
typedef struct iqfoc_observer {
    /* Between two steps another set may be put here that iqfoc_observer_check accepts: adapted R, flux, L_q. */
    const iqfoc_observer_config_t *config;
    iqfoc_ab_t psi;    /* flux linkage at the last step, stationary frame: each component within +-32 */
    int32_t theta_q32; /* at the last step */
    int32_t speed_q32; /* per cycle, within +-1/3 */
    iq24_t error;      /* e of the last step, turns */
    iq24_t flux_error; /* off of the last step, held to +-8 */
    uint32_t count;    /* cycles in a row: within the limits if it seeks, beyond one if it is locked */
    uint32_t slow;     /* cycles in a row below speed_min */
    uint32_t status;   /* sticky: IQFOC_OBSERVER_LOST_... */
    bool locked;
    bool begins; /* the next step takes the angle from the EMF */
} iqfoc_observer_t;

/* IQFOC_OK, or the error of a value outside its range: those of iqfoc_flux_predictor_check, IQFOC_ERROR_OBSERVER. */
iqfoc_error_t iqfoc_observer_check(const iqfoc_observer_config_t *config);

/* Checks config, which must outlive the observer; then as iqfoc_observer_start at angle 0 and rest, seeking. */
iqfoc_error_t iqfoc_observer_init(iqfoc_observer_t *observer, const iqfoc_observer_config_t *config);

/*
 * Sets angle, speed and flux for the current i of this instant, and resets `status`. known: true locks at once, after
 * an alignment, an open-loop start (start.h) or a sensor; false seeks: theta does not matter, and the speed needs the
 * right sign and to be within +-50 %. Not within the time of a step.
 *
 * |component of i| <= 15.9. theta: turns, any number of whole ones. speed: held to IQFOC_ROTOR_SPEED_MAX.
 * Largest error of psi, known or after the first step, of 400000 drawn: 1.8 LSB times 1 + |psi| + l_q + |l_d - l_q|.
 */
void iqfoc_observer_start(iqfoc_observer_t *observer, iqfoc_ab_t i, iq24_t theta, iq24_t speed, bool known);

/*
 * Mean current of a cycle from the samples at its start, middle and end: (start + 4 middle + end)/6, Simpson's rule.
 * In the voltage drop its error is below r |i| phi^4/2880 for a current that turns with the rotor. Without a sample in
 * the middle (two updates a period) the mean of both ends has r |i| phi^2/12.
 *
 * |component| <= 15.9. Largest error: 0.51 LSB. Range: the sum is within 95.4.
 */
static inline iqfoc_ab_t iqfoc_observer_mean(iqfoc_ab_t start, iqfoc_ab_t middle, iqfoc_ab_t end)
{
    const int32_t sixth_q32 = INT32_C(715827883);
    const iqfoc_ab_t mean = {iq24_mul_high_round(start.alpha + 4 * middle.alpha + end.alpha, sixth_q32),
                             iq24_mul_high_round(start.beta + 4 * middle.beta + end.beta, sixth_q32)};
    return mean;
}

/*
 * One cycle, at the instant that ends it. u: mean voltage that acted in the cycle, |component| <= 2: duties times the
 * measured DC link, less the loss of the legs (iqfoc_extension_acting). i_mean: mean current of the cycle; i: current at
 * its end; |component| <= 15.9 each. l_q i is held to +-32, i_d to +-4.
 *
 * Largest error of 400000 drawn with |a| >= 1/4, against the lines above in double with the same state: psi 2.5 LSB
 * times 1 + |a| + l_q + |l_d - l_q| + 4 |off|; off 1.8 LSB times 1 + |a| + l_q + 4 |l_d - l_q| (1 + 1/|a|); theta 0.7
 * LSB and speed 0.2 LSB times 1 + 1/|a|; locked, theta 0.6 LSB and speed 0.1 LSB times 1 + 1/radius + 0.004 |e|, with e
 * in LSB. d is that of theta + speed rounded down to 2^-24 turn. |d x a| is held to 1.5 radius, radius for e to 1/64 or more.
 *
 * Range: psi is within 32 a component, u and the drop move it by 18, and psi' is held to +-32. So a is within 64 a
 * component, and 90.6 long; the length expected is within 16 + 4 * 4. Their difference is held to +-8, and g <= 1.
 */
void iqfoc_observer_step(iqfoc_observer_t *observer, iqfoc_ab_t u, iqfoc_ab_t i_mean, iqfoc_ab_t i);

/*
 * The electrical angle `instant` cycles after the last step, -8 ... 8: turns, -1/2 <= theta < 1/2. Largest error 1 LSB of
 * the observer's own.
 */
static inline iq24_t iqfoc_observer_theta(const iqfoc_observer_t *observer, iq24_t instant)
{
    return iqfoc_rotor_theta_of_q32(observer->theta_q32, observer->speed_q32, instant);
}

/* The speed, turns per cycle: |speed| <= IQFOC_ROTOR_SPEED_MAX. Error 0.5 LSB of the observer's own. */
static inline iq24_t iqfoc_observer_speed(const iqfoc_observer_t *observer)
{
    return iqfoc_rotor_speed_of_q32(observer->speed_q32);
}

/* Deprecated name of version 0.1. The next version has only the name above. */
#define iqfoc_observer_turns iqfoc_observer_speed

#ifdef __cplusplus
}
#endif

#endif
