/*
 * The motor file (interfaces.md, "The motor file: TOML") as a struct, physical units.
 *
 * An absent [extension.<id>] table means that the model does not take that effect into account; `has` says which tables are there.
 * docs/interfaces.md defines the models and signs of the values.
 */
#ifndef SIM_HOST_DATA_MOTOR_H
#define SIM_HOST_DATA_MOTOR_H

#include "../base/error.h"
#include "cause.h"
#include "pwm_updates.h"

#include <stdbool.h>
#include <stddef.h>

/* One field a parameter of causes.def, and which [extension.<id>] tables are there. */
typedef struct motor_extension {
    bool has[CAUSE_COUNT];
#define VALUE(ID, field, ...)        double field;
#define PHASE_VALUES(ID, field, ...) double field[3];
#define PHASE_RATES(ID, field, ...)  double field[3];
#include "causes.def"
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
    pwm_updates pwm;      /* a recording that says otherwise has precedence */
    motor_extension ext;
} motor;

/* A parameter of a cause, and its place in a motor. */
typedef enum motor_value_kind {
    VALUE_REAL,
    VALUE_WHOLE,
    VALUE_MEAN_INDUCTANCE, /* of L_d_H and L_q_H */
    VALUE_RATE,            /* of another value, per second */
    VALUE_EXTRA            /* a term of a law that has others */
} motor_value_kind;

typedef struct motor_value {
    cause_id cause;
    bool of_machine;  /* in [motor], not in [extension.<id>] */
    const char *key;  /* in the file: "v_dead_V"; for a mean, none */
    const char *name; /* in the diagnosis: "v_dead" */
    const char *unit;
    motor_value_kind kind;
    size_t offset; /* of the double within motor */
    bool needed;   /* else `absent` may stand for it */
    double absent; /* means no effect; NAN: its being there says nothing */
} motor_value;

/* Written and reported only if it is not zero. */
static inline bool motor_value_is_extra(const motor_value *v)
{
    return v->kind == VALUE_RATE || v->kind == VALUE_EXTRA;
}

extern const motor_value motor_values[];
extern const size_t motor_values_length;

double motor_value_of(const motor *m, const motor_value *v);

/* Whether [extension.<id>] is a table that a motor file may hold. */
bool motor_is_extension(cause_id id);

/* Whether it has the cause and no entry ahead of this one has the same id: for what is said once. */
bool motor_has_first(const motor *m, cause_id id);

/* Whether its saturation_dq is a map of parts that saturate and of nothing else: what iqfoc/flux_map.h holds. */
bool motor_has_parts_alone(const motor *m);

/* Sets `has` of a cause to whether any of its values differs from the one that means no effect. */
void motor_note_extension(motor *m, cause_id cause);

/* A motor with every value 0, every gain 1 and no extension. */
motor motor_blank(void);

/*
 * The inductances at zero current: [motor]'s; with [extension.saturation], its L_0_H as the mean of the two, in the ratio of [motor];
 * with [extension.saturation_dq], its L_d0_H and L_q0_H. All code that reads an inductance from a motor file uses this function.
 */
void motor_inductances(const motor *m, double *L_d_H, double *L_q_H);

/*
 * The orders, in mechanical revolutions, that an angle's error may have: once and twice per mechanical revolution (an
 * eccentric or tilted sensor), once and twice per electrical one (a resolver's windings). The first of them that is
 * `order`; ANGLE_ORDERS: none.
 */
enum { ANGLE_ORDERS = 4 };
double motor_order_of(const motor *m, size_t n);
size_t motor_angle_order(const motor *m, double order);

/* The entries of an angle's error, one an order: the cause of each and its three values. */
typedef struct motor_harmonic {
    cause_id cause;
    double *order, *amplitude_rad, *phase_rad;
} motor_harmonic;

motor_harmonic motor_harmonic_of(motor_extension *x, size_t n);

/* Peak of the rated current. */
double motor_rated_peak_A(const motor *m);

/* Electrical rad/s of a mechanical speed. */
double motor_speed_rad_s(const motor *m, double n_rpm);

/* Reads and checks; on failure *e holds file, line, column and what was expected. */
bool motor_read(const char *path, motor *m, error *e);

/*
 * Sets an error at the value of `key` ("R_ohm") of a motor file that was read: for errors that only a user of the motor can find, such as
 * a value outside fixed-point range. Reads the file again for the position. Returns false.
 */
bool motor_refuse(const char *path, const char *key, error *e, const char *format, ...) ERROR_PRINTF(4, 5);

/* Writes a motor file that motor_read reads back to the same values (17 significant digits where needed). */
bool motor_write(const char *path, const motor *m, const char *comment, error *e);

#endif
