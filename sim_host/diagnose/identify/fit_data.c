/* What a fit works on (fit_data.h). */
#include "fit_data.h"

#include "observer.h"

#include <stdlib.h>

static const double GAIN_START = 0.5;

bool fit_data_make(fit_data *d, diagnose_rows *r, const coordinate_frame *f, size_t rows_max, error *e)
{
    *d = (fit_data){.rows = r, .frame = f};
    size_t total = 0;
    for (size_t b = 0; b < r->blocks; b++) {
        total += r->block[b].held_out ? 0 : r->block[b].count;
    }
    size_t every = total / rows_max + 1;
    d->block = calloc(r->blocks + 1, sizeof *d->block);
    size_t seen = 0;
    for (size_t b = 0; d->block && b < r->blocks; b++) {
        if (r->block[b].held_out) {
            continue;
        }
        if (seen++ % every == 0) {
            d->block[d->blocks++] = b;
            d->longest = r->block[b].count > d->longest ? r->block[b].count : d->longest;
        }
    }
    size_t outputs = OBSERVER_OUTPUTS * d->longest + 1;
    d->nodes = calloc(r->nodes, sizeof *d->nodes);
    d->base = calloc(outputs, sizeof *d->base);
    d->moved = calloc(outputs, sizeof *d->moved);
    d->columns = calloc(outputs * COLUMN_COUNT, sizeof *d->columns);
    d->seen = calloc(d->longest + 1, sizeof *d->seen);
    if (!d->seen || !d->block || !d->nodes || !d->base || !d->moved || !d->columns) {
        fit_data_free(d);
        return error_failure(e, 0, "out of memory for a fit of %zu rows", total);
    }
    return true;
}

void fit_data_free(fit_data *d)
{
    free(d->block);
    free(d->nodes);
    free(d->base);
    free(d->moved);
    free(d->columns);
    free(d->seen);
    *d = (fit_data){0};
}

fit_state fit_nominal(void)
{
    fit_state s = {0};
    for (size_t g = 0; g < ROWS_MAX_GROUPS; g++) {
        s.noise[g].gain = GAIN_START;
    }
    return s;
}
