/* Sorting numbers (sort.h). */
#include "sort.h"

#include <stdlib.h>

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort_ascending(double *value, size_t count)
{
    qsort(value, count, sizeof *value, by_size);
}
