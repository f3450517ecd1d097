/*
 * The current's reference from a torque: maximum torque per ampere, field weakening by voltage feedback, and
 * the limits of current. Optional: it sets iqfoc_cycle_t's i_ref once a cycle, between the calls.
 *
 *     i_d0 = -s i_q^2/(1 + sqrt(1 + s^2 i_q^2))         most torque per ampere for the i_q of the last step
 *     z   += g ((share u_limit)^2 - |u|^2)              <= 0: the voltage that the controller asked for
 *     i_d  = max(i_d0 + z, i_d_min)
 *     i_q  = torque/(1 - s i_d/2),   |i_q| <= sqrt(i_max^2 - i_d^2) - (what of z i_d_min has no room for)
 *
 * s = 2 (L_q - L_d) I_b/psi_f is the machine's saliency; 0 leaves i_d0 = 0 and i_q = torque. The first line is
 * the usual i_d0 = c - sqrt(c^2 + i_q^2), c = 1/s, in a form that subtracts no nearly equal numbers and
 * needs no c, which a machine without saliency has not. Taking the last i_q for it makes no loop of its own:
 * its gain is (r - 1)/r < 1, r = sqrt(1 + s^2 i_q^2).
 *
 * One integrator does all the weakening, without a threshold and so without hysteresis: first it lowers i_d,
 * and where i_d may not fall further it takes i_q back, so that a drive which has run out of voltage loses
 * torque and not its hold of the current.
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
    iq24_t share;    /* of the voltage limit that the controller may ask for, 0.5 ... 1.125 */
} iqfoc_reference_config_t;

/* Zero it to begin anew. */
typedef struct iqfoc_reference {
    iq24_acc_t weakening; /* z: -8 ... 0 per unit, 48 fractional bits */
    iq24_t i_q;           /* of the last step */
} iqfoc_reference_t;

/* IQFOC_OK, or what is wrong: IQFOC_ERROR_SALIENCY, _CURRENT_LIMIT (i_max or i_d_min), _WEAKENING. */
iqfoc_error_t iqfoc_reference_check(const iqfoc_reference_config_t *config);

/*
 * One step. torque: over (3/2) pole_pairs psi_f I_b, that is the i_q which makes it where i_d = 0: |torque| <=
 * 8. u: the voltage that the controller asked for at the last peak, dq per unit: a component beyond 1.5
 * counts as 1.5. u_limit: the largest it can be, per unit, 0 ... 1.5: the modulator's limit times u_dc, u_dc/
 * sqrt(3) in linear modulation. Out: within i_max, i_d from i_d_min on. Largest error of 400000 drawn,
 * against the formulas in double with the same state: i_d 3 LSB; i_q 16 LSB where i_d leaves it 0.5 and
 * more of the circle (the root is steep at its end); of z none but the squares' rounding, 2 LSB times gain
 * a step.
 */
iqfoc_dq_t iqfoc_reference_step(iqfoc_reference_t *reference, const iqfoc_reference_config_t *config,
                                iq24_t torque, iqfoc_dq_t u, iq24_t u_limit);

/* ---- The formulas in double, with limits, and an initialiser (params.h has the bases). ---- */
#define IQFOC_RAW_REFERENCE_SALIENCY(L_d_H, L_q_H, psi_Wb, I_b_A)                                            \
    (2.0 * ((L_q_H) - (L_d_H)) * (I_b_A) / (psi_Wb))
#define IQFOC_MAX_REFERENCE_SALIENCY 44.0
/* d|u|^2/di_d is about 2 u_q omega L_d, u_q nearly the whole voltage. */
#define IQFOC_RAW_REFERENCE_GAIN(w_rad_s, L_d_H, T_s, I_b_A, U_b_V, omega_rad_s, u_V)                        \
    ((w_rad_s) * (T_s) * (U_b_V) / (I_b_A) * (U_b_V) / (2.0 * (u_V) * (omega_rad_s) * (L_d_H)))
#define IQFOC_MAX_REFERENCE_GAIN 8.0

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

#ifdef __cplusplus
}
#endif

#endif
