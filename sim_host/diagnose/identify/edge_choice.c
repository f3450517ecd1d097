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

/* Each edge's own current sees all of the ripple, and no knee but the filter's error and the dead time's length. */
static const double FOUND_KNEE_SHARE = 0.01;
static const double FOUND_RIPPLE = 1.0;
/* A compensation of twice what is lost. */
static const double DEAD_SHARE_START = 1.0;

static void set_knee(const fit_data *d, fit_state *s, double share)
{
    s->z[P_KNEE] = log(share * d->frame->i_rated_peak_A / d->frame->nominal.i_knee_A);
}

/* Whether a dead time of this sign can follow a law. Each edge's own current is followed behind an over-compensation alone:
 * without one (a share of -1) it fits better, and lets a voltage gain with an inductance pass for a flux. */
static bool law_allows(edge_law law, double v_dead)
{
    return law != EDGE_OVER || v_dead < 0.0;
}

bool edge_choose(fit_data *d, fit_state *s)
{
    double best = 0.0;
    fit_state chosen = *s;
    if (d->frame->nominal.v_dead_V != 0.0) {
        s->edge = d->frame->nominal.edge;
        return true;
    }
    for (size_t k = 0; k < KNEES * EDGE_LAWS; k++) {
        fit_state trial = *s;
        const int column[] = {P_V_DEAD};
        trial.edge = (edge_law)(k / KNEES);
        trial.z[P_RIPPLE] = trial.edge == EDGE_OVER ? FOUND_RIPPLE : RIPPLE_START;
        trial.z[P_DEAD_SHARE] = DEAD_SHARE_START;
        set_knee(d, &trial, knee_share[k % KNEES]);
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
        if (h > 0.0 && law_allows(trial.edge, -g / h) && g * g / h > best) {
            best = g * g / h;
            chosen = trial;
        }
    }
    *s = chosen;
    return true;
}

/* A law that stays so far behind by what its cause moves does not make up for it by last digits: those stand already. */
static const double BEHIND = 100.0;

/* The state under another law, from where that usually lies. */
static fit_state under(const fit_data *d, const fit_state *s, edge_law law)
{
    fit_state trial = *s;
    trial.edge = law;
    if (law == EDGE_OVER && s->edge != EDGE_OVER) {
        trial.z[P_RIPPLE] = FOUND_RIPPLE;
        trial.z[P_DEAD_SHARE] = DEAD_SHARE_START;
        set_knee(d, &trial, FOUND_KNEE_SHARE);
    }
    return trial;
}

bool edge_revise(fit_data *d, fit_state *s, int refine_steps, edge_contest *last)
{
    const fit_state own = *s;
    const bool allowed = law_allows(own.edge, own.z[P_V_DEAD]);
    if (allowed && 4.0 * fabs(last->objective - own.objective) < last->apart) {
        return true;
    }
    double best = allowed ? own.objective : INFINITY;
    last->apart = INFINITY;
    for (int other = 0; other < (int)EDGE_LAWS; other++) {
        fit_state trial = under(d, &own, (edge_law)other);
        if (trial.edge == own.edge || !law_allows(trial.edge, own.z[P_V_DEAD])) {
            continue;
        }
        double alone;
        const fit_aim ranked = fit_ranked(best + BEHIND);
        if (!fit_refine_within(d, &trial, refine_steps, &ranked, &alone)) {
            return false;
        }
        if (!law_allows(trial.edge, trial.z[P_V_DEAD])) {
            continue;
        }
        last->apart = fmin(last->apart, fabs(trial.objective - own.objective));
        if (trial.objective < best) {
            best = trial.objective;
            *s = trial;
        }
    }
    last->objective = s->objective;
    return true;
}
