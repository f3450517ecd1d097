/*
 * Firmware from torque to duties over the whole range of the inverter. iqfoc/reference.h (torque to current, field
 * weakening) runs before the library's control cycle with PI, and the modulator goes up to six-step.
 *
 * Six-step by a timer is optional. At a weakening of i_d_to_timer_A six-step replaces the carrier at the voltage's
 * exact angle, and i_d follows from the speed. The carrier resumes when i_d is back at i_d_to_carrier_A.
 */
#ifndef SIM_HOST_LOOPS_TORQUE_DRIVE_H
#define SIM_HOST_LOOPS_TORQUE_DRIVE_H

#include "drive/firmware_host.h"

#include "iqfoc/cycle_six_step.h"
#include "iqfoc/reference.h"

#include <stdbool.h>

typedef struct torque_drive {
    drive_host host;
    drive_firmware cycle; /* the library's, behind its calls */
    iqfoc_methods_t methods;
    iqfoc_reference_config_t reference_config;
    iqfoc_reference_t reference;
    iqfoc_reference_link_t link;
    bool may_use_timer, timer_runs;
    iq24_t i_d_to_timer, i_d_to_carrier;
    double d_share; /* of the voltage: its d component over six-step's length, filtered */
    iq24_t i_d;     /* of six-step, filtered over some states */
    int may_go;     /* states for which the carrier could have resumed */
    iqfoc_six_step_config_t six_config;
    iqfoc_six_step_t six;
} torque_drive;

/* Limits and bandwidths of the reference, in addition to the motor's data. */
typedef struct torque_limits {
    double i_max_A, i_d_min_A;
    double share;           /* of the voltage limit */
    double bandwidth_Hz;    /* of the current control */
    double weakening_per_s; /* bandwidth of the field weakening, at the motor's highest speed and u_dc_V */
    double u_dc_V;
    double timer_Hz; /* bandwidth of six-step's angle; 0: no timer */
    double i_d_to_timer_A, i_d_to_carrier_A;
} torque_limits;

/*
 * methods: the control cycle's, with PI; with IQFOC_MODULATION_PWM the voltage stays in the linear range. False if a
 * value does not fit the library's ranges.
 */
bool torque_drive_init(torque_drive *d, const motor *m, const torque_limits *limits, iqfoc_methods_t methods,
                       error *e);

/* The firmware. Its i_ref.q is the torque, over (3/2) pole_pairs psi_f I_b; i_ref.d is not read. */
drive_firmware torque_drive_firmware(torque_drive *d);

/* The fundamental of the voltage asked for last, over a DC link of u_dc (per unit). */
double torque_drive_voltage(const torque_drive *d, double u_dc);

#endif
