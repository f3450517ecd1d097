/*
 * The sets that a search has fitted from a state that was a fit already: what they can do is known, as long as the law of
 * the edges is the same and no stretch was turned.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_FITTED_SETS_H
#define SIM_HOST_DIAGNOSE_CHOOSE_FITTED_SETS_H

#include "diagnose/identify/hypotheses.h"

enum { SEARCH_ROUNDS = 5, FITTED_A_ROUND = 6 };

typedef struct fitted_sets {
    hypothesis_set set[SEARCH_ROUNDS * FITTED_A_ROUND];
    size_t count;
    edge_law edge; /* the law that they were fitted under */
} fitted_sets;

static inline bool fitted_sets_have(const fitted_sets *f, hypothesis_set set)
{
    for (size_t k = 0; k < f->count; k++) {
        if (f->set[k] == set) {
            return true;
        }
    }
    return false;
}

#endif
