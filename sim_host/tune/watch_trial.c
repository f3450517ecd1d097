/* The watch tried (watch_trial.h). */
#include "watch_trial.h"

#include "drive/drive_loop.h"
#include "tuned_drive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const watch_change_text[WATCH_CHANGES] = {"nothing", "magnet 5 % weaker", "winding 60 K warmer",
                                                      "sensor's gain 2 % higher", "dead time doubled"};
const char *const watch_change_key[WATCH_CHANGES] = {"nothing", "magnet", "winding", "sensor", "dead_time"};
const char *const watch_group_text[IQFOC_WATCH_GROUPS + 1] = {
    "resistance", "inductance",   "flux",        "voltage gain",  "dead time",
    "angle",      "voltage late", "sensor gain", "sensor offset", "none"};

static const iqfoc_watch_group_t group_of_change[WATCH_CHANGES] = {
    IQFOC_WATCH_NONE, IQFOC_WATCH_FLUX, IQFOC_WATCH_RESISTANCE, IQFOC_WATCH_SENSOR_GAIN,
    IQFOC_WATCH_DEAD_TIME};

/* One drive on its way. */
typedef struct watched {
    tuned_drive firmware;
    drive_firmware calls;
    drive_loop loop;
    plant_random random;
    const tune_result *design;
    motor told; /* what the firmware knows */
    double I_A, omega_most, omega;
    double i_d, i_q;                 /* wanted, per unit */
    long speed_until, current_until; /* cycles */
} watched;

static double between(plant_random *r, double low, double high)
{
    return low + (high - low) * plant_random_uniform(r);
}

static void change_drive(plant_config *c, watch_change change, int phase)
{
    switch (change) {
    case WATCH_MAGNET:
        c->machine.psi_f_Wb *= 0.95;
        break;
    case WATCH_WINDING:
        c->machine.R_ohm *= 1.0 + 60.0 * 0.00393;
        break;
    case WATCH_SENSOR:
        c->sensors.current_gain[phase] *= 1.02;
        break;
    case WATCH_LEGS:
        c->inverter.t_dead_s *= 2.0;
        break;
    case WATCH_NOTHING:
    case WATCH_CHANGES:
    default:
        break;
    }
}

/* Of the voltage in linear modulation, so that steps have room. */
static const double VOLTAGE_SHARE = 0.75;
/* How far the speed goes beyond that at which this much voltage is reached at rated current. */
static const double WEAKENED = 1.2;

static double speed_most(const tune_result *r)
{
    const double flux =
        hypot(r->design.machine.psi_f_Wb, r->design.machine.L_q_H * motor_rated_peak_A(&r->motor));
    const double omega = WEAKENED * VOLTAGE_SHARE * r->motor.u_dc_V / sqrt(3.0) / flux;
    return fmin(omega, motor_speed_rad_s(&r->motor, r->motor.n_max_rpm));
}

/* The i_d at which the voltage suffices at this speed and i_q, or more. */
static double weakened(const watched *w, double omega)
{
    const tune_machine *machine = &w->design->design.machine;
    const double most = VOLTAGE_SHARE * w->design->motor.u_dc_V / sqrt(3.0) / fmax(fabs(omega), 1.0);
    const double flux_q = machine->L_q_H * w->i_q * w->I_A;
    const double flux_d = sqrt(fmax(most * most - flux_q * flux_q, 0.0));
    return (flux_d - machine->psi_f_Wb) / (machine->L_d_H * w->I_A);
}

static bool begin(watched *w, const tune_result *r, uint64_t seed, error *e)
{
    w->told = tuned_motor(&r->motor, &r->design.machine);
    motor *m = &w->told;
    plant_config c = plant_config_from_motor(m);
    w->I_A = motor_rated_peak_A(m);
    c.inverter.t_dead_s = WATCH_DEAD_S;
    c.sensors.current_noise_A = WATCH_NOISE * w->I_A;
    c.seed = seed;
    m->ext.has[CAUSE_DEAD_TIME] = true;
    m->ext.v_dead_V = m->u_dc_V * WATCH_DEAD_S * m->f_pwm_Hz;
    m->ext.i_knee_A = 0.02 * w->I_A;
    if (!plant_config_check(&c, e) || !tuned_drive_init(&w->firmware, m, &r->design, e) ||
        !tuned_drive_extend(&w->firmware, m, e)) {
        return false;
    }
    tuned_drive_watch(&w->firmware, m, &r->design.machine, c.sensors.current_noise_A);
    w->calls = tuned_drive_firmware(&w->firmware);
    plant_random_seed(&w->random, seed, 7);
    drive_loop_begin(&w->loop, m, &c, &w->calls);
    w->design = r;
    w->omega_most = speed_most(r);
    w->omega = between(&w->random, -1.0, 1.0) * w->omega_most;
    w->speed_until = w->current_until = 0;
    plant_set_speed(&w->loop.drive, w->omega, 0.0);
    return true;
}

