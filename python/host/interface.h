/*
 * What the Python package calls: the library and the host's modules behind plain C functions.
 *
 * Two read this file: the C compiler, and Python, which gives it to cffi without the lines that begin with a #. So the two
 * cannot disagree on a signature; but cffi must be able to parse this file.
 *
 * Handles are made here and given back to py_..._free. A function that can fail takes an error * and returns NULL or false.
 */
#ifndef PYTHON_HOST_INTERFACE_H
#define PYTHON_HOST_INTERFACE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct error error;
typedef struct motor motor;
typedef struct recording recording;
typedef struct py_plant py_plant;
typedef struct py_firmware py_firmware;
typedef struct py_machine py_machine;
typedef struct py_observer py_observer;
typedef struct py_cycle py_cycle;
typedef struct py_recorder py_recorder;
typedef struct py_pattern py_pattern;
typedef struct tune_report py_design;
typedef struct py_tuned py_tuned;
typedef struct py_diagnosis py_diagnosis;

/* ---- what went wrong: status 0 nothing, 1 the program, 2 the input ---- */
error *py_error_new(void);
void py_error_free(error *e);
int py_error_status(const error *e);
const char *py_error_text(const error *e);

/* ---- the library's functions, element by element; every argument and result an array of n int32 ---- */
typedef struct py_function {
    const char *name;
    int ins;
    int outs;
    void (*each)(size_t n, const int32_t *const *in, int32_t *const *out);
} py_function;
const py_function *py_functions(size_t *count);
/* The hash over all golden vectors, and the one that this version is meant to have. One call at a time. */
uint64_t py_golden(uint64_t *expected);
void py_from_float(size_t n, const double *x, int32_t *iq);

/* ---- a motor file ---- */
/* label: what messages and diagnoses call it; NULL: its path. */
motor *py_motor_read(const char *path, const char *label, error *e);
bool py_motor_write(const motor *m, const char *path, const char *comment, error *e);
void py_motor_free(motor *m);

/* ---- a machine's predictions in the firmware's arithmetic ---- */
py_machine *py_machine_new(const motor *m, error *e);
void py_machine_free(py_machine *p);
/* method: euler, quasi_discrete, exact, salient, flux, quasi_discrete_mean, exact_mean, salient_mean; false: no such.
 * in: i_alpha, i_beta, u_alpha, u_beta, theta at the start, speed. out: alpha, beta. */
bool py_machine_predict(const py_machine *p, const char *method, size_t n, const int32_t *const *in,
                        int32_t *const *out);
/* The constants: predictor's k_u, k_r, k_psi. */
void py_machine_constants(const py_machine *p, int32_t *three);

/* ---- angle and speed without a sensor ---- */
py_observer *py_observer_new(const motor *m, error *e);
void py_observer_free(py_observer *p);
void py_observer_start(py_observer *p, const int32_t *i_ab, int32_t theta, int32_t speed, bool known);
/* One cycle a row. in: alpha and beta of u, i_mean, i. out: theta, speed, locked. */
void py_observer_steps(py_observer *p, size_t n, const int32_t *const *in, int32_t *const *out);
/* IQFOC_OBSERVER_LOST_... since the start. */
uint32_t py_observer_lost(const py_observer *p);

/* ---- controllers ---- */
typedef struct py_sample {
    int32_t i[3];
    int32_t theta;
    int32_t speed;
    int32_t u_dc;
    int32_t instant;
    uint32_t time;
    bool clipped;
    bool has_mean; /* i_mean: means of the phases over an interval of six-step */
    int32_t i_mean[3];
} py_sample;
typedef struct py_command {
    int32_t duty[3];
    int32_t scale;
    bool gates;
    double interval_s; /* 0: duties of a PWM period; else an inverter state of six-step for so long */
} py_command;
typedef struct py_state {
    uint32_t status;
    bool enabled;
    bool tripped;
    bool corrected;
    int32_t i_ref_dq[2];
    int32_t i_dq[2];
    int32_t u_dq[2];
    int32_t u_ab[2];
    int32_t i_valley[2];
    int32_t i_next[2];
    int32_t error[2];
    int32_t i_corrected_dq[2];
} py_state;
typedef struct py_methods {
    int model;
    int feedback;
    int modulation;
    int control;
    double bandwidth_Hz;
    double observer_gain;
    bool extended;
} py_methods;
py_cycle *py_cycle_new(const motor *m, const py_methods *how, error *e);
void py_cycle_free(py_cycle *c);
void py_cycle_enable(py_cycle *c, bool enabled);
void py_cycle_clear(py_cycle *c);
/* Owned by the cycle. */
py_firmware *py_cycle_firmware(py_cycle *c);
/* Six-step by a timer, from the instant of this sample on; gain, angle and limits of the angle as in iqfoc/cycle_six_step.h.
 * any_angle: `angle` is not given, but that of the last requested voltage. */
