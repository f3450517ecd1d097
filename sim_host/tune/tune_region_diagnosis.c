/* The uncertainty set of a diagnosis (tune_region.h). */
#include "tune_region_points.h"

#include "base/json.h"
#include "base/solve.h"
#include "model/flux_map.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { AXIS_R, AXIS_D, AXIS_Q, AXIS_PSI, AXIS_L, AXES_NAMED };

/* A mean of both inductances moves both in the ratio that the motor file gives. */
static int axis_of(const char *name)
{
    static const char *const names[] = {"R", "L_d", "L_q", "psi_f", "L", "L_0"};
    for (int n = 0; n < (int)(sizeof names / sizeof names[0]); n++) {
        if (name != NULL && strcmp(name, names[n]) == 0) {
            return n < AXES_NAMED ? n : AXIS_L;
        }
    }
    return -1;
}

/* What a change of 1 of a named parameter moves in R, L_d and L_q. */
static void column_of(int axis, const tune_machine *centre, double column[TUNE_AXES])
{
    const double mean = 0.5 * (centre->L_d_H + centre->L_q_H);
    memset(column, 0, TUNE_AXES * sizeof column[0]);
    if (axis == AXIS_L) {
        column[AXIS_D] = centre->L_d_H / mean;
        column[AXIS_Q] = centre->L_q_H / mean;
    } else if (axis < TUNE_AXES) {
        column[axis] = 1.0;
    }
}

static void set_value(tune_machine *m, int axis, double value)
{
    double *const place[] = {&m->R_ohm, &m->L_d_H, &m->L_q_H, &m->psi_f_Wb};
    if (axis == AXIS_L) {
        const double ratio = value / (0.5 * (m->L_d_H + m->L_q_H));
        m->L_d_H *= ratio;
        m->L_q_H *= ratio;
    } else {
        *place[axis] = value;
    }
}

/* One parameter with its interval, as `estimates` and a cause's `parameters` have it. */
static void take_parameter(const json_t *p, tune_region *region, double low[AXES_NAMED],
                           double high[AXES_NAMED])
{
    const int axis = axis_of(json_string_value(json_object_get(p, "name")));
    const json_t *value = json_object_get(p, "value");
    const json_t *interval = json_object_get(p, "ci95");
    if (axis < 0 || !json_is_number(value) || !(json_number_value(value) > 0.0)) {
        return;
    }
    set_value(&region->centre, axis, json_number_value(value));
    const json_t *from = json_array_get(interval, 0);
    const json_t *to = json_array_get(interval, 1);
    if (json_is_number(from) && json_is_number(to)) {
        low[axis] = fmin(json_number_value(from) - json_number_value(value), 0.0);
        high[axis] = fmax(json_number_value(to) - json_number_value(value), 0.0);
    }
}

static void take_values(const json_t *root, tune_region *region, double low[AXES_NAMED],
                        double high[AXES_NAMED])
{
    const json_t *estimates = json_object_get(root, "estimates");
    for (size_t n = 0; n < json_array_size(estimates); n++) {
        const json_t *p = json_array_get(estimates, n);
        const json_t *excited = json_object_get(p, "excited");
        if (excited == NULL || json_is_true(excited)) {
            take_parameter(p, region, low, high);
        }
    }
    const json_t *causes = json_object_get(root, "causes");
    for (size_t n = 0; n < json_array_size(causes); n++) {
        const json_t *parameters = json_object_get(json_array_get(causes, n), "parameters");
        for (size_t k = 0; k < json_array_size(parameters); k++) {
            take_parameter(json_array_get(parameters, k), region, low, high);
        }
    }
}

/* chi squared's 95 % point for 1 to 3 degrees of freedom. */
static const double chi_squared_95[TUNE_AXES + 1] = {0.0, 3.841458820694124, 5.991464547107979,
                                                     7.814727903251179};

/* The covariance's part of R, L_d and L_q, and what of psi_f it says. Leaves region->known at 0 if none. */
static bool take_covariance(const json_t *covariance, tune_region *region, double *psi_deviation)
{
    const json_t *names = json_object_get(covariance, "names");
    const json_t *matrix = json_object_get(covariance, "matrix");
    size_t at[TUNE_AXES] = {0};
    int axis[TUNE_AXES] = {0};
    int found = 0;
    for (size_t n = 0; n < json_array_size(names); n++) {
        const int which = axis_of(json_string_value(json_array_get(names, n)));
        const double variance = json_number_value(json_array_get(json_array_get(matrix, n), n));
        if (which == AXIS_PSI && variance > 0.0) {
            *psi_deviation = sqrt(variance);
        } else if (which >= 0 && which != AXIS_PSI && variance > 0.0 && found < TUNE_AXES) {
            at[found] = n;
            axis[found++] = which;
        }
    }
    double factor[TUNE_AXES * TUNE_AXES] = {0.0};
    for (int n = 0; n < found; n++) {
        for (int k = 0; k <= n; k++) {
            factor[n * found + k] = json_number_value(json_array_get(json_array_get(matrix, at[n]), at[k]));
        }
    }
    if (found == 0 || !solve_factor((size_t)found, factor)) {
        return found == 0;
    }
    region->known = found;
    region->radius = sqrt(chi_squared_95[found]);
    for (int n = 0; n < found; n++) {
        double column[TUNE_AXES];
        column_of(axis[n], &region->centre, column);
        for (int row = 0; row < TUNE_AXES; row++) {
            for (int k = 0; k <= n; k++) {
                region->root[row][k] += column[row] * factor[n * found + k];
            }
            if (column[row] != 0.0) {
                region->low[row] = region->high[row] = 0.0;
            }
        }
    }
    return true;
}

