/* Questions to a recording (question.h). */
#include "question.h"

#include "base/normal.h"
#include "base/solve.h"
#include "diagnose/identify/gram.h"
#include "diagnose/tell/known.h"
#include "diagnose/tell/values.h"

#include <math.h>
#include <string.h>

/* Nothing is known beforehand of a number that may be off by so many reporting thresholds. */
static const double UNKNOWN = 100.0;
/* Of `usual`: a half width of this is a value. */
static const double A_VALUE = 0.1;

static bool is_shape(int column)
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (size_t k = 0; k < hypothesis_table[h].shapes; k++) {
            if (column == (int)hypothesis_table[h].shape[k]) {
                return true;
            }
        }
    }
    return false;
}

/* What is known of a column that is free: what drives show. */
static double usual_of(hypothesis_id h, int column)
{
    if (column < P_COUNT && coordinate_table[column].usual > 0.0) {
        return coordinate_table[column].usual;
    }
    return UNKNOWN * hypothesis_table[h].least;
}

static double precision(double width)
{
    return 1.0 / (width * width);
}

/* The columns of a set, free, and those that move within their tolerance. */
static void open_columns(question *q, hypothesis_set set)
{
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT] = {0.0};
    fit_state s = q->w->state;
    s.set = set;
    const size_t members = gram_columns(&q->w->fitted, &s, set, column);
    const size_t n = last_digits_append(&q->w->fitted, &s, members, column, prior);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (size_t k = 0; hypothesis_in(set, h) && k < members; k++) {
            for (size_t c = 0; c < hypothesis_table[h].columns; c++) {
                if (column[k] == hypothesis_table[h].column[c]) {
                    prior[k] = precision(usual_of(h, column[k]));
                }
            }
        }
    }
    for (size_t k = 0; k < n; k++) {
        /* What only shapes a law is not in the view. */
        if (!is_shape(column[k])) {
            q->prior[q->columns] = prior[k];
            q->column[q->columns++] = column[k];
        }
    }
}

static void free_coordinate(question *q, coordinate_id id)
{
    const double usual = coordinate_usual(id);
    for (size_t k = 0; k < q->columns; k++) {
        if (q->column[k] == (int)id) {
            q->prior[k] = precision(usual);
            return;
        }
    }
    q->prior[q->columns] = precision(usual);
    q->column[q->columns++] = (int)id;
}

/* Adds a number; once all columns are there. */
static void add_number(question *q, const motor_value *v)
{
    const double at = values_at(q->w, v, 0, 0.0);
    for (size_t k = 0; k < q->columns; k++) {
        q->by[q->numbers][k] = (values_at(q->w, v, q->column[k], COORDINATE_STEP) - at) / COORDINATE_STEP;
    }
    q->number[q->numbers++] = v;
}

/* Whether test segments can show it, in addition to the effect of the others. */
static bool can_stand_beside(hypothesis_set set, hypothesis_id h)
{
    bool taken[P_COUNT] = {false};
    bool own[P_COUNT] = {false};
    for (hypothesis_id other = 0; other < H_COUNT; other++) {
        if (hypothesis_in(set, other)) {
            hypothesis_mark(other, taken);
        }
    }
    hypothesis_mark(h, own);
    for (int k = 0; k < P_COUNT; k++) {
        if (own[k] && (taken[k] || coordinate_table[k].rate)) {
            return false;
        }
    }
    return hypothesis_table[h].needs != NEEDS_TEMPERATURE && hypothesis_table[h].needs != NEEDS_A_COUNT &&
           hypothesis_table[h].needs != NEEDS_A_TRIAL && hypothesis_table[h].fixed == 0;
}

/* The other cause's hypothesis that does best in the member's place, and where it would lie then. */
static hypothesis_id rival_of(const session *w, const evidence_view *view, hypothesis_id member,
                              cause_id other, double z[P_COUNT])
{
    const hypothesis_set rest = w->state.set & ~HYPOTHESIS_BIT(member);
    hypothesis_id best = H_COUNT;
    double least = INFINITY;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        evidence_option option;
        if (hypothesis_cause(h)->of != other || !hypothesis_in(w->possible, h) ||
            !can_stand_beside(w->state.set, h)) {
            continue;
        }
        (void)evidence_cost(view, &w->state, rest | HYPOTHESIS_BIT(h), &option);
        if (isfinite(option.score) && option.cost < least) {
            least = option.cost;
            best = h;
            memcpy(z, option.z, sizeof option.z);
        }
    }
    return best;
}

/* All numbers of a cause that its hypothesis moves and that have a size. */
static size_t numbers_of(const question *q, hypothesis_id h, const motor_value *list[DIAGNOSIS_PARAMETERS])
{
    size_t n = 0;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        bool moves = false;
        for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
            const double by = values_at(q->w, v, hypothesis_table[h].column[k], COORDINATE_STEP) -
                              values_at(q->w, v, 0, 0.0);
            moves = moves || (by != 0.0 && isfinite(by));
        }
        if (moves && v->cause == hypothesis_table[h].cause && v->kind != VALUE_WHOLE &&
            v->kind != VALUE_RATE && n < DIAGNOSIS_PARAMETERS) {
            list[n++] = v;
        }
    }
    return n;
}

