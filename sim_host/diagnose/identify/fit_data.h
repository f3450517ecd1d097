/*
 * What a fit works on and what it improves: the blocks that are fitted, and a state of coordinates and noise.
 *
 * Each group has its own innovation covariance and filter gain, both estimated along with the coordinates.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_FIT_DATA_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_FIT_DATA_H

#include "base/parallel.h"
#include "hypotheses.h"
#include "observer.h"

#include <stdbool.h>

typedef struct group_noise {
    double gain;                 /* of the filter, 1 = trust the sensor alone */
    double cov[3], zero;         /* innovation: aa, ab, bb, and of the three sensors' mean (A^2) */
    double white[3], white_zero; /* whitening: rows of the inverse Cholesky factor 11, 21, 22 */
    double rows;
} group_noise;

typedef struct fit_state {
    hypothesis_set set;
    double z[P_COUNT];
    edge_law edge; /* of a dead time: chosen by likelihood, no number to move */
    group_noise noise[ROWS_MAX_GROUPS];
    double objective; /* sum of n log det cov: -2 log likelihood up to a constant */
} fit_state;

/* What a block adds to its group's sums; summed afterwards in the blocks' order, so that threads change nothing. */
typedef struct block_sums {
    double cov[3], zero, rows;
} block_sums;

typedef struct fit_data {
    diagnose_rows *rows;
    const coordinate_frame *frame;
    size_t *block; /* indices of the blocks that are fitted */
    size_t blocks;
    size_t longest; /* rows of the longest block */
    size_t rows_all;
    double effort;       /* spent: fit_spend */
    double granted;      /* beyond what one search may spend: fit_grant */
    unsigned beginnings; /* so many searches had a grant */
    /* Sums are of the steps by which a search looks (coordinate_look), not of slopes where a state stands. */
    bool searches;
    /* All groups have one noise: what a model that lacks much leaves in each is no measure of how well it is known. */
    bool pooled;
    averaged_node *nodes;
    block_sums *sums; /* one a block */
    /* For one block, by each worker of base/parallel.h. */
    struct fit_work {
        double *base;        /* innovations */
        unsigned char *seen; /* which of its rows have one */
        double *columns;     /* whitened derivatives: [column][3 rows] */
        observer_step *way;  /* of the state's own drive */
        averaged_cycle *cycle;
    } work[PARALLEL_MOST];
} fit_data;

/* At most `rows_max` rows are fitted, evenly spread over the recording. */
bool fit_data_make(fit_data *d, diagnose_rows *r, const coordinate_frame *f, size_t rows_max, error *e);
void fit_data_free(fit_data *d);

/* A start: the motor file's values, every gain one half. */
fit_state fit_nominal(void);

/* Ways of a drive through all blocks: in rows of a plain one, to which a dear law adds about its own time. */
void fit_spend(fit_data *d, const averaged_drive *drive, size_t ways);

/* So much that no search begins that may be left out, nor another round of one. What has begun is ended, and what is named is
 * weighed, as ever. */
bool fit_has_spent(const fit_data *d);

/* For a search that must begin anew, as what it searches in has changed: what is left, and half as much at least as the one before
 * it was granted. However often all begins anew, that is no more than twice what the first may spend. */
void fit_grant(fit_data *d);

static inline averaged_drive fit_drive(const fit_data *d, const fit_state *s)
{
    return coordinates_drive(d->frame, s->z, s->edge);
}

#endif
