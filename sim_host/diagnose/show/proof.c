/* The strongest cause's effect and its fit (proof.h). */
#include "proof.h"

#include "diagnose/identify/hypotheses.h"
#include "diagnose/identify/observer.h"
#include "diagnose/tell/dead_time.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- With and without the cause ---- */

/* One-cycle errors of the extended model without the strongest cause, and what that cause removes from them. */
typedef struct proof {
    const diagnosis_cause *cause;
    bool alone;                   /* false: without and of all causes together */
    vec_ab *without_A, *fitted_A; /* one entry per row; NAN: no prediction there */
} proof;

/* The extended drive with all that the cause's hypotheses move taken back to the motor file. */
static averaged_drive drive_without(const diagnosis *d, cause_id cause)
{
    averaged_drive drive = d->extended_drive;
    bool moved[P_COUNT] = {false};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_table[h].cause == cause) {
            hypothesis_mark(h, moved);
        }
    }
    for (size_t k = 0; k < P_COUNT; k++) {
        if (moved[k]) {
            const size_t offset = coordinate_table[k].offset;
            memcpy((unsigned char *)&drive + offset, (const unsigned char *)&d->nominal_drive + offset,
                   sizeof(double));
        }
    }
    return drive;
}

static bool predict(const diagnose_rows *r, const averaged_drive *drive, vec_ab *error_A)
{
    averaged_node *nodes = rows_nodes(r, drive);
    if (nodes == NULL) {
        return false;
    }
    for (size_t n = 0; n < r->recording->stretches; n++) {
        const stretch *s = &r->recording->stretch[n];
        observer_one_cycle(r, drive, nodes, s->first, s->count, error_A + s->first);
    }
    free(nodes);
    return true;
}

/*
 * The errors of both models are there. They differ by all causes together; other rows separate one cause, unless it
 * corrects rows and not the model, or depends on a revolution that only the diagnosis has found.
 */
static bool is_separable(const report_context *c, cause_id cause)
{
    const bool in_rows = cause == CAUSE_MISSED_UPDATE || cause == CAUSE_SPEED_LAG ||
                         cause == CAUSE_DC_LINK_RIPPLE || cause == CAUSE_SENSOR_FAULT;
    return c->d->causes + c->d->minors > 1 && !in_rows &&
           (cause != CAUSE_ANGLE_HARMONIC || c->rec->theta_mech_rad != NULL);
}

static void take_difference(proof *of, size_t rows, const vec_ab *without, const vec_ab *with)
{
    for (size_t k = 0; k < rows; k++) {
        of->without_A[k] = without[k];
        of->fitted_A[k] = (vec_ab){without[k].alpha - with[k].alpha, without[k].beta - with[k].beta};
    }
}

/* The first row of a stretch has no prediction. */
static void leave_out_starts(proof *of, const recording *rec)
{
    for (size_t n = 0; n < rec->stretches; n++) {
        of->without_A[rec->stretch[n].first] = (vec_ab){NAN, NAN};
    }
}

static bool separate(proof *of, const report_context *c, cause_id cause, error *e)
{
    const size_t rows = c->rec->rows;
    const averaged_drive without = drive_without(c->d, cause);
    diagnose_rows own;
    if (!rows_prepare(&own, c->rec, c->nominal, e)) {
        return false;
    }
    vec_ab *both = calloc(2 * rows, sizeof *both);
    const bool ok =
        both != NULL && predict(&own, &without, both) && predict(&own, &c->d->extended_drive, both + rows);
    if (ok) {
        take_difference(of, rows, both, both + rows);
        leave_out_starts(of, c->rec);
    }
    free(both);
    rows_free(&own);
    return ok || error_failure(e, 0, "out of memory");
}

static void proof_free(proof *of)
{
    free(of->without_A);
    free(of->fitted_A);
    of->without_A = of->fitted_A = NULL;
}

