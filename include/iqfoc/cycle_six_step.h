/*
 * Six-step by a timer: the control cycle without a carrier. Each call is made at the instant at which an inverter
 * state ends, and returns the next state and its duration.
 *
 *     command = iqfoc_cycle_six_step_begin(&six, &cycle, &config, angle, &sample);
 *     at each end:  command = iqfoc_cycle_six_step_switch(&six, &cycle, &sample, now);
 *     back to PWM:  iqfoc_cycle_six_step_end(&six, &cycle, speed);  then valleys and peaks again
 *
 * The DC link fixes the length of the voltage. An integrator of the error of i_q controls the only free quantity, the
 * angle of the voltage to the rotor. Its feedback is the mean of the phase currents over the state's interval, turned
 * by the rotor's angle at mid-interval and corrected by 2016 (10). The correction matters here: over a sixth of a
 * turn the discrete angle alone makes the current 5.3 % too small. Status bits, trips, limits, safe output and i_ref
 * are those of the cycle.
 */
#ifndef IQFOC_CYCLE_SIX_STEP_H
#define IQFOC_CYCLE_SIX_STEP_H

#include "cycle.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iqfoc_six_step_config {
    iq24_t gain; /* turns of the voltage's angle per current in error and state: 0 ... 1 */
    iq24_t
        angle_min; /* lower limit of the voltage's angle ahead of the d axis, turns: -1/2 <= angle_min < angle_max <= 1/2 */
    iq24_t angle_max;
    bool discrete_angle; /* for comparison: the mean of 2016 (3), not corrected */
} iqfoc_six_step_config_t;

/* The state. All fields may be read. cycle.i_dq is the feedback, cycle.u_now the voltage that acts. */
typedef struct iqfoc_six_step {
    const iqfoc_six_step_config_t *config;
    iq24_acc_t angle;   /* of the voltage ahead of the d axis, turns */
    int32_t state;      /* inverter state of the present interval, 0 ... 5 */
    iq24_t theta_begin; /* rotor angle at the start of the interval; i_begin is the current there */
    iqfoc_ab_t i_begin;
    iq24_t u_dc; /* of the last sample, held to the cycle's limits */
} iqfoc_six_step_t;

typedef struct iqfoc_six_step_command {
    iqfoc_command_t command; /* duties 0 or 1: write them at once */
    iq24_t movement;         /* angle that the rotor covers until the next call, turns: 1/600 ... 1/3 */
    uint32_t
        ticks; /* the same as a time at the sample's speed; at most 128 cycles, which it is at standstill */
} iqfoc_six_step_command_t;

/*
 * Starts six-step: from PWM, or from standstill. Returns the first state.
 *
 * angle: of the voltage ahead of the d axis, turns; in a running drive iqfoc_cycle_voltage_angle gives it. sample: as
 * below. A configuration outside its ranges, or a NULL, gives the safe command and leaves six->config NULL: check
 * six->config when the drive starts. Call it in the cycle's interrupt, or ahead of the first one.
 */
iqfoc_six_step_command_t iqfoc_cycle_six_step_begin(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle,
                                                    const iqfoc_six_step_config_t *config, iq24_t angle,
                                                    const iqfoc_sample_t *sample);

/*
 * Angle of the last requested voltage ahead of the d axis: turns, -1/2 ... 1/2. The firmware calls it in the cycle's
 * interrupt, just ahead of iqfoc_cycle_six_step_begin.
 */
iq24_t iqfoc_cycle_voltage_angle(const iqfoc_cycle_t *cycle);

/*
 * At the end of a state: feedback, control, next state. From the timer's interrupt only.
 *
 * sample: i, theta, turns and u_dc at this instant; i_mean holds the means of the phases over the interval. Without
 * has_mean the angle does not change, and IQFOC_STATUS_NO_INTERVAL is set. now: the port's timer when the call began.
 * The states follow the sign of `speed`. The time between calls is not checked: the port sets the interval. A drive
 * that is tripped or not enabled gets the safe command, and the angle does not change.
 *
 * Error: the integrator is exact but for its products. The interval's end is where the voltage's angle, as known now,
 * is half a sector past the state: to 3 LSB.
 */
iqfoc_six_step_command_t iqfoc_cycle_six_step_switch(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle,
                                                     const iqfoc_sample_t *sample, uint32_t now);

/*
 * Ends six-step: back to the carrier, PI and IQFOC_MODULATION_OVER. The integrators are set to the voltage of
 * six-step, (2/pi) u_dc at the present angle, minus the decoupling at i_ref and `speed`. The next valley is treated
 * as a first one. From the timer's interrupt, with no valley or peak under way.
 */
void iqfoc_cycle_six_step_end(const iqfoc_six_step_t *six, iqfoc_cycle_t *cycle, iq24_t speed);

#ifdef __cplusplus
}
#endif

#endif
