/* The limit that the code of the hand-overs holds voltages and fluxes to. */
#ifndef IQFOC_SRC_HELD_H
#define IQFOC_SRC_HELD_H

#include "iqfoc/iq24.h"

static inline iq24_t held_to_8(iq24_t x)
{
    return iq24_clamp(x, IQ24(-8.0), IQ24(8.0));
}

#endif
