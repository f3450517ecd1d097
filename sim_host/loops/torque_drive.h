/*
 * Firmware that turns a torque into duties over the whole range of the inverter: the reference (torque to
 * current, field weakening) ahead of the library's cycle, PI and the modulator up to six-step.
 */
#ifndef SIM_HOST_LOOPS_TORQUE_DRIVE_H
#define SIM_HOST_LOOPS_TORQUE_DRIVE_H

#include "drive/firmware_host.h"

#include "iqfoc/reference.h"

#include <stdbool.h>

typedef struct torque_drive {
    drive_host host;
    drive_firmware cycle; /* the library's, behind its calls */
    iqfoc_methods_t methods;
    iqfoc_reference_config_t reference_config;
    iqfoc_reference_t reference;
} torque_drive;

/* What the reference may ask for, beside the motor's data. */
typedef struct torque_limits {
    double i_max_A, i_d_min_A;
    double share;           /* of the voltage limit */
    double bandwidth_Hz;    /* of the current control */
    double weakening_per_s; /* bandwidth of the field weakening, at the motor's highest speed and u_dc_V */
    double u_dc_V;
} torque_limits;

/*
 * methods: what the cycle does by PI; with IQFOC_MODULATION_PWM the voltage stays in the linear range. False where
 * a value does not fit the library's ranges.
 */
bool torque_drive_init(torque_drive *d, const motor *m, const torque_limits *limits, iqfoc_methods_t methods,
                       error *e);

/* The firmware. Its i_ref.q is the torque, over (3/2) pole_pairs psi_f I_b; i_ref.d is not read. */
drive_firmware torque_drive_firmware(torque_drive *d);

#endif
