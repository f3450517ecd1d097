/*
 * Small vectors that the library passes by value. All components are IQ24 in per unit (docs/units.md): currents per
 * peak rated current, voltages per nominal DC-link voltage.
 *
 * Frames: `abc` phases; `ab` stationary, alpha on the axis of phase A, beta 90 electrical degrees ahead; `dq` rotor,
 * d on the magnet's flux. The Clarke transform is amplitude invariant: a balanced set of peak I is a vector of length
 * I.
 */
#ifndef IQFOC_VECTOR_H
#define IQFOC_VECTOR_H

#include "iq24.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iqfoc_abc {
    iq24_t a;
    iq24_t b;
    iq24_t c;
} iqfoc_abc_t;

typedef struct iqfoc_ab {
    iq24_t alpha;
    iq24_t beta;
} iqfoc_ab_t;

typedef struct iqfoc_dq {
    iq24_t d;
    iq24_t q;
} iqfoc_dq_t;

#ifdef __cplusplus
}
#endif

#endif
