/* The error of the recorded angle that repeats with the revolution (sensor_error.h). */
#include "sensor_error.h"

#include "base/vector.h"

#include <math.h>

sensor_error sensor_error_of(motor *m)
{
    sensor_error s = {.pole_pairs = m->pole_pairs};
    for (size_t n = 0; n < ANGLE_ORDERS; n++) {
        const motor_harmonic h = motor_harmonic_of(&m->ext, n);
        if (m->ext.has[h.cause]) {
            s.entry[s.entries++] = h;
        }
    }
    return s;
}

double sensor_error_at(const sensor_error *s, double theta_mech_rad)
{
    double ahead = 0.0;
    for (int again = 0; again < 3; again++) {
        const double is = theta_mech_rad - ahead / s->pole_pairs;
        ahead = 0.0;
        for (int n = 0; n < s->entries; n++) {
            const motor_harmonic *h = &s->entry[n];
            ahead += *h->amplitude_rad * cos(*h->order * is + *h->phase_rad);
        }
    }
    return ahead;
}

void sensor_error_angles(const recording *r, const stretch *at, int pole_pairs, int turned,
                         double *theta_mech_rad)
{
    double whole = VEC_TWO_PI * turned;
    for (size_t j = 0; j < at->count; j++) {
        const size_t k = at->first + j;
        if (r->theta_mech_rad != NULL) {
            theta_mech_rad[j] = r->theta_mech_rad[k];
            continue;
        }
        if (j > 0) {
            const double step = r->theta_e_rad[k] - r->theta_e_rad[k - 1];
            whole -= VEC_TWO_PI * round((step - r->omega_e_rad_s[k] * r->T_s) / VEC_TWO_PI);
        }
        theta_mech_rad[j] = (r->theta_e_rad[k] + whole) / pole_pairs;
    }
}

static double mean_square(const sensor_error *s, const double *off_rad, const double *theta_mech_rad,
                          size_t count)
{
    double sum = 0.0;
    for (size_t j = 0; j < count; j++) {
        if (!isnan(off_rad[j])) {
            const double off = remainder(off_rad[j] + sensor_error_at(s, theta_mech_rad[j]), VEC_TWO_PI);
            sum += off * off;
        }
    }
    return sum;
}

int sensor_error_turned(const sensor_error *s, const recording *r, const stretch *at, const double *off_rad,
                        double *theta_mech_rad)
{
    int best = 0;
    double least = INFINITY;
    for (int turned = 0; turned < s->pole_pairs && r->theta_mech_rad == NULL && s->entries > 0; turned++) {
        sensor_error_angles(r, at, s->pole_pairs, turned, theta_mech_rad);
        const double sum = mean_square(s, off_rad, theta_mech_rad, at->count);
        if (sum < least) {
            least = sum;
            best = turned;
        }
    }
    return best;
}
