/*
 * The first drive, from power-on to torque: offsets, alignment, closed loop; what stops it, and what may try again.
 * The same on every chip; of the port it wants the HAL and the six functions at the end.
 */
#ifndef DRIVE_H
#define DRIVE_H

#include "iqfoc/hal.h"
#include "iqfoc/offset.h"
#include "iqfoc/params.h"
#include "iqfoc/restart.h"
#include "iqfoc/start.h"
#include "iqfoc/supervision.h"

/* ---- The motor, from its data sheet. ---- */
#define R_OHM         0.09
#define L_H           1.2e-4
#define PSI_F_WB      6.5e-3
#define POLE_PAIRS    7
#define I_RATED_A_RMS 10.0
#define U_DC_V        24.0
#define PWM_HZ        20000

/*
 * The first run: a laboratory supply of 24 V with its current limit at 2 A, a third of the motor's current at most, and
 * no restart by itself. When all has been seen to work, -DFIRST_RUN=0.
 */
#ifndef FIRST_RUN
#define FIRST_RUN 1
#endif

#define T_S           (1.0 / PWM_HZ)
#define BANDWIDTH     (6.2832 * PWM_HZ / 20.0) /* rad/s */
#define I_BASE_A      IQFOC_I_BASE(I_RATED_A_RMS)
#define I_ALIGN_PU    (FIRST_RUN ? 0.15 : 0.3)
#define I_LIMIT_PU    (FIRST_RUN ? 0.35 : 1.5)
#define ALIGN_SECONDS 0.6 /* of each stage: several times the period with which the shaft swings */

typedef enum drive_state {
    DRIVE_CALIBRATES, /* offsets of the current sensors, outputs off */
    DRIVE_ALIGNS,     /* the rotor on phase A, the encoder's angle from it */
    DRIVE_RUNS,
    DRIVE_WAITS, /* after a fault that may clear by itself */
    DRIVE_IS_OFF /* why: drive.why */
} drive_state_t;

/* Bits of `why` in addition to those of iqfoc/cycle.h and iqfoc/supervision.h. */
#define DRIVE_OFFSET_BAD    UINT32_C(0x01000000) /* see drive.offset */
#define DRIVE_ALIGNMENT_BAD UINT32_C(0x02000000) /* see drive.start.verdict */

typedef struct drive {
    drive_state_t state;
    uint32_t why;
    iqfoc_cycle_t cycle;
    iqfoc_cycle_config_t config;
    iqfoc_offset_t offset;
    iqfoc_start_t start;
    iqfoc_restart_t restart;
    iqfoc_supervision_t supervision;
    iqfoc_dq_t i_wanted; /* the reference in closed loop; write it from anywhere */
} drive_t;

/* ticks_per_second: of iqfoc_hal_now. False if a configuration is refused. */
bool drive_begin(drive_t *drive, uint32_t ticks_per_second);

/* The one interrupt of a period: the valley's samples have been converted. */
void drive_interrupt(drive_t *drive, iqfoc_hal_t *hal);

/* ---- What the drive asks of the port beyond the HAL. ---- */
void port_set_offset(iqfoc_hal_t *hal, iqfoc_abc_t offset); /* subtract it from the currents from now on */
void port_set_predicted(iqfoc_hal_t *hal, iqfoc_abc_t current); /* stands in for shunts that cannot be read */
void port_align(iqfoc_hal_t *hal, iq24_t theta);                /* at the last valley this was the angle */
bool port_angle_lost(const iqfoc_hal_t *hal);
bool port_break(const iqfoc_hal_t *hal); /* the break input stopped the outputs, or would now */
void port_clear_break(iqfoc_hal_t *hal);

#endif
