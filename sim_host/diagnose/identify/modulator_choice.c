/* Chooses the modulator by likelihood (modulator_choice.h). */
#include "modulator_choice.h"

#include "base/solve.h"
#include "edge_choice.h"
#include "gram.h"
#include "row_edges.h"

#include <math.h>
#include <stdlib.h>

/* Chi square by which another modulator must at least be better. */
static const double CLEAR = 100.0;

/* Start value of the sensor filter, in cycles: the middle of the usual range. Without a filter no edge is seen. */
static const double LAG_BEGINS = 0.1;

/* Lists the columns of the effects, and moves each effect to where its derivative is not zero. False: out of memory. */
static bool begin(fit_data *d, fit_state *s, unsigned by, int column[], size_t *columns)
{
    *columns = 0;
    if ((by & EDGES_BY_DEAD_TIME) != 0) {
        column[(*columns)++] = P_V_DEAD;
        if (s->z[P_V_DEAD] == 0.0 && !edge_choose(d, s)) {
            return false;
        }
    }
    if ((by & EDGES_BY_SENSOR_LAG) != 0) {
        column[(*columns)++] = P_SENSOR_LAG;
        const bool none = s->z[P_SENSOR_LAG] == 0.0 && d->frame->nominal.sensor_lag_s == 0.0;
        s->z[P_SENSOR_LAG] = none ? LAG_BEGINS : s->z[P_SENSOR_LAG];
    }
    if ((by & EDGES_BY_IRON) != 0) {
        column[(*columns)++] = P_FE;
    }
    return true;
}

/* Residual in chi square if only these effects move, under the rows' edges and the state's noise. False: out of memory. */
static bool left_under(fit_data *d, const fit_state *s, unsigned by, double *left)
{
    int column[3];
    size_t n = 0;
    fit_state trial = *s;
    gram *grams = begin(d, &trial, by, column, &n) ? gram_blocks(d, &trial, column, n) : NULL;
    if (!grams) {
        return false;
    }
    gram sum = {.c = 0.0};
    double step[3];
    for (size_t b = 0; b < d->blocks; b++) {
        gram_add(&sum, &grams[b], n);
        sum.c += grams[b].c;
    }
    free(grams);
    *left = sum.c;
    if (solve_positive(n, COLUMN_COUNT, &sum.h[0][0], sum.g, step)) {
        for (size_t k = 0; k < n; k++) {
            *left -= sum.g[k] * step[k];
        }
    }
    return true;
}

/* Residual of the state itself, in chi square. False: out of memory. */
static bool left_as_it_is(fit_data *d, const fit_state *s, double *left)
{
    gram *grams = gram_blocks(d, s, NULL, 0);
    *left = 0.0;
    for (size_t b = 0; grams && b < d->blocks; b++) {
        *left += grams[b].c;
    }
    free(grams);
    return grams != NULL;
}

bool modulator_choose(fit_data *d, const fit_state *s, unsigned by, double least, bool *changed)
{
    diagnose_rows *r = d->rows;
    const modulator own = r->modulator;
    double left[MODULATORS];
    modulator best = own;
    double bar;
    *changed = false;
    if (!left_as_it_is(d, s, &bar)) {
        return false;
    }
    for (int which = 0; which < (int)MODULATORS; which++) {
        rows_fill_edges(r, d->frame->motor, (modulator)which);
        if (!left_under(d, s, by, &left[which])) {
            return false;
        }
    }
    bar = fmin(bar, left[own]);
    bar -= fmax(CLEAR, least * bar);
    for (int which = 0; which < (int)MODULATORS; which++) {
        if (left[which] < bar && left[which] < left[best]) {
            best = (modulator)which;
        }
    }
    rows_fill_edges(r, d->frame->motor, best);
    *changed = best != own;
    return true;
}
