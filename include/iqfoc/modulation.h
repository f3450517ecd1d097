/*
 * Duties of the three half-bridges for a voltage vector: PWM with min/max zero sequence, and six-step. All functions
 * only read their arguments: any context may call them.
 */
#ifndef IQFOC_MODULATION_H
#define IQFOC_MODULATION_H

#include "transform.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The modulator's result for the inverter. */
typedef struct iqfoc_duties {
    iqfoc_abc_t high; /* high-side duty cycle of each leg: IQ24, 0 ... 1 */
    iq24_t scale;     /* 1, or < 1: the factor by which the modulator shortened the voltage */
} iqfoc_duties_t;

/*
 * The factor that scales a voltage whose phases differ by too much: a little below span_max/span, so that phases
 * multiplied by it and rounded down are not. 1 LSB <= span_max < span; with span_max >= 1/2 the largest error is 7
 * LSB, downwards.
 */
iq24_t iqfoc_modulation_scale(iq24_t span, iq24_t span_max);

/* The lowest and the highest of three phases, which differ by less than 128. */
IQFOC_STEP void iqfoc_modulation_ends(iqfoc_abc_t x, iq24_t *lowest, iq24_t *highest)
{
    iq24_t low = x.c;
    iq24_t high = x.b;
    IQ24_ORDER(low, high);
    *lowest = iq24_min(low, x.a);
    *highest = iq24_max(high, x.a);
}

/* iqfoc_modulate of a voltage over u_dc, v = u u_dc_inverse rounded down. */
IQFOC_STEP iqfoc_duties_t iqfoc_modulate_relative(iqfoc_ab_t v, iq24_t span_max)
{
    iqfoc_abc_t x = iqfoc_clarke_inverse(v);
    iq24_t low;
    iq24_t high;
    iqfoc_modulation_ends(x, &low, &high);
    iq24_t scale = IQ24_ONE;
    const iq24_t span = iq24_sub_wrap(high, low);
    if (span > span_max) {
        scale = iqfoc_modulation_scale(span, span_max);
        x.a = iq24_mul_trunc(x.a, scale);
        x.b = iq24_mul_trunc(x.b, scale);
        x.c = iq24_mul_trunc(x.c, scale);
        iqfoc_modulation_ends(x, &low, &high);
    }
    const iq24_t used = iq24_sub_wrap(high, low);
    /*@ assert duties_apart: used >= 0; */
    const iq24_t shift = iq24_sub_wrap(iq24_asr32(IQ24_ONE - used, 1), low);
    const iqfoc_duties_t duties = {
        {iq24_add_wrap(x.a, shift), iq24_add_wrap(x.b, shift), iq24_add_wrap(x.c, shift)}, scale};
    return duties;
}

/*
 * Centre-aligned PWM with the zero sequence -(max + min)/2 of the three phase voltages, which uses the DC
 * link as fully as space-vector modulation and gives the same switching instants.
 *
 * u: stationary voltage, per unit, |u| <= 32. u_dc_inverse: 1/u_dc in per unit, 0 < u_dc_inverse <= 2. span_max:
 * largest difference of two duties, 0 < span_max <= 1: below 1 it leaves room for sampling and dead time. A voltage
 * beyond the hexagon is shortened at the same angle by the factor scale; 1 means that it was not shortened. Duties
 * lie in [0, 1] for every input in that range. Largest error against double: a duty within the hexagon 3 LSB; for
 * span_max >= 1/2, of 400000 drawn: shortened, 4 LSB + 1.5 LSB per unit of |u| u_dc_inverse; scale 7 LSB (it is
 * rounded down, so that the duties fit).
 *
 * Range: |u u_dc_inverse| <= 64, so |phase| <= 64.1 and span = max - min <= sqrt(3) 64 = 110.9: no sum wraps.
 * With 0 <= span <= 1, (1 - span)/2 >= 0 is the lowest duty and (1 - span)/2 + span <= 1 the highest,
 * exactly: nothing need be clamped after it. Error within the hexagon, all floors: voltage over u_dc 1 LSB,
 * inverse Clarke 1.2 (twice: a phase and the lowest, in which the former partly cancels), the half 0.5.
 */
IQFOC_STEP iqfoc_duties_t iqfoc_modulate(iqfoc_ab_t u, iq24_t u_dc_inverse, iq24_t span_max)
{
    const iqfoc_ab_t v = {iq24_mul_trunc(u.alpha, u_dc_inverse), iq24_mul_trunc(u.beta, u_dc_inverse)};
    return iqfoc_modulate_relative(v, span_max);
}

/*
 * Six-step: the active inverter state nearest to a voltage angle. State k, 0 ... 5, has its vector at k
 * turns/6: (2/3) u_dc e^(j k pi/3) (2016 Section 5.1 prints pi/6; there are six of them in a turn). High-side
 * states in phase order: 100 110 010 011 001 101.
 *
 * angle: IQ24 turns, any (the low 24 bits count). A tie goes to the higher k. Exact.
 */
int32_t iqfoc_six_step_state(iq24_t angle);

/* The duties (0 or 1) of a state 0 ... 5; any other gives all low. scale is 1. */
iqfoc_duties_t iqfoc_six_step_duties(int32_t state);

/*
 * The voltage vector of a state 0 ... 5 for a DC link in per unit, |u_dc| < 64: 0 for another state. Error
 * 0.7 LSB.
 */
iqfoc_ab_t iqfoc_six_step_voltage(int32_t state, iq24_t u_dc);

/*
 * Angle that a turning reference still has to cover before the next state is nearest: IQ24 turns, 0 < result <= 1/6
 * forward, and the same backward for turns_per_cycle < 0. A port divides it by the speed to set its timer. 1/6 turn
 * is no whole number of LSB: exact to 1 LSB.
 */
iq24_t iqfoc_six_step_remaining(iq24_t angle, iq24_t turns_per_cycle);

#ifdef __cplusplus
}
#endif

#endif
