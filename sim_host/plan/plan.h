/*
 * Designs a test recording that separates the possible causes, out of test segments (`plan_piece`).
 *
 * Each segment runs once in the switching-level plant for a twentieth of the time. The information of a recording is
 * the sum of its runs'. The choice minimises the sum over the parameters of log(variance), each with all others
 * unknown, plus -10 log(1 - r^2), where r is the correlation of the worst pair. It first adds the slot that lowers
 * the sum most, one after the other, and then exchanges slots as long as one helps. The sum is the logarithm of the
 * covariance's determinant less that of the correlations'. A parameter that is not distinguishable from another
 * therefore counts as unknown. Among similar choices the worst pair matters more for unmodelled effects than
 * intervals of a hundredth of the reporting threshold.
 */
#ifndef SIM_HOST_PLAN_PLAN_H
#define SIM_HOST_PLAN_PLAN_H

#include "plan_information.h"

#include "data/plan_pieces.h"

enum { PLAN_RUNS = 20, PLAN_SLOTS = 20 };

/* Expected knowledge from a recording, by its information. */
typedef struct plan_outlook {
    double half_width[PLAN_ASKED]; /* of the 95 % interval with all others unknown, in the parameter's unit */
    double over_least[PLAN_ASKED]; /* the same over the reporting threshold */
    bool determined[PLAN_ASKED];   /* the recording determines it */
    double worst_correlation;      /* largest of two determined parameters */
    int worst[2];
    double median_over_least; /* of all asked for */
    /*
     * Of each named hypothesis: the smallest reported size in units of the reporting threshold `least`, and its
     * closest alternative. 0: not visible here.
     */
    double limit[H_COUNT];
    hypothesis_id rival[H_COUNT];
    bool never[H_COUNT]; /* not distinguishable from the rival at any size */
} plan_outlook;

typedef struct plan {
    size_t pieces, tried;
    plan_piece piece[PLAN_RUNS]; /* chosen */
    int slots[PLAN_RUNS];
    scenario_run run[PLAN_RUNS];
    scenario scenario; /* its runs are `run` */
    double seconds;    /* settling included */
    plan_outlook outlook;
} plan;

/* False with *e set if the limits leave no time or no segment. */
bool plan_make(const motor *m, const plan_limits *limits, long seed, plan *p, error *e);

/* The outlook of a scenario's recording. */
bool plan_look(const motor *m, const scenario *s, long seed, plan_outlook *out, error *e);

/* The outlook of an information. */
void plan_outlook_of(const plan_information *info, plan_outlook *out);

/* The minimised sum above, in units of the reporting thresholds. */
double plan_unknown(double h[PLAN_ASKED][PLAN_ASKED]);

#endif
