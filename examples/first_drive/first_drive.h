/*
 * The smallest drive: one motor, its cycle, a current reference. The same on every target.
 */
#ifndef EXAMPLES_FIRST_DRIVE_H
#define EXAMPLES_FIRST_DRIVE_H

#include "iqfoc/cycle.h"

#define FIRST_DRIVE_PWM_HZ 5000

/*
 * Makes the cycle ready and lets it ask for i_q. ticks_per_second: of the port's clock. False if
 * it was refused.
 */
bool first_drive_start(iqfoc_cycle_t *cycle, uint32_t ticks_per_second, iq24_t i_q);

#endif