/* False with *e set if memory runs out. */
static bool proof_make(proof *of, const report_context *c, error *e)
{
    const diagnosis *d = c->d;
    const cause_id cause = (cause_id)(cause_find(d->cause[0].id) - cause_table);
    *of = (proof){.cause = &d->cause[0],
                  .alone = d->causes + d->minors == 1 || is_separable(c, cause),
                  .without_A = calloc(c->rec->rows, sizeof *of->without_A),
                  .fitted_A = calloc(c->rec->rows, sizeof *of->fitted_A)};
    if (of->without_A == NULL || of->fitted_A == NULL) {
        proof_free(of);
        return error_failure(e, 0, "out of memory");
    }
    if (!is_separable(c, cause)) {
        take_difference(of, c->rec->rows, d->error_nominal, d->error_extended);
    } else if (!separate(of, c, cause, e)) {
        proof_free(of);
        return false;
    }
    return true;
}

/* ---- Over what the cause depends on ---- */

typedef enum view {
    OVER_EFFECT, /* over the fitted effect itself: a line of slope 1 */
    OVER_CURRENT,
    OVER_VOLTAGE,
    OVER_SPEED,
    ANGLE_OVER_SPEED,
    ANGLE_OVER_REVOLUTION,
    FLUX_OVER_ANGLE
} view;

static const struct {
    const char *x_label, *y_label;
} labels[] = {
    [OVER_EFFECT] = {"voltage that the fitted cause adds, V", "residual voltage (mean), V"},
    [OVER_CURRENT] = {"phase current, A", "residual phase voltage (mean), V"},
    [OVER_VOLTAGE] = {"commanded phase voltage, V", "residual phase voltage (mean), V"},
    [OVER_SPEED] = {"electrical speed, rad/s", "residual q voltage (mean), V"},
    [ANGLE_OVER_SPEED] = {"electrical speed, rad/s", "angle error, degrees"},
    [ANGLE_OVER_REVOLUTION] = {"mechanical rotor angle, degrees", "angle error, electrical degrees"},
    [FLUX_OVER_ANGLE] = {"electrical rotor angle, degrees", "error of the magnet flux in q, mWb"},
};

static view view_of(const report_context *c, const char *cause)
{
    static const struct {
        cause_id cause;
        view view;
        bool turning;
    } table[] = {
        {CAUSE_DEAD_TIME, OVER_CURRENT, false},
        {CAUSE_RESISTANCE, OVER_CURRENT, false},
        {CAUSE_PHASE_ASYMMETRY, OVER_CURRENT, false},
        {CAUSE_VOLTAGE_GAIN, OVER_VOLTAGE, false},
        {CAUSE_FLUX_LINKAGE, OVER_SPEED, true},
        {CAUSE_ANGLE_OFFSET, ANGLE_OVER_SPEED, true},
        {CAUSE_ANGLE_DELAY, ANGLE_OVER_SPEED, true},
        {CAUSE_EMF_HARMONICS, FLUX_OVER_ANGLE, true},
        {CAUSE_ANGLE_HARMONIC, ANGLE_OVER_REVOLUTION, true},
    };
    for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
        if (strcmp(cause, cause_table[table[n].cause].id) == 0) {
            const bool angle = table[n].view != ANGLE_OVER_REVOLUTION || c->rec->theta_mech_rad != NULL ||
                               c->nominal->pole_pairs == 1;
            const bool magnet =
                (table[n].view != ANGLE_OVER_SPEED && table[n].view != ANGLE_OVER_REVOLUTION) ||
                c->nominal->psi_f_Wb != 0.0;
            return (c->turns || !table[n].turning) && angle && magnet ? table[n].view : OVER_EFFECT;
        }
    }
    return OVER_EFFECT;
}

/* The phase whose parameter is farthest from the file; -1: the cause does not tell phases apart. */
static int phase_of(const diagnosis_cause *cause)
{
    int phase = -1;
    double most = 0.0;
    for (size_t n = 0; strcmp(cause->id, "phase_asymmetry") == 0 && n < cause->parameters && n < 3; n++) {
        const double away = fabs(cause->parameter[n].value - cause->parameter[n].nominal);
        if (away > most) {
            most = away;
            phase = (int)n;
        }
    }
    return phase;
}

