/*
 * What a motor file's last digits leave open.
 *
 * No file is exact: each ordinary parameter (R, L_d, L_q, psi_f, the voltages' and sensors' scales, offsets, the
 * angle) may be off by a part of what would be worth a name. Each has a normal prior of that width (`digits` of its
 * coordinate) and is marginalised: the sums of a view are deflated once by what these small moves can take off, and
 * every set of causes is then weighed as before. A set that trades exactly for one cause (voltage gain, R and psi for L:
 * scaling all four changes nothing) gains nothing by it any more, because what it would mop up is mopped up already.
 *
 * With y the step of a set's own coordinates, d that of the small ones, and P their prior precisions, the cost
 * c + 2 g.(y + d) + (y + d)' H (y + d) + d' P d has its optimum over d at d = -M (g + H y), M = (H + P)^-1, all on
 * the small coordinates; what is left is again a quadratic form in y, with H - H M H, g - H M g and c - g' M g.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_LAST_DIGITS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_LAST_DIGITS_H

#include "gram.h"

/* The coordinates that may move unnamed in these rows; returns how many. */
size_t last_digits_list(const diagnose_rows *r, coordinate_id at[P_COUNT]);

/*
 * Appends them to the columns of a state's members, each with the precision of its prior (of the others' entries
 * nothing is said); returns how many columns there are then. Of coordinates that members move jointly, as many go
 * in as the members' directions leave free.
 */
size_t last_digits_append(const fit_data *d, const fit_state *s, size_t members, int column[COLUMN_COUNT],
                          double prior[COLUMN_COUNT]);

/* What z holds beside the set's own directions. */
void last_digits_rest(hypothesis_set set, const double z[P_COUNT], double rest[P_COUNT]);

/*
 * Deflates the sums of all columns by what may move unnamed, but for the coordinates that are `held` (may be NULL). If they
 * cannot be they stay as they are: then nothing moves unnamed.
 */
void last_digits_deflate(const diagnose_rows *r, const bool *held, gram *sums);

/* -2 log of the prior of what z moves beside the set's own directions, up to a constant. */
double last_digits_unusual(hypothesis_set set, const double z[P_COUNT]);

/* Takes what lies beside the set's own directions back to where it may be unnamed. */
void last_digits_bound(hypothesis_set set, double z[P_COUNT]);

/* A hypothesis goes: what its coordinates may keep unnamed stays, the rest returns to the motor file's. */
void last_digits_keep(hypothesis_id h, double z[P_COUNT]);

#endif
