/* The proof itself: each of the three mistakes planted here must raise an alarm. */
#include "any.h"

static const int32_t table[6] = {1, 2, 3, 4, 5, 6};
volatile int32_t sink;

/* A sum that overflows. */
void planted_overflow(void)
{
    sink = any() + any_within(0, 1);
}

/* A shift beyond the width. */
void planted_shift(void)
{
    sink = any_within(0, 7) << any_count(0, 32);
}

/* An index out of bounds. */
void planted_index(void)
{
    sink = table[any_within(0, 6)];
}