/* One value over x: y / weight, of the measured effect and of the fitted one. */
typedef struct point {
    double x, measured, fitted, weight;
} point;

static double in_degrees(double rad)
{
    const double wrapped = remainder(rad, VEC_TWO_PI);
    return 180.0 / VEC_PI * (wrapped < 0.0 ? wrapped + VEC_TWO_PI : wrapped);
}

/* The d or q part of a voltage. */
static double part_of(const residual_point *p, bool q)
{
    const double c = cos(p->theta_rad);
    const double s = sin(p->theta_rad);
    return q ? p->v_V.beta * c - p->v_V.alpha * s : p->v_V.alpha * c + p->v_V.beta * s;
}

/* The points of one cycle; returns how many. An angle error moves the d voltage by -omega psi_f times itself. */
static size_t points_of(const report_context *c, view how, int phase, size_t k,
                        const residual_point *measured, const residual_point *fitted, point out[3])
{
    const double psi_Wb = c->d->extended_motor.psi_f_Wb;
    const double omega = measured->omega_rad_s;
    size_t n = 0;
    if (how == OVER_EFFECT || how == OVER_CURRENT || how == OVER_VOLTAGE) {
        for (int x = 0; x < 3; x++) {
            const double over = how == OVER_EFFECT    ? fitted->v_phase_V[x]
                                : how == OVER_CURRENT ? measured->i_phase_A[x]
                                                      : measured->u_phase_V[x];
            if (phase < 0 || phase == x) {
                out[n++] = (point){over, measured->v_phase_V[x], fitted->v_phase_V[x], 1.0};
            }
        }
        return n;
    }
    const bool q = how == OVER_SPEED || how == FLUX_OVER_ANGLE;
    out[0] = (point){omega, part_of(measured, q), part_of(fitted, q), 1.0};
    if (how == FLUX_OVER_ANGLE) {
        out[0].x = in_degrees(measured->theta_rad);
        out[0].weight = -1e-3 * omega;
    } else if (how != OVER_SPEED) {
        out[0].weight = -VEC_PI / 180.0 * omega * psi_Wb;
    }
    if (how == ANGLE_OVER_REVOLUTION) {
        out[0].x = c->rec->theta_mech_rad != NULL ? in_degrees(c->rec->theta_mech_rad[k - 1])
                                                  : in_degrees(measured->theta_rad);
    }
    return 1;
}

/* ---- Bins ---- */

enum { BINS = 48, LEAST_COUNT = 24 };

typedef struct bin {
    double x, measured, fitted, weight;
    size_t count;
} bin;

static size_t points_at(const report_context *c, const proof *of, view how, size_t k, point out[3])
{
    const residual measured = {c->rec, of->without_A, c->after.L_d_H, c->after.L_q_H};
    const residual fitted = {c->rec, of->fitted_A, c->after.L_d_H, c->after.L_q_H};
    residual_point m;
    residual_point f;
    if (k == 0 || !residual_at(&measured, k, &m) || !residual_at(&fitted, k, &f)) {
        return 0;
    }
    return points_of(c, how, phase_of(of->cause), k, &m, &f, out);
}

static double reach(const report_context *c, const proof *of, view how)
{
    double most = 1e-9;
    point at[3];
    for (size_t k = 1; k < c->rec->rows; k++) {
        const size_t n = points_at(c, of, how, k, at);
        for (size_t j = 0; j < n; j++) {
            most = fmax(most, fabs(at[j].x));
        }
    }
    return 1.001 * most;
}

static chart_data bins_of(const report_context *c, const proof *of, view how, double low, double high)
{
    bin bins[BINS] = {{.count = 0}};
    point at[3];
    chart_data d = chart_data_of(3);
    for (size_t k = 1; k < c->rec->rows; k++) {
        const size_t n = points_at(c, of, how, k, at);
        for (size_t j = 0; j < n; j++) {
            const double place = (at[j].x - low) / (high - low) * BINS;
            if (place >= 0.0 && place < BINS) {
                bin *b = &bins[(size_t)place];
                b->x += at[j].x;
                b->measured += at[j].weight * at[j].measured;
                b->fitted += at[j].weight * at[j].fitted;
                b->weight += at[j].weight * at[j].weight;
                b->count++;
            }
        }
    }
    for (size_t n = 0; n < BINS; n++) {
        if (bins[n].count >= LEAST_COUNT && bins[n].weight > 0.0) {
            chart_data_add(&d,
                           (double[]){bins[n].x / (double)bins[n].count, bins[n].measured / bins[n].weight,
                                      bins[n].fitted / bins[n].weight});
        }
    }
    return d;
}

