/*
 * Electrical angle from the count of an incremental encoder with index.
 *
 *     theta = theta_known + pole_pairs (count - count_known)/counts_per_turn        turns
 *
 * A count shows how far the shaft turned, not its angle. The angle at one count must be known first: from an
 * alignment (iqfoc/start.h) or from the index. A drive can store the electrical angle of the index for later starts
 * (iqfoc_encoder_index_theta). Each later index pulse shows whether counts were lost or added, and corrects the
 * angle.
 *
 * All functions change or read one state: call them from one interrupt, or lock them against each other.
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
    uint32_t slip_max; /* largest count error of an index pulse, which has a width: 0 ... counts_per_turn/4 */
    bool index_known;  /* index_theta is known from an earlier alignment */
    iq24_t index_theta; /* electrical angle at the index, turns */
} iqfoc_encoder_config_t;

/* The state. All fields may be read. */
typedef struct iqfoc_encoder {
    const iqfoc_encoder_config_t *config;
    uint64_t turns_per_count_q48; /* electrical, rounded down */
    uint32_t count_known;
    iq24_t theta_known;   /* electrical angle there */
    bool referenced;      /* theta_known is valid: the angle may be used */
    bool indexed;         /* the index was seen */
    uint32_t index_count; /* count at the index */
    int32_t slip;         /* at the last index pulse: counts too many (positive) or too few (negative) */
    uint32_t slips;       /* index pulses with an error above slip_max; saturates */
} iqfoc_encoder_t;

/*
 * Initialises the state, without a reference. config must outlive it. Ahead of the first interrupt.
 * IQFOC_ERROR_ENCODER: a field out of its range.
 */
iqfoc_error_t iqfoc_encoder_init(iqfoc_encoder_t *encoder, const iqfoc_encoder_config_t *config);

/*
 * Electrical angle of a count, turns: any number of whole ones. count: below counts_per_turn. Largest error:
 * 0.51 LSB.
 */
iq24_t iqfoc_encoder_theta(const iqfoc_encoder_t *encoder, uint32_t count);

/* At this count (below counts_per_turn) the electrical angle is theta: the alignment's result. */
void iqfoc_encoder_align(iqfoc_encoder_t *encoder, uint32_t count, iq24_t theta);

/*
 * The index pulse came at this count (below counts_per_turn), as the counter's capture shows. The first one is the
 * reference if config->index_known. A later one with an error above slip_max moves the reference and counts in
 * `slips`. Returns true for the first one, and for a later one within slip_max.
 */
bool iqfoc_encoder_index(iqfoc_encoder_t *encoder, uint32_t count);

/*
 * Electrical angle at the index; 0 before both alignment and index. The firmware stores it after the first alignment,
 * for index_theta of the next start.
 */
iq24_t iqfoc_encoder_index_theta(const iqfoc_encoder_t *encoder);

#ifdef __cplusplus
}
#endif

#endif
