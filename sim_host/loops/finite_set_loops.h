/*
 * The study of finite-control-set control: horizons 1 to 3 with each predictor, over the control intervals per
 * fundamental period, and switching against distortion. Drive and step as in current_loops.h.
 */
#ifndef SIM_HOST_LOOPS_FINITE_SET_LOOPS_H
#define SIM_HOST_LOOPS_FINITE_SET_LOOPS_H

#include "current_loops.h"
#include "finite_set_drive.h"

enum { FINITE_SET_RATIOS = 5, FINITE_SET_WEIGHTS = 7, FINITE_SET_PREDICTORS = LOOP_MODELS };

/* Not whole, or the states would repeat with the rotor's turns; 20 periods are whole numbers of intervals. */
extern const double finite_set_ratios[FINITE_SET_RATIOS];
extern const double finite_set_weights[FINITE_SET_WEIGHTS];

typedef struct finite_set_point {
    loop_result loop;
    double nodes; /* predicted currents per decision, mean */
} finite_set_point;

/* Intervals per fundamental period for the trade of switching against distortion. */
#define FINITE_SET_TRADE_RATIO 100.15

typedef struct finite_set_loops {
    finite_set_point at[FINITE_SET_RATIOS][FINITE_SET_PREDICTORS][IQFOC_FINITE_SET_HORIZON];
    finite_set_point trade[IQFOC_FINITE_SET_HORIZON][FINITE_SET_WEIGHTS]; /* exact predictor */
    /*
     * Deadbeat with PWM at horizon 1's switching frequency, rounded to a whole SFFR; 0 if that is below 5: no loop
     * then.
     */
    loop_result pwm[FINITE_SET_WEIGHTS];
    double pwm_ratio[FINITE_SET_WEIGHTS];
} finite_set_loops;

bool finite_set_loop_run(double ratio, iqfoc_model_t model, int horizon, double weight,
                         finite_set_point *point, error *e);

bool finite_set_loops_run(finite_set_loops *all, error *e);

#endif
