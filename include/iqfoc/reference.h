/*
 * Current reference for a torque: maximum torque per ampere, field weakening by voltage feedback, and current limits.
 * It is optional: it sets iqfoc_cycle_t's i_ref once a cycle, between the cycle's calls.
 *
 *     i_d0 = -s i_q^2/(1 + sqrt(1 + s^2 i_q^2))         most torque per ampere for the i_q of the last step
 *     z   += g ((share u_limit)^2 - |u|^2)              <= 0; u: the voltage requested by the controller
 *     i_d  = max(i_d0 + z, i_d_min)
 *     i_q  = torque/(1 - s i_d/2),   |i_q| <= sqrt(i_max^2 - i_d^2) - (the part of z that i_d_min cuts off)
 *
 * s = 2 (L_q - L_d) I_b/psi_f is the machine's saliency; 0 gives i_d0 = 0 and i_q = torque. The first line is the
 * usual i_d0 = c - sqrt(c^2 + i_q^2), c = 1/s, in a form that subtracts no nearly equal numbers and needs no c, which
 * is infinite without saliency. The last i_q in this line makes a loop with the gain (r - 1)/r < 1, r = sqrt(1 + s^2
 * i_q^2), which is stable.
 *
 * One integrator does all the weakening, without a threshold and so without hysteresis. It first lowers i_d. When i_d
 * has reached its minimum, it lowers i_q: a drive without voltage reserve then loses torque and keeps control of its
 * current.
 *
 * A DC link with ripple or dips: iqfoc_reference_link keeps a reserve that follows the measured link. It weakens for the
 * lowest limit of late, and moves z at once with a change of it, for the integrator alone is slower than a dip.
 *
 *     u_low  = min(u_limit, u_low + (u_limit - u_low)/128)
 *     z     += g_link (the change of (share u_low)^2, as far as |u| lacks it or has it left)
 */
#ifndef IQFOC_REFERENCE_H
#define IQFOC_REFERENCE_H

#include "error.h"
#include "params.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Per unit, IQ24. Fixed while it runs. */
typedef struct iqfoc_reference_config {
    iq24_t saliency; /* s: |s| i_max <= 11; negative where L_d > L_q */
    iq24_t i_max;    /* the current's length, 0 < i_max <= 4 */
    iq24_t i_d_min;  /* -i_max ... 0 */
    iq24_t gain;     /* g: current per voltage^2 and cycle, 0 ... 8; 0: no weakening */
    iq24_t share;    /* share of the voltage limit that the controller may request, 0.5 ... 1.125 */
} iqfoc_reference_config_t;

/* The state. Zero: no weakening. */
typedef struct iqfoc_reference {
    iq24_acc_t weakening; /* z: -8 ... 0 per unit, 48 fractional bits */
    iq24_t i_q;           /* of the last step */
} iqfoc_reference_t;

/* The limit of the voltage under ripple and dips of the DC link. */
typedef struct iqfoc_reference_reserve {
    iq24_t gain; /* g_link: current per voltage^2, 0 ... 64; fixed while it runs */
    iq24_t low;  /* u_low, per unit; 0: no limit yet */
} iqfoc_reference_link_t;

/* Returns IQFOC_OK or the error: IQFOC_ERROR_SALIENCY, _CURRENT_LIMIT (i_max or i_d_min), _WEAKENING. */
iqfoc_error_t iqfoc_reference_check(const iqfoc_reference_config_t *config);

/*
 * One step, in the cycle's interrupt or in a task of the same rate; i_ref must be written between the cycle's calls.
 * torque: over (3/2) pole_pairs psi_f I_b, which is the i_q of this torque at i_d = 0: |torque| <= 8. u: the voltage
 * that the controller requested at the last peak, dq per unit: a component beyond 1.5 counts as 1.5. u_limit: the
 * largest possible voltage, per unit, 0 ... 1.5: the modulator's limit times u_dc, u_dc/ sqrt(3) in linear
 * modulation. Out: within i_max, i_d from i_d_min on. Largest error of 400000 drawn, against the formulas in double
 * with the same state: i_d 3 LSB; i_q 16 LSB where i_d leaves it 0.5 and more of the circle (the root is steep at its
 * end); of z none but the squares' rounding, 2 LSB times gain a step.
 */
