/*
 * The study of current loops: PI with angle advance (the library's cycle), and deadbeat control with each
 * predictor, over the SFFR and over errors of the parameters.
 *
 * Drive: that of the 2019 paper at 5000 rpm (250 Hz), with a switching frequency from 1.25 to 12.5 kHz. The torque
 * current steps from 30 % to 70 % of rated, which the DC link allows at each ratio.
 */
#ifndef SIM_HOST_LOOPS_CURRENT_LOOPS_H
#define SIM_HOST_LOOPS_CURRENT_LOOPS_H

#include "closed_loop.h"
#include "deadbeat_drive.h"
#include "drive/firmware_host.h"

typedef enum loop_method {
    LOOP_PI_MIDPOINT,    /* fed by the sample at the carrier peak */
    LOOP_PI_MEAN,        /* fed by the quasi-discrete mean */
    LOOP_DEADBEAT_EULER, /* from here on in the order of loop_models */
    LOOP_DEADBEAT_QUASI_DISCRETE,
    LOOP_DEADBEAT_EXACT,
    LOOP_LEARNING_EULER, /* the same with a disturbance observer */
    LOOP_LEARNING_QUASI_DISCRETE,
    LOOP_LEARNING_EXACT,
    LOOP_METHODS
} loop_method;

/* The predictors that predictive control is compared with. */
enum { LOOP_MODELS = 3 };
extern const iqfoc_model_t loop_models[LOOP_MODELS];
extern const char *const loop_model_text[LOOP_MODELS];

extern const char *const loop_method_text[LOOP_METHODS];
extern const char *const loop_method_key[LOOP_METHODS];

/* The firmware's parameters, as multiples of the true ones. */
typedef struct loop_belief {
    const char *text, *key;
    double L, psi, R;
} loop_belief;

enum { LOOP_RATIOS = 9, LOOP_BELIEFS = 7, LOOP_NOMINAL = 0 };
extern const double loop_ratios[LOOP_RATIOS];
extern const loop_belief loop_beliefs[LOOP_BELIEFS];

typedef struct current_loops {
    loop_result at[LOOP_RATIOS][LOOP_BELIEFS][LOOP_METHODS];
    /* Right parameters, noise of LOOP_NOISE of the rated peak. */
    loop_result noisy[LOOP_RATIOS][LOOP_METHODS];
    /* Largest ratio of the model's L to the true L, up to LOOP_L_MOST, at which the loop is stable. */
    double L_most[LOOP_RATIOS][LOOP_METHODS];
} current_loops;

/* Observer gain: ten cycles' memory. */
#define LOOP_LEARNING 0.1
#define LOOP_NOISE    0.005
#define LOOP_SEED     UINT64_C(5)
#define LOOP_RPM      5000.0
#define LOOP_L_MOST   3.0

/* The drive at a ratio: the paper's, with another switching frequency. */
motor loop_motor_at(double ratio);

/* The run that all share: the drive, the step and the noise's share of the rated peak. */
loop_case current_loop_case(double ratio, double noise);

/*
 * The library's cycle in the loop, PI as `iqfoc simulate` runs it; extension: NULL, or the corrections around it. Its
 * own trips are off: the study has one trip limit for all methods.
 */
bool cycle_loop_run(const loop_case *c, const motor *assumed, const scenario_control *control,
                    const iqfoc_extension_t *extension, loop_result *result, error *e);

/* The same with deadbeat control; the arguments are deadbeat_drive_init's. */
bool deadbeat_loop_run(const loop_case *c, const motor *assumed, iqfoc_model_t model, double learning,
                       bool extended, loop_result *result, error *e);

/* A method in the loop, at the usual bandwidth if it has one; assumed: the firmware's motor. */
bool loop_method_run(const loop_case *c, const motor *assumed, loop_method how, loop_result *result,
                     error *e);

/* One run: method, belief and noise as given. */
bool current_loop_run(double ratio, loop_method how, const loop_belief *belief, double noise,
                      loop_result *result, error *e);

/* All of them. */
bool current_loops_run(current_loops *all, error *e);

#endif
