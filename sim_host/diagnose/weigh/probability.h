/*
 * How probable each cause is, by the evidence of the sets about the one that was chosen.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_PROBABILITY_H
#define SIM_HOST_DIAGNOSE_WEIGH_PROBABILITY_H

#include "evidence.h"

/*
 * The set as it is, with one member less, with one more, and with one in place of another: each weighs exp(-score/2), the score what the
 * search compares, over how much wider than white noise the scores scatter. A cause's probability is the share of the sets that hold one
 * of its hypotheses, or one that contains a member's. Sets without a member are weighed with its tolerance held: what is beyond `least`
 * is none.
 */
typedef struct standing {
    double against; /* by what a member reduces -2 log likelihood, so held; 0 of others */
    double probability;
    double alone; /* the same without what is contained: of this hypothesis rather than a larger one */
    double rival; /* the weight of the likeliest set without the cause, over that of the state's own */
} standing;

enum { RIVALS_FITTED = 16 };

/* What sets were fitted about a state, and their scores. */
typedef struct rival_fits {
    fit_state of;
    hypothesis_set possible;
    size_t count;
    hypothesis_set set[RIVALS_FITTED];
    double score[RIVALS_FITTED];
} rival_fits;

/*
 * One entry a hypothesis; those of a cause are alike. With d, a set that the parabola makes likelier than the state's own is fitted; fits keeps these.
 * False: out of memory.
 */
bool probability_of(const evidence_view *view, const fit_state *s, hypothesis_set possible, double inflation,
                    fit_data *d, rival_fits *fits, standing of[H_COUNT]);

#endif
