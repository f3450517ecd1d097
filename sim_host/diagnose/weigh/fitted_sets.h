/*
 * The sets that were fitted from a state that was a fit already, and where they came out: what they can do is known, as long as
 * the law of the edges is the same and no stretch was turned.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_FITTED_SETS_H
#define SIM_HOST_DIAGNOSE_WEIGH_FITTED_SETS_H

#include "diagnose/identify/fit_data.h"

typedef struct fitted_set {
    hypothesis_set asked; /* state.set has less where a member turned out too small */
    double worth;         /* reduction by the tolerances of its laws (tolerance.h) */
    fit_state state;
} fitted_set;

/* All zero: none yet. */
typedef struct fitted_sets {
    fitted_set *one;
    size_t count, room;
    edge_law edge; /* the law that they were fitted under */
} fitted_sets;

/* How `asked` came out, or NULL where that is not known or took what is not allowed. Holds until the next is kept. */
const fitted_set *fitted_sets_find(const fitted_sets *f, hypothesis_set asked, hypothesis_set allowed);

/* Without memory it is not kept, and will be fitted again. */
void fitted_sets_keep(fitted_sets *f, hypothesis_set asked, const fit_state *state, double worth);

/* None is known under another law of the edges. */
void fitted_sets_forget(fitted_sets *f, edge_law edge);

void fitted_sets_free(fitted_sets *f);

#endif
