/* Trials of the change detector (watch_trial.h). */
#include "watch_trial.h"

#include "watch_duty.h"

#include "base/progress.h"
#include "base/sort.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const watch_change_text[WATCH_CHANGES] = {"nothing",
                                                      "magnet 5 % weaker",
                                                      "winding 60 K warmer",
                                                      "sensor's gain 2 % higher",
                                                      "dead time doubled",
                                                      "one phase's R 50 % higher",
                                                      "eccentric rotor, 5 % of flux"};
const char *const watch_change_key[WATCH_CHANGES] = {"nothing",   "magnet", "winding", "sensor",
                                                     "dead_time", "phase",  "rotor"};
const char *const watch_condition_text[WATCH_CONDITIONS] = {"nothing changes",
                                                            "link +-1 % at 300 Hz",
                                                            "link +-3 % at 300 Hz",
                                                            "winding +-10 K, magnet +-5 K, adapted",
                                                            "L -3 % at rated current, stated",
                                                            "L -10 % at rated current, stated",
                                                            "load steps"};
const char *const watch_condition_key[WATCH_CONDITIONS] = {
    "constant", "ripple_1", "ripple_3", "temperature", "saturation_3", "saturation_10", "load_steps"};
const char *const watch_group_text[IQFOC_WATCH_GROUPS + 1] = {
    "resistance",   "inductance",  "flux",          "voltage gain",     "dead time",    "angle",
    "voltage late", "sensor gain", "sensor offset", "phase resistance", "eccentricity", "none"};

static const iqfoc_watch_group_t group_of_change[WATCH_CHANGES] = {
    IQFOC_WATCH_NONE,        IQFOC_WATCH_FLUX,      IQFOC_WATCH_RESISTANCE,
    IQFOC_WATCH_SENSOR_GAIN, IQFOC_WATCH_DEAD_TIME, IQFOC_WATCH_PHASE_RESISTANCE,
    IQFOC_WATCH_ECCENTRICITY};

/* ---- Changes ---- */

typedef struct outcome {
    bool early, noted;
    double alarm_s, since_s; /* after the change */
    iqfoc_watch_group_t group;
    double amount;
} outcome;

