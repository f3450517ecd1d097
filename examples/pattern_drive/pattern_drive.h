/*
 * A drive with five pulses per electrical period: its current is controlled by the flux trajectory of an optimal pattern, and its edges
 * go through the HAL's optional function. The same on every target.
 */
#ifndef EXAMPLES_PATTERN_DRIVE_H
#define EXAMPLES_PATTERN_DRIVE_H

#include "iqfoc/hal.h"
#include "iqfoc/pattern_control.h"

#define PATTERN_DRIVE_HZ 5000 /* control cycles a second */

/* Where a target puts the interrupts' functions and constants. */
#ifndef PATTERN_DRIVE_FAST
#define PATTERN_DRIVE_FAST
#define PATTERN_DRIVE_CONST
#endif

typedef struct pattern_drive {
    iqfoc_pattern_control_t control;
    iqfoc_dq_t i_ref;
    iqfoc_dq_t i; /* of the last valley */
    iqfoc_edges_t edges;
    bool stopped; /* by an overcurrent or a clipped sample; for good */
} pattern_drive_t;

/*
 * period_ticks: of a control cycle, ticks of the carrier's timer. least_ticks: between two edges of a leg, as inverter and port need it. False
 * if the library refuses the drive.
 */
bool pattern_drive_start(pattern_drive_t *drive, uint32_t period_ticks, uint32_t least_ticks, iq24_t i_q);

/* The interrupts' work, for a machine that turns by 1/128 ... 1/8 turn in a cycle. */
void pattern_drive_valley(pattern_drive_t *drive, iqfoc_hal_t *hal);
void pattern_drive_peak(pattern_drive_t *drive, iqfoc_hal_t *hal);

#endif
