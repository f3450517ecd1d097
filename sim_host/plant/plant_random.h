/*
 * Random numbers of the plant: the same bits on every machine for the same seed.
 * xoshiro256++ (Blackman and Vigna, 2019), seeded by splitmix64 as its authors recommend.
 */
#ifndef SIM_HOST_PLANT_PLANT_RANDOM_H
#define SIM_HOST_PLANT_PLANT_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

typedef struct plant_random {
    uint64_t s[4];
    double spare; /* the second of a pair of Gaussians */
    bool has_spare;
} plant_random;

/* Streams of one seed are independent: an effect that draws more does not change what another draws. */
void plant_random_seed(plant_random *r, uint64_t seed, uint64_t stream);

uint64_t plant_random_bits(plant_random *r);

/* Uniform on [0, 1), 53 bits. */
double plant_random_uniform(plant_random *r);

/* Normal, mean 0, standard deviation 1 (Marsaglia's polar method). */
double plant_random_normal(plant_random *r);

#endif
