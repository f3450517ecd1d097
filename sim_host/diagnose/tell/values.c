/* Values and intervals of a named cause (values.h). */
#include "values.h"

#include "diagnose/measure/plain_knee.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* A tolerance is a third of the reporting threshold (causes.def). */
static const double DIGITS_OF_LEAST = 3.0;

/* A current that no drive reaches, over the rated peak: the upper end of an interval without saturation. */
static const double NEVER = 1e6;

/* A column that moves the cause's values, and its uncertainty. */
typedef struct spread {
    int column;
    double half_width; /* 95 %, in z */
    double step;       /* for differences */
} spread;

enum { SPREADS = COLUMN_COUNT };

/* Whether a column moves what a hypothesis moves, or shapes. */
static bool is_of(const hypothesis *hypo, const bool moved[P_COUNT], int column)
{
    double unit[P_COUNT] = {0.0};
    bool any = hypo->cause == CAUSE_CURRENT_OFFSET &&
               column == P_OFFSET_ZERO; /* the sum of three currents shows it */
    column_move(column, 1.0, unit);
    for (size_t k = 0; k < P_COUNT; k++) {
        any = any || (moved[k] && unit[k] != 0.0);
    }
    for (size_t k = 0; k < hypo->shapes; k++) {
        any = any || column == (int)hypo->shape[k];
    }
    return any;
}

/* Half width along a column, and of a model that is not exact. */
static double half_width_of(const session *w, hypothesis_id h, int column)
{
    const hypothesis *hypo = &hypothesis_table[h];
    const coordinate *of = &coordinate_table[column < P_COUNT ? column : P_L_D];
    const double half = certainty_half_width(&w->certainty, column) + of->summary;
    for (size_t k = 0; k < hypo->columns; k++) {
        if (hypo->column[k] == column) {
            const session_strays strays = session_model_strays(w, hypo->cause);
            /* The parts of a vector are correlated: its length counts. */
            const double size =
                hypo->one_vector ? hypothesis_size(h, w->state.z) : fabs(column_value(column, w->state.z));
            return half + strays.of_least * hypo->least + fmax(strays.of_effect, hypo->loose) * size;
        }
    }
    return half + session_model_strays(w, CAUSE_COUNT).of_least * DIGITS_OF_LEAST * of->digits;
}

/* The fitted columns that move what a hypothesis moves; with `all` every one, for a value that other causes' columns move. */
static size_t spreads_of(const session *w, hypothesis_id h, bool all, spread list[SPREADS])
{
    const hypothesis *hypo = &hypothesis_table[h];
    const certainty *c = &w->certainty;
    bool moved[P_COUNT] = {false};
    size_t n = 0;
    hypothesis_mark(h, moved);
    for (size_t k = 0; k < c->columns; k++) {
        const int column = c->column[k];
        if (all || is_of(hypo, moved, column)) {
            const double step = column < P_COUNT ? coordinate_step((coordinate_id)column) : COORDINATE_STEP;
            list[n++] = (spread){column, half_width_of(w, h, column), step};
        }
    }
    for (size_t k = hypo->fixed; k < hypo->columns && n < SPREADS; k++) {
        if (!column_shows(hypo->column[k], &w->rows)) {
            /* Only the range of a gain is known. */
            const coordinate *gain = &coordinate_table[hypo->column[k]];
            list[n++] = (spread){hypo->column[k], 0.5 * (gain->high - gain->low), COORDINATE_STEP};
        }
    }
    return n;
}

/* A value at the fitted z moved along a column. */
double values_at(const session *w, const motor_value *v, int column, double by)
{
    double z[P_COUNT];
    memcpy(z, w->state.z, sizeof z);
    column_move(column, by, z);
    const averaged_drive drive = session_drive(w, z);
    const motor m = averaged_drive_motor(&drive, w->frame.motor);
    return motor_value_of(&m, v);
}

void values_bound_saturation(double never_A, diagnosis_parameter *p)
{
    if (p->value == 0.0) {
        p->low = 0.0;
        p->high = never_A;
    } else if (p->low <= 0.0) {
        p->low = fmin(p->high, p->value);
        p->high = never_A;
    }
}

/*
 * The interval of one value. Where one column moves it, the ends of that column's interval carry over (the
 * interval of I_sat is symmetric in 1/I_sat^2, in which the law is linear); where several do, by first
 * derivatives, with how these lean on one another. Returns the number of columns that move it.
 */
