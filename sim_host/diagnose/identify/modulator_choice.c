/* The modulator by likelihood (modulator_choice.h). */
#include "modulator_choice.h"

#include "edge_choice.h"
#include "gram.h"
#include "row_edges.h"

#include <stdlib.h>

/* Chi square by which another modulator must be the better one. */
static const double CLEAR = 100.0;

/* What a dead time that moves alone leaves under the rows' edges, in the state's deviations. */
static bool left_under(fit_data *d, const fit_state *s, double *left)
{
    const int column[] = {P_V_DEAD};
    fit_state trial = *s;
    if (s->z[P_V_DEAD] == 0.0 && !edge_choose(d, &trial)) {
        return false;
    }
    gram *grams = gram_blocks(d, &trial, column, 1);
    if (!grams) {
        return false;
    }
    double c = 0.0;
    double g = 0.0;
    double h = 0.0;
    for (size_t b = 0; b < d->blocks; b++) {
        c += grams[b].c;
        g += grams[b].g[0];
        h += grams[b].h[0][0];
    }
    free(grams);
    *left = h > 0.0 ? c - g * g / h : c;
    return true;
}

bool modulator_choose(fit_data *d, const fit_state *s, bool *changed)
{
    diagnose_rows *r = d->rows;
    const modulator own = r->modulator;
    double left[MODULATORS];
    modulator best = own;
    *changed = false;
    if (r->recording->duty[0]) {
        return true;
    }
    for (int which = 0; which < (int)MODULATORS; which++) {
        rows_fill_edges(r, d->frame->motor, (modulator)which);
        if (!left_under(d, s, &left[which])) {
            return false;
        }
    }
    for (int which = 0; which < (int)MODULATORS; which++) {
        if (left[which] < left[own] - CLEAR && left[which] < left[best]) {
            best = (modulator)which;
        }
    }
    rows_fill_edges(r, d->frame->motor, best);
    *changed = best != own;
    return true;
}
