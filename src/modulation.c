/*
 * Min/max zero-sequence PWM and six-step (include/iqfoc/modulation.h).
 */
#include "iqfoc/modulation.h"

#include "iqfoc/transform.h"

static iq24_t larger(iq24_t x, iq24_t y)
{
    return x > y ? x : y;
}

static iq24_t smaller(iq24_t x, iq24_t y)
{
    return x < y ? x : y;
}

/* A duty within [0, 1]: the last LSB of the roundings before it must not switch a leg the wrong way. */
static iq24_t duty(iq24_t x)
{
    return iq24_clamp(x, 0, IQ24_ONE);
}

/*
 * Range: |u u_dc_inverse| <= 32 a component, so |phase| <= 43.8 and span = max - min <= sqrt(3) 32 sqrt(2)
 * = 78.4: no sum wraps. 0 < scale < 1 where span > span_max, so what is shortened only gets smaller. Error
 * within the hexagon: voltage over u_dc 0.5 LSB, inverse Clarke 1.2, zero sequence 1.2: together below 3.
 * Shortened: the rounded scale costs 0.5 LSB times the phase's size besides, and the span's own error.
 */
iqfoc_duties_t iqfoc_modulate(iqfoc_ab_t u, iq24_t u_dc_inverse, iq24_t span_max)
{
    const iqfoc_ab_t v = {iq24_mul_round(u.alpha, u_dc_inverse), iq24_mul_round(u.beta, u_dc_inverse)};
    iqfoc_abc_t x = iqfoc_clarke_inverse(v);
    iq24_t high = larger(larger(x.a, x.b), x.c);
    iq24_t low = smaller(smaller(x.a, x.b), x.c);
    iqfoc_duties_t duties = {{0, 0, 0}, IQ24_ONE};
    const iq24_t span = iq24_sub_wrap(high, low);
    if (span > span_max) {
        duties.scale = iq24_div(span_max, span);
        x.a = iq24_mul_round(x.a, duties.scale);
        x.b = iq24_mul_round(x.b, duties.scale);
        x.c = iq24_mul_round(x.c, duties.scale);
        high = iq24_mul_round(high, duties.scale);
        low = iq24_mul_round(low, duties.scale);
    }
    const iq24_t shift = iq24_sub_wrap(IQ24_ONE / 2, iq24_asr32(iq24_add_wrap(high, low), 1));
    duties.high.a = duty(iq24_add_wrap(x.a, shift));
    duties.high.b = duty(iq24_add_wrap(x.b, shift));
    duties.high.c = duty(iq24_add_wrap(x.c, shift));
    return duties;
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
    const iqfoc_ab_t u = {in_phase * iqfoc_mul_q31(u_dc, IQFOC_Q31_1_3),
                          in_quadrature * iqfoc_mul_q31(u_dc, IQFOC_Q31_1_SQRT3)};
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
