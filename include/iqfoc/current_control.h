/*
 * Current control in the rotor frame: PI with back-calculation anti-windup, and decoupling.
 *
 *     u  = kp e + I,   I += ki e,   e = i_ref - i                        for d and q
 *     u += ( -x x_q i_q,  x (x_d i_d + emf) )                            x = speed in turns per cycle
 *     I += k_aw (scale - 1) u                                            where the modulator made scale * u
 *
 * The caller chooses the frame in which u acts: the cycle turns u back by the rotor angle at the middle of the time
 * in which the voltage acts. Each function changes only `control`: call them in one context, the interrupt that
 * controls the current.
 */
#ifndef IQFOC_CURRENT_CONTROL_H
#define IQFOC_CURRENT_CONTROL_H

#include "iq24.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Per unit, IQ24 (iqfoc/params.h makes them). All >= 0. */
typedef struct iqfoc_current_control_gains {
    iq24_t kp_d; /* voltage per current, <= 32 */
    iq24_t kp_q; /* the same for q; differs if L_q != L_d */
    iq24_t ki_d; /* voltage per current and cycle, <= 32 */
    iq24_t ki_q;
    iq24_t
        anti_windup; /* k_aw: share of the shortened voltage subtracted from the integrators per cycle, <= 1 */
    iq24_t x_d;      /* 2 pi L_d I_b / (T U_b): reactance at one turn per cycle, <= 96; 0: no decoupling */
    iq24_t x_q;      /* 2 pi L_q I_b / (T U_b) */
    iq24_t emf;      /* 2 pi psi_f / (T U_b): EMF at one turn per cycle, <= 96 */
} iqfoc_current_control_gains_t;

/*
 * The integrators: voltage per unit with 48 fractional bits, so that no error is too small to be integrated.
 * Zero them to reset.
 */
typedef struct iqfoc_current_control {
    iq24_acc_t integral_d; /* within +-8 per unit */
    iq24_acc_t integral_q;
} iqfoc_current_control_t;

/*
 * A sum held to -8 <= result < 8, the limit of integrators and results: eight times the DC-link voltage.
 *
 * The high word of Q15.48 is Q15.16, and 8 is 2^19 there. Only that word is held, to 20 bits; the low word does not
 * change. A sum outside becomes a number within 2^-16 of its limit, and a sum inside does not change.
 */
static inline iq24_acc_t iqfoc_current_control_hold(iq24_acc_t sum)
{
    const int32_t high = IQ24_HOLD_BITS((int32_t)iq24_asr64(sum, 32), 20);
    return iq24_acc_join(high, (uint32_t)((uint64_t)sum & UINT32_MAX));
}

/*
 * The controllers' part of the voltage, before decoupling and before any limit of the inverter.
 *
 * i_ref, i: per unit, |component| <= 32. Out: per unit voltage, each component held to +-8; so is the
 * integrator. Largest error against double: 1 LSB (rounded down); of the integrator none. Beyond +-8, 2^-16.
 *
 * Range: |e| <= 64 and k <= 32 give |k e| <= 2048 in per unit, 2^59 in the accumulator; with |I| <= 8 the sum
 * fits.
 */
static inline iqfoc_dq_t iqfoc_current_control_step(iqfoc_current_control_t *control,
                                                    const iqfoc_current_control_gains_t *gains,
                                                    iqfoc_dq_t i_ref, iqfoc_dq_t i)
{
    const iq24_t e_d = iq24_sub_wrap(i_ref.d, i.d);
    const iq24_t e_q = iq24_sub_wrap(i_ref.q, i.q);
    const iq24_acc_t u_d = iq24_acc_mac(control->integral_d, gains->kp_d, e_d);
    const iq24_acc_t u_q = iq24_acc_mac(control->integral_q, gains->kp_q, e_q);
    const iqfoc_dq_t u = {iq24_acc_trunc(iqfoc_current_control_hold(u_d)),
                          iq24_acc_trunc(iqfoc_current_control_hold(u_q))};
    control->integral_d = iqfoc_current_control_hold(iq24_acc_mac(control->integral_d, gains->ki_d, e_d));
    control->integral_q = iqfoc_current_control_hold(iq24_acc_mac(control->integral_q, gains->ki_q, e_q));
    return u;
}

/*
 * The decoupling: the voltage that cancels the coupling of the axes and the EMF, added to the controllers' voltage.
 *
 * i: per unit, |component| <= 32. speed: |speed| <= 1/3 turn per cycle. Out: per unit voltage, each
 * component held to +-8. Largest error: 0.5 LSB + 0.5 LSB per unit of i (the rounded reactance), rounded
 * down: 1 LSB more.
 *
 * Range: |x x_q| <= 96/3 = 32, so a product is at most 32 * 32 = 1024 in per unit, 2^58 in the accumulator;
 * the EMF 32.
 */
static inline iqfoc_dq_t iqfoc_current_control_decoupling(const iqfoc_current_control_gains_t *gains,
                                                          iqfoc_dq_t i, iq24_t speed)
{
    const iq24_t reactance_d = iq24_mul_round(speed, gains->x_d);
    const iq24_t reactance_q = iq24_mul_round(speed, gains->x_q);
    const iq24_acc_t d = iq24_acc_mul(-reactance_q, i.q);
    const iq24_acc_t q = iq24_acc_mac(iq24_acc_mul(reactance_d, i.d), speed, gains->emf);
    const iqfoc_dq_t u = {iq24_acc_trunc(iqfoc_current_control_hold(d)),
                          iq24_acc_trunc(iqfoc_current_control_hold(q))};
    return u;
}