/* A new acceleration every 50 to 150 ms, new currents every 10 to 50 ms, the field weakened where it must be. */
static bool cycle(watched *w, long n, drive_row *row, error *e)
{
    const double T_s = w->loop.base.T_s;
    if (n >= w->speed_until) {
        const double span_s = between(&w->random, 0.05, 0.15);
        const double next = between(&w->random, -1.0, 1.0) * w->omega_most;
        plant_set_speed(&w->loop.drive, w->omega, (next - w->omega) / span_s);
        w->speed_until = n + lround(span_s / T_s);
        w->omega += (next - w->omega) / span_s * (double)lround(span_s / T_s) * T_s;
    }
    if (n >= w->current_until) {
        w->i_d = between(&w->random, -0.4, 0.1);
        w->i_q = between(&w->random, -0.9, 0.9);
        w->current_until = n + lround(between(&w->random, 0.01, 0.05) / T_s);
    }
    const double omega = plant_now(&w->loop.drive).omega_e_rad_s;
    const iqfoc_dq_t i_ref = {iq24_from_double(fmin(w->i_d, weakened(w, omega))), iq24_from_double(w->i_q)};
    return drive_loop_span(&w->loop, i_ref, row, e);
}

/* ---- Changes ---- */

typedef struct outcome {
    bool early, noted;
    double alarm_s, since_s; /* after the change */
    iqfoc_watch_group_t group;
    double amount;
} outcome;

static bool one_trial(const tune_result *r, watch_change change, uint64_t seed, outcome *out, error *e)
{
    watched w;
    drive_row row;
    const double T_s = 1.0 / r->motor.f_pwm_Hz;
    const long clean = lround(WATCH_CLEAN_S / T_s);
    const long cycles = clean + lround((WATCH_CHANGED_S + WATCH_NAMED_S) / T_s);
    *out = (outcome){.group = IQFOC_WATCH_NONE};
    if (!begin(&w, r, seed, e)) {
        return false;
    }
    const iqfoc_watch_t *watch = &w.firmware.watch;
    long alarm = -1;
    for (long n = 0; n < cycles && watch->group == IQFOC_WATCH_NONE; n++) {
        if (n == clean) {
            change_drive(&w.loop.drive.config, change, (int)(seed % 3));
        }
        if (!cycle(&w, n, &row, e)) {
            return false;
        }
        alarm = alarm < 0 && watch->naming > 0 ? n : alarm;
    }
    out->early = alarm >= 0 && alarm < clean;
    out->noted =
        !out->early && watch->group != IQFOC_WATCH_NONE && (double)(alarm - clean) * T_s <= WATCH_CHANGED_S;
    out->alarm_s = (double)(alarm - clean) * T_s;
    out->since_s = ((double)watch->since * IQFOC_WATCH_BLOCK_CYCLES - (double)clean) * T_s;
    out->group = watch->group;
    out->amount = ldexp(watch->amount_q16, -16);
    return true;
}

/* Up to the alarm; *n: cycles so far. False with *e set if the firmware is gone. */
static bool run_to_alarm(watched *w, watch_change change, long *n, error *e)
{
    const double T_s = w->loop.base.T_s;
    const long clean = lround(WATCH_CLEAN_S / T_s);
    const long last = clean + lround(WATCH_CHANGED_S / T_s);
    for (*n = 0; *n < last && w->firmware.watch.naming == 0; (*n)++) {
        drive_row row;
        if (*n == clean) {
            change_drive(&w->loop.drive.config, change, 0);
        }
        if (!cycle(w, *n, &row, e)) {
            return false;
        }
    }
    return true;
}

