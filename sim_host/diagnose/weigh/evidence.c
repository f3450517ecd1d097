/* The cost of any set as a quadratic form (evidence.h). */
#include "evidence.h"

#include "base/solve.h"
#include "tolerance.h"

#include <math.h>
#include <stdio.h>
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
 * What a law leaves in proportion to its effect is marginalised (tolerance.h). A share of what all causes explain stays, as
 * no error of an effect's size or shape leaves it: no map of a few terms is that of a machine to better than a part in a hundred of
 * its flux.
 */
static const double LEAST_SHARE_BESIDE_MAP = 1e-2;

/* The columns of the allowed hypotheses, the coordinates that these move, and what shapes the laws of those that stand. */
static size_t columns_of(const fit_data *d, const fit_state *s, hypothesis_set allowed,
                         int column[COLUMN_COUNT])
{
    bool wanted[COLUMN_COUNT] = {[P_OFFSET_ZERO] = rows_show_three(d->rows)};
    coordinate_id small[P_COUNT];
    const size_t smalls = last_digits_list(d->rows, small);
    size_t n = 0;
    for (size_t k = 0; k < smalls; k++) {
        wanted[small[k]] = true;
    }
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (size_t k = 0; hypothesis_in(s->set, h) && k < hypothesis_table[h].shapes; k++) {
            wanted[hypothesis_table[h].shape[k]] = true;
        }
        if (hypothesis_in(allowed, h)) {
            hypothesis_mark(h, wanted); /* the coordinates are the first of the columns */
            for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
                wanted[hypothesis_table[h].column[k]] = true;
            }
        }
    }
    for (int c = 0; c < COLUMN_COUNT; c++) {
        if (wanted[c] && column_shows(c, d->rows)) {
            column[n++] = c;
        }
    }
    return n;
}

bool evidence_is_same(const fit_state *a, const fit_state *b)
{
    bool same = a->set == b->set && a->edge == b->edge;
    for (size_t k = 0; same && k < P_COUNT; k++) {
        same = a->z[k] == b->z[k];
    }
    for (size_t g = 0; same && g < ROWS_MAX_GROUPS; g++) {
        const group_noise *m = &a->noise[g];
        const group_noise *n = &b->noise[g];
        same = m->gain == n->gain && m->white_zero == n->white_zero;
        for (size_t k = 0; same && k < 3; k++) {
            same = m->white[k] == n->white[k];
        }
    }
    return same;
}

static bool is_of(const evidence_view *view, const fit_data *d, const fit_state *s, hypothesis_set allowed)
{
    return view->stands && view->searches == d->searches && (allowed & ~view->allowed) == 0 &&
           evidence_is_same(&view->of, s);
}

bool evidence_look(fit_data *d, const fit_state *s, hypothesis_set allowed, evidence_view *view)
{
    if (is_of(view, d, s, allowed)) {
        view->explained = view->least = 0.0;
        return true;
    }
    int column[COLUMN_COUNT];
    const size_t n = columns_of(d, s, allowed | s->set, column);
    gram *blocks = gram_blocks(d, s, column, n);
    gram *sums = calloc(1, sizeof *sums);
    memset(view, 0, sizeof *view);
    view->searches = d->searches;
    view->of = *s;
    view->allowed = allowed;
    view->rows = d->rows;
    view->frame = d->frame;
    view->edge = s->edge;
    view->of_least = d->frame->of_least;
    const bool ok =
        blocks && sums && tolerance_sum(d, s, blocks, column, n, sums, &view->worth, view->scatter);
    view->sums.c = ok ? sums->c : 0.0;
    for (size_t i = 0; ok && i < n; i++) {
        view->sums.g[column[i]] = sums->g[i];
        for (size_t j = 0; j < n; j++) {
            view->sums.h[column[i]][column[j]] = sums->h[i][j];
        }
    }
    free(blocks);
    free(sums);
    if (!ok) {
        return false;
    }
    view->stands = true;
    view->total = view->sums;
    last_digits_deflate(d->rows, NULL, &view->total);
    for (size_t k = 0; k < P_COUNT; k++) {
        view->to_nominal[k] = -s->z[k];
    }
    view->to_nominal[P_OFFSET_ZERO] = 0.0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (size_t k = 0; k < hypothesis_table[h].shapes; k++) {
            view->to_nominal[hypothesis_table[h].shape[k]] = 0.0;
        }
    }
    return true;
}

