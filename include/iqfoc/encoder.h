/*
 * An incremental encoder's count to the electrical angle, with its index.
 *
 *     theta = theta_known + pole_pairs (count - count_known)/counts_per_turn        turns
 *
 * A count says how far the shaft went, not where it is: the angle at one count must be known first, from an
 * alignment (iqfoc/start.h) or from the index, whose electrical angle a drive can keep from then on
 * (iqfoc_encoder_index_theta). After that every index pulse shows whether counts were lost or added, and puts
 * the angle right.
 */
#ifndef IQFOC_ENCODER_H
#define IQFOC_ENCODER_H

#include "error.h"
#include "iq24.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iqfoc_encoder_config {
    uint32_t counts_per_turn; /* edges in a turn of the shaft; the counter runs modulo it: 4 ... 65536 */
    uint32_t pole_pairs;      /* 1 ... 64 */
    uint32_t slip_max;        /* counts that an index may be off: its pulse is so wide; 0 ... counts/4 */
    bool index_known;         /* index_theta is known from an earlier alignment */
    iq24_t index_theta;       /* electrical angle at the index, turns */
} iqfoc_encoder_config_t;

/* Read what you like. */
typedef struct iqfoc_encoder {
    const iqfoc_encoder_config_t *config;
    uint64_t turns_per_count_q48; /* electrical, rounded down */
    uint32_t count_known;
    iq24_t theta_known;   /* electrical angle there */
    bool referenced;      /* theta_known is true: the angle may be used */
    bool indexed;         /* the index was seen */
    uint32_t index_count; /* where */
    int32_t slip;         /* of the last index pulse: counts too many (positive) or too few */
    uint32_t slips;       /* index pulses that were off by more than slip_max; stops at its end */
} iqfoc_encoder_t;

/* Begins, without a reference. config must outlive it. IQFOC_ERROR_ENCODER: a field out of its range. */
iqfoc_error_t iqfoc_encoder_init(iqfoc_encoder_t *encoder, const iqfoc_encoder_config_t *config);

/*
 * Electrical angle of a count, turns: any number of whole ones. count: below counts_per_turn. Largest error:
 * 0.51 LSB.
 */
iq24_t iqfoc_encoder_theta(const iqfoc_encoder_t *encoder, uint32_t count);

/* At this count (below counts_per_turn) the electrical angle is theta: the alignment's result. */
void iqfoc_encoder_align(iqfoc_encoder_t *encoder, uint32_t count, iq24_t theta);

/*
 * The index pulse came at this count (below counts_per_turn), as the counter's capture says. The first is the
 * reference, if config->index_known. A later one further off than slip_max moves the reference along and is
 * counted in `slips`. True if it was in its place or the first.
 */
bool iqfoc_encoder_index(iqfoc_encoder_t *encoder, uint32_t count);

/* Electrical angle at the index, to be kept for the next start; 0 before both alignment and index were. */
iq24_t iqfoc_encoder_index_theta(const iqfoc_encoder_t *encoder);

#ifdef __cplusplus
}
#endif

#endif
