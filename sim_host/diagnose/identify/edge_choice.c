/* Edge model of a dead time, by likelihood (edge_choice.h). */
#include "edge_choice.h"

#include "fit.h"
#include "gram.h"

#include <math.h>
#include <stdlib.h>

/* Knee currents that are tried, as shares of the rated peak current: from an ideal switch to a slow one. */
static const double knee_share[] = {0.005, 0.02, 0.06, 0.15};
enum { KNEES = sizeof knee_share / sizeof *knee_share };
/* An edge finds all of the ripple. */
static const double RIPPLE_START = 1.0;

/* With a compensation: hard switches. The knee covers what is not known of the current at the edge. */
static const double COMPENSATED_KNEE_SHARE = 0.01;
static const double LEAST_KNEE_SHARE = 0.001;

/* Chi square that the second parameter, the compensation, must reduce to be considered. */
static const double SECOND_NUMBER = 25.0;

static void set_knee(const fit_data *d, fit_state *s, coordinate_id knee, double share)
{
    const double nominal_A =
        knee == P_KNEE ? d->frame->nominal.i_knee_A : d->frame->nominal.compensation_knee_A;
    s->z[knee] = log(share * d->frame->i_rated_peak_A / nominal_A);
}

/* Sums g and h over all blocks, for a dead time (n = 1) or with its compensation (n = 2). False: out of memory. */
static bool sum_of(fit_data *d, const fit_state *s, size_t n, double g[2], double h[3])
{
    static const int column[] = {P_V_DEAD, P_COMPENSATION};
    gram *grams = gram_blocks(d, s, column, n);
    for (size_t b = 0; grams && b < d->blocks; b++) {
        g[0] += grams[b].g[0];
        h[0] += grams[b].h[0][0];
        g[1] += n > 1 ? grams[b].g[1] : 0.0;
        h[1] += n > 1 ? grams[b].h[0][1] : 0.0;
        h[2] += n > 1 ? grams[b].h[1][1] : 0.0;
    }
    const bool ok = grams != NULL;
    free(grams);
    return ok;
}

/* Reduction in chi square by a dead time alone under the state's edge model. */
static bool plain_gain(fit_data *d, const fit_state *s, double *gain)
{
    double g[2] = {0.0};
    double h[3] = {0.0};
    const bool ok = sum_of(d, s, 1, g, h);
    *gain = h[0] > 0.0 ? g[0] * g[0] / h[0] : 0.0;
    return ok;
}

/* The same by a dead time with its compensation; 0 if one of the two would be negative. */
static bool compensated_gain(fit_data *d, const fit_state *s, double *gain)
{
    double g[2] = {0.0};
    double h[3] = {0.0};
    const bool ok = sum_of(d, s, 2, g, h);
    const double det = h[0] * h[2] - h[1] * h[1];
    *gain = 0.0;
    if (ok && det > 1e-9 * h[0] * h[2]) {
        const double left = (h[1] * g[1] - h[2] * g[0]) / det;
        const double taken_back = (h[1] * g[0] - h[0] * g[1]) / det;
        *gain = taken_back > 0.0 && left + taken_back > 0.0 ? -(g[0] * left + g[1] * taken_back) : 0.0;
    }
    return ok;
}

/* How soft a hard switch seems where the current that decides has such noise: the mean sign's slope at zero, sqrt(2/pi) / noise. */
static double hard_share(const fit_data *d)
{
    return fmax(LEAST_KNEE_SHARE, 1.25 * d->rows->noise_A / d->frame->i_rated_peak_A);
}

static fit_state before_compensation(const fit_data *d, const fit_state *s, double share)
{
    fit_state trial = *s;
    trial.edge = EDGE_CLIPPED;
    trial.z[P_RIPPLE] = RIPPLE_START;
    set_knee(d, &trial, P_KNEE, COMPENSATED_KNEE_SHARE);
    set_knee(d, &trial, P_COMPENSATION_KNEE, share);
    return trial;
}

bool edge_choose(fit_data *d, fit_state *s)
{
    double best = 0.0;
    fit_state chosen = *s;
    if (s->z[P_V_DEAD] != 0.0 || s->z[P_COMPENSATION] != 0.0) {
        return true;
    }
    if (averaged_drive_loses(&d->frame->nominal)) {
        s->edge = d->frame->nominal.edge;
        return true;
    }
    for (size_t k = 0; k < 2 * KNEES; k++) {
        fit_state trial = *s;
        double gain;
        trial.edge = k < KNEES ? EDGE_CHARGED : EDGE_CLIPPED;
        trial.z[P_RIPPLE] = RIPPLE_START;
        set_knee(d, &trial, P_KNEE, knee_share[k % KNEES]);
        if (!plain_gain(d, &trial, &gain)) {
            return false;
        }
        if (gain > best) {
            best = gain;
            chosen = trial;
        }
    }
    const double plain = best;
    for (size_t k = 0; k < KNEES - 1; k++) {
        const fit_state trial = before_compensation(d, s, k > 0 ? knee_share[k] : hard_share(d));
        double gain;
        if (!compensated_gain(d, &trial, &gain)) {
            return false;
        }
        if (gain > plain + SECOND_NUMBER && gain > best) {
            best = gain;
            chosen = trial;
        }
    }
    *s = chosen;
    return true;
}

void edge_of_set(const fit_data *d, fit_state *s)
{
    if (hypothesis_in(s->set, H_COMPENSATED) && s->edge != EDGE_CLIPPED) {
        *s = before_compensation(d, s, hard_share(d));
    } else if (!hypothesis_in(s->set, H_COMPENSATED)) {
        s->z[P_COMPENSATION] = 0.0;
    }
}

/*
 * Gives up an edge model whose own parameters leave an objective that is higher by this. The parameter tolerances are fitted already
 * and do not make up for it.
 */
static const double BEHIND = 100.0;

bool edge_revise(fit_data *d, fit_state *s, int refine_steps, edge_contest *last)
{
    const fit_state own = *s;
    if (4.0 * fabs(last->objective - own.objective) < last->apart) {
        return true;
    }
    double alone;
    const fit_aim ranked = fit_ranked(own.objective + BEHIND);
    fit_state trial = own;
    trial.edge = own.edge == EDGE_CHARGED ? EDGE_CLIPPED : EDGE_CHARGED;
    if (!fit_refine_within(d, &trial, refine_steps, &ranked, &alone)) {
        return false;
    }
    last->apart = fabs(trial.objective - own.objective);
    if (trial.objective < own.objective) {
        *s = trial;
    }
    last->objective = s->objective;
    return true;
}
