/*
 * The current controller that `iqfoc tune` designs: a complex-vector PI controller with active resistance, or
 * deadbeat control with disturbance observer. It uses the exact model of a machine with or without saliency.
 *
 * At valley k the voltage v_k of the cycle that begins is already decided. In the rotor's frame, with each voltage
 * seen at the start of its own cycle, the machine is (iqfoc/predictor_salient.h)
 *
 *     i_(k+1) = F i_k + G v_k + m + drift
 *
 * The controller solves this equation twice, first for the current to come and then for the voltage:
 *
 *     drift  += learn (i_k - i^_k)                                disturbance estimate by the observer gain `learn`
 *     i^_(k+1) = F i_k + G v_k + m + drift                        predicted current
 *     aim_(k+2) = follow aim_(k+1) + (1 - follow) i_ref           target: the filtered reference of the mean current
 *     want    = valley(aim_(k+2)) + keep e^(-j phi) (i^_(k+1) - valley(aim_(k+1)))      set-point of the valley's current
 *     v_(k+1) = G^-1 (want - F i^_(k+1) - m - drift)
 *
 * The closed loop has the poles keep e^(-j phi), 1 - learn and 0. It follows its reference with the pole `follow` and
 * one cycle of delay. A pole at keep e^(-j phi) in the rotor's frame is real in the stationary one: a resistance
 * added to the winding has this effect. Written with an integrator, the controller is the state feedback of M.
 * Hinkkanen et al., "Current control for synchronous motor drives: direct discrete-time pole-placement design", IEEE
 * Trans. Ind. Appl. 52(2), 2016, pp. 1530-1541, with that pole turned (docs/tune.md). In this form a voltage that the
 * modulator shortened needs no anti-windup, since v_k is the voltage that acted.
 *
 * Torque follows the cycle's mean current. valley(aim) is the current at the valleys that has the mean `aim`
 * (iqfoc/valley_reference.h), plus `offset`. The offset is estimated from the samples at the carrier's peak. Even
 * with a wrong model, the mean that three samples show settles at the reference. Samples at valley and peak do not
 * show the ripple of PWM, which has a mean as seen from the rotor: 2.3 % of the rated current at SFFR 5. With
 * iqfoc_tuned_ripple the true mean settles at the reference.
 *
 *     static const iqfoc_tuned_law_t law = IQFOC_TUNED_LAW;           the header of `iqfoc tune`
 *     tuned = iqfoc_tuned_at_speed(&law, speed);                       when the speed changes: a slower task
 *     iqfoc_tuned_ripple(&state, iqfoc_ripple_seen(...));              at each valley: of the cycle that ends
 *     u = iqfoc_tuned_step(&state, &tuned, i, u_now, i_ref, theta);    at each valley, acts from the next one
 *     iqfoc_tuned_peak(&state, i, theta);                              at each peak
 */
#ifndef IQFOC_TUNED_CONTROL_H
#define IQFOC_TUNED_CONTROL_H

#include "iq24_math.h"
#include "predictor_salient.h"
#include "transform.h"
#include "valley_reference.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The machine and the design of the controller. The machine's k_d and k_q: 1/16 ... 16. */
typedef struct iqfoc_tuned_law {
    iqfoc_salient_machine_t machine;
    iq24_t keep;   /* pole radius: share of a current error that remains after one cycle, 0 ... 1 */
    iq24_t follow; /* pole of the reference filter, 0 ... 1; 0: no filter */
    iq24_t learn;  /* observer gain: share of a prediction error added to the disturbance estimate, 0 ... 1 */
    iq24_t learn_offset; /* gain of the offset estimate of the valleys' current, 0 ... 1; 0: no estimate */
} iqfoc_tuned_law_t;

/* The coefficients at one speed. */
typedef struct iqfoc_tuned {
    iqfoc_salient_t end; /* F, G and m */
    iq24_t voltage_dd;   /* G^-1 */
    iq24_t voltage_dq;
    iq24_t voltage_qd;
    iq24_t voltage_qq;
    iq24_t keep_cos; /* pole keep e^(-j phi): real part, and negative imaginary part */
    iq24_t keep_sin;
    iqfoc_valley_reference_t reference;
    iq24_t
        bow; /* correction coefficient: (mean of a cycle - mean of its ends)/(middle - mean of its ends), 0.63 ... 2/3 */
    iq24_t speed;
    iq24_t follow;
    iq24_t learn;
    iq24_t learn_offset;
} iqfoc_tuned_t;