iqfoc_dq_t iqfoc_reference_step(iqfoc_reference_t *reference, const iqfoc_reference_config_t *config,
                                iq24_t torque, iqfoc_dq_t u, iq24_t u_limit);

/*
 * The limit for iqfoc_reference_step under ripple and dips of the DC link: call it before each step, with the same u
 * and u_limit, and give the step what it returns. link->gain: 0 ... 64, outside it counts as the nearer end.
 *
 * To the bit: the rise is rounded down, so that u_low stays up to 127 LSB below a constant limit. Each square is
 * rounded to nearest. Largest error of 400000 drawn, against the formulas in double with the same state: u_low 1 LSB, z 8 LSB
 * times g_link a step. z stays within -12 ... 0.
 */
iq24_t iqfoc_reference_link(iqfoc_reference_t *reference, iqfoc_reference_link_t *link,
                            const iqfoc_reference_config_t *config, iqfoc_dq_t u, iq24_t u_limit);

/* ---- The formulas in double, with limits, and an initialiser (params.h has the bases). ---- */
#define IQFOC_RAW_REFERENCE_SALIENCY(L_d_H, L_q_H, psi_Wb, I_b_A)                                            \
    (2.0 * ((L_q_H) - (L_d_H)) * (I_b_A) / (psi_Wb))
#define IQFOC_MAX_REFERENCE_SALIENCY 44.0
/* d|u|^2/di_d is about 2 u_q omega L_d, with u_q nearly the whole voltage. */
#define IQFOC_RAW_REFERENCE_LINK_GAIN(L_d_H, I_b_A, U_b_V, omega_rad_s, u_V)                                 \
    ((U_b_V) / (I_b_A) * (U_b_V) / (2.0 * (u_V) * (omega_rad_s) * (L_d_H)))
#define IQFOC_RAW_REFERENCE_GAIN(w_rad_s, L_d_H, T_s, I_b_A, U_b_V, omega_rad_s, u_V)                        \
    ((w_rad_s) * (T_s)*IQFOC_RAW_REFERENCE_LINK_GAIN(L_d_H, I_b_A, U_b_V, omega_rad_s, u_V))
#define IQFOC_MAX_REFERENCE_GAIN      8.0
#define IQFOC_MAX_REFERENCE_LINK_GAIN 64.0

/*
 * iqfoc_reference_config_t for a weakening of w_rad_s, some 100 1/s, at the highest electrical speed omega and
 * the voltage u_V there: saliency, i_max, i_d_min, gain, share.
 */
#define IQFOC_REFERENCE(w_rad_s, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V, omega_rad_s, u_V, i_max_A,         \
                        i_d_min_A, share)                                                                    \
    {                                                                                                        \
        IQFOC_CHECKED(IQFOC_RAW_REFERENCE_SALIENCY(L_d_H, L_q_H, psi_Wb, I_b_A),                             \
                      -IQFOC_MAX_REFERENCE_SALIENCY, IQFOC_MAX_REFERENCE_SALIENCY),                          \
            IQFOC_CHECKED((i_max_A) / (I_b_A), 1e-6, 4.0), IQFOC_CHECKED((i_d_min_A) / (I_b_A), -4.0, 0.0),  \
            IQFOC_CHECKED(IQFOC_RAW_REFERENCE_GAIN(w_rad_s, L_d_H, T_s, I_b_A, U_b_V, omega_rad_s, u_V),     \
                          0.0, IQFOC_MAX_REFERENCE_GAIN),                                                    \
            IQFOC_CHECKED(share, 0.5, 1.125)                                                                 \
    }

/* iqfoc_reference_link_t at the start, for the same speed and voltage. */
#define IQFOC_REFERENCE_LINK(L_d_H, I_b_A, U_b_V, omega_rad_s, u_V)                                          \
    {                                                                                                        \
        IQFOC_CHECKED(IQFOC_RAW_REFERENCE_LINK_GAIN(L_d_H, I_b_A, U_b_V, omega_rad_s, u_V), 0.0,             \
                      IQFOC_MAX_REFERENCE_LINK_GAIN),                                                        \
            0                                                                                                \
    }

#ifdef __cplusplus
}
#endif

#endif