bool py_cycle_to_timer(py_cycle *c, const py_sample *sample, const double *gain_and_limits, double angle,
                       bool any_angle, py_command *command, error *e);
/* Back to PWM: the state goes on as the first PWM period. */
bool py_cycle_to_carrier(py_cycle *c, py_command *command, error *e);
/* True: six-step by a timer; *angle: of its voltage ahead of the d axis, turns. */
bool py_cycle_timer(const py_cycle *c, double *angle);
void py_cycle_state(const py_cycle *c, py_state *state);
void py_firmware_reference(py_firmware *f, int32_t d, int32_t q);
void py_firmware_valley(py_firmware *f, const py_sample *sample);
void py_firmware_peak(py_firmware *f, const py_sample *sample, int32_t output_mid, py_command *command);
/* "MISSED | STALE" of status bits. */
void py_status_text(uint32_t status, char *text, size_t size);

/* ---- the design of a controller, and that controller ---- */
typedef struct py_tune_choice {
    double ratio; /* SFFR at n_max; 0: the motor file's f_pwm_Hz */
    bool deadbeat;
    double margin;
    double run_up_s;     /* from standstill to n_max, for observer and speed control */
    double inertia_kgm2; /* of the shaft; 0: no speed control */
    double tolerance[3]; /* of R, L and psi_f, shares */
    long drives;
    long seed;
    bool compares;
} py_tune_choice;
typedef struct py_watched {
    bool alarm;
    const char *group; /* NULL: none named */
    double amount;     /* in the sizes of iqfoc/watch.h */
    double since;      /* cycles of the detector until the change; with a group */
    double cycles;     /* that the detector saw */
    int32_t i_dq[2];
    int32_t drift_dq[2];
} py_watched;
/* diagnosis_path: the JSON of a diagnosis, or NULL. */
py_design *py_tune(const motor *m, const py_tune_choice *choice, const char *diagnosis_path, error *e);
void py_design_free(py_design *d);
bool py_design_json(const py_design *d, const char *path, error *e);
bool py_design_text(const py_design *d, const char *path, error *e);
/* What `iqfoc tune -o` writes; of a design that compares. */
bool py_design_report(const py_design *d, const char *directory, error *e);
/* The motor that was designed for. */
motor *py_design_motor(const py_design *d);
/* noise_A: of one current sample; 0: the diagnosis'. The controller does not need the design afterwards. */
py_tuned *py_tuned_new(const py_design *d, bool watched, double noise_A, error *e);
void py_tuned_free(py_tuned *t);
py_firmware *py_tuned_firmware(py_tuned *t);
void py_tuned_state(const py_tuned *t, py_watched *state);

/* ---- the plant ---- */
typedef struct py_reading {
    double t_s;
    double i_A[3];
    double theta_e_rad;
    double theta_mech_rad;
    double omega_e_rad_s;
    double u_dc_V;
    double temp_C;
} py_reading;
typedef struct py_means {
    double duration_s;
    double i_A[3];
    double i_dq_A[2];
    double u_V[3];
} py_means;
typedef struct py_now {
    double t_s;
    double theta_e_rad;
    double omega_e_rad_s;
    double i_A[3];
    double i_dq_A[2];
    double torque_Nm;
} py_now;
/* J_kgm2 0: the shaft follows the prescribed speed. */
py_plant *py_plant_new(const motor *m, size_t effects, const char *const *effect, long seed, double J_kgm2,
                       double friction_Nms, error *e);
void py_plant_free(py_plant *p);
void py_plant_set_speed(py_plant *p, double omega_e_rad_s, double accel_e_rad_s2);
void py_plant_set_load(py_plant *p, double T_load_Nm);
void py_plant_cycle(py_plant *p, const double *duty, py_reading *valley, py_reading *peak, py_means *means);
/* An inverter state, duties 0 or 1, for any time; sampled at its start and its end. */
void py_plant_interval(py_plant *p, const double *duty, double interval_s, py_reading *start, py_reading *end,
                       py_means *means);
/* Sensors between two cycles. */
void py_plant_sample(py_plant *p, py_reading *now);
void py_plant_state(const py_plant *p, py_now *now);

/* Names of a run's columns, from 0; NULL beyond the last. */
const char *py_run_column_name(size_t column);
/* So many cycles of firmware and plant, a row of each column for each. False: the firmware stopped the drive.
 * Six-step by a timer: so many inverter states; the columns of the peak stay as they are. recorder: NULL or one that takes each cycle. */
