/*
 * The library's vectors for the golden vectors: drawn component by component, and added to a digest likewise.
 */
#ifndef TESTS_TARGET_GOLDEN_TYPES_H
#define TESTS_TARGET_GOLDEN_TYPES_H

#include "digest.h"
#include "golden_inputs.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

static inline iq24_t golden_positive(golden_inputs_t *inputs, iq24_t limit)
{
    return iq24_abs_sat(golden_within(inputs, limit));
}

static inline iqfoc_ab_t golden_ab(golden_inputs_t *inputs, iq24_t limit)
{
    iqfoc_ab_t ab;
    ab.alpha = golden_within(inputs, limit);
    ab.beta = golden_within(inputs, limit);
    return ab;
}

static inline iqfoc_dq_t golden_dq(golden_inputs_t *inputs, iq24_t limit)
{
    iqfoc_dq_t dq;
    dq.d = golden_within(inputs, limit);
    dq.q = golden_within(inputs, limit);
    return dq;
}

static inline iqfoc_abc_t golden_abc(golden_inputs_t *inputs, iq24_t limit)
{
    iqfoc_abc_t abc;
    abc.a = golden_within(inputs, limit);
    abc.b = golden_within(inputs, limit);
    abc.c = golden_within(inputs, limit);
    return abc;
}

static inline void digest_ab(uint64_t *digest, iqfoc_ab_t ab)
{
    digest_add(digest, ab.alpha);
    digest_add(digest, ab.beta);
}

static inline void digest_dq(uint64_t *digest, iqfoc_dq_t dq)
{
    digest_add(digest, dq.d);
    digest_add(digest, dq.q);
}

static inline void digest_abc(uint64_t *digest, iqfoc_abc_t abc)
{
    digest_add(digest, abc.a);
    digest_add(digest, abc.b);
    digest_add(digest, abc.c);
}

#endif
