/*
 * The checklist of docs/porting.md, ticked off on the host: does a port's HAL do what iqfoc/hal.h asks of it?
 *
 * The port runs against a rig: its hardware in memory, which the test sets and looks at in physical words. A
 * new port writes a rig of a page (tests/target/rig_stm32g4.c is one) and calls port_check_all.
 */
#ifndef TESTS_TARGET_PORT_CHECK_H
#define TESTS_TARGET_PORT_CHECK_H

#include "iqfoc/hal.h"

#include <stdbool.h>

/* The port's hardware. Phases are numbered 0, 1, 2 for A, B, C as they are wired to the motor. */
typedef struct port_rig {
    iqfoc_hal_t *hal;
    /* True currents into the motor, in per unit; their sum is 0. */
    void (*set_current)(const double i_pu[3]);
    void (*set_dc_link)(double u_pu);
    /* True electrical angle, in turns, any number; moves the shaft there. */
    void (*set_angle)(double turns);
    /* Moves time to a point of the carrier period, 0 valley, 0.5 peak, below 1. Passing valley or peak the
     * hardware samples; passing a valley the shadow registers act. Only forwards: a smaller number is the
     * next period. */
    void (*go_to)(double phase);
    /* Is the high side of a leg on at this moment? Are the outputs on at all? */
    bool (*leg_high)(int leg);
    bool (*outputs_on)(void);
    uint32_t (*period_ticks)(void);
    double current_step_pu; /* resolution of the converters */
    double angle_step;      /* of the angle sensor, turns */
} port_rig;

/* Each item by Unity's assertions, with a message that says what is wrong with the port. */
void port_check_current_scaling_signs_and_order(const port_rig *rig);
void port_check_dc_link(const port_rig *rig);
void port_check_angle_and_speed(const port_rig *rig);
void port_check_sampling_instant(const port_rig *rig);
void port_check_update_instant(const port_rig *rig);
void port_check_duties_and_order(const port_rig *rig);
void port_check_gates(const port_rig *rig);

#endif
