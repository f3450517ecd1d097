/* Resolver and sine/cosine encoder (include/iqfoc/resolver.h). */
#include "iqfoc/resolver.h"

#include <stddef.h>

/* Beyond any amplitude that passes: keeps the sum of two squares within its format. */
#define FAR IQ24(4.0)

iqfoc_error_t iqfoc_resolver_check(const iqfoc_resolver_t *resolver)
{
    if (resolver == NULL) {
        return IQFOC_ERROR_NULL;
    }
    const bool good =
        iq24_within(resolver->offset_sin, -FAR, FAR) && iq24_within(resolver->offset_cos, -FAR, FAR) &&
        iq24_within(resolver->gain_sin, IQ24_ONE / 16, 16 * IQ24_ONE) &&
        iq24_within(resolver->gain_cos, IQ24_ONE / 16, 16 * IQ24_ONE) &&
        iq24_within(resolver->amplitude_max, 2, 2 * IQ24_ONE) &&
        iq24_within(resolver->amplitude_min, 1, resolver->amplitude_max - 1) &&
        iq24_within(resolver->ratio, 1, 64) && iq24_within(resolver->theta_0, -IQ24_ONE, IQ24_ONE);
    return good ? IQFOC_OK : IQFOC_ERROR_RESOLVER;
}

static iq24_t scaled(iq24_t voltage, iq24_t offset, iq24_t gain)
{
    return iq24_clamp(iq24_mul_sat(iq24_sub_sat(voltage, offset), gain), -FAR, FAR);
}

/*
 * Range: |x|, |y| <= 4, so that x^2 + y^2 <= 32 in Q48 is 2^53; the limits' squares are at most 2^50. |atan2|
 * <= 2^23, times 64 is 2^29, less 2^24: no wrap.
 */
iqfoc_resolver_angle_t iqfoc_resolver_read(const iqfoc_resolver_t *resolver, iq24_t sin, iq24_t cos)
{
    const iq24_t y = scaled(sin, resolver->offset_sin, resolver->gain_sin);
    const iq24_t x = scaled(cos, resolver->offset_cos, resolver->gain_cos);
    const iq24_acc_t square = iq24_acc_mac(iq24_acc_mul(x, x), y, y);
    const iq24_acc_t least = iq24_acc_mul(resolver->amplitude_min, resolver->amplitude_min);
    const iq24_acc_t most = iq24_acc_mul(resolver->amplitude_max, resolver->amplitude_max);
    const iqfoc_resolver_angle_t angle = {resolver->ratio * iq24_atan2(y, x) - resolver->theta_0,
                                          square >= least && square <= most};
    return angle;
}
