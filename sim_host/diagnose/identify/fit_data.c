/* The data of a fit, its effort and its start (fit_data.h). */
#include "fit_data.h"

#include "model/flux_map.h"
#include "model/iron_branch.h"

#include <math.h>
#include <stdlib.h>

static const double GAIN_START = 0.5;

/*
 * The effort limit. It allows about 1,800 runs through the rows of a fit. On two cores that, the round that has begun and the weighing
 * take at most three seconds. When twice as many rows were fitted, of 220 development recordings with two and three effects twice the
 * limit got as many right, and three quarters of it two fewer.
 */
static const double ENOUGH = 0.9e7;

void fit_data_select(fit_data *d, size_t rows_max)
{
    const diagnose_rows *r = d->rows;
    size_t total = 0;
    for (size_t b = 0; b < r->blocks; b++) {
        total += r->block[b].held_out ? 0 : r->block[b].count;
    }
    const double share = fmin((double)rows_max / fmax((double)total, 1.0), 1.0);
    double due = 0.0; /* blocks of the group that should be selected by now, and were not */
    size_t group = ROWS_MAX_GROUPS;
    d->blocks = d->rows_fitted = 0;
    for (size_t b = 0; b < r->blocks; b++) {
        if (r->block[b].held_out) {
            continue;
        }
        due = r->block[b].group != group ? 1.0 : due + share; /* the first one of each group is fitted */
        group = r->block[b].group;
        if (due >= 1.0) {
            due -= 1.0;
            d->block[d->blocks++] = b;
            d->rows_fitted += r->block[b].count;
        }
    }
    const double rows = fmin((double)d->rows_max, (double)total);
    d->weight = rows_max < d->rows_max ? fmax(rows / fmax((double)d->rows_fitted, 1.0), 1.0) : 1.0;
}

bool fit_data_make(fit_data *d, diagnose_rows *r, const coordinate_frame *f, size_t rows_max, error *e)
{
    *d = (fit_data){.rows = r, .frame = f, .rows_max = rows_max};
    for (size_t b = 0; b < r->blocks; b++) {
        d->longest = r->block[b].count > d->longest ? r->block[b].count : d->longest;
    }
    d->block = calloc(r->blocks + 1, sizeof *d->block);
    d->sums = calloc(r->blocks + 1, sizeof *d->sums);
    d->nodes = calloc(r->nodes, sizeof *d->nodes);
    size_t outputs = OBSERVER_OUTPUTS * d->longest + 1;
    bool complete = d->block && d->nodes && d->sums;
    for (size_t k = 0; k < parallel_workers(); k++) {
        struct fit_work *w = &d->work[k];
        w->base = calloc(outputs, sizeof *w->base);
        w->columns = calloc(outputs * COLUMN_COUNT, sizeof *w->columns);
        w->way = calloc(d->longest + 1, sizeof *w->way);
        w->cycle = calloc(d->longest + 1, sizeof *w->cycle);
        w->own_cycle = calloc(d->longest + 1, sizeof *w->own_cycle);
        w->seen = calloc(d->longest + 1, sizeof *w->seen);
        complete = complete && w->base && w->columns && w->way && w->cycle && w->own_cycle && w->seen;
    }
    if (!complete) {
        fit_data_free(d);
        return error_failure(e, 0, "out of memory for a fit of %zu rows", r->rows);
    }
    fit_data_select(d, rows_max);
    return true;
}

void fit_data_free(fit_data *d)
{
    free(d->block);
    free(d->nodes);
    free(d->sums);
    for (size_t k = 0; k < PARALLEL_MOST; k++) {
        free(d->work[k].base);
        free(d->work[k].columns);
        free(d->work[k].way);
        free(d->work[k].cycle);
        free(d->work[k].own_cycle);
        free(d->work[k].seen);
    }
    *d = (fit_data){0};
}

void fit_spend(fit_data *d, const averaged_drive *drive, size_t ways)
{
    const double dear = (averaged_drive_loses(drive) ? 1.0 : 0.0) + (iron_branch_present(drive) ? 1.0 : 0.0) +
                        (drive->sensor_lag_s != 0.0 ? 1.0 : 0.0) + (flux_map_bends(drive) ? 0.5 : 0.0);
    d->effort += (1.0 + dear) * (double)ways * (double)d->rows_fitted;
}

bool fit_has_spent(const fit_data *d)
{
    return d->effort > ENOUGH + d->granted;
}

void fit_grant(fit_data *d)
{
    /* The whole limit for the first search, half for the second, a quarter for the third. */
    const double share = ldexp(1.0, -(int)d->beginnings);
    d->granted = fmax(d->granted, d->effort + (share - 1.0) * ENOUGH);
    d->beginnings++;
}

fit_state fit_nominal(void)
{
    fit_state s = {0};
    for (size_t g = 0; g < ROWS_MAX_GROUPS; g++) {
        s.noise[g].gain = GAIN_START;
    }
    return s;
}
