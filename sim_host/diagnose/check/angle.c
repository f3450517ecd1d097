/* Compares the angle and the speed column (angle.h). */
#include "angle.h"

#include "base/sort.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* Median of (step of theta, unwrapped by `turn`) / (omega T), over rows that move; 0 if hardly any does. */
static double growth(const recording *rec, double turn)
{
    double *ratio = calloc(rec->rows, sizeof *ratio);
    double median = 0.0;
    size_t n = 0;
    double fastest = 0.0;
    for (size_t k = 0; k < rec->rows; k++) {
        fastest = fmax(fastest, fabs(rec->omega_e_rad_s[k]));
    }
    for (size_t s = 0; ratio && s < rec->stretches; s++) {
        for (size_t j = 1; j < rec->stretch[s].count; j++) {
            size_t k = rec->stretch[s].first + j;
            double expected = rec->omega_e_rad_s[k] * rec->T_s;
            double step = rec->theta_e_rad[k] - rec->theta_e_rad[k - 1];
            step -= turn * round(step / turn);
            if (fabs(rec->omega_e_rad_s[k]) > 0.05 * fastest && fabs(expected) > 1e-4) {
                ratio[n++] = step / expected;
            }
        }
    }
    if (n > 50) {
        sort_ascending(ratio, n);
        median = ratio[n / 2];
    }
    free(ratio);
    return median;
}

static bool near(double x, double target)
{
    return fabs(x - target) < 0.06 * fabs(target);
}

bool check_angle(const recording *rec, const motor *m, error *e)
{
    double lowest = INFINITY;
    double highest = -INFINITY;
    double jump = 0.0;
    double moves = 0.0;
    for (size_t s = 0; s < rec->stretches; s++) {
        for (size_t j = 0; j < rec->stretch[s].count; j++) {
            size_t k = rec->stretch[s].first + j;
            lowest = fmin(lowest, rec->theta_e_rad[k]);
            highest = fmax(highest, rec->theta_e_rad[k]);
            double step = j > 0 ? fabs(rec->theta_e_rad[k] - rec->theta_e_rad[k - 1]) : 0.0;
            jump = fmax(jump, step);
            moves = fmax(moves, fabs(rec->omega_e_rad_s[k]) * rec->T_s);
        }
    }
    if (jump > 300.0 && jump <= 360.5 && highest - lowest <= 360.5) {
        return error_input(
            e, rec->path, 0, 0,
            "theta_e_rad runs from %.4g to %.4g and wraps by 360: it looks like degrees; expected radians",
            lowest, highest);
    }
    if (jump > 0.5 && highest - lowest <= 1.001 && moves > 1e-3 && moves < 0.45) {
        return error_input(
            e, rec->path, 0, 0,
            "theta_e_rad runs from %.4g to %.4g and wraps by 1: it looks like turns; expected radians",
            lowest, highest);
    }
    double ratio = growth(rec, VEC_TWO_PI);
    double pairs = (double)m->pole_pairs;
    if (ratio == 0.0 || (ratio > 0.7 && ratio < 1.4)) {
        return true;
    }
    const char *why = "theta_e_rad and omega_e_rad_s do not match";
    if (near(ratio, -1.0)) {
        why = "omega_e_rad_s and the slope of theta_e_rad have opposite signs: one of them counts backwards";
    } else if (near(ratio, VEC_TWO_PI / 60.0) || near(ratio, pairs * VEC_TWO_PI / 60.0)) {
        why = "omega_e_rad_s looks like revolutions per minute; expected electrical rad/s";
    } else if (near(ratio, VEC_TWO_PI)) {
        why = "omega_e_rad_s looks like hertz; expected rad/s";
    } else if (m->pole_pairs > 1 && near(ratio, pairs)) {
        why = "omega_e_rad_s looks mechanical; expected electrical rad/s";
    } else if (m->pole_pairs > 1 && near(ratio, 1.0 / pairs)) {
        why = "theta_e_rad looks mechanical; expected the electrical angle";
    } else if (near(ratio, 1000.0) || near(ratio, 0.001)) {
        why = "omega_e_rad_s is wrong by a factor of 1000";
    } else if (near(ratio, 57.2957795) || near(ratio, 0.01745329)) {
        why = "one of theta_e_rad and omega_e_rad_s looks like degrees";
    }
    return error_input(e, rec->path, 0, 0, "%s (the angle changes by %.3g times omega T per cycle)", why,
                       ratio);
}
