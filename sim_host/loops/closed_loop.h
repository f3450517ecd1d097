/*
 * A closed loop of firmware and switching-level plant at constant speed, and the measures of its response to a step
 * of i_q.
 *
 *     settle | step -> transient | steady window of whole fundamental periods
 *
 * The loop is the simulator's (drive/drive_loop.h). Errors are those of the true mean current of each cycle, seen
 * from the turning rotor. Torque follows that current.
 */
#ifndef SIM_HOST_LOOPS_CLOSED_LOOP_H
#define SIM_HOST_LOOPS_CLOSED_LOOP_H

#include "drive/drive_loop.h"

enum {
    LOOP_START_CYCLES = 4,    /* a predictive controller has reached its set-point */
    LOOP_SETTLE_CYCLES = 200, /* ten time constants of the PI loops, at f_pwm/20 */
    LOOP_TRANSIENT_CYCLES = 120,
    LOOP_TRACE_BEFORE = 4, /* cycles of a trace before the step */
    LOOP_TRACE_CYCLES = 44
};

typedef struct loop_case {
    motor truth; /* the drive, perfect but for the noise */
    const plant_config
        *drive;           /* NULL, or the drive instead of `truth`, sensors included: no noise is added */
    double omega_e_rad_s; /* constant */
    double i_q_before_A;  /* peak; i_d is 0 throughout */
    double i_q_after_A;
    int periods;    /* fundamental periods in the steady window */
    double noise_A; /* standard deviation of each current sample */
    /* Two updates a carrier period: `truth` has twice the carrier's frequency, a control cycle is half a period, and
     * errors are of the mean over a whole one, valley to valley, as the ripple of a half does not cancel. */
    bool halves;
    uint64_t seed;
} loop_case;

typedef enum loop_outcome {
    LOOP_HOLDS,    /* settles within LOOP_OFFSET_LIMIT of the reference */
    LOOP_MISSES,   /* settles, but farther from it */
    LOOP_UNSTABLE, /* varies by more than LOOP_WANDER_LIMIT: only the DC link limits it */
    LOOP_TRIPS     /* beyond LOOP_TRIP_LIMIT, an overcurrent trip in a real drive */
} loop_outcome;

/* Shares of the rated peak current. */
#define LOOP_OFFSET_LIMIT 0.05
#define LOOP_WANDER_LIMIT 0.05
#define LOOP_TRIP_LIMIT   3.0
#define LOOP_SETTLED      0.05

/* Percent of the rated peak current unless stated otherwise. NAN if the loop tripped. */
typedef struct loop_result {
    loop_outcome outcome;
    /* Of the error vector in the steady window: the whole, the constant part, and the rest. */
    double rms_percent, offset_percent, wander_percent;
    double i_d_offset_percent, i_q_offset_percent;
    /* Of i_q beyond its reference after the step, in percent of the step. */
    double overshoot_percent;
    /* From the reference's step until the error stays within LOOP_SETTLED; -1: never. */
    int settling_cycles;
    /* The same, with LOOP_SETTLED counted from the largest error in the steady window, which is ripple. */
    int settling_beside_cycles;
    /* Largest error from cycle LOOP_START_CYCLES up to the step: the machine turns at full speed and its
     * terminals are shorted when the firmware begins. */
    double start_percent;
    /* Of phase A in the steady window: all other components over the fundamental. */
    double thd_percent;
    /* Mean per leg: pulses a second. */
    double switching_Hz;
    /*
     * In the steady window, relative to the torque of the i_q asked for: the mean torque's excess, and the rms of the
     * cycles' means about their mean.
     */
    double torque_error_percent, torque_ripple_percent;
    double trace_q[LOOP_TRACE_CYCLES];     /* mean i_q over rated around the step */
    double trace_start[LOOP_TRACE_CYCLES]; /* error in percent of rated, from switch-on */
} loop_result;

const char *loop_outcome_text(loop_outcome outcome);

/* False with *e set only if the firmware stopped. */
bool closed_loop_run(const loop_case *c, const drive_firmware *firmware, loop_result *result, error *e);

#endif
