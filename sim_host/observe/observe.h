/*
 * The firmware's observer without a sensor (iqfoc/observer.h) over a recording, compared with the recorded angle.
 *
 * Each stretch begins without an angle, but with the recorded speed, so that each shows how long the pull-in takes. A row counts as
 * settled once the observer has been locked for OBSERVE_SETTLED_ROWS rows and while the recorded speed is above the least one.
 */
#ifndef SIM_HOST_OBSERVE_OBSERVE_H
#define SIM_HOST_OBSERVE_OBSERVE_H

#include "base/error.h"
#include "base/json.h"
#include "base/spread.h"
#include "data/motor.h"
#include "data/recording.h"
#include "report/chart.h"

#include <stdio.h>

enum { OBSERVE_SETTLED_ROWS = 200, OBSERVE_SPEEDS = 5, OBSERVE_CURRENTS = 4, OBSERVE_REASONS = 3 };

typedef struct observe_result {
    long rows, locked;
    long lost[OBSERVE_REASONS];          /* by angle, flux, low speed */
    long pull_in;                        /* rows until the lock, the longest; -1: never locked */
    double least_rpm;                    /* the least speed */
    double speed_rms_rpm;                /* observed minus recorded speed, settled rows; NAN without rows */
    double bandwidth_rad_s;              /* of the phase-locked loop */
    spread all;                          /* of the angle's error, degrees: observed minus recorded */
    spread fast;                         /* from observe_speed_share[1] of the top speed on */
    spread by_speed[OBSERVE_SPEEDS];     /* observe_speed_share[n] ... [n + 1] of the top speed */
    spread by_current[OBSERVE_CURRENTS]; /* observe_current_share[n] ... [n + 1] of the rated peak */
} observe_result;

/* Ends of the parts, as shares. The last end is infinite. */
extern const double observe_speed_share[OBSERVE_SPEEDS + 1];
extern const double observe_current_share[OBSERVE_CURRENTS + 1];

/*
 * Replays the rows: current, voltage or duties, DC link, and the currents at the middle where they are recorded. The
 * motor file's extensions that the firmware corrects are in force, and the errors of the recorded angle that
 * repeat with the revolution are removed from it. A command that the PWM puts out several times a cycle, turned or late
 * (pwm_updates.h of the recording, else of the motor file), acts as its mean over the cycle. False: a motor whose values
 * the observer refuses, or a recording without two rows in a row.
 *
 * bandwidth_rad_s: of the phase-locked loop, up to 1/T; 0: the usual one (port/host/extension_host.h).
 *
 * series: of OBSERVE_COLUMNS, or NULL; each row adds the number of rows so far in seconds, recorded and observed speed
 * in rpm, and in settled rows the angle's error in degrees.
 */
enum { OBSERVE_COLUMNS = 4 };
bool observe_recording(const recording *r, const motor *m, double bandwidth_rad_s, observe_result *result,
                       chart_data *series, error *e);

/* A new reference; NULL: out of memory. */
json_t *observe_json(const motor *m, const observe_result *result);

/* index.html in a folder, with charts of the series. */
bool observe_page(const char *directory, const motor *m, const observe_result *result,
                  const chart_data *series, error *e);

void observe_print(const motor *m, const observe_result *result, FILE *out);

#endif