static size_t interval_of(const session *w, const motor_value *v, const spread *list, size_t n,
                          diagnosis_parameter *p)
{
    const double fitted = values_at(w, v, 0, 0.0);
    const spread *only = NULL;
    double half[SPREADS] = {0.0}; /* what each column adds */
    double square = 0.0;
    size_t moving = 0;
    for (size_t k = 0; k < n; k++) {
        double change = values_at(w, v, list[k].column, list[k].step) - fitted;
        if (strcmp(v->unit, "rad") == 0) {
            change = remainder(change, VEC_TWO_PI);
        }
        half[k] = change / list[k].step * list[k].half_width;
        if (change != 0.0) {
            only = &list[k];
            moving++;
        }
        for (size_t j = 0; j <= k; j++) {
            const double lean =
                j == k ? 1.0 : 2.0 * certainty_correlation(&w->certainty, list[j].column, list[k].column);
            square += lean * half[j] * half[k];
        }
    }
    square = fmax(square, 0.0);
    p->low = p->value - sqrt(square);
    p->high = p->value + sqrt(square);
    if (moving == 1 && fitted != 0.0) {
        /* The plain model of a dead time replaces the fitted one: scale the ends. */
        const double share = p->value / fitted;
        const double a = share * values_at(w, v, only->column, -only->half_width);
        const double b = share * values_at(w, v, only->column, only->half_width);
        p->low = fmin(a, b);
        p->high = fmax(a, b);
    }
    if (moving > 0 && v->offset == offsetof(motor, ext.I_sat_dq_A)) {
        values_bound_saturation(NEVER * w->frame.i_rated_peak_A, p);
    }
    return moving;
}

void values_tell(const session *w, hypothesis_id h, const double z[P_COUNT], diagnosis_cause *cause)
{
    const motor nominal = averaged_drive_motor(&w->frame.nominal, w->frame.motor);
    averaged_drive drive = session_drive(w, z);
    spread list[SPREADS];
    const size_t n = spreads_of(w, h, false, list);
    bool moved[DIAGNOSIS_PARAMETERS] = {false};
    const motor_value *value[DIAGNOSIS_PARAMETERS] = {NULL};
    if (hypothesis_table[h].cause == CAUSE_DEAD_TIME) {
        drive.i_knee_A = plain_knee_A(&drive, &w->rows, w->frame.i_rated_peak_A);
    }
    const motor found = averaged_drive_motor(&drive, w->frame.motor);
    cause->id = hypothesis_cause(h)->id;
    cause->words = hypothesis_table[h].words;
    cause->parameters = 0;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        if (v->cause != hypothesis_table[h].cause || cause->parameters == DIAGNOSIS_PARAMETERS) {
            continue;
        }
        diagnosis_parameter *p = &cause->parameter[cause->parameters];
        snprintf(p->name, sizeof p->name, "%s", v->name);
        snprintf(p->unit, sizeof p->unit, "%s", v->unit);
        p->nominal = motor_value_of(&nominal, v) + 0.0; /* no -0 */
        p->value = p->low = p->high = motor_value_of(&found, v);
        /* Whole numbers have no interval. */
        const bool moves = v->kind == VALUE_WHOLE || interval_of(w, v, list, n, p) > 0;
        if (motor_value_is_extra(v) && !moves && p->nominal == 0.0) {
            continue; /* not there */
        }
        value[cause->parameters] = v;
        moved[cause->parameters++] = moves;
    }
    /* A value fixed at the motor file's is as uncertain as a fitted one of the same unit, or as the other causes' columns make it. */
    for (size_t k = 0; k < cause->parameters; k++) {
        diagnosis_parameter *p = &cause->parameter[k];
        double widest = 0.0;
        for (size_t j = 0; !moved[k] && j < cause->parameters; j++) {
            const diagnosis_parameter *other = &cause->parameter[j];
            const bool like = moved[j] && strcmp(other->unit, p->unit) == 0;
            widest = like ? fmax(widest, 0.5 * (other->high - other->low)) : widest;
        }
        if (!moved[k] && widest > 0.0) {
            p->low = p->value - widest;
            p->high = p->value + widest;
        } else if (!moved[k]) {
            interval_of(w, value[k], list, spreads_of(w, h, true, list), p);
        }
    }
}
