/*
 * The data of a fit and its state: the blocks that are fitted, and the coordinates and the noise that the fit improves.
 *
 * Each group has its own innovation covariance and observer gain. Both are estimated together with the coordinates.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_FIT_DATA_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_FIT_DATA_H

#include "base/parallel.h"
#include "hypotheses.h"
#include "observer.h"

#include <stdbool.h>

typedef struct group_noise {
    double gain;                 /* observer gain; 1 trusts the sensor alone */
    double cov[3], zero;         /* innovation: aa, ab, bb, and of the three sensors' mean (A^2) */
    double white[3], white_zero; /* whitening: rows of the inverse Cholesky factor 11, 21, 22 */
    double rows, counted;        /* as in block_sums */
} group_noise;

typedef struct fit_state {
    hypothesis_set set;
    double z[P_COUNT];
    edge_law edge; /* edge model of a dead time: chosen by likelihood, not a coordinate */
    group_noise noise[ROWS_MAX_GROUPS];
    double objective; /* sum of n log det cov: -2 log likelihood up to a constant */
} fit_state;

/*
 * What a block adds to its group's sums. They are added in the order of the blocks, so that the number of threads does not change the
 * result.
 */
typedef struct block_sums {
    double cov[3], zero;
    double rows, counted; /* rows with an innovation; the sum of the shares of it that are counted */
} block_sums;

typedef struct fit_data {
    diagnose_rows *rows;
    const coordinate_frame *frame;
    size_t *block; /* indices of the blocks that are fitted */
    size_t blocks;
    size_t longest;      /* rows of the longest block, fitted or not */
    size_t rows_fitted;  /* in those blocks */
    size_t rows_max;     /* of fit_data_make */
    double weight;       /* what a row counts in the objective and in all sums: fit_data_select */
    double effort;       /* so far, in rows: fit_spend */
    double granted;      /* in addition to the limit of one search: fit_grant */
    unsigned beginnings; /* number of grants */
    /* True: derivatives over the steps of a search (coordinate_look); false: slopes at the state. */
    bool searches;
    /* True: all groups share one noise. If the residual of a model is large, the residual of a group does not show its noise. */
    bool pooled;
    averaged_node *nodes;
    block_sums *sums; /* one a block */
    /* Work space of each worker of base/parallel.h, for one block. */
    struct fit_work {
        double *base;       /* innovations */
        double *seen;       /* the share of each row's innovation that is counted */
        double *columns;    /* whitened derivatives: [column][3 rows] */
        observer_step *way; /* run of the state's own drive */
        averaged_cycle *cycle, *own_cycle;
    } work[PARALLEL_MOST];
} fit_data;

/* Selects the blocks to fit: at least one of each group, evenly spread, with about `rows_max` rows at most. */
bool fit_data_make(fit_data *d, diagnose_rows *r, const coordinate_frame *f, size_t rows_max, error *e);
void fit_data_free(fit_data *d);

/*
 * Selects again, at most d->rows_max. What is left out is made up for by the weight of the other rows: the objective is about that of
 * d->rows_max, and so what a cause must reduce it by stays in proportion.
 */
void fit_data_select(fit_data *d, size_t rows_max);

/* The start of a fit: the nominal model, with gains of 0.5. */
fit_state fit_nominal(void);

/*
 * Adds the effort of `ways` runs of a drive through all fitted blocks. Its unit is a row of a simple drive; a costly model adds about
 * the time that it needs.
 */
void fit_spend(fit_data *d, const averaged_drive *drive, size_t ways);

/*
 * True once the effort limit is reached: skip optional searches and further rounds. A round that has begun is finished, and the
 * causes are weighed as usual.
 */
bool fit_has_spent(const fit_data *d);

/*
 * Grants effort to a search that must start again because its data has changed: all that is left, and at least half of what the
 * search before it was granted. However many searches start, their sum is at most twice the limit of the first.
 */
void fit_grant(fit_data *d);

static inline averaged_drive fit_drive(const fit_data *d, const fit_state *s)
{
    return coordinates_drive(d->frame, s->z, s->edge);
}

#endif
