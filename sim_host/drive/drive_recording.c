/* A simulated drive's rows as a recording (drive_recording.h). */
#include "drive_recording.h"

#include <math.h>
#include <stdlib.h>

/* Cycles between the last of a run and the first of the next: more than 1.5, so that a stretch ends. */
#define PAUSE_CYCLES 10.0

/* Room in the first `count` of these columns, if they are wanted. */
static bool columns(double **out, int count, bool wanted, size_t rows)
{
    for (int x = 0; x < count && wanted; x++) {
        out[x] = calloc(rows, sizeof **out);
        if (out[x] == NULL) {
            return false;
        }
    }
    return true;
}

static bool allocate(recording *r, const scenario_log *log, const pwm_updates *pwm, size_t rows)
{
    const int sensors = log->third_current ? 3 : 2;
    r->run = calloc(rows, sizeof *r->run);
    r->i_c_measured = log->third_current;
    r->pwm = *pwm;
    r->pwm_stated = !pwm_updates_is_plain(pwm);
    return r->run != NULL && columns(&r->t_s, 1, true, rows) && columns(&r->theta_e_rad, 1, true, rows) &&
           columns(&r->omega_e_rad_s, 1, true, rows) && columns(r->i_A, sensors, true, rows) &&
           columns(r->u_V, 3, log->voltages, rows) && columns(r->duty, 3, log->duties, rows) &&
           columns(&r->u_dc_V, 1, log->u_dc, rows) && columns(r->i_mid_A, sensors, log->mid_currents, rows) &&
           columns(&r->theta_mech_rad, 1, log->mechanical_angle, rows) &&
           columns(&r->temp_C, 1, log->temperature, rows);
}

bool drive_recording_begin(drive_recording *r, const scenario *s, double T_s, error *e)
{
    size_t rows = 0;
    for (size_t k = 0; k < s->runs; k++) {
        rows += (size_t)scenario_run_cycles(&s->run[k], T_s);
    }
    r->capacity = rows;
    r->T_s = T_s;
    if (!allocate(&r->recording, &s->log, &s->pwm, rows)) {
        recording_free(&r->recording);
        return error_failure(e, 0, "out of memory for a recording of %zu rows", rows);
    }
    return true;
}

double drive_recording_next_s(const drive_recording *r)
{
    const recording *rec = &r->recording;
    return rec->rows == 0 ? 0.0 : rec->t_s[rec->rows - 1] + PAUSE_CYCLES * r->T_s;
}

double drive_recording_run_s(const scenario *s, size_t n, double T_s)
{
    double begin_s = 0.0;
    for (size_t k = 0; k < n; k++) {
        begin_s += ((double)(scenario_run_cycles(&s->run[k], T_s) - 1) + PAUSE_CYCLES) * T_s;
    }
    return begin_s;
}

static void set(double *values, size_t k, double value)
{
    if (values != NULL) {
        values[k] = value;
    }
}

static bool add_row(void *context, const drive_row *row, error *e)
{
    drive_recording *r = context;
    recording *rec = &r->recording;
    const size_t k = rec->rows;
    if (k >= r->capacity) {
        return error_failure(e, 0, "more cycles than the scenario has");
    }
    if (row->run != r->run) {
        r->begin_s = drive_recording_next_s(r);
        r->first = k;
        r->run = row->run;
    }
    double u_V[3];
    recording_commanded(row->duty, row->valley.u_dc_V, u_V);
    rec->run[k] = row->run;
    rec->t_s[k] = r->begin_s + (double)(k - r->first) * r->T_s;
    rec->theta_e_rad[k] = row->valley.theta_e_rad;
    rec->omega_e_rad_s[k] = row->valley.omega_e_rad_s;
    set(rec->u_dc_V, k, row->valley.u_dc_V);
    set(rec->theta_mech_rad, k, row->valley.theta_mech_rad);
    set(rec->temp_C, k, row->valley.temp_C);
    for (int x = 0; x < 3; x++) {
        set(rec->i_A[x], k, row->valley.i_A[x]);
        set(rec->i_mid_A[x], k, row->peak.i_A[x]);
        set(rec->u_V[x], k, u_V[x]);
        set(rec->duty[x], k, row->duty[x]);
    }
    rec->rows++;
    return true;
}

drive_log drive_recording_log(drive_recording *r)
{
    const drive_log log = {r, add_row};
    return log;
}