void evidence_hold(const evidence_view *view, hypothesis_id h, evidence_view *held)
{
    bool own[P_COUNT] = {false};
    hypothesis_mark(h, own);
    *held = *view;
    held->total = held->sums;
    last_digits_deflate(view->rows, own, &held->total);
}

/* The coordinate that has the factor, of each of hypotheses_scaled. */
static const coordinate_id with_factor[HYPOTHESES_SCALED] = {P_R, P_L_D, P_PSI, P_K_U};

/* The place in hypotheses_scaled of the one role that a set lacks; HYPOTHESES_SCALED if it lacks none or several. */
static size_t lacks(hypothesis_set set)
{
    unsigned roles = 0;
    size_t place = HYPOTHESES_SCALED;
    for (hypothesis_set rest = set; rest != 0; rest &= rest - 1) {
        roles |= hypothesis_table[hypothesis_first(rest)].role;
    }
    for (size_t k = 0; k < HYPOTHESES_SCALED; k++) {
        if ((roles & hypothesis_table[hypotheses_scaled[k]].role) == 0) {
            if (place < HYPOTHESES_SCALED) {
                return HYPOTHESES_SCALED;
            }
            place = k;
        }
    }
    return place;
}

/*
 * R, inductance, psi_f and all voltages multiplied by one factor change no current. If the state's set moves three of these four, and
 * `set` another three of them, `set` is the same drive as *about, which moves the state's three.
 */
static bool is_same_drive(const fit_state *s, hypothesis_set set, hypothesis_set *about)
{
    const size_t from = lacks(s->set);
    const size_t to = lacks(set);
    if (from == HYPOTHESES_SCALED || to == HYPOTHESES_SCALED || from == to ||
        !hypothesis_in(set, hypotheses_scaled[from])) {
        return false;
    }
    *about = (set & ~HYPOTHESIS_BIT(hypotheses_scaled[from])) | HYPOTHESIS_BIT(hypotheses_scaled[to]);
    return true;
}

/* The cost of `set` as that of the same drive `about`, whose values it has by another factor. */
static bool cost_of_same_drive(const evidence_view *view, const fit_state *s, hypothesis_set set,
                               hypothesis_set about, evidence_option *option)
{
    const hypothesis_set came = set & ~about;
    const bool is_choice = evidence_cost(view, s, about, option) || about == s->set;
    option->set = set;
    if (!is_choice) {
        return false;
    }
    coordinates_scale(view->frame, coordinates_to_file(view->frame, with_factor[lacks(set)], option->z), 1.0,
                      option->z);
    option->score = option->cost + evidence_price(view, set, option->z);
    return hypotheses_physical(set, option->z) && hypotheses_count(came, option->z, view->of_least);
}

/* The slope of the cost by a column, after some coordinates are moved away. */
static double slope_after(const gram *t, size_t column, const double *away, const size_t *moved, size_t moves)
{
    double slope = t->g[column];
    for (size_t k = 0; k < moves; k++) {
        slope += t->h[column][moved[k]] * away[moved[k]];
    }
    return slope;
}

