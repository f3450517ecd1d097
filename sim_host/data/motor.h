/*
 * The motor file (interfaces.md, "The motor file: TOML") as a struct, physical units.
 *
 * An absent [extension.<id>] table means that the model does not take that effect into account; `has` says
 * which tables stand. Laws and signs of the values are those of interfaces.md.
 */
#ifndef SIM_HOST_DATA_MOTOR_H
#define SIM_HOST_DATA_MOTOR_H

#include "../base/error.h"

#include <stdbool.h>

/* The effects that the averaged model knows beyond [motor]; the names in text are motor_extension_id(). */
typedef enum extension_id {
    EXT_SATURATION,
    EXT_DEAD_TIME,
    EXT_VOLTAGE_GAIN,
    EXT_CURRENT_OFFSET,
    EXT_CURRENT_GAIN,
    EXT_ANGLE_OFFSET,
    EXT_ANGLE_HARMONIC,
    EXT_ANGLE_DELAY,
    EXT_VOLTAGE_DELAY,
    EXT_EMF_HARMONICS,
    EXT_PHASE_ASYMMETRY,
    EXT_COUNT
} extension_id;

typedef struct motor_extension {
    bool has[EXT_COUNT];
    double L_0_H, I_sat_A;     /* saturation: flux/current = L_0 / (1 + (|i|/I_sat)^2), both axes in ratio */
    double v_dead_V, i_knee_A; /* dead_time */
    double k_u;                /* voltage_gain: applied = k_u * recorded; 1 when absent */
    double o_A[3];             /* current_offset: measured = g * true + o */
    double g[3];               /* current_gain; 1 when absent */
    double theta_0_rad;        /* angle_offset: recorded = true + theta_0 */
    double harmonic_order;     /* angle_harmonic: 1 or 2 per mechanical revolution */
    double harmonic_amplitude_rad, harmonic_phase_rad;
    double t_delay_s;          /* angle_delay: recorded(t_k) = true(t_k + t_delay) */
    int voltage_delay_cycles;  /* voltage_delay: applied in k = recorded in k - cycles */
    double psi_5_Wb, psi_7_Wb; /* emf_harmonics, signed flux */
    double dR_ohm[3];          /* phase_asymmetry */
} motor_extension;

typedef struct motor {
    const char *path; /* where it was read from, for messages; borrowed from the caller; NULL: made here */
    char name[128];
    int pole_pairs;       /* >= 1 */
    double R_ohm;         /* >= 0 */
    double L_d_H, L_q_H;  /* > 0 */
    double psi_f_Wb;      /* >= 0; 0 is a plain RL load */
    double I_rated_A_rms; /* > 0 */
    double n_max_rpm;     /* > 0, mechanical */
    double f_pwm_Hz;      /* > 0 */
    double u_dc_V;        /* > 0, nominal */
    motor_extension ext;
} motor;

/* A motor with every value 0, every gain 1 and no extension. */
motor motor_blank(void);

/* The id as in the file and the JSON: "dead_time". */
const char *motor_extension_id(extension_id id);

/* Reads and checks; on failure *e holds file, line, column and what was expected. */
bool motor_read(const char *path, motor *m, error *e);

/*
 * Sets an error at the value of `key` ("R_ohm") of a motor file that was read: for what only a user of the
 * motor can find wrong, such as a value that no fixed-point constant holds. Reads the file anew for the
 * position. Returns false.
 */
bool motor_refuse(const char *path, const char *key, error *e, const char *format, ...) ERROR_PRINTF(4, 5);

/* Writes a motor file that motor_read reads back to the same values (17 significant digits where needed). */
bool motor_write(const char *path, const motor *m, const char *comment, error *e);

#endif
