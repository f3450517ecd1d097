/*
 * Three Hall sensors to angle and speed: enough to turn, and to start under load.
 *
 *     sector     5     0     1     2     3     4          sensor X is high within a quarter turn of its phase's
 *     A B C     101   100   110   010   011   001         axis; sector k is centred at k/6 turns
 *
 * At the border between two sectors the angle is known; from there it goes on with the speed, and stops at
 * the next border until the sensors say that it was passed. The speed is the angle between the last borders
 * over the time between them, up to six: after a full turn it does not matter how exactly the sensors are
 * placed. A last span that differs by more than half counts alone, as the speed changes. While the next border
 * does not come, the speed falls to what is still possible. After a reversal, and before the second border,
 * there is no speed, and the angle is the middle of the sector: 1/12 turn off at most.
 *
 * theta and turns may be used as they are, or be the measurement of iqfoc/tracker.h.
 */
#ifndef IQFOC_HALLS_H
#define IQFOC_HALLS_H

#include "error.h"
#include "rotor.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_HALLS_SECTORS 6

/* Sensor bits, as iqfoc_halls_step takes them. */
#define IQFOC_HALL_A UINT32_C(1)
#define IQFOC_HALL_B UINT32_C(2)
#define IQFOC_HALL_C UINT32_C(4)

/* Initialiser: sensors where they belong. */
#define IQFOC_HALLS(stall_cycles)                                                                            \
    {                                                                                                        \
        {IQ24(-1.0 / 12.0), IQ24(1.0 / 12.0), IQ24(3.0 / 12.0),                                              \
         IQ24(5.0 / 12.0),  IQ24(7.0 / 12.0), IQ24(9.0 / 12.0)},                                             \
            stall_cycles                                                                                     \
    }

typedef struct iqfoc_halls_config {
    /* Angle of the border between sector k - 1 and sector k, turns: within 1/24 of k/6 - 1/12. */
    iq24_t border[IQFOC_HALLS_SECTORS];
    uint32_t stall_cycles; /* so long without a border is standstill: 1 ... 2^20 */
} iqfoc_halls_config_t;

/* Sticky bits of `faults`. */
#define IQFOC_HALLS_INVALID UINT32_C(1) /* 000 or 111: a wire, or the supply */
#define IQFOC_HALLS_SKIPPED UINT32_C(2) /* a sector was passed over: a wire, interference, or too fast */

/* Times in 1/256 of a cycle. Read theta, turns, faults. */
typedef struct iqfoc_halls {
    const iqfoc_halls_config_t *config;
    iq24_t theta;    /* electrical angle at the last valley, turns */
    iq24_t turns;    /* electrical speed, turns per cycle, |turns| <= 1/3 */
    uint32_t faults; /* write 0 to clear */
    int32_t sector;  /* -1: none seen yet */
    int32_t way;     /* of the last border: 1, -1; 0 none yet */
    uint32_t since;  /* the last border */
    uint32_t count;  /* spans between borders passed in the same way, up to 6 */
    uint32_t next;   /* where in `span` the next one goes */
    uint32_t span[IQFOC_HALLS_SECTORS];
    iq24_t turns_seen; /* the speed between the last borders */
} iqfoc_halls_t;

/* config must outlive it. IQFOC_ERROR_HALLS: a field out of its range. */
iqfoc_error_t iqfoc_halls_init(iqfoc_halls_t *halls, const iqfoc_halls_config_t *config);

/*
 * Once a cycle, at its valley. bits: IQFOC_HALL_* now, other bits do not count; since_q8: time since their
 * last change, in 1/256 of a cycle, as a timer's capture says, read where the bits differ from the last
 * call's; 128 where there is no capture. Beyond 256 it counts as 256.
 *
 * Largest error of the arithmetic: theta 1 LSB per cycle since the border, and 1 LSB; turns 1 LSB.
 */
void iqfoc_halls_step(iqfoc_halls_t *halls, uint32_t bits, uint32_t since_q8);

#ifdef __cplusplus
}
#endif

#endif
