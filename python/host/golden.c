/* Whether this build computes what every other does: the hash over all golden vectors (golden_hash.h). */
#include "golden_hash.h"

#include "interface.h"

uint64_t py_golden(uint64_t *expected)
{
    *expected = GOLDEN_HASH;
    return golden_hash(NULL);
}
