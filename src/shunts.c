/* Selection of usable low-side shunts (include/iqfoc/shunts.h). */
#include "iqfoc/shunts.h"

#include <stddef.h>

iqfoc_error_t iqfoc_shunts_check(const iqfoc_shunts_t *shunts)
{
    if (shunts == NULL) {
        return IQFOC_ERROR_NULL;
    }
    return iq24_within(shunts->duty_max, IQ24(0.25), IQ24_ONE) ? IQFOC_OK : IQFOC_ERROR_SHUNTS;
}

uint32_t iqfoc_shunts_usable(const iqfoc_shunts_t *shunts, iqfoc_abc_t duties)
{
    const iq24_t most = shunts->duty_max;
    return (duties.a <= most ? IQFOC_SHUNT_A : 0) | (duties.b <= most ? IQFOC_SHUNT_B : 0) |
           (duties.c <= most ? IQFOC_SHUNT_C : 0);
}

/* -(x + y). Range: |x + y| <= 2^32 in 64 bits, saturated once. */
static iq24_t third(iq24_t x, iq24_t y)
{
    return iq24_sat(-((int64_t)x + y));
}

iqfoc_shunts_currents_t iqfoc_shunts_read(const iqfoc_shunts_t *shunts, iqfoc_abc_t measured,
                                          iqfoc_abc_t duties, iqfoc_abc_t predicted)
{
    iqfoc_shunts_currents_t result = {measured, iqfoc_shunts_usable(shunts, duties), true};
    switch (result.usable) {
    case IQFOC_SHUNT_A | IQFOC_SHUNT_B | IQFOC_SHUNT_C:
        break;
    case IQFOC_SHUNT_B | IQFOC_SHUNT_C:
        result.i.a = third(measured.b, measured.c);
        break;
    case IQFOC_SHUNT_A | IQFOC_SHUNT_C:
        result.i.b = third(measured.a, measured.c);
        break;
    case IQFOC_SHUNT_A | IQFOC_SHUNT_B:
        result.i.c = third(measured.a, measured.b);
        break;
    default:
        result.i = predicted;
        result.measured = false;
        break;
    }
    return result;
}

/*
 * Range: duties within 0 ... 1 and 0 <= shift <= lowest: each difference is within 0 ... 1. The highest goes
 * down with the others, so the line voltages stay.
 */
iqfoc_abc_t iqfoc_shunts_make_room(const iqfoc_shunts_t *shunts, iqfoc_abc_t duties)
{
    const iq24_t low = iq24_min(iq24_min(duties.a, duties.b), duties.c);
    const iq24_t larger = iq24_max(duties.a, duties.b);
    const iq24_t smaller = iq24_min(duties.a, duties.b);
    const iq24_t middle = iq24_max(smaller, iq24_min(larger, duties.c));
    const iq24_t shift = iq24_clamp(middle - shunts->duty_max, 0, low);
    const iqfoc_abc_t moved = {duties.a - shift, duties.b - shift, duties.c - shift};
    return moved;
}