bool watch_trial_dump(const tune_result *r, watch_change change, uint64_t seed, double seconds,
                      watch_dump *dump, error *e)
{
    watched w;
    long n = 0;
    memset(dump, 0, sizeof *dump);
    if (!begin(&w, r, seed, e) || !run_to_alarm(&w, change, &n, e)) {
        return false;
    }
    dump->told = w.told;
    dump->noted = w.firmware.watch.naming > 0;
    if (!dump->noted) {
        return true;
    }
    scenario_run run = {.cycles = lround(seconds / w.loop.base.T_s)};
    const scenario s = {.log = {.duties = true, .u_dc = true, .third_current = true}, .runs = 1, .run = &run};
    bool ok = drive_recording_begin(&dump->rows, &s, w.loop.base.T_s, e);
    const drive_log log = drive_recording_log(&dump->rows);
    for (const long last = n + run.cycles; n < last && ok; n++) {
        drive_row row = {.run = 1};
        ok = cycle(&w, n, &row, e) && log.row(log.context, &row, e);
    }
    dump->group = w.firmware.watch.group;
    return ok &&
           (recording_find_stretches(&dump->rows.recording) || error_failure(e, 0, "watch: out of memory"));
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

bool watch_trial_run(const tune_result *r, watch_change change, int trials, uint64_t seed, watch_trial *out,
                     error *e)
{
    double *delay = calloc((size_t)trials + 1, sizeof *delay);
    *out = (watch_trial){.trials = trials, .median_s = NAN, .latest_s = NAN};
    if (delay == NULL) {
        return error_failure(e, 0, "watch: out of memory");
    }
    const iqfoc_watch_group_t right = group_of_change[change];
    bool ok = true;
    for (int n = 0; n < trials && ok; n++) {
        outcome one;
        ok = one_trial(r, change, seed + (uint64_t)n, &one, e);
        if (ok && one.noted) {
            delay[out->noted++] = one.alarm_s;
            out->since_within += fabs(one.since_s) <= 0.1 ? 1 : 0;
            out->right += one.group == right ? 1 : 0;
            out->amount += one.group == right ? one.amount : 0.0;
        }
        out->named[ok ? one.group : IQFOC_WATCH_NONE]++;
        out->early += ok && one.early ? 1 : 0;
    }
    if (ok && out->noted > 0) {
        qsort(delay, (size_t)out->noted, sizeof *delay, by_size);
        out->median_s = delay[out->noted / 2];
        out->latest_s = delay[out->noted - 1];
    }
    out->amount = out->right > 0 ? out->amount / out->right : NAN;
    free(delay);
    return ok;
}

/* ---- Nothing ---- */

static double highest_of(const iqfoc_watch_t *watch)
{
    int32_t highest = 0;
    for (int n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        highest = watch->up_q16[n] > highest ? watch->up_q16[n] : highest;
        highest = watch->down_q16[n] > highest ? watch->down_q16[n] : highest;
    }
    return ldexp(highest, -16);
}

/* Runs of this many cycles, each with its own seed and way. */
enum { CLEAN_RUN = 1000000 };

bool watch_clean_run(const tune_result *r, double cycles, uint64_t seed, watch_clean *out, error *e)
{
    watched w;
    drive_row row;
    double before = 0.0;
    *out = (watch_clean){.cycles = 0.0};
    while (out->cycles < cycles) {
        const long of_run = (long)fmin((double)CLEAN_RUN, cycles - out->cycles);
        if (!begin(&w, r, seed++, e)) {
            return false;
        }
        for (long n = 0; n < of_run; n++) {
            if (!cycle(&w, n, &row, e)) {
                return false;
            }
            if (w.firmware.watch.count == 0) {
                const double now = highest_of(&w.firmware.watch);
                out->highest = fmax(out->highest, now);
                for (int level = 1; level < WATCH_LEVELS; level++) {
                    out->passed[level] += before < level && now >= level ? 1 : 0;
                }
                before = now;
            }
            if (w.firmware.watch.naming > 0) {
                out->alarms++;
                iqfoc_watch_reset(&w.firmware.watch);
            }
        }
        out->cycles += (double)of_run;
    }
    return true;
}
