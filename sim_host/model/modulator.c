/* Duties by the common part that a modulator adds (modulator.h). */
#include "modulator.h"

#include "base/vector.h"

#include <stdbool.h>
#include <stddef.h>

const char *const modulator_words[MODULATORS] = {
    [MODULATOR_MIN_MAX] = "space vectors",
    [MODULATOR_SINE] = "sine",
    [MODULATOR_LOW] = "the lowest leg held low",
    [MODULATOR_HIGH] = "the highest leg held high",
    [MODULATOR_LARGEST] = "the leg of the largest voltage held",
    [MODULATOR_AHEAD] = "the leg of the largest voltage held, 30 degrees ahead",
    [MODULATOR_BEHIND] = "the leg of the largest voltage held, 30 degrees behind",
    [MODULATOR_MIDDLE] = "the leg of the middle voltage held",
};

/* Which of three is the largest, or the middle one, by size. */
static size_t by_size(const double u[3], bool middle)
{
    size_t most = 0;
    size_t least = 0;
    for (size_t x = 1; x < 3; x++) {
        most = fabs(u[x]) > fabs(u[most]) ? x : most;
        least = fabs(u[x]) <= fabs(u[least]) ? x : least;
    }
    return middle && most != least ? 3 - most - least : most;
}

/* The common part, of the link, that puts leg x at the rail of its voltage's sign; which leg, a voltage turned by so much says. */
static double to_rail(const double u[3], double turn_rad, bool middle, double per_V)
{
    const vec_ab v = vec_from_phases(u);
    const vec_rotor r = rotor_at(turn_rad);
    double seen[3];
    vec_to_phases((vec_ab){r.cos * v.alpha - r.sin * v.beta, r.sin * v.alpha + r.cos * v.beta}, seen);
    const size_t x = by_size(seen, middle);
    return (seen[x] > 0.0 ? 0.5 : -0.5) - u[x] * per_V;
}

static double common_part(modulator which, const double u[3], double per_V)
{
    const double high = fmax(u[0], fmax(u[1], u[2]));
    const double low = fmin(u[0], fmin(u[1], u[2]));
    switch (which) {
    case MODULATOR_SINE:
        return 0.0;
    case MODULATOR_LOW:
        return -0.5 - low * per_V;
    case MODULATOR_HIGH:
        return 0.5 - high * per_V;
    case MODULATOR_LARGEST:
        return to_rail(u, 0.0, false, per_V);
    case MODULATOR_AHEAD:
        return to_rail(u, VEC_PI / 6.0, false, per_V);
    case MODULATOR_BEHIND:
        return to_rail(u, -VEC_PI / 6.0, false, per_V);
    case MODULATOR_MIDDLE:
        return to_rail(u, 0.0, true, per_V);
    case MODULATOR_MIN_MAX:
    default:
        return -0.5 * (high + low) * per_V;
    }
}

void modulator_duties(modulator which, const double u_V[3], double u_dc_V, double duty[3])
{
    const double per_V = u_dc_V > 0.0 ? 1.0 / u_dc_V : 0.0;
    const double common = per_V > 0.0 ? common_part(which, u_V, per_V) : 0.0;
    for (size_t x = 0; x < 3; x++) {
        duty[x] = fmin(fmax(0.5 + u_V[x] * per_V + common, 0.0), 1.0);
    }
}
