/* The law of a dead time near zero current, by likelihood (edge_choice.h). */
#include "edge_choice.h"

#include "fit.h"
#include "gram.h"

#include <math.h>
#include <stdlib.h>

/* Shares of the rated peak current: an ideal switch, a usual one, a slow one. */
static const double knee_share[] = {0.005, 0.02, 0.06, 0.15};
enum { KNEES = sizeof knee_share / sizeof *knee_share };
static const double RIPPLE_START = 0.7;

bool edge_choose(fit_data *d, fit_state *s)
{
    double best = 0.0;
    fit_state chosen = *s;
    for (size_t k = 0; k < KNEES * EDGE_LAWS; k++) {
        fit_state trial = *s;
        const int column[] = {P_V_DEAD};
        trial.edge = (edge_law)(k / KNEES);
        trial.z[P_RIPPLE] = RIPPLE_START;
        trial.z[P_KNEE] = log(knee_share[k % KNEES] * d->frame->i_rated_peak_A / d->frame->nominal.i_knee_A);
        gram *grams = gram_blocks(d, &trial, column, 1);
        if (!grams) {
            return false;
        }
        double g = 0.0;
        double h = 0.0;
        for (size_t b = 0; b < d->blocks; b++) {
            g += grams[b].g[0];
            h += grams[b].h[0][0];
        }
        free(grams);
        if (h > 0.0 && g * g / h > best) {
            best = g * g / h;
            chosen = trial;
        }
    }
    *s = chosen;
    return true;
}

bool edge_revise(fit_data *d, fit_state *s, int refine_steps, edge_contest *last)
{
    const edge_law law = s->edge;
    if (4.0 * fabs(last->objective - s->objective) < last->apart) {
        return true;
    }
    last->apart = INFINITY;
    for (int other = 0; other < (int)EDGE_LAWS; other++) {
        fit_state trial = *s;
        if ((edge_law)other == law) {
            continue;
        }
        trial.edge = (edge_law)other;
        if (!fit_refine(d, &trial, refine_steps)) {
            return false;
        }
        last->apart = fmin(last->apart, fabs(trial.objective - s->objective));
        if (trial.objective < s->objective) {
            *s = trial;
        }
    }
    last->objective = s->objective;
    return true;
}
