/*
 * Parameter tolerances: small deviations from the motor file that have no name.
 *
 * No motor file is exact. Each ordinary parameter (R, L_d, L_q, psi_f, scales of voltages and sensors, offsets, the angle) may
 * deviate by a part of its reporting threshold. Each deviation has a normal prior of that width (`digits` of its coordinate) and is
 * marginalised: the sums of a view are deflated once by all these deviations, and every set of causes is then weighed as before. Some
 * sets are equivalent to one cause: voltage gain, R and psi_f to L, because scaling all four changes nothing. Such a set gains
 * nothing more, because the tolerances absorb the small error that it would fit.
 *
 * With y the step of a set's own coordinates, d that of the tolerances, and P their prior precisions, the cost
 *
 *     c + 2 g.(y + d) + (y + d)' H (y + d) + d' P d
 *
 * has its minimum over d at d = -M (g + H y), M = (H + P)^-1, all on the coordinates of the tolerances. The minimum is again a
 * quadratic form in y, with H - H M H, g - H M g and c - g' M g.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_LAST_DIGITS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_LAST_DIGITS_H

#include "gram.h"

/* The coordinates that have a tolerance and that these rows show; returns how many. */
size_t last_digits_list(const diagnose_rows *r, coordinate_id at[P_COUNT]);

/*
 * Appends these coordinates to the columns of a state's members. Writes the precision of each one's prior to `prior`, and leaves the
 * members' entries as they are. Returns the number of columns. If members move several coordinates jointly, only as many of these are
 * appended as the members' directions leave free.
 */
size_t last_digits_append(const fit_data *d, const fit_state *s, size_t members, int column[COLUMN_COUNT],
                          double prior[COLUMN_COUNT]);

/* The part of z that is not along the set's own directions. */
void last_digits_rest(hypothesis_set set, const double z[P_COUNT], double rest[P_COUNT]);

/*
 * Deflates the sums of all columns by the tolerances, except for the coordinates that are `held` (may be NULL). If that cannot be
 * solved, the sums do not change: then nothing has a tolerance.
 */
void last_digits_deflate(const diagnose_rows *r, const bool *held, gram *sums);

/* -2 log of the prior of the part of z that is not along the set's own directions, up to a constant. */
double last_digits_unusual(hypothesis_set set, const double z[P_COUNT]);

/* Limits the part of z that is not along the set's own directions to three standard deviations of the tolerances. */
void last_digits_bound(hypothesis_set set, double z[P_COUNT]);

/* Takes a hypothesis out of z: limits its coordinates to three standard deviations of their tolerances, 0 if they have none. */
void last_digits_keep(hypothesis_id h, double z[P_COUNT]);

#endif
