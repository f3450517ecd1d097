/*
 * Is everything still connected? Status bits for a phase and for a sensor that is lost; they stand beside the
 * cycle's own (iqfoc/cycle.h), whose numbers they leave free, so that one word holds all.
 *
 * A lost phase carries no current while the others do. That can be seen only over half an electrical turn, as
 * at one angle any phase may have none: means of |i| are compared over windows that the rotor turns through.
 * At standstill nothing is said; there the alignment shows it (iqfoc/start.h says STUCK).
 *
 * A lost current sensor shows in the sum of three measured currents, which is nought in a machine whose star
 * point floats. Two sensors have no such sum: a dead one then looks like a lost phase.
 */
#ifndef IQFOC_SUPERVISION_H
#define IQFOC_SUPERVISION_H

#include "error.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_STATUS_LOST_PHASE          UINT32_C(0x00010000)
#define IQFOC_STATUS_LOST_CURRENT_SENSOR UINT32_C(0x00020000)
#define IQFOC_STATUS_LOST_ANGLE_SENSOR                                                                       \
    UINT32_C(0x00040000)                        /* the firmware's to set: tracker, resolver, ... */
#define IQFOC_STATUS_BREAK UINT32_C(0x00080000) /* the firmware's: the break input */

typedef struct iqfoc_supervision_config {
    iq24_t i_least;       /* windows whose largest mean |i| is below it say nothing: 0 < x <= 16 */
    iq24_t share;         /* a phase below this share of the largest mean is lost: 0 < x <= 1/2; 1/8 */
    uint32_t window_min;  /* cycles of a window at least: 6 ... 2^20 */
    uint32_t windows_bad; /* in a row until LOST_PHASE: 1 ... 2^20 */
    iq24_t sum_max;       /* |a + b + c| beyond it is wrong: 0 < x <= 16 */
    uint32_t sums_bad;    /* cycles in a row until LOST_CURRENT_SENSOR: 1 ... 2^20 */
} iqfoc_supervision_config_t;

/* Read status and phase. */
typedef struct iqfoc_supervision {
    const iqfoc_supervision_config_t *config;
    uint32_t status; /* sticky bits */
    uint32_t phase;  /* bit 0, 1, 2: the lost ones when LOST_PHASE was set */
    int64_t sum_a;   /* of |i| in this window, Q24 */
    int64_t sum_b;
    int64_t sum_c;
    int64_t angle;   /* that the rotor has turned in it, Q24 turns */
    uint32_t cycles; /* of it */
    uint32_t bad_windows;
    uint32_t bad_sums;
} iqfoc_supervision_t;

/* config must outlive it. IQFOC_ERROR_SUPERVISION: a field out of its range. */
iqfoc_error_t iqfoc_supervision_init(iqfoc_supervision_t *supervision,
                                     const iqfoc_supervision_config_t *config);

/* Clears status and memory. */
void iqfoc_supervision_clear(iqfoc_supervision_t *supervision);

/*
 * Once a cycle. i: the phase currents, per unit, any; turns: the speed, turns per cycle, |turns| <= 1; running:
 * the gates are on - nothing is judged otherwise, and the window begins anew. Returns the sticky bits.
 *
 * A window that the rotor does not turn through within 2^24 cycles begins anew.
 */
uint32_t iqfoc_supervision_step(iqfoc_supervision_t *supervision, iqfoc_abc_t i, iq24_t turns, bool running);

#ifdef __cplusplus
}
#endif

#endif
