/*
 * A drive that puts right what a diagnosis found: the cycle with the corrections of iqfoc/extension.h around
 * it, its constants from the header that `iqfoc diagnose -o DIR` wrote (docs/tutorial.md). The same on every
 * target.
 */
#ifndef EXAMPLES_CORRECTED_DRIVE_H
#define EXAMPLES_CORRECTED_DRIVE_H

#include "iqfoc/hal.h"

#define CORRECTED_DRIVE_PWM_HZ 4000

/*
 * Makes the cycle ready and lets it ask for i_q. ticks_per_second: of the port's clock. False if
 * it was refused.
 */
bool corrected_drive_start(iqfoc_cycle_t *cycle, uint32_t ticks_per_second, iq24_t i_q);

/* In place of iqfoc_isr_valley and iqfoc_isr_peak. */
void corrected_drive_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);
void corrected_drive_peak(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);

#endif
