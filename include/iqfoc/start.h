/*
 * Start of a machine with unknown rotor angle: alignment of the rotor by a current, then optionally an angle that
 * turns by itself.
 *
 *     RAISE  the current rises at a quarter turn        HOLD   and is constant there
 *     TURN   its angle goes back to 0                   SETTLE and is constant there: the rotor's d axis is on phase A
 *     RUN_UP the angle turns faster and faster          OPEN_LOOP and then with speed_end
 *
 * With a single angle a rotor opposite to it would not move, because it has no torque. Coming from a quarter turn it
 * does. A sensor's travel between the two angles also shows whether it counts in the right direction, with the right
 * number of pole pairs, or not at all.
 *
 * Call the step once a cycle, ahead of the valley's handler and in its interrupt. Both samples of the cycle use its
 * angle:
 *
 *     iqfoc_start_step(&start, sensor_theta);
 *     cycle.i_ref = start.i_ref;
 *     sample.theta = iqfoc_start_theta(&start, sample.instant);  sample.speed = start.speed;
 *
 * The current must be large enough for the load, and each stage long compared with the shaft's oscillation. A
 * friction of x times the torque at a quarter turn leaves an alignment error of asin(x).
 */
#ifndef IQFOC_START_H
#define IQFOC_START_H

#include "error.h"
#include "iq24_math.h"
#include "rotor.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iqfoc_start_config {
    iq24_t i_align;         /* per unit, 0 < x <= 16 */
    uint32_t ramp_cycles;   /* duration of RAISE, and of TURN: 1 ... 2^24 */
    uint32_t hold_cycles;   /* duration of HOLD, and of SETTLE: 1 ... 2^24 */
    iq24_t speed_end;       /* speed of OPEN_LOOP, |x| <= 1/3 turn per cycle; 0: alignment only */
    uint32_t run_up_cycles; /* duration of RUN_UP: 1 ... 2^24; any if speed_end is 0 */
} iqfoc_start_config_t;

typedef enum iqfoc_start_stage {
    IQFOC_START_RAISE,
    IQFOC_START_HOLD,
    IQFOC_START_TURN,
    IQFOC_START_SETTLE,
    IQFOC_START_RUN_UP,
    IQFOC_START_OPEN_LOOP,
    IQFOC_START_ALIGNED /* speed_end is 0: the angle stays 0 */
} iqfoc_start_stage_t;

/* Verdict on the sensor's travel between the two alignments, to 1/16 turn. */
typedef enum iqfoc_start_verdict {
    IQFOC_START_NOT_YET,
    IQFOC_START_GOOD,     /* a quarter turn back, as expected */
    IQFOC_START_STUCK,    /* no movement: no current, a blocked shaft, a dead sensor */
    IQFOC_START_REVERSED, /* a quarter turn forward: it counts backwards, or two phases are exchanged */
    IQFOC_START_WRONG_WAY /* another distance: pole pairs, lines, or too high a load */
} iqfoc_start_verdict_t;

/* The state. All fields may be read. */
typedef struct iqfoc_start {
    const iqfoc_start_config_t *config;
    iqfoc_start_stage_t stage;
    iqfoc_start_verdict_t verdict;
    uint32_t done;        /* cycles of this stage that have passed */
    iq24_t theta;         /* electrical angle for this cycle's valley, turns */
    iq24_t speed;         /* and its speed, turns per cycle */
    iqfoc_dq_t i_ref;     /* current in the frame of that angle, per unit */
    iq24_t sensor_before; /* the sensor's angle at a quarter turn */
    iq24_t sensor_zero;   /* the sensor's angle at 0: from SETTLE's end on the sensor's offset, turns */
} iqfoc_start_t;

/*
 * Initialises the start. config must outlive it. IQFOC_ERROR_START: a field out of its range. Ahead of the first
 * step.
 */
iqfoc_error_t iqfoc_start_init(iqfoc_start_t *start, const iqfoc_start_config_t *config);

/*
 * The next cycle, in the valley's interrupt. sensor_theta: a sensor's electrical angle at this valley with any
 * offset, turns; without a sensor any value, and the verdict has no meaning. Largest error: current 0.5 LSB, and 0.5
 * LSB per unit of i_align; angle and the speed of the run-up 1 LSB per cycle.
 */
void iqfoc_start_step(iqfoc_start_t *start, iq24_t sensor_theta);

/*
 * The angle `instant` cycles after the valley, -1 ... 1: turns. Error 0.5 LSB.
 *
 * Range: |turns at| <= 1/3; the sum wraps by whole turns.
 */
static inline iq24_t iqfoc_start_theta(const iqfoc_start_t *start, iq24_t instant)
{
    return iq24_add_wrap(start->theta, iq24_mul_round(start->speed, instant));
}

/*
 * The start's current as seen from the true angle of this valley, once a sensor or an observer has that angle. A
 * firmware with its own current controller calls it in the valley's interrupt when it changes to that angle. The
 * actual current may deviate by some percent, and integrators hold for the old angle. With the control cycle use
 * iqfoc_cycle_hand_over (cycle.h), which makes no step of the torque. Largest error: 0.51 LSB per unit of the
 * current, and 0.5.
 */
iqfoc_dq_t iqfoc_start_handover(const iqfoc_start_t *start, iq24_t theta_true);

#ifdef __cplusplus
}
#endif

#endif