static bool one_trial(const tune_result *r, watch_change change, uint64_t seed, outcome *out, error *e)
{
    watch_duty w;
    drive_row row;
    const double T_s = 1.0 / r->motor.f_pwm_Hz;
    const long clean = lround(WATCH_CLEAN_S / T_s);
    const long cycles = clean + lround((WATCH_CHANGED_S + WATCH_NAMED_S) / T_s);
    *out = (outcome){.group = IQFOC_WATCH_NONE};
    if (!watch_duty_begin(&w, r, WATCH_CONSTANT, seed, e)) {
        return false;
    }
    const iqfoc_watch_t *watch = &w.firmware.watch;
    long alarm = -1;
    for (long n = 0; n < cycles && watch->group == IQFOC_WATCH_NONE; n++) {
        if (n == clean) {
            watch_duty_change(&w.loop.drive.config, change, (int)(seed % 3));
        }
        if (!watch_duty_cycle(&w, n, &row, e)) {
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

/* A clock is read once in so many cycles. */
enum { TOLD_EVERY = 256 };

/* A firmware in an emulator takes minutes for a second. */
static void tell_drive(progress *shown, const watch_duty *w, watch_change change, long n)
{
    if (n % TOLD_EVERY == 0) {
        progress_say(shown, "watch: %s, %.2f s of the drive", watch_change_text[change],
                     (double)n * w->loop.base.T_s);
    }
}

/* Up to the alarm; *n: cycles so far. False with *e set if the firmware stopped. */
static bool run_to_alarm(watch_duty *w, watch_change change, progress *shown, long *n, bool *alarm, error *e)
{
    const double T_s = w->loop.base.T_s;
    const long clean = lround(WATCH_CLEAN_S / T_s);
    const long last = clean + lround(WATCH_CHANGED_S / T_s);
    for (*n = 0; *n < last && !*alarm; (*n)++) {
        drive_row row;
        tell_drive(shown, w, change, *n);
        if (*n == clean) {
            watch_duty_change(&w->loop.drive.config, change, 0);
        }
        if (!watch_duty_cycle(w, *n, &row, e)) {
            return false;
        }
        *alarm = (row.answer.status & TUNED_FIRMWARE_ALARM) != 0;
    }
    return true;
}

static bool dump_drive(const tune_result *r, watch_change change, uint64_t seed, double seconds,
                       const watch_target *target, progress *shown, watch_dump *dump, error *e)
{
    watch_duty w;
    long n = 0;
    memset(dump, 0, sizeof *dump);
    if (!watch_duty_begin(&w, r, WATCH_CONSTANT, seed, e) ||
        (target != NULL && !target->start(target->context, &w.firmware.config, &w.model, &w.calls, e)) ||
        !run_to_alarm(&w, change, shown, &n, &dump->noted, e)) {
        return false;
    }
    dump->model = w.model;
    dump->alarm_s = (double)n * w.loop.base.T_s - WATCH_CLEAN_S;
    if (!dump->noted) {
        return true;
    }
    scenario_run run = {.cycles = lround(seconds / w.loop.base.T_s)};
    const scenario s = {.log = {.duties = true, .u_dc = true, .third_current = true}, .runs = 1, .run = &run};
    bool ok = drive_recording_begin(&dump->rows, &s, w.loop.base.T_s, e);
    const drive_log log = drive_recording_log(&dump->rows);
    for (const long last = n + run.cycles; n < last && ok; n++) {
        drive_row row = {.run = 1};
        tell_drive(shown, &w, change, n);
        ok = watch_duty_cycle(&w, n, &row, e) && log.row(log.context, &row, e);
    }
    dump->group = w.firmware.watch.group;
    return ok && (target == NULL || target->group(target->context, &dump->group, e)) &&
           (recording_find_stretches(&dump->rows.recording) || error_failure(e, 0, "watch: out of memory"));
}

bool watch_trial_dump(const tune_result *r, watch_change change, uint64_t seed, double seconds,
                      const watch_target *target, watch_dump *dump, error *e)
{
    progress shown = progress_begin("watch", 0.0, "");
    const bool ok = dump_drive(r, change, seed, seconds, target, &shown, dump, e);
    progress_end(&shown);
    return ok;
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
    progress shown = progress_begin("watch", 0.0, "");
    for (int n = 0; n < trials && ok; n++) {
        outcome one;
        progress_say(&shown, "watch: %s, drive %d of %d", watch_change_text[change], n + 1, trials);
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
    progress_end(&shown);
    if (ok && out->noted > 0) {
        sort_ascending(delay, (size_t)out->noted);
        out->median_s = delay[out->noted / 2];
        out->latest_s = delay[out->noted - 1];
    }
    out->amount = out->right > 0 ? out->amount / out->right : NAN;
    free(delay);
    return ok;
}

/* ---- No change ---- */

static double highest_of(const iqfoc_watch_t *watch)
{
    int32_t highest = 0;
    for (int n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        highest = watch->up_q16[n] > highest ? watch->up_q16[n] : highest;
        highest = watch->down_q16[n] > highest ? watch->down_q16[n] : highest;
    }
    return ldexp(highest, -16);
}

/* Runs of this many cycles, each with its own seed and duty. */
enum { CLEAN_RUN = 1000000 };

static void look_at_block(iqfoc_watch_t *watch, double *before, watch_clean *out)
{
    const double now = highest_of(watch);
    out->highest = fmax(out->highest, now);
    for (int level = 1; level < WATCH_LEVELS; level++) {
        out->passed[level] += *before < level && now >= level ? 1 : 0;
    }
    *before = now;
    if (watch->naming > 0) {
        out->alarms++;
        iqfoc_watch_reset(watch);
    }
}

bool watch_clean_run(const tune_result *r, watch_condition condition, double cycles, uint64_t seed,
                     watch_clean *out, error *e)
{
    watch_duty w;
    drive_row row;
    double before = 0.0;
    bool ok = true;
    char task[64];
    (void)snprintf(task, sizeof task, "watch: %s", watch_condition_text[condition]);
    progress shown = progress_begin(task, cycles, "cycles");
    *out = (watch_clean){.cycles = 0.0};
    while (ok && out->cycles < cycles) {
        const long of_run = (long)fmin((double)CLEAN_RUN, cycles - out->cycles);
        ok = watch_duty_begin(&w, r, condition, seed++, e);
        for (long n = 0; n < of_run && ok; n++) {
            ok = watch_duty_cycle(&w, n, &row, e);
            if (w.firmware.watch.count == 0) {
                look_at_block(&w.firmware.watch, &before, out);
                progress_update(&shown, out->cycles + (double)n);
            }
        }
        out->cycles += (double)of_run;
    }
    progress_end(&shown);
    return ok;
}