/* The state. Set it to zero at the start, and after each missed cycle. */
typedef struct iqfoc_tuned_state {
    iqfoc_dq_t drift;  /* disturbance estimate: current per cycle, held to +-4 */
    iqfoc_dq_t offset; /* estimated offset of the valleys' current from the model, held to +-1 */
    iqfoc_dq_t aim;    /* target: mean current of the next cycle */
    iqfoc_dq_t ripple; /* its part of the last cycle's mean; 0: not taken into account */
    iqfoc_dq_t i;      /* at the last valley */
    iqfoc_dq_t i_mid;  /* at the last peak */
    iqfoc_dq_t i_next; /* predicted for the next valley */
    iqfoc_dq_t
        error;      /* prediction error of the last valley without the disturbance estimate: iqfoc/watch.h */
    bool predicted; /* i_next was predicted at the last valley */
    bool has_mid;   /* i_mid was sampled at the peak after it */
} iqfoc_tuned_state_t;

/* Least k_d and k_q of a law's machine. */
#define IQFOC_TUNED_K_LEAST_Q26 (INT32_C(1) << 22)

/* Currents are held to this limit, voltages to twice this limit: above those of any drive. */
#define IQFOC_TUNED_CURRENT_LIMIT IQ24(8.0)
#define IQFOC_TUNED_VOLTAGE_LIMIT IQ24(16.0)

/*
 * The law at a speed.
 *
 * speed: IQ24 turns per control cycle, |speed| <= IQFOC_ROTOR_SPEED_MAX; a larger one is taken as that limit. Largest
 * error: keep_cos and keep_sin 1.1 LSB; of 100000 drawn: of G^-1 1e-7 of its largest entry and 1 LSB (a share as
 * small as the sensors' noise by far), bow 20 LSB. For a slower task: iqfoc_salient_at_speed and four divisions. Copy
 * the result where the valley's interrupt cannot come between.
 */
iqfoc_tuned_t iqfoc_tuned_at_speed(const iqfoc_tuned_law_t *law, iq24_t speed);

/*
 * One control cycle, in its valley's interrupt: the voltage for the cycle after the one that begins now.
 *
 * i: sample at this valley, u_now: the voltage of the cycle that begins: its duties times the measured DC link,
 * |component| <= 1. i_ref: reference of the mean current, rotor frame, |component| <= 8. theta: at this valley. Out: per unit,
 * stationary frame, each component held to +-22.7 (a rotor-frame component to +-16); the modulator may have to
 * shorten it. Currents beyond +-8 count as +-8.
 *
 * Largest error of 100000 drawn, against the five lines above in double with the same coefficients: 8 LSB
 * with machines as in data/motors/ (k 1 ... 3, k_psi <= 2, |i| <= 1); each rounding of a predicted current is
 * multiplied by G^-1.
 *
 * Range: iqfoc_salient_step gives |121|, with the drift 125. |aim| <= 8 makes |valley| <= 11.7 + 3.7 + 1, and
 * keep (|8| + 16.4) sqrt 2 <= 34.6, so `want` is within 51.1; its difference to 125 saturates. |G^-1| <= 32
 * (k >= 1/16 and det G >= 0.6 k_d k_q): 2 * 32 * 128 = 8192 per unit fits the accumulator's 32768.
 */
iqfoc_ab_t iqfoc_tuned_step(iqfoc_tuned_state_t *state, const iqfoc_tuned_t *tuned, iqfoc_ab_t i,
                            iqfoc_ab_t u_now, iqfoc_dq_t i_ref, iq24_t theta);

/*
 * Stores the ripple's part of the mean of the cycle that ends at this valley (iqfoc/ripple.h: iqfoc_ripple_seen of its
 * duties and of the angle at its middle), held to +-2. Call it before the valley's step, in the same interrupt. The
 * offset takes it in with the gain learn_offset. Without this call the mean without ripple settles at the reference.
 */
static inline void iqfoc_tuned_ripple(iqfoc_tuned_state_t *state, iqfoc_dq_t ripple)
{
    state->ripple.d = iq24_clamp(ripple.d, IQ24(-2.0), IQ24(2.0));
    state->ripple.q = iq24_clamp(ripple.q, IQ24(-2.0), IQ24(2.0));
}

/*
 * Stores the sample at the carrier's peak; the next valley's step estimates the offset from it. i: |component| <= 64.
 * Without this call the offset does not change. From the peak's interrupt only.
 */
static inline void iqfoc_tuned_peak(iqfoc_tuned_state_t *state, iqfoc_ab_t i, iq24_t theta)
{
    state->i_mid = iqfoc_park(i, iq24_sincos(theta));
    state->has_mid = true;
}

#ifdef __cplusplus
}
#endif

#endif
