#include "plausible.h"

bool plausible_check(const recording *rec, const char *path, const motor *m, error *e)
{
    (void)m;
    size_t longest = 0;
    for (size_t s = 0; s < rec->stretches; s++) {
        longest = rec->stretch[s].count > longest ? rec->stretch[s].count : longest;
    }
    if (longest < 50) {
        return error_input(e, path, 0, 0,
                           "the longest stretch of consecutive cycles has %zu rows; at least 50 are needed",
                           longest);
    }
    return true;
}
