/*
 * The cost of a set of hypotheses as a quadratic form in the sums of one view.
 */
#include "search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Chi square per fitted parameter: about log(rows) as in Schwarz's criterion. Robust tests follow, so that
 * this only has to rank. */
static const double PENALTY = 12.0;
/* And per cause: no real drive is the model to the last digit, and a trade such as a voltage gain with R and
 * L for a flux of the wrong size (their exact equal but for one part in a thousand) must not win by what that
 * leaves. */
static const double CAUSE_PENALTY = 25.0;

/*
 * And in proportion: a small effect found beside large ones may be what their laws leave (shares of what all
 * of them explain). What dead time's law leaves near zero current looks like a voltage that is a little off,
 * in all the ways that follow.
 */
static const double LEAST_SHARE = 5e-4;
static const double LEAST_SHARE_BESIDE_DEAD_TIME = 1e-3;
static const hypothesis_set like_dead_time =
    HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_INDUCTANCE) | HYPOTHESIS_BIT(H_SALIENCY) |
    HYPOTHESIS_BIT(H_SATURATION) | HYPOTHESIS_BIT(H_FLUX) | HYPOTHESIS_BIT(H_VOLTAGE_GAIN) |
    HYPOTHESIS_BIT(H_EMF_HARMONICS) | HYPOTHESIS_BIT(H_ASYMMETRY_A) | HYPOTHESIS_BIT(H_ASYMMETRY_B) |
    HYPOTHESIS_BIT(H_ASYMMETRY_C) | HYPOTHESIS_BIT(H_ASYMMETRY) | HYPOTHESIS_BIT(H_ANGLE_DELAY);

/* More than this of the voltage late is a voltage delay of whole cycles, seen from a model that is not there
 * yet. */
static const double LATE_SHARE_MOST = 0.3;

/* Iron loss of more than this share of the rated current, in its z of 1 %, is none. */
static const double IRON_MOST = 25.0;

static bool within(double z, double most)
{
    return z > 0.0 && z <= most;
}

/* Whether the signs and sizes are such as an effect without a choice of them can have. */
static bool is_physical(hypothesis_set set, const double z[P_COUNT])
{
    return (!(set & HYPOTHESIS_BIT(H_DEAD_TIME)) || z[P_V_DEAD] > 0.0) &&
           (!(set & HYPOTHESIS_BIT(H_SATURATION)) || z[P_SATURATION] > 0.0) &&
           (!(set & HYPOTHESIS_BIT(H_LATE_SHARE)) || within(z[P_U_DELAY_1], LATE_SHARE_MOST)) &&
           (!(set & HYPOTHESIS_BIT(H_IRON_LOSS)) || within(z[P_IRON], IRON_MOST)) &&
           (!(set & HYPOTHESIS_BIT(H_EDDY)) || within(z[P_EDDY] + z[P_EDDY_LATER], IRON_MOST));
}

bool search_look(fit_data *d, const fit_state *s, search_view *view)
{
    int column[COLUMN_COUNT];
    for (int c = 0; c < COLUMN_COUNT; c++) {
        column[c] = c;
    }
    gram *grams = fit_grams(d, s, column, COLUMN_COUNT);
    if (!grams) {
        return false;
    }
    memset(view, 0, sizeof *view);
    view->two_sensors = d->rows->two_sensors;
    for (size_t b = 0; b < d->blocks; b++) {
        view->total.c += grams[b].c;
        for (size_t i = 0; i < COLUMN_COUNT; i++) {
            view->total.g[i] += grams[b].g[i];
            for (size_t j = 0; j < COLUMN_COUNT; j++) {
                view->total.h[i][j] += grams[b].h[i][j];
            }
        }
    }
    free(grams);
    for (size_t k = 0; k < P_COUNT; k++) {
        view->to_nominal[k] =
            k == P_KNEE || k == P_RIPPLE || k == P_EDGE || k == P_OFFSET_ZERO ? 0.0 : -s->z[k];
    }
    return true;
}

bool search_cost(const search_view *view, const fit_state *s, hypothesis_set set, search_option *option)
{
    const gram *t = &view->total;
    double away[COLUMN_COUNT];
    int column[COLUMN_COUNT];
    size_t n = 0;
    memcpy(away, view->to_nominal, sizeof away);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const hypothesis *hypo = &hypothesis_table[h];
        if (!(set & HYPOTHESIS_BIT(h))) {
            continue;
        }
        for (size_t k = 0; k < hypo->columns; k++) {
            if (hypo->fixed) {
                away[hypo->column[k]] += 1.0;
            } else if (hypo->column[k] != P_GAIN_C || t->h[P_GAIN_C][P_GAIN_C] > 0.0) {
                column[n++] = hypo->column[k]; /* with two sensors there is no third gain */
            }
        }
    }
    if (t->h[P_OFFSET_ZERO][P_OFFSET_ZERO] > 0.0) {
        column[n++] = P_OFFSET_ZERO;
    }
    double slope[COLUMN_COUNT];
    option->set = set;
    option->score = INFINITY;
    option->cost = t->c;
    for (size_t i = 0; i < COLUMN_COUNT; i++) {
        slope[i] = t->g[i];
        for (size_t j = 0; j < P_COUNT; j++) {
            slope[i] += t->h[i][j] * away[j];
        }
        option->cost += away[i] * (t->g[i] + slope[i]);
    }
    double small[COLUMN_COUNT][COLUMN_COUNT];
    double right[COLUMN_COUNT];
    double step[COLUMN_COUNT];
    for (size_t i = 0; i < n; i++) {
        right[i] = -slope[column[i]];
        for (size_t j = 0; j < n; j++) {
            small[i][j] = t->h[column[i]][column[j]];
        }
    }
    if (!fit_solve(n, (const double(*)[COLUMN_COUNT])small, right, step)) {
        return false;
    }
    memcpy(option->z, s->z, sizeof option->z);
    for (int k = 0; k < P_COUNT; k++) {
        option->z[k] += away[k];
    }
    for (size_t i = 0; i < n; i++) {
        option->cost -= step[i] * right[i];
        column_move(column[i], step[i], option->z);
    }
    option->score = option->cost + search_penalty(view, set) + hypotheses_unusual(set, option->z);
    return is_physical(set, option->z) && hypotheses_count(set, option->z);
}

double search_least(double explained, hypothesis_set set, hypothesis_id h)
{
    bool like = (set & HYPOTHESIS_BIT(H_DEAD_TIME)) && (like_dead_time & HYPOTHESIS_BIT(h));
    return (like ? LEAST_SHARE_BESIDE_DEAD_TIME : LEAST_SHARE) * explained;
}

double search_penalty(const search_view *view, hypothesis_set set)
{
    double sum = 0.0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (set & HYPOTHESIS_BIT(h)) {
            size_t parameters = hypothesis_table[h].columns + (h == H_DEAD_TIME ? 2 : 0);
            parameters -= h == H_CURRENT_GAIN && view->two_sensors;
            sum += PENALTY * (double)parameters + CAUSE_PENALTY + hypothesis_table[h].surprise +
                   search_least(view->explained, set, h);
        }
    }
    return sum;
}

const char *search_words(hypothesis_set set, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((set & HYPOTHESIS_BIT(h)) && used < size) {
            int n = snprintf(text + used, size - used, "%s%s", used ? " + " : "", hypothesis_table[h].cause);
            used += n > 0 ? (size_t)n : 0;
        }
    }
    return used ? text : "nothing";
}
