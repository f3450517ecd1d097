/*
 * Angle and speed from three Hall sensors. The angle is good enough to run, and to start under load.
 *
 *     sector     5     0     1     2     3     4          sensor X is high within a quarter turn of its phase's
 *     A B C     101   100   110   010   011   001         axis; sector k is centred at k/6 turns
 *
 * At the border between two sectors the angle is known. From there it follows the speed, and stops at the next border
 * until the sensors show that the rotor passed it. The speed is the angle between the last borders, up to six, over
 * the time between them. After a full turn the placement of the sensors has no effect. If the last span differs by
 * more than half, the speed is changing and this span counts alone. While the next border does not come, the speed
 * falls to the largest possible value. After a reversal, and before the second border, there is no speed, and the
 * angle is the middle of the sector, with an error of 1/12 turn at most.
 *
 * Use theta and turns directly, or as the measurement of iqfoc/tracker.h.
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

/* Initialiser: sensors at their nominal places. */
#define IQFOC_HALLS(stall_cycles)                                                                            \
    {                                                                                                        \
        {IQ24(-1.0 / 12.0), IQ24(1.0 / 12.0), IQ24(3.0 / 12.0),                                              \
         IQ24(5.0 / 12.0),  IQ24(7.0 / 12.0), IQ24(9.0 / 12.0)},                                             \
            stall_cycles                                                                                     \
    }

typedef struct iqfoc_halls_config {
    /* Angle of the border between sector k - 1 and sector k, turns: within 1/24 of k/6 - 1/12. */
    iq24_t border[IQFOC_HALLS_SECTORS];
    uint32_t stall_cycles; /* without a border for this time the speed is 0: 1 ... 2^20 */
} iqfoc_halls_config_t;

/* Sticky bits of `faults`. */
#define IQFOC_HALLS_INVALID UINT32_C(1) /* 000 or 111: a wire, or the supply */
#define IQFOC_HALLS_SKIPPED UINT32_C(2) /* a sector was passed over: a wire, interference, or too fast */

/* Times in 1/256 of a cycle. Read theta, turns, faults. */
typedef struct iqfoc_halls {
    const iqfoc_halls_config_t *config;
    iq24_t theta;    /* electrical angle at the last valley, turns */
    iq24_t speed;    /* electrical speed, turns per cycle, |speed| <= 1/3 */
    uint32_t faults; /* write 0 to clear */
    int32_t sector;  /* -1: none seen yet */
    int32_t way;     /* direction at the last border: 1, -1; 0 none yet */
    uint32_t since;  /* time since the last border */
    uint32_t count;  /* spans between borders in the same direction, up to 6 */
    uint32_t next;   /* index in `span` of the next one */
    uint32_t span[IQFOC_HALLS_SECTORS];
    iq24_t speed_seen; /* the speed between the last borders */
} iqfoc_halls_t;

/* config must outlive it. IQFOC_ERROR_HALLS: a field out of its range. Ahead of the first interrupt. */
iqfoc_error_t iqfoc_halls_init(iqfoc_halls_t *halls, const iqfoc_halls_config_t *config);

/*
 * Once a cycle, in its valley's interrupt. bits: IQFOC_HALL_* now; other bits are ignored. since_q8: time since their
 * last change in 1/256 of a cycle, from a timer's capture; 128 without one. It is used only if the bits differ from
 * the last call's. Beyond 256 it counts as 256.
 *
 * Largest error of the arithmetic: theta 1 LSB per cycle since the border, and 1 LSB; speed 1 LSB.
 */
void iqfoc_halls_step(iqfoc_halls_t *halls, uint32_t bits, uint32_t since_q8);

#ifdef __cplusplus
}
#endif

#endif