/* One number of each, the two that lean on one another most. False if there is none. */
static bool add_pair(question *q)
{
    const motor_value *a[DIAGNOSIS_PARAMETERS];
    const motor_value *b[DIAGNOSIS_PARAMETERS];
    const size_t as = numbers_of(q, q->pair[0], a);
    const size_t bs = numbers_of(q, q->pair[1], b);
    double most = -1.0;
    const motor_value *best[2] = {NULL, NULL};
    for (size_t i = 0; i < as; i++) {
        for (size_t j = 0; j < bs; j++) {
            answer now;
            q->numbers = 0;
            add_number(q, a[i]);
            add_number(q, b[j]);
            if (question_ask(q, NULL, 0.0, &now) && fabs(now.correlation) > most) {
                most = fabs(now.correlation);
                best[0] = a[i];
                best[1] = b[j];
            }
        }
    }
    q->numbers = 0;
    for (size_t n = 0; n < 2 && best[n] != NULL; n++) {
        add_number(q, best[n]);
    }
    return q->numbers == 2;
}

static void place(question *q, size_t which, hypothesis_id h, const double z[P_COUNT])
{
    q->pair[which] = h;
    for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
        q->at[which][k] = column_value(hypothesis_table[h].column[k], z);
    }
}

bool question_of_pair(question *q, const session *w, const evidence_view *view, hypothesis_id member,
                      cause_id other)
{
    double z[P_COUNT];
    const hypothesis_id rival = rival_of(w, view, member, other, z);
    if (rival == H_COUNT || !can_stand_beside(0, member)) {
        return false;
    }
    *q = (question){.w = w, .view = view};
    place(q, 0, member, w->state.z);
    place(q, 1, rival, z);
    open_columns(q, w->state.set | HYPOTHESIS_BIT(rival));
    return add_pair(q);
}

/* The number of that name. */
static const motor_value *value_named(const char *name)
{
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        if (strcmp(v->name, name) == 0) {
            return v;
        }
    }
    return NULL;
}

/* What drives show of a number: of its coordinate, which is one of the columns. */
static double usual_width(const question *q, const motor_value *v, coordinate_id id)
{
    const double at = values_at(q->w, v, 0, 0.0);
    const double by = (values_at(q->w, v, (int)id, COORDINATE_STEP) - at) / COORDINATE_STEP;
    const double usual = coordinate_usual(id);
    return fabs(by) * usual;
}

bool question_of_estimates(question *q, const session *w, const evidence_view *view, const diagnosis *d)
{
    *q = (question){.w = w, .view = view, .pair = {H_COUNT, H_COUNT}};
    open_columns(q, w->state.set);
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        if (!d->estimate[k].excited) {
            free_coordinate(q, known_numbers[k].coordinate);
        }
    }
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        const coordinate_id id = known_numbers[k].coordinate;
        const motor_value *v = d->estimate[k].excited ? NULL : value_named(known_numbers[k].parameter[0]);
        if (v != NULL) {
            q->enough[q->numbers] = NORMAL_95 * A_VALUE * usual_width(q, v, id);
            add_number(q, v);
        }
    }
    return q->numbers > 0;
}

static double product(const question *q, size_t a, size_t b, double c[COLUMN_COUNT][COLUMN_COUNT])
{
    double sum = 0.0;
    for (size_t i = 0; i < q->columns; i++) {
        for (size_t j = 0; j < q->columns; j++) {
            sum += q->by[a][i] * c[i][j] * q->by[b][j];
        }
    }
    return sum;
}

/* Chi square of a hypothesis where it would lie: what its leaving costs with all else free. */
static double chi_square(const question *q, size_t which, double c[COLUMN_COUNT][COLUMN_COUNT])
{
    const hypothesis *hypo = &hypothesis_table[q->pair[which]];
    double part[HYPOTHESIS_COLUMNS][HYPOTHESIS_COLUMNS];
    double z[HYPOTHESIS_COLUMNS];
    double x[HYPOTHESIS_COLUMNS];
    size_t at[HYPOTHESIS_COLUMNS];
    size_t n = 0;
    double sum = 0.0;
    for (size_t k = 0; k < hypo->columns; k++) {
        for (size_t j = 0; j < q->columns; j++) {
            if (q->column[j] == hypo->column[k]) {
                z[n] = q->at[which][k];
                at[n++] = j;
            }
        }
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            part[i][j] = c[at[i]][at[j]];
        }
    }
    if (n == 0 || !solve_positive(n, HYPOTHESIS_COLUMNS, &part[0][0], z, x)) {
        return 0.0;
    }
    for (size_t i = 0; i < n; i++) {
        sum += z[i] * x[i];
    }
    return sum / q->w->certainty.inflation;
}

bool question_ask(const question *q, const double more[COLUMN_COUNT][COLUMN_COUNT], double cycles,
                  answer *out)
{
    double c[COLUMN_COUNT][COLUMN_COUNT];
    for (size_t i = 0; i < q->columns; i++) {
        for (size_t j = 0; j < q->columns; j++) {
            c[i][j] = q->view->sums.h[q->column[i]][q->column[j]] + (i == j ? q->prior[i] : 0.0);
            c[i][j] += more != NULL ? cycles * more[q->column[i]][q->column[j]] : 0.0;
        }
    }
    *out = (answer){.apart = 0.0};
    if (!solve_covariance(q->columns, COLUMN_COUNT, &c[0][0], &c[0][0])) {
        return false;
    }
    bool known = true;
    for (size_t n = 0; n < q->numbers; n++) {
        const double variance = product(q, n, n, c);
        out->half_width[n] = NORMAL_95 * sqrt(variance * q->w->certainty.inflation);
        known = known && variance > 0.0 && isfinite(variance);
    }
    if (known && q->pair[0] != H_COUNT) {
        out->apart = fmin(chi_square(q, 0, c), chi_square(q, 1, c));
        out->correlation = product(q, 0, 1, c) / sqrt(product(q, 0, 0, c) * product(q, 1, 1, c));
    }
    return known;
}
