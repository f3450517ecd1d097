/*
 * The current controller that `iqfoc tune` makes: a complex-vector PI controller with active resistance, or
 * deadbeat control with a learnt drift, by the exact model of a machine with or without saliency.
 *
 * At valley k the voltage v_k of the cycle that begins is decided already. In the rotor's frame, each voltage
 * seen at the start of its own cycle, the machine is (iqfoc/predictor_salient.h)
 *
 *     i_(k+1) = F i_k + G v_k + m + drift
 *
 * and the controller is that equation twice, once for what comes and once for what is wanted:
 *
 *     drift  += learn (i_k - i^_k)                                what the model gets wrong, learnt
 *     i^_(k+1) = F i_k + G v_k + m + drift                        where the current will be
 *     aim_(k+2) = follow aim_(k+1) + (1 - follow) i_ref           where the reference's filter wants the mean
 *     want    = valley(aim_(k+2)) + keep e^(-j phi) (i^_(k+1) - valley(aim_(k+1)))
 *     v_(k+1) = G^-1 (want - F i^_(k+1) - m - drift)
 *
 * The loop has the poles keep e^(-j phi), 1 - learn and 0, and answers to its reference by the pole `follow`
 * and one cycle of delay. A pole at keep e^(-j phi) in the rotor's frame is real in the stationary one: it is
 * what a resistance would do that is added to the winding. Written with an integrator it is the state feedback
 * of M. Hinkkanen et al., "Current control for synchronous motor drives: direct discrete-time pole-placement
 * design", IEEE Trans. Ind. Appl. 52(2), 2016, pp. 1530-1541, with that pole turned (docs/tune.md); written so,
 * a voltage that the modulator had to shorten needs no anti-windup, since v_k is what stood.
 *
 * Torque follows the cycle's mean. valley(aim) is the current at the valleys whose mean is aim
 * (iqfoc/valley_reference.h) plus `offset`, which is learnt from the samples at the carrier's peak: whatever
 * the model believes, the mean that three samples show is what settles at the reference.
 *
 *     static const iqfoc_tuned_law_t law = IQFOC_TUNED_LAW;           the header of `iqfoc tune`
 *     tuned = iqfoc_tuned_at_speed(&law, turns);                       where the speed changes: a slower task
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

/* The machine and the design. The machine's k_d and k_q: 1/16 ... 16. */
typedef struct iqfoc_tuned_law {
    iqfoc_salient_machine_t machine;
    iq24_t keep;         /* share of an error of the current that a cycle leaves, 0 ... 1 */
    iq24_t follow;       /* the same of the reference's filter, 0 ... 1; 0: none */
    iq24_t learn;        /* of a prediction error, into the drift, 0 ... 1 */
    iq24_t learn_offset; /* of the valley's offset, 0 ... 1; 0: the model's alone */
} iqfoc_tuned_law_t;

/* The law at a speed. */
typedef struct iqfoc_tuned {
    iqfoc_salient_t end; /* F, G and m */
    iq24_t voltage_dd;   /* G^-1 */
    iq24_t voltage_dq;
    iq24_t voltage_qd;
    iq24_t voltage_qq;
    iq24_t keep_cos; /* keep e^(-j phi): its real part, and the imaginary one's opposite */
    iq24_t keep_sin;
    iqfoc_valley_reference_t reference;
    iq24_t bow; /* mean of a cycle less that of its ends, over middle less ends: 0.63 ... 2/3 */
    iq24_t turns;
    iq24_t follow;
    iq24_t learn;
    iq24_t learn_offset;
} iqfoc_tuned_t;

/* Zero it to begin anew, and whenever a cycle was missed. */
typedef struct iqfoc_tuned_state {
    iqfoc_dq_t drift;  /* current per cycle, held to +-4 */
    iqfoc_dq_t offset; /* valley less its model, held to +-1 */
    iqfoc_dq_t aim;    /* mean wanted of the cycle that comes */
    iqfoc_dq_t i;      /* at the last valley */
    iqfoc_dq_t i_mid;  /* at the last peak */
    iqfoc_dq_t i_next; /* predicted for the next valley */
    iqfoc_dq_t error;  /* what the model without the drift got wrong of the last valley: iqfoc/watch.h */
    bool predicted;    /* i_next is of the last valley */
    bool has_mid;      /* i_mid is of the peak after it */
} iqfoc_tuned_state_t;

/* Least k_d and k_q of a law's machine. */
#define IQFOC_TUNED_K_LEAST_Q26 (INT32_C(1) << 22)

/* Currents are held to this, voltages to twice of it: beyond what any drive carries. */
#define IQFOC_TUNED_CURRENT_LIMIT IQ24(8.0)
#define IQFOC_TUNED_VOLTAGE_LIMIT IQ24(16.0)

/*
 * The law at a speed.
 *
 * turns: IQ24 turns per control cycle, |turns| <= IQFOC_ROTOR_TURNS_MAX; a larger one is taken as that limit.
 * Largest error: keep_cos and keep_sin 1.1 LSB; of 100000 drawn: of G^-1 1e-7 of its largest entry and 1
 * LSB (a share as small as the sensors' noise by far), bow 20 LSB. For a slower task:
 * iqfoc_salient_at_speed and four divisions.
 */
iqfoc_tuned_t iqfoc_tuned_at_speed(const iqfoc_tuned_law_t *law, iq24_t turns);

/*
 * One control cycle at its valley: the voltage for the cycle after the one that begins now.
 *
 * i: sample at this valley, u_now: the voltage of the cycle that begins, as the modulator made it, |component|
 * <= 1. i_ref: mean current wanted, rotor frame, |component| <= 8. theta: at this valley. Out: per unit,
 * stationary frame, each component held to +-22.7 (a rotor-frame component to +-16); the modulator may have to
 * shorten it. Currents beyond +-8 count as +-8.
 *
 * Largest error of 100000 drawn, against the five lines above in double with the same coefficients: 8 LSB
 * with machines as in motors/ (k 1 ... 3, k_psi <= 2, |i| <= 1); each rounding of a predicted current is
 * multiplied by G^-1.
 *
 * Range: iqfoc_salient_step gives |121|, with the drift 125. |aim| <= 8 makes |valley| <= 11.7 + 3.7 + 1, and
 * keep (|8| + 16.4) sqrt 2 <= 34.6, so `want` is within 51.1; its difference to 125 saturates. |G^-1| <= 32
 * (k >= 1/16 and det G >= 0.6 k_d k_q): 2 * 32 * 128 = 8192 per unit fits the accumulator's 32768.
 */
iqfoc_ab_t iqfoc_tuned_step(iqfoc_tuned_state_t *state, const iqfoc_tuned_t *tuned, iqfoc_ab_t i,
                            iqfoc_ab_t u_now, iqfoc_dq_t i_ref, iq24_t theta);

/*
 * The sample at the carrier's peak, which the next valley's step takes the mean's offset from. i: |component|
 * <= 64. Without this call the offset stays where it is.
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
