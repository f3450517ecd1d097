/*
 * Six-step by a timer: the cycle without a carrier. One call per inverter state, at the instant at which the state
 * ends; it gives the next one and how long it stands.
 *
 *     command = iqfoc_cycle_six_step_begin(&six, &cycle, &config, angle, &sample);
 *     at each end:  command = iqfoc_cycle_six_step_switch(&six, &cycle, &sample, now);
 *     back to PWM:  iqfoc_cycle_six_step_end(&six, &cycle, turns);  then valleys and peaks again
 *
 * The voltage's length is the DC link's, its angle to the rotor the only thing left to control: an integrator of
 * i_q's error sets it. It is fed with the mean of the phase currents over the state's interval, turned by the
 * rotor's angle in its middle, and corrected by 2016 (10), which counts here: over a sixth of a turn the angle alone
 * makes the current 5.3 % too small. Status, trips, limits and the safe output are the cycle's, and so is i_ref.
 */
#ifndef IQFOC_CYCLE_SIX_STEP_H
#define IQFOC_CYCLE_SIX_STEP_H

#include "cycle.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iqfoc_six_step_config {
    iq24_t gain;      /* turns of the voltage's angle per current in error and state: 0 ... 1 */
    iq24_t angle_min; /* of the voltage ahead of the d axis, turns: -1/2 <= angle_min < angle_max <= 1/2 */
    iq24_t angle_max;
    bool discrete_angle; /* for comparison: the mean as 2016 (3) has it, not corrected */
} iqfoc_six_step_config_t;

/* The state; read what you like. The current fed back is cycle.i_dq, the voltage that acts cycle.u_now. */
typedef struct iqfoc_six_step {
    const iqfoc_six_step_config_t *config;
    iq24_acc_t angle;   /* of the voltage ahead of the d axis, turns */
    int32_t state;      /* of the interval that runs, 0 ... 5 */
    iq24_t theta_begin; /* at its begin */
    iqfoc_ab_t i_begin;
    iq24_t u_dc; /* of the last sample, held to the cycle's limits */
} iqfoc_six_step_t;

typedef struct iqfoc_six_step_command {
    iqfoc_command_t command; /* duties 0 or 1, to be put out at once */
    iq24_t turns;            /* that the rotor covers until the next call: 1/600 ... 1/3 */
    uint32_t ticks; /* the same as time, at the sample's speed; at most 128 cycles, so at standstill */
} iqfoc_six_step_command_t;

/*
 * From the carrier to the timer, or from standstill of both: the first state.
 *
 * angle: of the voltage ahead of the d axis, turns; from a drive that runs by iqfoc_cycle_voltage_angle. sample: as
 * below. A configuration outside its ranges, or a NULL, gives the safe command and leaves six->config NULL: check it
 * where the drive starts.
 */
iqfoc_six_step_command_t iqfoc_cycle_six_step_begin(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle,
                                                    const iqfoc_six_step_config_t *config, iq24_t angle,
                                                    const iqfoc_sample_t *sample);

/* Angle of the voltage that the cycle asked for last, ahead of the d axis: turns, -1/2 ... 1/2. */
iq24_t iqfoc_cycle_voltage_angle(const iqfoc_cycle_t *cycle);

/*
 * At the end of a state: feedback, control, next state.
 *
 * sample: i, theta, turns and u_dc at this instant; i_mean the phases' means over the interval. Without has_mean
 * the angle stays as it is, and IQFOC_STATUS_NO_INTERVAL says so. now: the port's timer when the call began. The
 * states follow the direction of `turns`. Nothing is asked of the time between calls: the interval is the port's. A
 * drive that is tripped or not enabled gets the safe command, and the angle stays.
 *
 * Error: the integrator is exact but for its products; the interval's end is where the voltage's angle, as known
 * now, is half a sector past the state: to 3 LSB.
 */
iqfoc_six_step_command_t iqfoc_cycle_six_step_switch(iqfoc_six_step_t *six, iqfoc_cycle_t *cycle,
                                                     const iqfoc_sample_t *sample, uint32_t now);

/*
 * Back to the carrier, PI and IQFOC_MODULATION_OVER: the integrators are given what makes the voltage of six-step,
 * (2/pi) u_dc at the present angle, beside the decoupling at i_ref and `turns`. The next valley begins anew.
 */
void iqfoc_cycle_six_step_end(const iqfoc_six_step_t *six, iqfoc_cycle_t *cycle, iq24_t turns);

#ifdef __cplusplus
}
#endif

#endif
