/*
 * The scenario file (docs/scenario.md) as a struct: speeds, currents, control and sensors of a simulation. Physical units. The motor file
 * has the drive itself.
 */
#ifndef SIM_HOST_DATA_SCENARIO_H
#define SIM_HOST_DATA_SCENARIO_H

#include "../base/error.h"
#include "profile.h"
#include "pwm_updates.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum scenario_feedback {
    FEEDBACK_MIDPOINT,           /* sample at the carrier peak */
    FEEDBACK_CORRECTED_MEAN,     /* 2016 (10) */
    FEEDBACK_QUASI_DISCRETE_MEAN /* 2019 (10) */
} scenario_feedback;

typedef enum scenario_modulation {
    MODULATION_PWM,
    MODULATION_SIX_STEP, /* one inverter state per control cycle: the nearest active vector */
    MODULATION_PATTERN   /* optimal pulse pattern, controlled by its flux trajectory */
} scenario_modulation;

typedef enum scenario_angle {
    ANGLE_MEASURED,
    ANGLE_OBSERVED /* the observer's, from the first cycles of settling on (iqfoc/sensorless.h) */
} scenario_angle;

typedef struct scenario_control {
    scenario_feedback feedback;
    scenario_modulation modulation;
    double bandwidth_Hz; /* of the current control; 0: the firmware's own choice */
    int updates;         /* a carrier period: 2 - a control cycle is half of it -, else 1 */
    scenario_angle angle;
} scenario_control;

/* Of the measurement that the firmware and the recording see. All 0 is perfect. */
typedef struct scenario_sensors {
    int current_bits;            /* of the ADC over -full_scale ... +full_scale; 0: not quantised */
    double current_full_scale_A; /* > 0 if current_bits > 0 */
    double current_noise_A;      /* standard deviation, each channel and sample on its own */
    double current_offset_A[3];
    double current_bandwidth_Hz; /* first-order low-pass; 0: none */
    double angle_noise_rad;      /* standard deviation, electrical */
    double speed_noise_rad_s;    /* standard deviation, electrical */
    double u_dc_noise_V;         /* standard deviation */
} scenario_sensors;

/* Which of the optional columns the recording gets. */
typedef struct scenario_log {
    bool voltages;         /* u_a_V ... ; voltages or duties */
    bool duties;           /* d_a ... and u_dc_V */
    bool u_dc;             /* u_dc_V without the duties */
    bool third_current;    /* i_c_A */
    bool mid_currents;     /* i_a_mid_A ... */
    bool mechanical_angle; /* theta_mech_rad */
    bool temperature;      /* temp_C: not a scenario's wish, but of a drive that warms */
} scenario_log;

typedef enum scenario_shaft {
    SHAFT_GIVEN,  /* speed_rpm is what the shaft does */
    SHAFT_INERTIA /* J domega_mech/dt = torque - load - friction * omega_mech, from speed_rpm at t = 0 */
} scenario_shaft;

typedef struct scenario_run {
    long cycles; /* control cycles; 0: duration_s holds instead */
    double duration_s;
    /* Ahead of t = 0, not logged: references at their first values, no excitation, shaft held. */
    long settle_cycles;
    long line, column;    /* of its speed in the file */
    profile speed_rpm;    /* mechanical, signed */
    profile i_d_A, i_q_A; /* references, peak */
    double u_dc_V;        /* true DC link; 0: the motor file's */
    bool halves;          /* of [control]: a control cycle is half a carrier period */
    pwm_updates pwm;      /* of [pwm] and [sensors] */
    double theta_mech_start_rad;
    scenario_shaft shaft;
    double J_kgm2;       /* > 0 with SHAFT_INERTIA */
    double friction_Nms; /* >= 0 */
    profile load_Nm;     /* against positive rotation */
} scenario_run;

typedef struct scenario {
    char name[128];
    scenario_control control;
    scenario_sensors sensors;
    scenario_log log;
    pwm_updates
        pwm; /* [pwm], shunts of [sensors], pulses of [control]: of the drive, and written into the recording's comments */
    size_t runs;       /* >= 1 */
    scenario_run *run; /* run[i] gets the recording's run number i + 1 */
} scenario;

/* Reads and checks; on failure *e holds file, line, column and what was expected, and *s is empty. */
bool scenario_read(const char *path, scenario *s, error *e);

void scenario_free(scenario *s);

/* Logged cycles of a run: at least one, of T_s each. */
long scenario_run_cycles(const scenario_run *run, double T_s);

#endif
