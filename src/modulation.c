/* Min/max zero-sequence PWM and six-step (include/iqfoc/modulation.h). */
#include "iqfoc/modulation.h"

#include "iqfoc/transform.h"

#include "iq24_longdiv.h"

/*
 * (span_max - 1)/span by long division, rounded down and at most one LSB less: no need to round to nearest
 * what must be too small.
 *
 * Range: 0 <= span_max - 1 < span, so the quotient is in [0, 1) and its three digits are all of it.
 * quotient span <= span_max - 1 in LSB: the phases' new span, which floors can raise by less than 1 LSB, is
 * below span_max.
 */
iq24_t iqfoc_modulation_scale(iq24_t span, iq24_t span_max)
{
    iq24_longdiv_t division = iq24_longdiv_begin(0, (uint32_t)(span_max - 1), (uint32_t)span);
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division);
    /*@ assert longdiv: division.quotient <= 16777216; */
    return (iq24_t)division.quotient;
}

/* The fraction of a turn, [0, 2^24). A mask of the two's complement: exact for negative angles too. */
static int32_t turn_fraction(iq24_t angle)
{
    return (int32_t)((uint32_t)angle & UINT32_C(0x00FFFFFF));
}

/* 6 fraction + half <= 6 2^24 + 2^23 < 2^27; floor division by 2^24 gives 0 ... 6, and 6 is 0 again. */
int32_t iqfoc_six_step_state(iq24_t angle)
{
    const int32_t state = (6 * turn_fraction(angle) + IQ24_ONE / 2) / IQ24_ONE;
    return state == 6 ? 0 : state;
}

/* Leg a is high in states 5 0 1, b in 1 2 3, c in 3 4 5: a bit mask per leg. */
iqfoc_duties_t iqfoc_six_step_duties(int32_t state)
{
    iqfoc_duties_t duties = {{0, 0, 0}, IQ24_ONE};
    duties.high.a = state == 5 || state == 0 || state == 1 ? IQ24_ONE : 0;
    duties.high.b = state >= 1 && state <= 3 ? IQ24_ONE : 0;
    duties.high.c = state >= 3 && state <= 5 ? IQ24_ONE : 0;
    return duties;
}

/*
 * From the legs: alpha = (2 a - b - c) u_dc/3, beta = (b - c) u_dc/sqrt(3).
 * Range: Clarke's precondition holds for legs of +-31.9; the legs' states are 0 or 1, and u_dc is multiplied
 * after.
 */
iqfoc_ab_t iqfoc_six_step_voltage(int32_t state, iq24_t u_dc)
{
    const iqfoc_abc_t legs = iqfoc_six_step_duties(state).high;
    const int32_t in_phase = (2 * legs.a - legs.b - legs.c) / IQ24_ONE; /* -2 ... 2 */
    const int32_t in_quadrature = (legs.b - legs.c) / IQ24_ONE;         /* -1 ... 1 */
    const iqfoc_ab_t u = {in_phase * iq24_mul_shift(u_dc, IQFOC_Q31_1_3, 31),
                          in_quadrature * iq24_mul_shift(u_dc, IQFOC_Q31_1_SQRT3, 31)};
    return u;
}

/*
 * In sixths of an LSB: position within the sector, counted from its lower border at (state - 1/2)/6 turns,
 * which is itself part of the sector: forward the next border must be reached, backward this one must be
 * passed. 6 fraction + half < 2^27; the rest modulo 2^24 is 0 ... 2^24 - 1.
 */
iq24_t iqfoc_six_step_remaining(iq24_t angle, iq24_t turns_per_cycle)
{
    const int32_t covered = (6 * turn_fraction(angle) + IQ24_ONE / 2) % IQ24_ONE;
    return turns_per_cycle < 0 ? covered / 6 + 1 : (IQ24_ONE - covered + 5) / 6;
}
