/* The plant's random numbers (plant_random.h). */
#include "plant_random.h"

#include <math.h>

static uint64_t splitmix64(uint64_t *state)
{
    uint64_t z = (*state += UINT64_C(0x9E3779B97F4A7C15));
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static uint64_t rotate_left(uint64_t x, int k)
{
    return (x << k) | (x >> (64 - k));
}

void plant_random_seed(plant_random *r, uint64_t seed, uint64_t stream)
{
    /* The stream goes through the mixer once: seed + 1 and stream + 1 must not land on the same state. */
    uint64_t of_stream = stream;
    uint64_t state = seed ^ splitmix64(&of_stream);
    for (int k = 0; k < 4; k++) {
        r->s[k] = splitmix64(&state);
    }
    r->spare = 0.0;
    r->has_spare = false;
}

uint64_t plant_random_bits(plant_random *r)
{
    uint64_t *s = r->s;
    uint64_t result = rotate_left(s[0] + s[3], 23) + s[0];
    uint64_t t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotate_left(s[3], 45);
    return result;
}

double plant_random_uniform(plant_random *r)
{
    return (double)(plant_random_bits(r) >> 11) * 0x1.0p-53;
}

double plant_random_normal(plant_random *r)
{
    if (r->has_spare) {
        r->has_spare = false;
        return r->spare;
    }
    double x, y, square;
    do {
        x = 2.0 * plant_random_uniform(r) - 1.0;
        y = 2.0 * plant_random_uniform(r) - 1.0;
        square = x * x + y * y;
    } while (square >= 1.0 || square == 0.0);
    double scale = sqrt(-2.0 * log(square) / square);
    r->spare = y * scale;
    r->has_spare = true;
    return x * scale;
}