/* Off the ellipsoid's axes: the diagnosis' intervals, or the tolerances without one. */
static int take_intervals(tune_region *region, const double low[AXES_NAMED], const double high[AXES_NAMED])
{
    int taken = 0;
    for (int axis = 0; axis < AXES_NAMED; axis++) {
        double column[TUNE_AXES];
        column_of(axis, &region->centre, column);
        for (int row = 0; row < TUNE_AXES && high[axis] > low[axis]; row++) {
            if (column[row] != 0.0) {
                region->low[row] = column[row] * low[axis];
                region->high[row] = column[row] * high[axis];
                taken++;
            }
        }
        if (axis == AXIS_PSI && high[axis] > low[axis]) {
            region->psi_low = low[axis];
            region->psi_high = high[axis];
        }
    }
    return taken;
}

/* ---- Fall of L with the current ---- */

enum { FALL_DIRECTIONS = 24, FALL_STEPS = 10 };

tune_fall tune_fall_of(const motor *m)
{
    const averaged_drive drive = averaged_drive_of(m);
    const flux_map_slope none = flux_map_at(&drive, (vec_dq){0.0, 0.0}).slope;
    const double I_A = motor_rated_peak_A(m);
    tune_fall fall = {.known = flux_map_bends(&drive)};
    for (int n = 0; n < FALL_DIRECTIONS * FALL_STEPS && fall.known; n++) {
        const double angle = VEC_TWO_PI * (n % FALL_DIRECTIONS) / FALL_DIRECTIONS;
        const double size_A = I_A * (n / FALL_DIRECTIONS + 1) / FALL_STEPS;
        const vec_dq i_A = {size_A * cos(angle), size_A * sin(angle)};
        const vec_dq straight = {none.dd * i_A.d, none.qq * i_A.q};
        const flux_map_point at = flux_map_at(&drive, i_A);
        fall.d = fmax(fall.d, 1.0 - at.slope.dd / none.dd);
        fall.q = fmax(fall.q, 1.0 - at.slope.qq / none.qq);
        fall.flux = fmax(fall.flux, hypot(straight.d - at.flux.d, straight.q - at.flux.q) /
                                        hypot(straight.d, straight.q));
    }
    return fall;
}

/* A map that turns back is none of iron: a tenth of L is left, as in a flux that saturates fully. */
static const double FALL_MOST = 0.9;

static void add_fall(const motor *m, const tune_tolerances *t, tune_region *region)
{
    const tune_fall fall = tune_fall_of(m);
    region->fall_source = fall.known ? "the motor file's saturation, up to the rated peak"
                                     : "the tolerance of L, since the motor file has no saturation";
    region->fall_d = fmin(fall.known ? fall.d : t->L, FALL_MOST);
    region->fall_q = fmin(fall.known ? fall.q : t->L, FALL_MOST);
    region->low[AXIS_D] = fmin(region->low[AXIS_D], -region->fall_d * region->centre.L_d_H);
    region->low[AXIS_Q] = fmin(region->low[AXIS_Q], -region->fall_q * region->centre.L_q_H);
}

bool tune_region_of_diagnosis(const motor *m, const char *path, const tune_tolerances *t, tune_region *region,
                              error *e)
{
    json_complaint wrong;
    json_t *root = json_read(path, &wrong);
    if (root == NULL && wrong.file.status != 0) {
        *e = wrong.file;
        return false;
    }
    if (root == NULL) {
        return error_input(e, path, wrong.line, 0, "expected a diagnosis (JSON): %s", wrong.text);
    }
    const json_t *covariance = json_object_get(root, "covariance");
    double low[AXES_NAMED] = {0.0};
    double high[AXES_NAMED] = {0.0};
    double psi_deviation = 0.0;
    bool ok =
        json_is_string(json_object_get(root, "verdict")) && json_is_array(json_object_get(root, "causes"));
    if (!ok) {
        (void)error_input(e, path, 0, 0, "expected a diagnosis as `iqfoc diagnose --json` writes it");
    } else {
        tune_region_of_tolerances(m, t, region);
        take_values(root, region, low, high);
        region->noise_A =
            json_number_value(json_object_get(json_object_get(root, "error"), "sensor_noise_A"));
        const int intervals = take_intervals(region, low, high);
        ok = take_covariance(covariance, region, &psi_deviation) ||
             error_input(e, path, 0, 0, "covariance: expected a symmetric matrix that is positive definite");
        if (psi_deviation > 0.0) {
            region->psi_high = sqrt(chi_squared_95[1]) * psi_deviation;
            region->psi_low = -region->psi_high;
        }
        /* Each inductance by itself, unless the box still holds both as tolerances or a mean made them. */
        region->alike = region->alike && !(high[AXIS_D] > low[AXIS_D]) && !(high[AXIS_Q] > low[AXIS_Q]) &&
                        region->high[AXIS_D] > region->low[AXIS_D] &&
                        region->high[AXIS_Q] > region->low[AXIS_Q];
        (void)snprintf(
            region->source, sizeof region->source, "%s",
            region->known > 0 ? "the 95 % ellipsoid of the diagnosis' covariance"
            : intervals > 0
                ? "the diagnosis' 95 % intervals, taken as independent: it has no covariance of R and L"
                : "stated tolerances: the diagnosis has neither covariance nor intervals of R and L");
        tune_region_add_points(region);
        region->L_off = tune_region_L_off(region);
        add_fall(m, t, region);
        tune_region_add_points(region);
    }
    json_free(root);
    return ok;
}