/*
 * The sum of the controllers' voltage and the decoupling, held and rounded once.
 *
 * Ranges as above, |speed| by 1 LSB more. Out: per unit voltage, each component held to +-8. Largest error
 * against double: 1 LSB (rounded down) and 1 LSB per unit of i (the reactance, rounded down); of the
 * integrators none.
 *
 * Range: |k e| <= 2048, |reactance i| <= 1024, EMF 32 and |I| <= 8 in per unit: below 2^60 in the accumulator.
 * 256 turns is below 2^31, and the high word of its product with x is turns times x, below 2^30.
 */
IQFOC_STEP iqfoc_dq_t iqfoc_current_control_voltage(iqfoc_current_control_t *control,
                                                    const iqfoc_current_control_gains_t *gains,
                                                    iqfoc_dq_t i_ref, iqfoc_dq_t i, iq24_t speed)
{
    const iq24_t e_d = iq24_sub_wrap(i_ref.d, i.d);
    const iq24_t e_q = iq24_sub_wrap(i_ref.q, i.q);
    IQ24_LOAD_FROM_HERE();
    iq24_t x_d;
    iq24_t x_q;
    IQ24_LOAD_PAIR(x_d, x_q, gains->x_d, gains->x_q);
    const iq24_t minus_reactance_q = iq24_mul_high(-256 * speed, x_q);
    const iq24_t reactance_d = iq24_mul_high(256 * speed, x_d);
    const iq24_acc_t integral_d = control->integral_d;
    const iq24_acc_t integral_q = control->integral_q;
    iq24_t kp_d;
    iq24_t kp_q;
    IQ24_LOAD_PAIR(kp_d, kp_q, gains->kp_d, gains->kp_q);
    iq24_acc_t d = iq24_acc_mac(integral_d, kp_d, e_d);
    iq24_acc_t q = iq24_acc_mac(integral_q, kp_q, e_q);
    d = iq24_acc_mac(d, minus_reactance_q, i.q);
    q = iq24_acc_mac(iq24_acc_mac(q, reactance_d, i.d), speed, gains->emf);
    iq24_t ki_d;
    iq24_t ki_q;
    IQ24_LOAD_PAIR(ki_d, ki_q, gains->ki_d, gains->ki_q);
    control->integral_d = iqfoc_current_control_hold(iq24_acc_mac(integral_d, ki_d, e_d));
    control->integral_q = iqfoc_current_control_hold(iq24_acc_mac(integral_q, ki_q, e_q));
    const iqfoc_dq_t u = {iq24_acc_trunc(iqfoc_current_control_hold(d)),
                          iq24_acc_trunc(iqfoc_current_control_hold(q))};
    return u;
}

/*
 * Back-calculation: call it after a step whose voltage the modulator shortened by scale < 1.
 *
 * u: the requested voltage, |component| <= 16. scale: 0 ... 1, as iqfoc_modulate gives it; 1 leaves the integrators
 * as they are.
 *
 * Range: |k_aw (scale - 1)| <= 1 and |u| <= 16 in per unit, so the product is at most 2^52 in the
 * accumulator; |I| <= 2^51.
 */
static inline void iqfoc_current_control_limited(iqfoc_current_control_t *control,
                                                 const iqfoc_current_control_gains_t *gains, iqfoc_dq_t u,
                                                 iq24_t scale)
{
    if (scale < IQ24_ONE) {
        const iq24_t back = iq24_mul_trunc(gains->anti_windup, scale - IQ24_ONE);
        control->integral_d = iqfoc_current_control_hold(iq24_acc_mac(control->integral_d, back, u.d));
        control->integral_q = iqfoc_current_control_hold(iq24_acc_mac(control->integral_q, back, u.q));
    }
}

/*
 * Sets the integrators to u minus the decoupling at i and `speed`. Without an error the next step then requests u: a
 * change of controller without a voltage step.
 *
 * u: |component| <= 8; i and turns as iqfoc_current_control_decoupling takes them. Largest error of the voltage that
 * iqfoc_current_control_voltage then asks for: 3 LSB where |i| <= 2. An integrator beyond +-8 is held to it.
 *
 * Range: the difference saturates, and times 1 it is below 2^55 in the accumulator.
 */
static inline void iqfoc_current_control_preset(iqfoc_current_control_t *control,
                                                const iqfoc_current_control_gains_t *gains, iqfoc_dq_t u,
                                                iqfoc_dq_t i, iq24_t speed)
{
    const iqfoc_dq_t apart = iqfoc_current_control_decoupling(gains, i, speed);
    control->integral_d = iqfoc_current_control_hold(iq24_acc_mul(iq24_sub_sat(u.d, apart.d), IQ24_ONE));
    control->integral_q = iqfoc_current_control_hold(iq24_acc_mul(iq24_sub_sat(u.q, apart.q), IQ24_ONE));
}

#ifdef __cplusplus
}
#endif

#endif