bool py_run(py_firmware *f, py_plant *p, py_recorder *recorder, size_t cycles, double *const *column,
            error *e);

/* ---- the recorder, and a recording of its stream ---- */
typedef struct py_recorder_choice {
    size_t columns;
    uint32_t column[16]; /* IQFOC_RECORDER_... of iqfoc/recorder.h */
    uint32_t rows;       /* that the memory holds */
    uint32_t decimation;
    uint32_t trigger; /* iqfoc_recorder_trigger_t */
    uint32_t status_bits;
    uint32_t trigger_column; /* index of `column` */
    double level;            /* in its unit */
    double pre_share;
    uint32_t octets_per_cycle; /* of the line; 0: all that wait */
} py_recorder_choice;
py_recorder *py_recorder_new(const motor *m, const py_recorder_choice *choice, error *e);
void py_recorder_free(py_recorder *r);
void py_recorder_arm(py_recorder *r);
/* Ends the recording; the line gets the rest. */
void py_recorder_stop(py_recorder *r);
bool py_recorder_finished(const py_recorder *r);
uint32_t py_recorder_lost(const py_recorder *r);
/* All octets of the line so far; valid until the next call. */
const uint8_t *py_recorder_stream(const py_recorder *r, size_t *count);
/* The number of a recorder's column by its name in a recording; 0: none. */
uint32_t py_recorder_column(const char *name);
/* The bit of a status by its name, ALARM of the change detector included; 0: none. */
uint32_t py_status_bit(const char *name);
/* note: one line of counts. */
recording *py_recording_stream(const char *label, const uint8_t *octets, size_t count, char *note,
                               size_t size, error *e);

/* ---- pulse patterns ---- */
py_pattern *py_pattern_new(const motor *m, int pulses, double on_time_s, double dead_time_s, error *e);
void py_pattern_free(py_pattern *p);
/* Lowest and highest index of the table. */
void py_pattern_range(const py_pattern *p, double *low, double *high);
/* All legs low without a recent edge. */
void py_pattern_clear(py_pattern *p);
/* One cycle a row. in: angle, speed, index. Of each row, for legs a, b, c: level and number of edges, 16 times, share high. */
void py_pattern_steps(py_pattern *p, size_t n, const int32_t *const *in, int32_t *level, int32_t *edges,
                      int32_t *instant, int32_t *high);
/* So many cycles on a plant: index, and the voltage's angle ahead of the d axis, turns. Columns as py_run's; those of the peak stay. */
void py_pattern_run(py_pattern *p, py_plant *on, double index, double ahead, size_t cycles,
                    double *const *column);

/* ---- recordings ---- */
recording *py_recording_read(const char *path, error *e);
recording *py_recording_make(const char *label, size_t rows, size_t count, const char *const *name,
                             const double *const *value, error *e);
/* text: gets a line for each run in which the firmware set status bits. */
recording *py_recording_simulate(const motor *m, const char *scenario_path, size_t effects,
                                 const char *const *effect, long seed, char *text, size_t size, error *e);
/* By a map's file, or a preset if map_path is NULL; m may be NULL. With count 0 the log is the file; else these columns are. */
recording *py_recording_import(const char *log, const char *map_path, const char *preset_name, const motor *m,
                               size_t rows, size_t count, const char *const *name, const double *const *value,
                               error *e);
bool py_recording_write(const recording *r, const char *path, const char *comment, error *e);
void py_recording_free(recording *r);
size_t py_recording_rows(const recording *r);
double py_recording_T_s(const recording *r);
bool py_recording_omega_derived(const recording *r);
/* Columns by number, from 0; NULL beyond the last. */
const char *py_recording_column_name(size_t column);
/* False: the recording has no such column, or it was filled in. */
bool py_recording_column(const recording *r, size_t column, double *out);

/* ---- the diagnosis ---- */
/* r and m must outlive it. */
py_diagnosis *py_diagnose(const recording *r, const motor *m, size_t skips, const char *const *skip,
                          error *e);
void py_diagnosis_free(py_diagnosis *p);
/* What `iqfoc diagnose` prints, and what it writes by --json and by -o. */
bool py_diagnosis_text(const py_diagnosis *p, const char *path, error *e);
bool py_diagnosis_json(const py_diagnosis *p, const char *path, error *e);
bool py_diagnosis_report(const py_diagnosis *p, const char *directory, error *e);
/* The motor file with what was found. */
motor *py_diagnosis_motor(const py_diagnosis *p);
/* One value a row: 8 columns, the alpha and beta of error_nominal, error_extended, free_nominal, free_extended, in A; NaN where there is no
 * prediction. held_out: 1 where a row was not fitted. */
void py_diagnosis_series(const py_diagnosis *p, double *const *column, double *held_out);
#endif
