/*
 * Firmware that turns a torque into duties over the whole range of the inverter: reference (torque to current,
 * field weakening), PI in the rotor frame, and the modulator up to six-step. All that runs at valley and peak
 * is the library's fixed point.
 */
#ifndef SIM_HOST_LOOPS_TORQUE_DRIVE_H
#define SIM_HOST_LOOPS_TORQUE_DRIVE_H

#include "drive/firmware.h"

#include "data/motor.h"

#include "iqfoc/current_control.h"
#include "iqfoc/overmodulation.h"
#include "iqfoc/predictor.h"
#include "iqfoc/reference.h"
#include "iqfoc/rotor.h"

#include <stdbool.h>

typedef enum torque_modulation {
    TORQUE_LINEAR,  /* up to the circle within the hexagon */
    TORQUE_HEXAGON, /* iqfoc_modulate: as far as the hexagon, the angle kept */
    TORQUE_SIX_STEP /* iqfoc_overmodulate */
} torque_modulation;

typedef struct torque_drive {
    torque_modulation modulation;
    bool
        midpoint; /* fed by the sample at the peak; else by the quasi-discrete mean, corrected by 2016 (10) */
    iqfoc_predictor_t predictor;
    iqfoc_current_control_gains_t gains;
    iqfoc_reference_config_t reference_config;
    iqfoc_reference_t reference;
    iqfoc_current_control_t control;
    iqfoc_overmodulation_t over;
    iqfoc_rotor_t rotor;
    iqfoc_dq_t fed_back;
    iqfoc_dq_t i_ref;
    iqfoc_dq_t u_dq;   /* asked for */
    iqfoc_ab_t u_next; /* made of it */
    iq24_t limit;      /* the largest voltage, over u_dc */
    iq24_t u_dc;
} torque_drive;

/* What the reference may ask for, beside the motor's data. */
typedef struct torque_limits {
    double i_max_A, i_d_min_A;
    double share;           /* of the voltage limit */
    double bandwidth_Hz;    /* of the current control */
    double weakening_per_s; /* bandwidth of the field weakening, at the motor's highest speed and u_dc_V */
    double u_dc_V;
} torque_limits;

/* False where a value does not fit the library's ranges. */
bool torque_drive_init(torque_drive *d, const motor *m, const torque_limits *limits, error *e);

/* The firmware. Its i_ref.q is the torque, over (3/2) pole_pairs psi_f I_b; i_ref.d is not read. */
drive_firmware torque_drive_firmware(torque_drive *d);

#endif
