/*
 * Offsets of the current sensors, measured while no current flows: once at the start, gates off, before the first
 * command. The mean of many samples resolves less than one step of the converter.
 *
 *     offset = mean(measured)           noise = sqrt(mean((measured - offset)^2))
 *
 * Call iqfoc_offset_step once per carrier period with the HAL's currents until the verdict is no longer BUSY. From
 * then on iqfoc_offset_removed gives the current. The same numbers may go to iqfoc_extension_t.i_offset instead. A
 * port with two sensors passes the third current that it computes from them; its offset follows.
 *
 * All functions share one state: call them from the interrupt that samples, iqfoc_offset_removed also from others
 * once the verdict is GOOD.
 */
#ifndef IQFOC_OFFSET_H
#define IQFOC_OFFSET_H

#include "error.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Limits. Per unit of the rated peak current, IQ24. */
typedef struct iqfoc_offset_limits {
    uint32_t settle;     /* samples skipped first, while amplifiers and filters settle; any number */
    uint32_t count_log2; /* then 2^count_log2 samples are averaged: 2 ... 16 */
    iq24_t offset_max;   /* |offset| beyond it is a fault: 0 < x <= 1 */
    iq24_t noise_max;    /* rms noise beyond it is a fault: 0 < x <= 1/8 */
} iqfoc_offset_limits_t;

typedef enum iqfoc_offset_verdict {
    IQFOC_OFFSET_BUSY,         /* needs more samples */
    IQFOC_OFFSET_GOOD,         /* the offsets may be used */
    IQFOC_OFFSET_OUT_OF_RANGE, /* a sensor torn off, its supply missing, or a current that flows */
    IQFOC_OFFSET_NOISY         /* a loose contact, interference, or a current that changes */
} iqfoc_offset_verdict_t;

/* Sums of one sensor's deviations from its first sample. */
typedef struct iqfoc_offset_sums {
    iq24_t first;
    int64_t sum;     /* Q24 */
    int64_t squares; /* Q48 */
    bool far;        /* a deviation beyond 1/8 was seen */
} iqfoc_offset_sums_t;

/* Read verdict, faulty, offset and noise. */
typedef struct iqfoc_offset {
    const iqfoc_offset_limits_t *limits;
    iqfoc_offset_verdict_t verdict; /* of two faults the worse one: out of range */
    uint32_t faulty;                /* bit 0, 1, 2: the verdict's fault is sensor A's, B's, C's */
    iqfoc_abc_t offset;             /* 0 while busy */
    iqfoc_abc_t noise;              /* rms, 0 while busy; 1/8 if a sample deviated by more than that */
    uint32_t seen;                  /* number of samples, skipped ones included */
    iqfoc_offset_sums_t a;
    iqfoc_offset_sums_t b;
    iqfoc_offset_sums_t c;
} iqfoc_offset_t;

/* Begins. limits must outlive the calibration. IQFOC_ERROR_OFFSET_LIMITS: a limit out of its range. */
iqfoc_error_t iqfoc_offset_init(iqfoc_offset_t *offset, const iqfoc_offset_limits_t *limits);

/*
 * One sample. measured: per unit, any; beyond 1/8 from the sensor's first sample it counts as noise. After
 * the verdict nothing changes any more. Largest error: offset 0.5 LSB of the exact mean; noise less than 1
 * LSB below the exact root, and 0.14 LSB above it (by src/offset.c; so found in 3000 runs drawn).
 */
iqfoc_offset_verdict_t iqfoc_offset_step(iqfoc_offset_t *offset, iqfoc_abc_t measured);

/*
 * measured - offset, held to the +-15.9 that a cycle takes. In: any. Exact.
 *
 * Range: the difference saturates.
 */
static inline iqfoc_abc_t iqfoc_offset_removed(const iqfoc_offset_t *offset, iqfoc_abc_t measured)
{
    const iq24_t most = IQ24(15.9);
    const iqfoc_abc_t i = {iq24_clamp(iq24_sub_sat(measured.a, offset->offset.a), -most, most),
                           iq24_clamp(iq24_sub_sat(measured.b, offset->offset.b), -most, most),
                           iq24_clamp(iq24_sub_sat(measured.c, offset->offset.c), -most, most)};
    return i;
}

#ifdef __cplusplus
}
#endif

#endif
