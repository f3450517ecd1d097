/* Sorting numbers. */
#ifndef SIM_HOST_BASE_SORT_H
#define SIM_HOST_BASE_SORT_H

#include <stddef.h>

/* Into ascending order, without NaN among them. */
void sort_ascending(double *value, size_t count);

#endif
