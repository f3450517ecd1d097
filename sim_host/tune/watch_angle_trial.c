/* Trials of the watch of the angle sensor (watch_angle_trial.h). */
#include "watch_angle_trial.h"

#include "watch_duty.h"

#include "base/progress.h"
#include "drive/firmware_host.h"
#include "params_host.h"

#include <math.h>

const char *const watch_angle_text[WATCH_ANGLE_FAULTS] = {"good angle sensor", "offset of 20 degrees",
                                                          "slip of 40 degrees", "eccentric, 8 degrees"};
const char *const watch_angle_key[WATCH_ANGLE_FAULTS] = {"none", "offset", "slip", "eccentric"};

static const double amount_deg[WATCH_ANGLE_FAULTS] = {0.0, WATCH_ANGLE_OFFSET_DEG, WATCH_ANGLE_SLIP_DEG,
                                                      WATCH_ANGLE_ECCENTRIC_DEG};

/* The firmware on its sensor, with observer and watch. */
typedef struct watched_angle {
    drive_host host;
    drive_firmware firmware;
    iqfoc_watch_angle_config_t config;
    iqfoc_watch_angle_t watch;
} watched_angle;

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    watched_angle *w = context;
    const bool ok = w->firmware.valley(w->firmware.context, i_ref, sample, e);
    (void)iqfoc_watch_angle_step(&w->watch, &w->host.sensorless);
    return ok;
}

static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    watched_angle *w = context;
    return w->firmware.peak(w->firmware.context, i_ref, sample, answer, e);
}

static bool begin(watched_angle *w, const motor *m, error *e)
{
    static const scenario_control control = {.feedback = FEEDBACK_QUASI_DISCRETE_MEAN,
                                             .modulation = MODULATION_PWM};
    iqfoc_cycle_config_t config;
    w->firmware = drive_firmware_host(&w->host, NULL);
    if (!drive_host_observe(&w->host, m, e) || !config_from_motor(m, &control, &config, e)) {
        return false;
    }
    config.trips = 0;
    const iqfoc_watch_angle_config_t limits =
        IQFOC_WATCH_ANGLE_CONFIG(m->pole_pairs, w->host.observer.speed_min, WATCH_ANGLE_BIAS_DEG / 360.0,
                                 WATCH_ANGLE_SWING_DEG / 360.0, WATCH_ANGLE_NOISE_DEG / 360.0);
    w->config = limits;
    if (iqfoc_watch_angle_init(&w->watch, &w->config) != IQFOC_OK) {
        return motor_refuse(m->path, "pole_pairs", e,
                            "pole_pairs = %d; expected 1 to 64 for the watch of the angle sensor",
                            m->pole_pairs);
    }
    const bool ok = w->firmware.start(w->firmware.context, &config, e);
    iqfoc_sensorless_use(&w->host.sensorless, false);
    return ok;
}

static void plant_fault(plant_sensors *s, iqfoc_watch_angle_fault_t fault)
{
    const double rad = amount_deg[fault] * VEC_TWO_PI / 360.0;
    if (fault == IQFOC_WATCH_ANGLE_ECCENTRIC) {
        s->harmonic[0] = (plant_harmonic){.order = 1.0, .amplitude_rad = rad};
    } else {
        s->theta_0_rad = rad;
    }
}

/* The amount is observed minus measured: minus the sensor's error. */
static double off_by_deg(const iqfoc_watch_angle_t *watch)
{
    const double found = 360.0 * iq24_to_double(watch->amount);
    const double planted =
        watch->fault == IQFOC_WATCH_ANGLE_ECCENTRIC ? amount_deg[watch->fault] : -amount_deg[watch->fault];
    return fabs(found - planted);
}

static bool one_trial(const tune_result *r, iqfoc_watch_angle_fault_t fault, uint64_t seed,
                      watch_angle_trial *out, error *e)
{
    watch_duty duty;
    watched_angle w;
    const drive_firmware firmware = {&w, NULL, take_valley, give_peak};
    const double T_s = 1.0 / r->motor.f_pwm_Hz;
    const long from = fault == IQFOC_WATCH_ANGLE_OFFSET ? 0 : lround(WATCH_CLEAN_S / T_s);
    const long cycles = from + lround((WATCH_CHANGED_S + WATCH_NAMED_S) / T_s);
    long named = 0;
    if (!watch_duty_begin(&duty, r, WATCH_CONSTANT, seed, e) || !begin(&w, &duty.model, e)) {
        return false;
    }
    duty.calls = firmware;
    for (long n = 0; n < cycles && w.watch.fault == IQFOC_WATCH_ANGLE_NONE; n++) {
        drive_row row;
        if (n == from) {
            plant_fault(&duty.loop.drive.config.sensors, fault);
        }
        if (!watch_duty_cycle(&duty, n, &row, e)) {
            return false;
        }
        named = n;
    }
    out->right += w.watch.fault == fault && named >= from ? 1 : 0;
    out->early += w.watch.fault != IQFOC_WATCH_ANGLE_NONE && named < from ? 1 : 0;
    if (fault != IQFOC_WATCH_ANGLE_NONE && w.watch.fault == fault) {
        out->latest_s = fmax(out->latest_s, (double)(named - from) * T_s);
        out->off_deg = fmax(out->off_deg, off_by_deg(&w.watch));
    }
    return true;
}

bool watch_angle_trial_run(const tune_result *r, iqfoc_watch_angle_fault_t fault, int trials, uint64_t seed,
                           watch_angle_trial *out, error *e)
{
    bool ok = true;
    *out = (watch_angle_trial){.trials = trials, .latest_s = NAN, .off_deg = NAN};
    progress shown = progress_begin("watch", 0.0, "");
    for (int n = 0; n < trials && ok; n++) {
        progress_say(&shown, "watch: %s, drive %d of %d", watch_angle_text[fault], n + 1, trials);
        ok = one_trial(r, fault, seed + (uint64_t)n, out, e);
    }
    progress_end(&shown);
    return ok;
}
