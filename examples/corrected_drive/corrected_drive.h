/*
 * A drive that puts right what a diagnosis found: the cycle with the corrections of iqfoc/extension.h inside,
 * its constants from the header that `iqfoc diagnose -o DIR` wrote (docs/tutorial.md). The same on every
 * target.
 */
#ifndef EXAMPLES_CORRECTED_DRIVE_H
#define EXAMPLES_CORRECTED_DRIVE_H

#include "iqfoc/cycle.h"
#include "iqfoc/methods.h"

#define CORRECTED_DRIVE_PWM_HZ 4000

/* As first_drive's; the last: samples, dead time and saturation are put right. */
static const iqfoc_methods_t corrected_drive_methods = {IQFOC_MODEL_QUASI_DISCRETE,
                                                        IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN, IQFOC_CONTROL_PI,
                                                        IQFOC_MODULATION_PWM, true};

/*
 * Makes the cycle ready and lets it ask for i_q. ticks_per_second: of the port's clock. False if
 * it was refused.
 */
bool corrected_drive_start(iqfoc_cycle_t *cycle, uint32_t ticks_per_second, iq24_t i_q);

#endif
