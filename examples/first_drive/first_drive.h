/*
 * The smallest drive: one motor, its cycle, a current reference. The same on every target.
 */
#ifndef EXAMPLES_FIRST_DRIVE_H
#define EXAMPLES_FIRST_DRIVE_H

#include "iqfoc/cycle.h"
#include "iqfoc/methods.h"

#define FIRST_DRIVE_PWM_HZ 5000

/* Constants, so that the compiler leaves out all other methods: predictor, feedback, controller, modulation. */
static const iqfoc_methods_t first_drive_methods = {IQFOC_MODEL_QUASI_DISCRETE,
                                                    IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN, IQFOC_CONTROL_PI,
                                                    IQFOC_MODULATION_PWM, false};

/*
 * Makes the cycle ready and lets it ask for i_q. ticks_per_second: of the port's clock. False if
 * it was refused.
 */
bool first_drive_start(iqfoc_cycle_t *cycle, uint32_t ticks_per_second, iq24_t i_q);

#endif
