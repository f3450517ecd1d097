/*
 * The checklist of docs/porting.md, ticked off on the host: does a port's HAL do what iqfoc/hal.h asks of it?
 *
 * The port runs against a rig: its hardware in memory, which the checks set and look at in physical words. A
 * new port writes a rig of a page and this program; nothing else is needed, no test framework either:
 *
 *     int main(void)
 *     {
 *         return port_check_all(my_rig_start, stdout) == 0 ? 0 : 1;
 *     }
 *
 * Installed with the library; find_package(iqfoc) says where: iqfoc_PORT_CHECK_DIR. C11 with its library; needs
 * libm. Rigs to look at: tests/target/rig_stm32g4.c, examples/template-stm32f405/check.
 */
#ifndef IQFOC_PORT_CHECK_H
#define IQFOC_PORT_CHECK_H

#include "iqfoc/hal.h"

#include <stdbool.h>
#include <stdio.h>

/* The port's hardware. Phases are numbered 0, 1, 2 for A, B, C as they are wired to the motor. */
typedef struct port_rig {
    iqfoc_hal_t *hal;
    /* True currents into the motor, in per unit; their sum is 0. */
    void (*set_current)(const double i_pu[3]);
    void (*set_dc_link)(double u_pu);
    /* True electrical angle, in turns, any number; moves the shaft there. */
    void (*set_angle)(double turns);
    /*
     * Moves time to a point of the carrier period, 0 valley, 0.5 peak, below 1. Passing valley or peak the
     * hardware samples; passing a valley the shadow registers act. Only forwards: a smaller number is the next
     * period.
     */
    void (*go_to)(double phase);
    /* Is the high side of a leg on at this moment? Are the outputs on at all? */
    bool (*leg_high)(int leg);
    bool (*outputs_on)(void);
    uint32_t (*period_ticks)(void); /* of iqfoc_hal_now */
    double current_step_pu;         /* resolution of the converters */
    double angle_step;              /* of the angle sensor, electrical turns */
    /* The converters are triggered at the valley alone: the peak's sample is the valley's, `instant` and all. */
    bool one_trigger;
    uint32_t edges_least; /* least distance of two edges of a leg, ticks; 0: no iqfoc_hal_write_edges */
} port_rig;

/* The hardware as it is after start-up, outputs off, angle known; each call starts again. */
typedef const port_rig *port_rig_start(void);

/* A line of the checklist. */
typedef struct port_check_item {
    const char *name;
    /* NULL: the port does it. Else what is wrong with it, in words; good until the next check. */
    const char *(*run)(port_rig_start *start);
} port_check_item;

#define PORT_CHECK_ITEMS 7
extern const port_check_item port_check_items[PORT_CHECK_ITEMS];

/* Of iqfoc_hal_write_edges, in port_check_edges.c: for a port that has it. go_to is then exact to a tick, as a share of the present cycle. */
#define PORT_CHECK_EDGES_ITEMS 4
extern const port_check_item port_check_edges_items[PORT_CHECK_EDGES_ITEMS];
int port_check_edges(port_rig_start *start, FILE *out);

/* All of them, a line each: "[x] name", or "[ ] name: what is wrong". Returns how many failed. */
int port_check_all(port_rig_start *start, FILE *out);

/* For further checks: the same of these items; and what is wrong, by a format of printf. */
int port_check_run(const port_check_item *items, int count, port_rig_start *start, FILE *out);
const char *port_check_wrong(const char *format, ...);

#endif
