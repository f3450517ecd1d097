/* Prediction by flux linkage (include/iqfoc/flux_predictor.h). */
#include "iqfoc/flux_predictor.h"

#include "iqfoc/extension_params.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include "flux_step.h"

#include <stddef.h>

/* Limit of a predicted current: above any sensor's range, within the range of the transforms. */
#define CURRENT_MAX IQ24(32.0)

static bool reciprocal(iq24_t l, iq24_t k)
{
    return iq24_within(l, IQ24(IQFOC_MIN_FLUX_L), IQ24(IQFOC_MAX_FLUX_L)) &&
           iq24_within(k, IQ24(1.0 / IQFOC_MAX_FLUX_L), IQ24(1.0 / IQFOC_MIN_FLUX_L)) &&
           iq24_within(iq24_mul_round(l, k), IQ24(0.9990234375), IQ24(1.0009765625));
}

/* True if skew is (l_d - l_q)/(l_d + l_q), or 0 (allowed without saturation). The sum is at most 16. */
static bool skewed(const iqfoc_flux_predictor_t *p)
{
    const iq24_t off = iq24_sub_wrap(iq24_mul_round(p->skew, p->l_d + p->l_q), p->l_d - p->l_q);
    return p->skew == 0 || (iq24_within(p->skew, -IQ24_ONE + 1, IQ24_ONE - 1) &&
                            iq24_within(off, IQ24(-0.0009765625), IQ24(0.0009765625)));
}

iqfoc_error_t iqfoc_flux_predictor_check(const iqfoc_flux_predictor_t *p)
{
    if (p == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!reciprocal(p->l_d, p->k_d)) {
        return IQFOC_ERROR_INDUCTANCE_D;
    }
    if (!reciprocal(p->l_q, p->k_q) || !skewed(p)) {
        return IQFOC_ERROR_INDUCTANCE_Q;
    }
    if (!iq24_within(p->r, 0, IQ24(IQFOC_MAX_FLUX_R))) {
        return IQFOC_ERROR_RESISTANCE;
    }
    return iq24_within(p->psi, 0, IQ24(IQFOC_MAX_FLUX_PSI)) ? IQFOC_OK : IQFOC_ERROR_FLUX;
}

/*
 * s times the current's square by the energy, (1 + skew) i_d^2 + (1 - skew) i_q^2. Range: |component| <= 32 and
 * |skew| < 1, so a weighted component is within 64 and the sum within 2 * 64 * 32 = 4096 in the accumulator;
 * both roundings saturate.
 */
static iq24_t saturation_of(const iqfoc_flux_predictor_t *p, iq24_t s, iqfoc_dq_t i)
{
    const iq24_t d = iq24_mul_round(IQ24_ONE + p->skew, i.d);
    const iq24_t q = iq24_mul_round(IQ24_ONE - p->skew, i.q);
    return iq24_mul_sat(s, iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(d, i.d), q, i.q)));
}

static iqfoc_ab_t flux_of(const iqfoc_flux_predictor_t *p, iq24_t s, iqfoc_ab_t i, iq24_sincos_t sc)
{
    const iqfoc_dq_t i_dq = iqfoc_park(i, sc);
    iqfoc_dq_t flux = {iq24_mul_round(p->l_d, i_dq.d), iq24_mul_round(p->l_q, i_dq.q)};
    if (s != 0) {
        const iq24_t rise =
            iq24_clamp(saturation_of(p, s, i_dq), 0, IQ24_ONE); /* the law ends at |i| = I_sat */
        const iq24_t fall = iq24_div(IQ24_ONE, IQ24_ONE + rise);
        flux.d = iq24_mul_round(flux.d, fall);
        flux.q = iq24_mul_round(flux.q, fall);
    }
    flux.d = iq24_add_sat(flux.d, p->psi);
    return iqfoc_park_inverse(flux, sc);
}

static iq24_t held(iq24_t i)
{
    return iq24_clamp(i, -CURRENT_MAX, CURRENT_MAX);
}

static iqfoc_ab_t current_of(const iqfoc_flux_predictor_t *p, iq24_t s, iqfoc_ab_t flux, iq24_sincos_t sc)
{
    const iqfoc_dq_t x = iqfoc_park(flux, sc);
    iqfoc_dq_t i = {held(iq24_mul_sat(iq24_sub_sat(x.d, p->psi), p->k_d)), held(iq24_mul_sat(x.q, p->k_q))};
    if (s != 0) {
        /* 0.25 is the turning point of the law: |i| = I_sat, factor 2. */
        const iq24_t x4 = 4 * iq24_clamp(saturation_of(p, s, i), 0, IQ24(0.25));
        const iq24_t factor = iq24_div(2 * IQ24_ONE, IQ24_ONE + iq24_sqrt(IQ24_ONE - x4));
        i.d = held(iq24_mul_sat(i.d, factor));
        i.q = held(iq24_mul_sat(i.q, factor));
    }
    return iqfoc_park_inverse(i, sc);
}

iqfoc_ab_t iqfoc_flux_predictor_step(const iqfoc_flux_predictor_t *p, const iqfoc_extension_t *extension,
                                     iqfoc_ab_t i, iqfoc_ab_t u, iq24_sincos_t start, iq24_sincos_t end)
{
    const iq24_t s = extension->saturation;
    const iqfoc_ab_t flux = flux_of(p, s, i, start);
    iqfoc_ab_t next =
        current_of(p, s, flux_after_cycle(p->r, flux, iqfoc_extension_acting(extension, u, i), i), end);
    const iqfoc_ab_t mean = flux_mean_current(i, next);
    next =
        current_of(p, s, flux_after_cycle(p->r, flux, iqfoc_extension_acting(extension, u, mean), mean), end);
    return next;
}
