/* iq24.h, iq24_math.h, transform.h, rotor.h. */
#include "any.h"

#include "iqfoc/rotor.h"

/* Sums, products, shifts, clamps: iq24.h, any arguments. */
void prove_sums_and_products(void)
{
    (void)iq24_add_wrap(any(), any());
    (void)iq24_sub_wrap(any(), any());
    (void)iq24_add_sat(any(), any());
    (void)iq24_sub_sat(any(), any());
    /* In two parts that together are all numbers: the sum inside depends on the part. */
    (void)iq24_neg_sat(IQ24_MIN);
    (void)iq24_neg_sat(any_within(IQ24_MIN + 1, IQ24_MAX));
    (void)iq24_mul_trunc(any(), any());
    (void)iq24_mul_round(any(), any());
    (void)iq24_mul_sat(any(), any());
    (void)iq24_mul_high(any(), any());
    (void)iq24_mul_shift(any(), any(), any_count(1, 31));
    (void)iq24_asr32(any(), any_count(0, 31));
    (void)iq24_acc_sat(iq24_acc_mul(any(), any()));
    (void)iq24_acc_join(any(), any_count(0, UINT32_MAX));
    (void)iq24_clamp(any(), -IQ24_ONE, IQ24_ONE);
}

/* Sine and cosine: any angle. */
void prove_sincos(void)
{
    (void)iq24_sincos(any());
}

/* Arc tangent: any vector. */
void prove_atan2(void)
{
    (void)iq24_atan2(any(), any());
}

/* Square root: any argument. */
void prove_sqrt(void)
{
    (void)iq24_sqrt(any());
}

/* Division: any arguments. */
void prove_div(void)
{
    (void)iq24_div(any(), any());
}

/* Rotor movement and the steady state's gain: any speed. */
void prove_rotor(void)
{
    (void)iqfoc_rotor_from_speed(any());
    (void)iqfoc_rotor_steady_gain(any());
}

/* Clarke, Park and their inverses: any phases, vectors within +-64. */
void prove_transforms(void)
{
    (void)iqfoc_clarke2(any(), any());
    (void)iqfoc_clarke3(any_abc(IQ24_MIN, IQ24_MAX));
    (void)iqfoc_clarke_inverse(any_ab(IQ24_MAX));
    (void)iqfoc_park(any_ab(IQ24(64.0)), any_sincos());
    (void)iqfoc_park_inverse(any_dq(IQ24(64.0)), any_sincos());
    const iq24_sincos_t q30 = {any_within(-64 * IQ24_ONE, 64 * IQ24_ONE),
                               any_within(-64 * IQ24_ONE, 64 * IQ24_ONE)};
    (void)iqfoc_park_inverse_q30(any_dq(IQ24(64.0)), q30);
    (void)iqfoc_park_inverse_high(any_dq(IQ24_MAX), q30);
}
