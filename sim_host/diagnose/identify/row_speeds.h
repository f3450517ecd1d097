/* The speeds of the rows: corrects them by the recorded angle, and places them in the table of the exact step. */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_SPEEDS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_SPEEDS_H

#include "rows.h"

/*
 * Makes the speeds at the samples those of the cycles between them, in each stretch. The difference between the angle and the integrated
 * speed is fitted by a parabola, and its slope corrects the speed: errors of the angle that repeat with the revolution average out. A
 * cycle then has the mean of the speeds at its start and end. By the speed at its start alone, an acceleration would leave psi_f times half
 * a cycle's change of it, which a fit of a ramp takes for a resistance.
 */
void rows_correct_speed(diagnose_rows *r);

/*
 * Gives every row, before and after each correction, the nearest node of an even grid of speeds. Keeps only the nodes in use. False:
 * out of memory.
 */
bool rows_place_nodes(diagnose_rows *r);

#endif
