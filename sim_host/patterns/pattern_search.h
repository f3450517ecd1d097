/* Patterns of least distortion at a given index (pattern_shape.h), by Gauss-Newton steps within bounds (base/solve.h). */
#ifndef SIM_HOST_PATTERNS_PATTERN_SEARCH_H
#define SIM_HOST_PATTERNS_PATTERN_SEARCH_H

#include "pattern_shape.h"

#include <stdbool.h>

/*
 * Moves the angles to the nearest minimum of pattern_distortion under pattern_index(s) = index and with `gap` or more,
 * rad, between all edges of the leg, also those of the other quarters. False if no such pattern is near: the angles are then
 * of no use.
 */
bool pattern_minimum(pattern_shape *s, double index, double gap, const pattern_weight *w);

/* The gaps' sum at which no room is left: pi/2 for gap (angles + 1/2). */
bool pattern_has_room(int angles, double gap);

/* Spreads the edges by `share` (angles + 1 positive numbers) over the room that the gaps leave. */
void pattern_spread(pattern_shape *s, double gap, const double *share);

#endif
