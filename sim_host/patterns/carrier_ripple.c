/* Spectrum of the flux under space-vector modulation (carrier_ripple.h). */
#include "carrier_ripple.h"

#include "base/vector.h"

#include <complex.h>
#include <stdbool.h>
#include <string.h>

enum { POSITIONS = 8, ORDER_MOST = 97, CORRECTIONS = 4 };

/* Coefficients of e^{jnx} of the flux, n from -ORDER_MOST, in units of half the link over the angular frequency. */
typedef struct spectrum {
    double complex flux[2 * ORDER_MOST + 1];
} spectrum;

/* Adds a step of 2 (half links) times `axis` at angle x. */
static void add_edge(spectrum *s, double complex axis, double x, int orders)
{
    const double complex turn = cexp(-I * x);
    double complex at = 1.0;
    for (int n = 1; n <= orders; n++) {
        at *= turn;
        const double size = -2.0 / (VEC_TWO_PI * n * n);
        s->flux[ORDER_MOST + n] += size * axis * at;
        s->flux[ORDER_MOST - n] += size * axis * conj(at);
    }
}

/* One turn with the amplitude, in half links. False if a duty leaves 0 to 1. */
static bool modulate(spectrum *s, int pulses, double amplitude, double position, int orders)
{
    const double period = VEC_TWO_PI / pulses;
    memset(s, 0, sizeof *s);
    for (int k = 0; k < pulses; k++) {
        const double middle = period * (k + 0.5 + position);
        double u[3];
        for (int x = 0; x < 3; x++) {
            u[x] = amplitude * cos(middle - x * VEC_TWO_PI / 3.0);
        }
        const double common = 0.5 * (fmax(u[0], fmax(u[1], u[2])) + fmin(u[0], fmin(u[1], u[2])));
        for (int x = 0; x < 3; x++) {
            const double complex axis = 2.0 / 3.0 * cexp(I * (x * VEC_TWO_PI / 3.0));
            const double half = 0.25 * period * (1.0 + u[x] - common);
            if (fabs(u[x] - common) > 1.0) {
                return false;
            }
            add_edge(s, axis, middle - half, orders);
            add_edge(s, -axis, middle + half, orders);
        }
    }
    return true;
}

/* Mean square of the harmonic flux, each direction with its weight. */
static double harmonic_square(const spectrum *s, const pattern_weight *w)
{
    const double complex *f = s->flux + ORDER_MOST;
    const double complex back = conj(f[1]) / cabs(f[1]);
    double sum = 0.0;
    for (int k = 1; k < ORDER_MOST; k++) {
        const double complex up = f[1 + k] * back;
        const double complex down = k == 1 ? 0.0 : conj(f[1 - k] * back);
        const double along = w->along * cabs(up + down);
        const double across = w->across * cabs(up - down);
        sum += 0.5 * (along * along + across * across);
    }
    return sum;
}

static double at_position(int pulses, double index, double position, const pattern_weight *w)
{
    const double wanted = 4.0 / VEC_PI * index;
    double amplitude = wanted;
    spectrum s;
    for (int n = 0; n < CORRECTIONS; n++) {
        if (!modulate(&s, pulses, amplitude, position, 1)) {
            return NAN;
        }
        amplitude *= wanted / cabs(s.flux[ORDER_MOST + 1]);
    }
    if (!modulate(&s, pulses, amplitude, position, ORDER_MOST)) {
        return NAN;
    }
    return harmonic_square(&s, w) / (wanted * wanted);
}

double carrier_ripple(int pulses, double index, const pattern_weight *w)
{
    double sum = 0.0;
    for (int n = 0; n < POSITIONS; n++) {
        sum += at_position(pulses, index, (double)n / POSITIONS, w);
    }
    return sqrt(sum / POSITIONS);
}
