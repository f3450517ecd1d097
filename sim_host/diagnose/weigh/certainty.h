/*
 * How sure: covariance of the fitted parameters that stays honest when the innovations are not white.
 *
 * In addition to the textbook inverse of J'J two sandwich estimates are made, (J'J)^-1 (sum of g g') (J'J)^-1, with
 * the scores g summed per block and per operating point. Small errors of the model are alike within a block,
 * or within an operating point, and differ between them: then the scatter of the scores is larger than the
 * noise would make it, and the interval grows. The widest of the three counts.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_CERTAINTY_H
#define SIM_HOST_DIAGNOSE_WEIGH_CERTAINTY_H

#include "diagnose/identify/fit_data.h"

typedef struct certainty {
    size_t columns;
    int column[COLUMN_COUNT];
    double covariance[COLUMN_COUNT][COLUMN_COUNT]; /* by blocks */
    double half_width[COLUMN_COUNT];               /* of the 95 % interval, in z */
    double inflation; /* how much wider than white noise would have it, in variance, >= 1 */
} certainty;

/* At a fitted state. If two columns are not distinguishable, every width is huge. False: out of memory. */
bool certainty_of(fit_data *d, const fit_state *s, certainty *c);

/*
 * The same of the columns in *c under a prior of this precision; the first `members` count for the inflation. The scatter of
 * the blocks has lost so many degrees of freedom: one a member that is free; only that of its mean where priors hold them all, as then
 * there may be more members than blocks. All else of *c is zero before, but the inflation, which is 1.
 */
bool certainty_under(fit_data *d, const fit_state *s, const double prior[][COLUMN_COUNT], size_t members,
                     size_t lost, certainty *c);

/* Chi square of a hypothesis' parameters being zero, robust. */
double certainty_chi_square(const certainty *c, const fit_state *s, hypothesis_id h);

/* Half width along a column, 0 if it was not fitted. */
double certainty_half_width(const certainty *c, int column);

/* Half width of a hypothesis' size, in the measure of its `least`. */
double certainty_of_size(const certainty *c, const fit_state *s, hypothesis_id h);

/*
 * Whether a hypothesis is larger than `least`, with its interval: a number by its half width, a vector whose length is its size if no
 * point as short lies in the ellipsoid that the half widths span. Terms of a flux map that trade each leave the length's own half
 * width as wide as it is, where no map as small fits at all.
 */
bool certainty_exceeds(const certainty *c, const fit_state *s, hypothesis_id h, double least);

/* How two columns lean on one another, -1 to 1; 0 if one was not fitted. */
double certainty_correlation(const certainty *c, int column, int other);

#endif
