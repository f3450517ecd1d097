/* Adaptation of resistance and magnet flux (include/iqfoc/adapt.h). */
#include "iqfoc/adapt.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/rotor.h"

/* Two components over the noise of a sample, Q16. */
typedef struct components {
    int32_t d, q;
} components;

#define HELD_Q16 INT64_C(0x7FFFFF) /* 128 */

/* x times a factor, over 2^bits, held to +-128 in Q16. Range: below 2^31 each. */
static int32_t held(iq24_t x, int32_t factor, uint32_t bits)
{
    const int64_t product = iq24_asr64((int64_t)x * factor, bits);
    return (int32_t)(product > HELD_Q16 ? HELD_Q16 : product < -HELD_Q16 ? -HELD_Q16 : product);
}

/* Q32. Range: 2^23 each, so that the sum of two is within 2^47. */
static int64_t product_of(components a, components b)
{
    return (int64_t)a.d * b.d + (int64_t)a.q * b.q;
}

/* The block's mean error at mid-cycle in flux, as in the change detector's first signatures. Sums of 32 in Q48. */
static components error_of(const iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t speed)
{
    const uint32_t bits = IQ24_FRACTION_BITS + IQFOC_WATCH_BLOCK_BITS;
    const iqfoc_dq_t e = {iq24_sat(iq24_asr64(watch->alpha_cos + watch->beta_sin, bits)),
                          iq24_sat(iq24_asr64(watch->beta_cos - watch->alpha_sin, bits))};
    const iqfoc_ab_t at_mid = iqfoc_park_inverse(e, iq24_sincos(iq24_asr32(speed, 1)));
    const components y = {
        held(iq24_mul_shift(at_mid.alpha, config->flux_d_q16, 16), config->per_noise_q8, 16),
        held(iq24_mul_shift(at_mid.beta, config->flux_q_q16, 16), config->per_noise_q8, 16)};
    return y;
}

/*
 * gain unit (x y)/most. Range: |x| |y|/(|x|^2 + 2^28) is at most |y|/2^15, at |x| = 2^14, and |y| is below 2^23.5: within
 * 362. most is 2^28 ... 2^48 + 2^28, shifted to 2^26 ... 2^30, and the quotient, over 256, is within 2; gain times quotient
 * is within 2^49 in Q48, and in Q32 times the unit within 2^56.
 */
static iq24_t step_of(iq24_t gain, iq24_t unit, int64_t xy_q32, int64_t most_q32)
{
    uint32_t bits = 0;
    while (iq24_asr64(most_q32, bits) > (INT64_C(1) << 30)) {
        bits += 4;
    }
    const iq24_t part =
        iq24_div(iq24_sat(iq24_asr64(xy_q32, bits + 8)), iq24_wrap(iq24_asr64(most_q32, bits)));
    const int64_t of_unit = iq24_asr64(IQ24_MUL64(gain, part), 16) * unit;
    return iq24_sat(iq24_asr64(of_unit + (INT64_C(1) << 23), 24));
}

static bool is_learnt_from(const iqfoc_watch_t *watch)
{
    const iq24_t square =
        iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(watch->i[0], watch->i[0]), watch->i[1], watch->i[1]));
    return watch->blocks >= 1 && watch->naming == 0 && watch->group == IQFOC_WATCH_NONE &&
           square >= IQ24(0.0225);
}

void iqfoc_adapt_block(iqfoc_adapt_t *adapt, const iqfoc_adapt_config_t *config, const iqfoc_watch_t *watch,
                       const iqfoc_watch_config_t *watch_config, iq24_t speed)
{
    if (!is_learnt_from(watch)) {
        return;
    }
    const iq24_t at_end = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    const iq24_t middle = iq24_sub_wrap(at_end, iq24_asr32(iq24_sub_wrap(at_end, watch->speed), 1));
    const int32_t size_r = watch_config->size_q16[IQFOC_WATCH_RESISTANCE];
    const int32_t size_psi = watch_config->size_q16[IQFOC_WATCH_FLUX];
    const components x_r = {held(-watch->i[0], size_r, 22), held(-watch->i[1], size_r, 22)};
    const components x_psi = {0, held(-middle, size_psi, 25)};
    const components y = error_of(watch, watch_config, middle);
    const int64_t most = product_of(x_r, x_r) + product_of(x_psi, x_psi) + IQFOC_ADAPT_FLOOR_Q32;
    const iq24_t r = step_of(config->gain, IQ24(IQFOC_ADAPT_R), product_of(x_r, y), most);
    const iq24_t psi = step_of(config->gain, IQ24(IQFOC_ADAPT_PSI), product_of(x_psi, y), most);
    adapt->r = iq24_clamp(iq24_add_sat(adapt->r, r), config->r_low, config->r_high);
    adapt->psi = iq24_clamp(iq24_add_sat(adapt->psi, psi), config->psi_low, config->psi_high);
}

/* x (1 + change), held to 2^30. Range: |change| <= 1. */
static int32_t changed(int32_t x, iq24_t change)
{
    const int64_t y = x + iq24_asr64((int64_t)x * change, IQ24_FRACTION_BITS);
    return (int32_t)(y > (INT64_C(1) << 30) ? (INT64_C(1) << 30) : y < 0 ? 0 : y);
}

iqfoc_tuned_law_t iqfoc_adapt_law(const iqfoc_tuned_law_t *nominal, const iqfoc_adapt_t *adapt)
{
    iqfoc_tuned_law_t law = *nominal;
    law.machine.rho_d_q30 = changed(law.machine.rho_d_q30, adapt->r);
    law.machine.rho_q_q30 = changed(law.machine.rho_q_q30, adapt->r);
    law.machine.k_psi_d_q27 = changed(law.machine.k_psi_d_q27, adapt->psi);
    law.machine.k_psi_q_q27 = changed(law.machine.k_psi_q_q27, adapt->psi);
    return law;
}