/* ---- Words ---- */

static const char *unit_of(const diagnosis_parameter *p)
{
    return strcmp(p->unit, "1") == 0 ? "" : p->unit;
}

/* The cause's values in one sentence: "3.36 V lost against the current's sign: 2 us at 4 kHz and 420 V." */
static void proof_words(const diagnosis *d, const diagnosis_cause *cause, char *text, size_t size)
{
    size_t used = 0;
    const diagnosis_parameter *dead = dead_time_of(cause);
    if (dead != NULL) {
        const double v = dead->value;
        char time[64];
        dead_time_words(&d->extended_motor, fabs(v), time, sizeof time);
        snprintf(text, size,
                 v < 0.0 ? "%.3g V more than the loss are compensated: %s."
                         : "%.3g V lost against the current's sign: %s.",
                 fabs(v), time);
        return;
    }
    text[0] = '\0';
    for (size_t k = 0; k < cause->parameters && used < size; k++) {
        const diagnosis_parameter *p = &cause->parameter[k];
        const char *unit = unit_of(p);
        const int n = snprintf(text + used, size - used, "%s%s = %.4g%s%s", k == 0 ? "" : ", ", p->name,
                               p->value, unit[0] != '\0' ? " " : "", unit);
        used += n > 0 ? (size_t)n : 0;
    }
    if (used < size && cause->parameters == 1 && cause->parameter[0].nominal != 0.0) {
        snprintf(text + used, size - used, "; the motor file has %.4g.", cause->parameter[0].nominal);
    } else if (used < size) {
        snprintf(text + used, size - used, ".");
    }
}

/* ---- The figure ---- */

static bool draw(page *p, const report_context *c, const proof *of, error *e)
{
    const diagnosis_cause *cause = of->cause;
    const view how = view_of(c, cause->id);
    const bool angle = how == FLUX_OVER_ANGLE || how == ANGLE_OVER_REVOLUTION;
    const double most = angle ? 0.0 : reach(c, of, how);
    const double low = angle ? 0.0 : -most;
    const double high = angle ? 360.0 : most;
    chart_data d = bins_of(c, of, how, low, high);
    char label[2][64];
    char words[400];
    char caption[300];
    snprintf(label[0], sizeof label[0], "measured");
    snprintf(label[1], sizeof label[1], "%s, fitted", cause->id);
    proof_words(c->d, cause, words, sizeof words);
    page_paragraph(p, "claim", "%s: %s", cause->id, words);
    snprintf(caption, sizeof caption,
             "Points: mean residual of the model without %s%s. Line: the part of it that %s.", cause->id,
             of->alone ? "" : " and the other causes",
             of->alone ? "the fitted cause explains" : "all fitted causes explain");
    const chart drawn = {
        .x_label = labels[how].x_label,
        .y_label = labels[how].y_label,
        .x = {.fixed = angle, .low = low, .high = high},
        .height = 330,
        .series = {{.label = label[0], .data = &d, .column = 1, .colour = CHART_FAINT, .mark = CHART_POINTS},
                   {.label = label[1],
                    .data = &d,
                    .column = 2,
                    .colour = CHART_BLUE,
                    .role = CHART_EXTENDED,
                    .width = 2.5}}};
    const bool ok = page_chart(p, &drawn, "proof", caption, e);
    chart_data_free(&d);
    return ok;
}

bool figure_proof(page *p, const report_context *c, error *e)
{
    proof of;
    if (!proof_make(&of, c, e)) {
        return false;
    }
    const bool ok = draw(p, c, &of, e);
    proof_free(&of);
    return ok;
}
