/* Corrections by the results of a diagnosis (include/iqfoc/extension.h). */
#include "iqfoc/extension.h"

#include "iqfoc/extension_params.h"
#include "iqfoc/transform.h"

#include <stddef.h>

/* Limit of a phase current for the cycle. */
#define CURRENT_MAX IQ24(15.9)

static bool all_within(iqfoc_abc_t x, iq24_t low, iq24_t high)
{
    return iq24_within(x.a, low, high) && iq24_within(x.b, low, high) && iq24_within(x.c, low, high);
}

iqfoc_error_t iqfoc_extension_check(const iqfoc_extension_t *extension)
{
    if (extension == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!all_within(extension->i_offset, IQ24(-IQFOC_MAX_EXT_OFFSET), IQ24(IQFOC_MAX_EXT_OFFSET)) ||
        !all_within(extension->i_gain_inverse, IQ24(IQFOC_MIN_EXT_GAIN), IQ24(IQFOC_MAX_EXT_GAIN))) {
        return IQFOC_ERROR_CURRENT_SENSOR;
    }
    if (!iq24_within(extension->theta_0, IQ24(-IQFOC_MAX_EXT_ANGLE), IQ24(IQFOC_MAX_EXT_ANGLE)) ||
        !iq24_within(extension->theta_delay, IQ24(-IQFOC_MAX_EXT_DELAY), IQ24(IQFOC_MAX_EXT_DELAY))) {
        return IQFOC_ERROR_ANGLE;
    }
    if (!iq24_within(extension->k_u, IQ24(IQFOC_MIN_EXT_GAIN), IQ24(IQFOC_MAX_EXT_GAIN)) ||
        !iq24_within(extension->v_dead, IQ24(-IQFOC_MAX_EXT_VOLTAGE), IQ24(IQFOC_MAX_EXT_VOLTAGE)) ||
        !iq24_within(extension->knee_inverse, 0, IQ24(IQFOC_MAX_EXT_KNEE_INVERSE))) {
        return IQFOC_ERROR_VOLTAGE;
    }
    return iq24_within(extension->saturation, 0, IQ24(IQFOC_MAX_EXT_SATURATION)) ? IQFOC_OK
                                                                                 : IQFOC_ERROR_SATURATION;
}

static iq24_t true_current(iq24_t measured, iq24_t offset, iq24_t gain_inverse)
{
    return iq24_clamp(iq24_mul_round(iq24_sub_sat(measured, offset), gain_inverse), -CURRENT_MAX,
                      CURRENT_MAX);
}

iqfoc_abc_t iqfoc_extension_current(const iqfoc_extension_t *extension, iqfoc_abc_t measured)
{
    const iqfoc_abc_t o = extension->i_offset;
    const iqfoc_abc_t g = extension->i_gain_inverse;
    const iqfoc_abc_t i = {true_current(measured.a, o.a, g.a), true_current(measured.b, o.b, g.b),
                           true_current(measured.c, o.c, g.c)};
    return i;
}

iq24_t iqfoc_extension_angle(const iqfoc_extension_t *extension, iq24_t theta, iq24_t speed)
{
    const iq24_t ahead = iq24_add_wrap(extension->theta_0, iq24_mul_round(extension->theta_delay, speed));
    return iq24_sub_wrap(theta, ahead);
}

void iqfoc_extension_sample(const iqfoc_extension_t *extension, iqfoc_sample_t *sample)
{
    sample->i = iqfoc_extension_current(extension, sample->i);
    if (sample->has_mean) {
        sample->i_mean = iqfoc_extension_current(extension, sample->i_mean);
    }
    sample->theta = iqfoc_extension_angle(extension, sample->theta, sample->speed);
    sample->u_dc = iq24_mul_sat(sample->u_dc, extension->k_u);
}

/* v_dead sat(i / knee). Saturating ahead of the clamp: any current is allowed. */
static iq24_t leg_lost(const iqfoc_extension_t *extension, iq24_t i)
{
    const iq24_t share = iq24_clamp(iq24_mul_sat(i, extension->knee_inverse), -IQ24_ONE, IQ24_ONE);
    return iq24_mul_round(extension->v_dead, share);
}

iqfoc_abc_t iqfoc_extension_lost(const iqfoc_extension_t *extension, iqfoc_abc_t i)
{
    const iqfoc_abc_t lost = {leg_lost(extension, i.a), leg_lost(extension, i.b), leg_lost(extension, i.c)};
    return lost;
}

iqfoc_ab_t iqfoc_extension_acting(const iqfoc_extension_t *extension, iqfoc_ab_t u, iqfoc_ab_t i)
{
    const iqfoc_ab_t lost = iqfoc_clarke3(iqfoc_extension_lost(extension, iqfoc_clarke_inverse(i)));
    const iqfoc_ab_t acting = {iq24_sub_wrap(iq24_mul_round(extension->k_u, u.alpha), lost.alpha),
                               iq24_sub_wrap(iq24_mul_round(extension->k_u, u.beta), lost.beta)};
    return acting;
}

static iq24_t compensated(const iqfoc_extension_t *extension, iq24_t duty, iq24_t i, iq24_t u_dc_inverse)
{
    if (duty <= 0 || duty >= IQ24_ONE) {
        return duty; /* no edge, no dead time */
    }
    const iq24_t more = iq24_mul_round(leg_lost(extension, i), u_dc_inverse);
    return iq24_clamp(iq24_add_wrap(duty, more), 0, IQ24_ONE);
}

void iqfoc_extension_compensate(const iqfoc_extension_t *extension, iqfoc_duties_t *duties, iqfoc_abc_t i,
                                iq24_t u_dc_inverse)
{
    duties->high.a = compensated(extension, duties->high.a, i.a, u_dc_inverse);
    duties->high.b = compensated(extension, duties->high.b, i.b, u_dc_inverse);
    duties->high.c = compensated(extension, duties->high.c, i.c, u_dc_inverse);
}

iqfoc_predictor_t iqfoc_extension_saturate(const iqfoc_extension_t *extension,
                                           const iqfoc_predictor_t *at_zero, iqfoc_ab_t i)
{
    const iq24_t square = iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(i.alpha, i.alpha), i.beta, i.beta));
    const iq24_t rise = iq24_clamp(iq24_mul_sat(extension->saturation, square), 0, IQ24_ONE);
    const iq24_t factor = IQ24_ONE + rise; /* L_0 / L(|i|) */
    const iqfoc_predictor_t p = {
        iq24_clamp(iq24_mul_round(at_zero->k_u, factor), 0, IQ24(IQFOC_MAX_K_U)),
        iq24_clamp(iq24_mul_round(at_zero->k_r, factor), 0, IQ24_ONE),
        iq24_clamp(iq24_mul_round(at_zero->k_psi, factor), 0, IQ24(IQFOC_MAX_K_PSI))};
    return p;
}
