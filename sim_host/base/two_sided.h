/* A mean from both sides, as that of a random walk with noise is. */
#ifndef SIM_HOST_BASE_TWO_SIDED_H
#define SIM_HOST_BASE_TWO_SIDED_H

#include <stddef.h>

/*
 * Replaces each of n numbers by the mean of all with the weights weight^distance, 0 <= weight < 1. At the ends fewer numbers count.
 * `work` holds n numbers.
 */
void two_sided_mean(double *x, double *work, size_t n, double weight);

#endif
