/*
 * The recording to make: pieces chosen by how well they let the causes be told apart.
 *
 * Each piece is run once in the switching-level drive for a twentieth of the time; the information of a recording
 * is the sum of its runs'. Chosen is what makes the sum over the parameters asked for of log(variance) least, each
 * variance with all the others unknown, and beside it the correlation r of the worst pair, as -10 log(1 - r^2):
 * first the slot that lowers it most, one after the other, then exchanges as long as one helps. Such a sum is
 * the logarithm of the covariance's determinant less that of the correlations': what cannot be told from another
 * counts as not known. Of several choices that do about as well, the margin for what no model knows lies in
 * the worst pair, and not in intervals that are a hundredth of what is worth a name.
 */
#ifndef SIM_HOST_PLAN_PLAN_H
#define SIM_HOST_PLAN_PLAN_H

#include "plan_information.h"
#include "plan_pieces.h"

enum { PLAN_RUNS = 20, PLAN_SLOTS = 20 };

/* What a recording lets be known, from its information. */
typedef struct plan_outlook {
    double half_width[PLAN_ASKED]; /* of the 95 % interval with all others unknown, in the parameter's unit */
    double over_least[PLAN_ASKED]; /* the same over what is worth a name */
    bool told[PLAN_ASKED];         /* the recording says anything of it */
    double worst_correlation;      /* largest of two parameters that are told */
    int worst[2];
    double median_over_least; /* of all asked for */
    /* Of each named hypothesis: the least size that is named, in units of `least` (1: all that is worth it), and
     * whom it is hardest to tell from. 0: it cannot be seen here. */
    double limit[H_COUNT];
    hypothesis_id rival[H_COUNT];
    bool never[H_COUNT]; /* no size of it can be told from the rival */
} plan_outlook;

typedef struct plan {
    size_t pieces, tried;
    plan_piece piece[PLAN_RUNS]; /* chosen */
    int slots[PLAN_RUNS];
    scenario_run run[PLAN_RUNS];
    scenario scenario; /* its runs are those */
    double seconds;    /* settling included */
    plan_outlook outlook;
} plan;

/* False with *e set if the limits leave no time or no piece. */
bool plan_make(const motor *m, const plan_limits *limits, long seed, plan *p, error *e);

/* What a scenario's recording would let be known. */
bool plan_look(const motor *m, const scenario *s, long seed, plan_outlook *out, error *e);

/* The outlook of an information. */
void plan_outlook_of(const plan_information *info, plan_outlook *out);

/* What is made least: above, in units of what is worth a name. */
double plan_unknown(double h[PLAN_ASKED][PLAN_ASKED]);

#endif
