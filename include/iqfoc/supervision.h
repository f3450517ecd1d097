/*
 * Supervision of phases and sensors: status bits for a lost phase and a lost sensor. Their numbers are different from
 * those of the cycle's bits (iqfoc/cycle.h), so that one word holds all.
 *
 * A lost phase carries no current while the others do. At one angle any phase may have zero current, so the means of
 * |i| are compared over windows of half an electrical turn or more. At standstill nothing is judged; there the
 * alignment shows a lost phase (iqfoc/start.h, verdict STUCK).
 *
 * A lost current sensor shows in the sum of three measured currents, which is zero in a machine with a floating star
 * point. With two sensors there is no such sum: a dead sensor then looks like a lost phase.
 *
 * All functions share one state: call them from the cycle's interrupt, or from one task once a cycle.
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
#define IQFOC_STATUS_LOST_ANGLE_SENSOR   UINT32_C(0x00040000) /* set by the firmware: tracker, resolver, ... */
#define IQFOC_STATUS_BREAK               UINT32_C(0x00080000) /* set by the firmware: the break input */

typedef struct iqfoc_supervision_config {
    iq24_t i_least;      /* windows whose largest mean |i| is below this value are not judged: 0 < x <= 16 */
    iq24_t share;        /* a phase below this share of the largest mean is lost: 0 < x <= 1/2; usually 1/8 */
    uint32_t window_min; /* minimum number of cycles of a window: 6 ... 2^20 */
    uint32_t windows_bad; /* bad windows in a row until LOST_PHASE: 1 ... 2^20 */
    iq24_t sum_max;       /* |a + b + c| above this value is bad: 0 < x <= 16 */
    uint32_t sums_bad;    /* cycles in a row until LOST_CURRENT_SENSOR: 1 ... 2^20 */
} iqfoc_supervision_config_t;

/* Read status and phase. */
typedef struct iqfoc_supervision {
    const iqfoc_supervision_config_t *config;
    uint32_t status; /* sticky bits */
    uint32_t phase;  /* bit 0, 1, 2: the lost phases when LOST_PHASE was set */
    int64_t sum_a;   /* sum of |i_a| in this window, Q24; likewise below */
    int64_t sum_b;
    int64_t sum_c;
    int64_t angle;   /* angle covered in this window, Q24 turns */
    uint32_t cycles; /* cycles in this window */
    uint32_t bad_windows;
    uint32_t bad_sums;
} iqfoc_supervision_t;

/* config must outlive it. IQFOC_ERROR_SUPERVISION: a field out of its range. */
iqfoc_error_t iqfoc_supervision_init(iqfoc_supervision_t *supervision,
                                     const iqfoc_supervision_config_t *config);

/* Clears status and state. */
void iqfoc_supervision_clear(iqfoc_supervision_t *supervision);

/*
 * Once a cycle. i: the phase currents, per unit, any; turns: the speed, turns per cycle, |speed| <= 1; running: the
 * gates are on. While they are off nothing is judged, and the window restarts. Returns the sticky bits.
 *
 * A window that the rotor does not turn through within 2^24 cycles restarts.
 */
uint32_t iqfoc_supervision_step(iqfoc_supervision_t *supervision, iqfoc_abc_t i, iq24_t speed, bool running);

#ifdef __cplusplus
}
#endif

#endif
