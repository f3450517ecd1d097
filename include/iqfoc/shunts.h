/*
 * Phase currents from low-side shunts, sampled at the carrier valley. A leg's shunt carries its phase current only
 * while the leg's low side is on, around the valley, for the share 1 - duty of the period.
 *
 * A sample is usable if that share leaves time on each side of the valley for dead time, settling and conversion:
 * duty <= duty_max. With three usable samples all are used. With two, the third current is the negative of their sum.
 * With fewer, the currents are the drive's own prediction. Which two are usable changes with the sector of the
 * voltage, so the duties select them.
 *
 *     sample.i = iqfoc_shunts_read(&shunts, sample.i, duties_before, predicted).i;
 *     command.duties.high = iqfoc_shunts_make_room(&shunts, command.duties.high);
 *
 * The functions only read their arguments: any context may call them.
 */
#ifndef IQFOC_SHUNTS_H
#define IQFOC_SHUNTS_H

#include "error.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* duty_max = 1 - 2 (dead time + settling + half the sampling)/T: the valley is in the middle of the window. */
typedef struct iqfoc_shunts {
    iq24_t duty_max; /* 0.25 ... 1 */
} iqfoc_shunts_t;

/* Bits of `usable`. */
#define IQFOC_SHUNT_A UINT32_C(1)
#define IQFOC_SHUNT_B UINT32_C(2)
#define IQFOC_SHUNT_C UINT32_C(4)

typedef struct iqfoc_shunts_currents {
    iqfoc_abc_t i;
    uint32_t usable; /* the shunts whose sample was used */
    bool measured;   /* false: fewer than two were usable, i is the prediction */
} iqfoc_shunts_currents_t;

/* IQFOC_ERROR_SHUNTS: duty_max out of its range. Once; the functions below rely on it. */
iqfoc_error_t iqfoc_shunts_check(const iqfoc_shunts_t *shunts);

/* The shunts that are usable at these duties: bits. duties: IQ24, any. Exact. */
uint32_t iqfoc_shunts_usable(const iqfoc_shunts_t *shunts, iqfoc_abc_t duties);

/*
 * Phase currents from the three shunts' samples. measured, predicted: per unit, any; an unusable shunt's reading has
 * no effect. duties: those of the period that ended at the valley, in which the samples settled. Exact; the third
 * current saturates, only if two are beyond +-64.
 */
iqfoc_shunts_currents_t iqfoc_shunts_read(const iqfoc_shunts_t *shunts, iqfoc_abc_t measured,
                                          iqfoc_abc_t duties, iqfoc_abc_t predicted);

/*
 * Duties with the same line voltages, all three lowered by as little as makes two shunts usable: until the middle
 * duty is duty_max, and at most until the lowest is 0. Duties with two usable shunts do not change. So two are usable
 * wherever the middle duty less the lowest is within duty_max: for a voltage of span_max <= duty_max always, where
 * centred duties allow no more than 2 duty_max - 1.
 *
 * duties: 0 ... 1; so is the result. Exact.
 */
iqfoc_abc_t iqfoc_shunts_make_room(const iqfoc_shunts_t *shunts, iqfoc_abc_t duties);

#ifdef __cplusplus
}
#endif

#endif
