/*
 * The rows' speeds: held to the recorded angle, and where each lies in the table of the exact step.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_SPEEDS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_SPEEDS_H

#include "rows.h"

/*
 * A recorded speed that is off disagrees with the recorded angle. Over a stretch the angle decides: its difference from the
 * integrated speed is fitted by a parabola, whose slope corrects the speed. Errors of the angle that come and go with the
 * revolution average out.
 */
void rows_correct_speed(diagnose_rows *r);

/* Gives every row, mended or not, the nearest node of an even grid of speeds, and keeps only the nodes in use. False: out of
 * memory. */
bool rows_place_nodes(diagnose_rows *r);

#endif
