/*
 * Torque control in six-step operation. The DC link sets the voltage's amplitude, a controller of i_q its angle to
 * the rotor. Once per inverter state the controller's input is the mean of the phase currents over that state.
 *
 * Discrete angle: the mean is turned by the angle at the middle of the interval, 2016 (3), the usual practice.
 * Corrected: 2016 (10). At a sixth of a turn per interval the first is the second over 1.0530. The controller then
 * drives the true current and the torque 5.3 % beyond the reference.
 *
 * The library's IQ24 code runs at each switching instant; the drive is the switching-level plant.
 */
#ifndef SIM_HOST_LOOPS_SIX_STEP_LOOP_H
#define SIM_HOST_LOOPS_SIX_STEP_LOOP_H

#include "base/error.h"

#include <stdbool.h>

enum { SIX_STEP_INTERVALS = 2400, SIX_STEP_STEP_AT = 1200, SIX_STEP_MEASURED = 600 };

typedef struct six_step_loop {
    double reference_before_A, reference_A; /* of i_q, peak */
    double i_q_A, i_d_A;                    /* true means over the last SIX_STEP_MEASURED intervals */
    double i_q_fed_back_A;                  /* what the controller saw */
    double torque_Nm, torque_reference_Nm;  /* true mean over the same, and what the reference asks for */
    double angle_deg;                       /* of the voltage ahead of the d axis */
    double trace_q_A[SIX_STEP_INTERVALS];   /* true mean of each interval */
    double trace_fed_back_A[SIX_STEP_INTERVALS];
    double trace_t_s[SIX_STEP_INTERVALS]; /* of its end */
} six_step_loop;

/* The drive of the 2019 paper at 8000 rpm, with a DC link that needs six-step there. */
#define SIX_STEP_RPM  8000.0
#define SIX_STEP_U_DC 540.0

/* How much more i_q the drive carries than it was asked for. */
double six_step_excess_percent(const six_step_loop *l);

bool six_step_loop_run(bool corrected, six_step_loop *result, error *e);

#endif
