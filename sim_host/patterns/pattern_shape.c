/* Harmonics of a pulse pattern, and their derivatives (pattern_shape.h). */
#include "pattern_shape.h"

#include "base/vector.h"

#include <stddef.h>

/* b_n/n and its derivatives by the angles, from cos and sin of n times each angle. */
static double flux_of(const pattern_shape *s, int n, const vec_rotor *at, double *slope)
{
    const double unit = 4.0 * s->start / (VEC_PI * n);
    double sum = 1.0;
    double sign = -2.0;
    for (int k = 0; k < s->angles; k++, sign = -sign) {
        sum += sign * at[k].cos;
        slope[k] = -unit * sign * at[k].sin;
    }
    return unit * sum / n;
}

double pattern_harmonic(const pattern_shape *s, int n)
{
    vec_rotor at[PATTERN_ANGLES_MOST];
    double slope[PATTERN_ANGLES_MOST];
    for (int k = 0; k < s->angles; k++) {
        at[k] = rotor_at(n * s->angle[k]);
    }
    return n * flux_of(s, n, at, slope);
}

double pattern_fundamental(const pattern_shape *s, double slope[PATTERN_ANGLES_MOST])
{
    vec_rotor at[PATTERN_ANGLES_MOST];
    for (int k = 0; k < s->angles; k++) {
        at[k] = rotor_at(s->angle[k]);
    }
    return flux_of(s, 1, at, slope);
}

double pattern_index(const pattern_shape *s)
{
    return pattern_harmonic(s, 1) * VEC_PI / 4.0;
}

void pattern_errors(const pattern_shape *s, const pattern_weight *w, double error[PATTERN_ERRORS],
                    double slope[PATTERN_ERRORS][PATTERN_ANGLES_MOST])
{
    vec_rotor low[PATTERN_ANGLES_MOST];
    vec_rotor by_two[PATTERN_ANGLES_MOST];
    vec_rotor by_six[PATTERN_ANGLES_MOST];
    for (int k = 0; k < s->angles; k++) {
        low[k] = rotor_at(-s->angle[k]);
        by_two[k] = rotor_at(2.0 * s->angle[k]);
        by_six[k] = rotor_at(6.0 * s->angle[k]);
    }
    for (int pair = 0; pair < PATTERN_PAIRS; pair++) {
        vec_rotor high[PATTERN_ANGLES_MOST];
        double p[PATTERN_ANGLES_MOST];
        double q[PATTERN_ANGLES_MOST];
        for (int k = 0; k < s->angles; k++) {
            low[k] = rotor_turned(low[k], by_six[k]);
            high[k] = rotor_turned(low[k], by_two[k]);
        }
        const double below = flux_of(s, 6 * pair + 5, low, q);
        const double above = flux_of(s, 6 * pair + 7, high, p);
        error[2 * pair] = w->along * (above + below);
        error[2 * pair + 1] = w->across * (above - below);
        for (int k = 0; slope != NULL && k < s->angles; k++) {
            slope[2 * pair][k] = w->along * (p[k] + q[k]);
            slope[2 * pair + 1][k] = w->across * (p[k] - q[k]);
        }
    }
}

double pattern_distortion(const pattern_shape *s, const pattern_weight *w)
{
    double error[PATTERN_ERRORS];
    double squares = 0.0;
    pattern_errors(s, w, error, NULL);
    for (int n = 0; n < PATTERN_ERRORS; n++) {
        squares += error[n] * error[n];
    }
    return sqrt(0.5 * squares) / fabs(pattern_harmonic(s, 1));
}
