/*
 * What laws may err by, marginalised.
 *
 * No law is exact. That of each cause holds to a stated share (`LAW_HOLDS` of the catalogue) of its effect at each
 * operating point, and what shapes it may differ from point to point (`wanders` of the coordinate). With v the direction
 * in which a member of the state lies, g and H one operating point's sums, D the columns v of all members and T their
 * variances, the errors of that point have their optimum at -M D'g, M = (1/T + D'HD)^-1, and what is left is again a
 * quadratic form: H - HD M D'H, g - HD M D'g and c - g'D M D'g. Done once a point, every set of causes is then weighed as
 * before: what only takes up what another's law leaves gains nothing by it.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_TOLERANCE_H
#define SIM_HOST_DIAGNOSE_WEIGH_TOLERANCE_H

#include "diagnose/identify/gram.h"

/*
 * Sums each operating point's blocks over `n` columns, deflates them by what the laws of the state's members may err by
 * there, and adds all up in *sums (indices local to the list). Returns by what that reduces -2 log likelihood, less the reduction
 * by so many free numbers alone. `scatter`, where not NULL, is each cause's share by which its effect
 * differs from point to point beyond the noise, -1 where no more than that. False: out of memory.
 */
bool tolerance_sum(const fit_data *d, const fit_state *s, const gram *blocks, const int *column, size_t n,
                   gram *sums, double *worth, double scatter[CAUSE_COUNT]);

/* The same worth alone, of a state that was fitted. */
bool tolerance_of_state(fit_data *d, const fit_state *s, double *worth);

#endif
