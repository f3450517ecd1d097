/* Estimates and covariance (known.h). */
#include "known.h"

#include "base/normal.h"
#include "diagnose/weigh/estimates.h"
#include "values.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const known_number known_numbers[DIAGNOSIS_ESTIMATES] = {
    {"R", "ohm", P_R, {"R", NULL}},
    {"L_d", "H", P_L_D, {"L_d", NULL}},
    {"L_q", "H", P_L_Q, {"L_q", NULL}},
    {"psi_f", "Wb", P_PSI, {"psi_f", NULL}},
    {"v_dead", "V", P_V_DEAD, {"v_dead", NULL}},
    {"voltage_delay", "1", P_U_DELAY_1, {"cycles", NULL}},
};

static const diagnosis_parameter *parameter_of_cause(const diagnosis *d, const known_number *what)
{
    for (size_t k = 0; k < d->causes + d->minors; k++) {
        const diagnosis_cause *cause = k < d->causes ? &d->cause[k] : &d->minor[k - d->causes];
        for (size_t n = 0; n < cause->parameters; n++) {
            const diagnosis_parameter *p = &cause->parameter[n];
            for (size_t t = 0; t < 2; t++) {
                if (what->parameter[t] && strcmp(p->name, what->parameter[t]) == 0) {
                    return p;
                }
            }
        }
    }
    return NULL;
}

/* The number that a coordinate moves. */
static double number_of(const averaged_drive *drive, coordinate_id id)
{
    double value;
    memcpy(&value, (const unsigned char *)drive + coordinate_table[id].offset, sizeof value);
    return value;
}

/* The same with that coordinate at z. */
static double number_at(const session *w, coordinate_id id, double z_of_it)
{
    double z[P_COUNT];
    memcpy(z, w->state.z, sizeof z);
    z[id] = z_of_it;
    const averaged_drive drive = session_drive(w, z);
    return number_of(&drive, id);
}

static void tell_estimates(const session *w, const evidence_view *view, diagnosis *d)
{
    bool moved[P_COUNT] = {false};
    hypotheses_mark(hypotheses_named(w->state.set), moved);
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        diagnosis_estimate *out = &d->estimate[k];
        const diagnosis_parameter *cause = parameter_of_cause(d, &known_numbers[k]);
        *out = (diagnosis_estimate){.name = known_numbers[k].name, .unit = known_numbers[k].unit};
        const estimate e =
            estimate_of(&w->fitted, view, &w->state, known_numbers[k].coordinate, w->certainty.inflation);
        /* L of both axes may be excited in one axis only. */
        if (cause && (e.excited || strcmp(cause->name, known_numbers[k].name) == 0)) {
            out->excited = true;
            out->value = cause->value;
            out->low = cause->low;
            out->high = cause->high;
            continue;
        }
        out->excited = e.excited;
        if (e.excited) {
            /* A number that a member moves is the extended motor file's. */
            const coordinate_id id = known_numbers[k].coordinate;
            double low;
            double high;
            coordinate_range(&w->frame, id, &low, &high);
            const double at = moved[id] ? w->state.z[id] : fmin(fmax(e.z, low), high);
            out->value = moved[id] ? number_of(&d->extended_drive, id) : number_at(w, id, at);
            out->low = number_at(w, id, at - e.half_width);
            out->high = number_at(w, id, at + e.half_width);
        }
    }
}

/* The values of the covariance: the motor's, and the causes' real-valued parameters. */
static size_t fitted_values(const diagnosis *d, const motor_value *fitted[DIAGNOSIS_FITTED])
{
    size_t n = 0;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        bool listed = v->of_machine && v->kind == VALUE_REAL;
        for (size_t k = 0; k < d->causes; k++) {
            const diagnosis_cause *cause = &d->cause[k];
            for (size_t j = 0; j < cause->parameters && !v->of_machine && v->kind != VALUE_WHOLE; j++) {
                listed = listed || (strcmp(cause->id, cause_table[v->cause].id) == 0 &&
                                    strcmp(cause->parameter[j].name, v->name) == 0);
            }
        }
        for (size_t k = 0; k < n; k++) {
            listed = listed && strcmp(fitted[k]->name, v->name) != 0;
        }
        if (listed && n < DIAGNOSIS_FITTED) {
            fitted[n++] = v;
        }
    }
    return n;
}

static void tell_covariance(const session *w, diagnosis *d)
{
    const certainty *c = &w->certainty;
    const motor_value *fitted[DIAGNOSIS_FITTED];
    /* A value's change along a column, times the widening of that column's interval. */
    double by[DIAGNOSIS_FITTED][COLUMN_COUNT];
    diagnosis_covariance *out = &d->covariance;
    const size_t count = fitted_values(d, fitted);
    out->count = count;
    for (size_t i = 0; i < count; i++) {
        const double at = values_at(w, fitted[i], 0, 0.0);
        snprintf(out->name[i], sizeof out->name[i], "%s", fitted[i]->name);
        snprintf(out->unit[i], sizeof out->unit[i], "%s", fitted[i]->unit);
        for (size_t k = 0; k < c->columns; k++) {
            const double step = COORDINATE_STEP;
            double change = values_at(w, fitted[i], c->column[k], step) - at;
            if (strcmp(fitted[i]->unit, "rad") == 0) {
                change = remainder(change, VEC_TWO_PI);
            }
            const double own = sqrt(c->covariance[k][k]);
            by[i][k] = change / step * (own > 0.0 ? fmax(c->half_width[k] / (NORMAL_95 * own), 1.0) : 1.0);
        }
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < count; j++) {
            double sum = 0.0;
            for (size_t k = 0; k < c->columns; k++) {
                for (size_t m = 0; m < c->columns; m++) {
                    sum += by[i][k] * c->covariance[k][m] * by[j][m];
                }
            }
            out->value[i][j] = sum;
        }
    }
}

void known_tell(const session *w, const evidence_view *view, diagnosis *d)
{
    tell_estimates(w, view, d);
    tell_covariance(w, d);
}

void known_reach(const session *other, diagnosis *d)
{
    const averaged_drive drive = session_drive(other, other->state.z);
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        diagnosis_estimate *e = &d->estimate[k];
        const double moved = number_of(&drive, known_numbers[k].coordinate) - e->value;
        if (e->excited) {
            const double low = e->value - e->low;
            const double high = e->high - e->value;
            e->low = fmin(e->low, e->value + moved - low);
            e->high = fmax(e->high, e->value + moved + high);
        }
    }
}

/* At the least, where something is left. */
static const double LEAST_WIDENING = 2.0;

void known_widen(diagnosis *d)
{
    const double by = fmax(LEAST_WIDENING, d->noise_floor > 0.0 ? d->extended / d->noise_floor : 1.0);
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES && !d->reliable; k++) {
        diagnosis_estimate *e = &d->estimate[k];
        e->low = e->value - by * (e->value - e->low);
        e->high = e->value + by * (e->high - e->value);
    }
}
