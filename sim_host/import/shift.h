/*
 * The shift between the command and the current of a log's rows.
 *
 *     the command in row k acts from cycle k + shift on
 *
 * as in interfaces.md's voltage_delay: applied in cycle k = recorded in cycle k - shift. A half is the mean of
 * two neighbours: the registers load at the carrier's peak, and each command acts in halves of two cycles.
 */
#ifndef SIM_HOST_IMPORT_SHIFT_H
#define SIM_HOST_IMPORT_SHIFT_H

#include "data/recording.h"

/*
 * Moves u_V and duty by `half_cycles` halves, and drops the rows of each stretch whose command is not in the
 * log. Of a half the voltages are kept and not the duties, since no pulse has the mean of two widths. False:
 * out of memory.
 */
bool shift_commands(recording *r, long half_cycles);

#endif
