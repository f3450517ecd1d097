/*
 * A DC-link voltage with a ripple that its column does not show, u_dc (1 + share sin(2 pi frequency t + phase)): the legs' voltages swing
 * with it, and with them the cycle's mean. Far slower than the carrier, it is the same throughout a cycle.
 */
#ifndef SIM_HOST_MODEL_LINK_RIPPLE_H
#define SIM_HOST_MODEL_LINK_RIPPLE_H

#include "averaged_drive.h"

/* The row under a link that is `factor` of what was recorded. The rows after it know of it by link_ripple_tell. */
void link_ripple_scale(cycle_row *row, double factor);

/* What a row knows of those before it, which may have another link now. `behind`: how many of its stretch there are. */
void link_ripple_tell(cycle_row *row, size_t behind);

#endif
