/*
 * The study of PI control on the observed angle (iqfoc/sensorless.h) next to the same on the measured angle, over the SFFR
 * and the load.
 *
 * Drive: that of the 2019 paper at 8000 rpm, with the switching frequency of each ratio. Sensors of 12 bit with noise of
 * 0.5 % of the rated peak. The dead time is 0.5 % of a carrier period; the observer's motor file has its voltage. Feedback is the
 * quasi-discrete mean, at the usual bandwidth.
 */
#ifndef SIM_HOST_LOOPS_SENSORLESS_LOOPS_H
#define SIM_HOST_LOOPS_SENSORLESS_LOOPS_H

#include "current_loops.h"

#include "base/json.h"
#include "report/page.h"

#include <stdio.h>

enum { SENSORLESS_RATIOS = 8, SENSORLESS_LOADS = 3 };

extern const double sensorless_ratios[SENSORLESS_RATIOS];
extern const double sensorless_loads[SENSORLESS_LOADS]; /* of the rated current; the last one is 1 */

#define SENSORLESS_RPM 8000.0

/* At a constant current. */
typedef struct sensorless_loop {
    double bias_deg, rms_deg; /* of the observed minus the true angle; rms about the bias */
    double speed_percent;     /* rms error of the observed speed */
    bool locked;              /* throughout */
    loop_result loop;
} sensorless_loop;

typedef struct sensorless_loops {
    sensorless_loop at[SENSORLESS_RATIOS][SENSORLESS_LOADS];
    /*
     * Step of i_q from 0 to the rated current: overshoot in percent of the step with the measured and the observed angle,
     * and the largest difference of a cycle's mean i_q, percent of the step.
     */
    double overshoot_measured[SENSORLESS_RATIOS], overshoot_observed[SENSORLESS_RATIOS];
    double step_percent[SENSORLESS_RATIOS];
} sensorless_loops;

bool sensorless_loops_run(sensorless_loops *all, error *e);

void sensorless_loops_print(const sensorless_loops *all, FILE *f);
/* NULL when memory runs out. */
json_t *sensorless_loops_json(const sensorless_loops *all);
void sensorless_loops_part(page *p, const sensorless_loops *all);

#endif