bool evidence_cost(const evidence_view *view, const fit_state *s, hypothesis_set set, evidence_option *option)
{
    hypothesis_set about;
    if (set != s->set && is_same_drive(s, set, &about)) {
        return cost_of_same_drive(view, s, set, about, option);
    }
    const gram *t = &view->total;
    double away[COLUMN_COUNT];
    int column[COLUMN_COUNT];
    size_t n = 0;
    memcpy(away, view->to_nominal, sizeof away);
    for (hypothesis_set rest = set; rest != 0; rest &= rest - 1) {
        const hypothesis *hypo = &hypothesis_table[hypothesis_first(rest)];
        for (size_t k = 0; k < hypo->columns; k++) {
            if (k < hypo->fixed) {
                away[hypo->column[k]] += 1.0;
            } else if (column_shows(hypo->column[k], view->rows)) {
                column[n++] = hypo->column[k];
            }
        }
    }
    if (t->h[P_OFFSET_ZERO][P_OFFSET_ZERO] > 0.0) {
        column[n++] = P_OFFSET_ZERO;
    }
    option->set = set;
    option->score = INFINITY;
    option->cost = t->c;
    size_t moved[P_COUNT];
    size_t moves = 0;
    for (size_t k = 0; k < P_COUNT; k++) {
        if (away[k] != 0.0) {
            moved[moves++] = k;
        }
    }
    for (size_t k = 0; k < moves; k++) {
        const size_t i = moved[k];
        option->cost += away[i] * (t->g[i] + slope_after(t, i, away, moved, moves));
    }
    double small[COLUMN_COUNT][COLUMN_COUNT];
    double right[COLUMN_COUNT];
    double step[COLUMN_COUNT];
    for (size_t i = 0; i < n; i++) {
        right[i] = -slope_after(t, (size_t)column[i], away, moved, moves);
        for (size_t j = 0; j < n; j++) {
            small[i][j] = t->h[column[i]][column[j]];
        }
    }
    memcpy(option->z, s->z, sizeof option->z);
    for (int k = 0; k < P_COUNT; k++) {
        option->z[k] += away[k];
    }
    if (!solve_positive(n, COLUMN_COUNT, &small[0][0], right, step)) {
        return false; /* the option is the one without a step, and no score */
    }
    for (size_t i = 0; i < n; i++) {
        option->cost -= step[i] * right[i];
        column_move(column[i], step[i], option->z);
    }
    option->score = option->cost + evidence_price(view, set, option->z);
    return hypotheses_physical(set, option->z) && hypotheses_count(set, option->z, view->of_least);
}

double evidence_least(double explained, hypothesis_set set, hypothesis_id h)
{
    if (hypothesis_table[h].cause != CAUSE_SATURATION_DQ && hypotheses_hold(set, CAUSE_SATURATION_DQ)) {
        return LEAST_SHARE_BESIDE_MAP * explained;
    }
    return 0.0;
}

double evidence_penalty(const evidence_view *view, hypothesis_set set)
{
    double sum = 0.0;
    for (hypothesis_set rest = set; rest != 0; rest &= rest - 1) {
        const hypothesis_id h = hypothesis_first(rest);
        size_t parameters = hypothesis_table[h].columns + hypothesis_table[h].shapes;
        for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
            parameters -= column_shows(hypothesis_table[h].column[k], view->rows) ? 0 : 1;
        }
        sum += PENALTY * (double)parameters + CAUSE_PENALTY + hypothesis_table[h].surprise +
               fmax(evidence_least(view->explained, set, h), hypothesis_cause(h)->named ? view->least : 0.0);
    }
    return sum;
}

double evidence_price(const evidence_view *view, hypothesis_set set, const double z[P_COUNT])
{
    return evidence_penalty(view, set) + hypotheses_unusual(set, z) +
           CAUSE_PENALTY * (double)hypotheses_more_causes(set, z, view->of_least);
}

const char *evidence_words(hypothesis_set set, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((set & HYPOTHESIS_BIT(h)) && used < size) {
            int n = snprintf(text + used, size - used, "%s%s", used ? " + " : "", hypothesis_cause(h)->id);
            used += n > 0 ? (size_t)n : 0;
        }
    }
    return used ? text : "nothing";
}
