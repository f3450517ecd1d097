/*
 * Watch of the angle sensor, for drives with a sensor and the observer (iqfoc/sensorless.h). From the observed angle minus the
 * measured one it names an offset, a slip or an eccentricity of the sensor, and the amount. Optional: no other part of the library calls
 * it. The voltage in the stationary frame gives the observed angle, so a fault of the sensor does not move it.
 *
 * The difference is averaged over blocks of whole mechanical revolutions with 64 cycles or more. With s the angle of the shaft, counted
 * from the observed angle:
 *
 *     mean = mean of difference,   (c, s) = 2 mean of (difference - its first one) times (cos s, sin s)
 *
 * An offset or a slip moves the mean. An eccentric sensor makes c and s. Each of the three has a sum for each sign (CUSUM), which is held
 * at 0 from below:
 *
 *     sum = max(0, sum + min(|x| - limit, sum_alarm/4))     alarm: sum >= sum_alarm, so after 4 blocks or more
 *
 * Four blocks after the alarm the fault gets its name:
 *
 *     SLIP         the mean has moved from that of the first block by more than 2 limit: a coupling that slipped, or lost counts
 *     OFFSET       otherwise, if the mean made the alarm: the sensor was off from the first block on
 *     ECCENTRIC    otherwise
 *
 * The observer has an error of its own, the bias: of its parameters, of the dead time, and in an acceleration. |bias| <= a must hold in
 * each block. Then the limit is 3/2 a. An offset is detected from 3 a on, whatever the bias is, and 2 limit > 2 a, so the bias never
 * makes a slip of an offset. A sudden slip is named so from 5 a on; a smaller one may be named an offset.
 *
 * The bound on false alarms. If a difference has sub-Gaussian noise sigma, so has the mean of a block, whatever the correlation within
 * it, and c and s have 4/pi sigma (a mean of |2 cos| times sigma). With l = 2 (limit - a)/noise^2 then E e^(l (x - limit)) <= 1. As for
 * iqfoc/watch.h, with the noise of different blocks independent, the mean time until a sum passes sum_alarm is e^(l sum_alarm) blocks or
 * more: IQFOC_WATCH_ANGLE_CONFIG sets l sum_alarm = 20.66, so 1.5 10^8 blocks until the first of the six. The noise of the observer is
 * correlated over 1/(w T) cycles, which is short against the 64 of a block.
 *
 *     valley:  iqfoc_sensorless_valley(&sensorless, &cycle, &sample);
 *              if (iqfoc_watch_angle_step(&watch, &sensorless)) {
 *                  watch.fault, watch.amount
 *              }
 */
#ifndef IQFOC_WATCH_ANGLE_H
#define IQFOC_WATCH_ANGLE_H

#include "sensorless.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iqfoc_watch_angle_fault {
    IQFOC_WATCH_ANGLE_NONE,
    IQFOC_WATCH_ANGLE_OFFSET,
    IQFOC_WATCH_ANGLE_SLIP,
    IQFOC_WATCH_ANGLE_ECCENTRIC /* once per mechanical revolution */
} iqfoc_watch_angle_fault_t;

/* IQ24. Limits and alarms: 2^-22 ... 1/2 electrical turn. */
typedef struct iqfoc_watch_angle_config {
    int32_t pole_pairs; /* 1 ... 64 */
    iq24_t speed_min;   /* speed in turns per cycle, above 0, up to IQFOC_ROTOR_SPEED_MAX: not judged below */
    iq24_t mean_limit;
    iq24_t mean_alarm;
    iq24_t swing_limit; /* of c and s */
    iq24_t swing_alarm;
} iqfoc_watch_angle_config_t;

/*
 * bias_turns: largest |mean error| of the observer over the drive's speeds, currents, accelerations and parameter errors, and swing_turns
 * its largest error once per mechanical revolution, both in electrical turns (docs/sensorless.md has the errors). noise_turns: rms of the
 * observed angle. speed_min: that of the observer or more.
 */
#define IQFOC_WATCH_ANGLE_CONFIG(pole_pairs, speed_min, bias_turns, swing_turns, noise_turns)                \
    {                                                                                                        \
        pole_pairs, speed_min, IQ24(1.5 * (bias_turns)),                                                     \
            IQ24(20.66 * (noise_turns) * (noise_turns) / (bias_turns)), IQ24(1.5 * (swing_turns)),           \
            IQ24(33.5 * (noise_turns) * (noise_turns) / (swing_turns))                                       \
    }

/* The state. All fields may be read. */
typedef struct iqfoc_watch_angle {
    const iqfoc_watch_angle_config_t *config;
    int64_t sum[3];    /* of the block: of difference - base, the same times cosine, times sine */
    iq24_t mechanical; /* 1/pole pairs */
    iq24_t base;       /* difference at the block's first cycle */
    iq24_t theta;      /* observed, at the last cycle */
    int32_t turn;      /* of the electrical turns of a revolution: 0 ... pole_pairs - 1 */
    int32_t path;      /* electrical turns of the block so far, IQ24, signed: within +-64.5 */
    int32_t count;     /* cycles in the block: 0 ... 32767 */
    int32_t wait;      /* electrical turns until the observer's start has decayed */
    iq24_t x[3];       /* of the last block: mean, c, s */
    iq24_t up[3];      /* the sums of both signs: 0 ... sum_alarm */
    iq24_t down[3];
    iq24_t first;    /* mean of the first block */
    iq24_t moved;    /* largest |mean - first| so far */
    uint32_t blocks; /* judged so far */
    int32_t naming;  /* blocks left until the name; 0: no alarm */
    iqfoc_watch_angle_fault_t fault;
    iqfoc_watch_angle_fault_t alarm; /* OFFSET or ECCENTRIC: the sum that made the alarm */
    iq24_t
        amount; /* observed minus measured, electrical turns: the mean, its change (SLIP), the amplitude (ECCENTRIC) */
} iqfoc_watch_angle_t;

/* IQFOC_OK; IQFOC_ERROR_NULL; IQFOC_ERROR_WATCH_ANGLE: a value outside its range. config must outlive the object. */
iqfoc_error_t iqfoc_watch_angle_init(iqfoc_watch_angle_t *watch, const iqfoc_watch_angle_config_t *config);

/* Forgets blocks, alarm and name: after a new zero of the sensor. */
void iqfoc_watch_angle_reset(iqfoc_watch_angle_t *watch);

/*
 * Call it after each iqfoc_sensorless_valley, in the same context. True in the cycle in which a fault gets its name; after that only a
 * reset starts the watch. A cycle does not count if the observer is not locked, its speed is below speed_min, the gates were off, or a
 * revolution takes more than 32767 cycles. Then the next block starts 4 electrical turns later, when the observer's start has decayed.
 *
 * Largest error of a block of n cycles, of 4000 drawn with |difference - base| <= 1/8: mean 0.6 LSB + 256/n LSB, c and s 4 LSB + 256/n
 * LSB.
 * Range: a difference from base is within 1/2 turn and n below 2^15, so a sum is below 2^38.
 */
bool iqfoc_watch_angle_step(iqfoc_watch_angle_t *watch, const iqfoc_sensorless_t *sensorless);

#ifdef __cplusplus
}
#endif

#endif
