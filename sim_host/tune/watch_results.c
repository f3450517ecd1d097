/* The trials' results as text and JSON (watch_results.h). */
#include "watch_results.h"

#include "base/json_file.h"

#include <math.h>

static json_t *trial_json(watch_change change, const watch_trial *t)
{
    json_t *named = json_object();
    for (int g = 0; g <= IQFOC_WATCH_GROUPS; g++) {
        if (t->named[g] > 0 &&
            json_object_set_new(named, watch_group_text[g], json_integer(t->named[g])) != 0) {
            json_free(named);
            return NULL;
        }
    }
    return json_pack("{s:s, s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:i, s:o}", "change", watch_change_key[change],
                     "trials", t->trials, "noted", t->noted, "right", t->right, "early", t->early, "median_s",
                     json_number(t->median_s), "latest_s", json_number(t->latest_s), "amount",
                     json_number(t->amount), "since_within_0.1_s", t->since_within, "named", named);
}

static json_t *adapt_json(const adapt_trial *t)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:b}", "R_off_percent", t->r_percent, "psi_off_percent",
                     t->psi_percent, "R_most_percent", t->r_most_percent, "psi_most_percent",
                     t->psi_most_percent, "error_percent", t->error_percent, "torque_percent",
                     t->torque_percent, "alarm", t->alarm ? 1 : 0);
}

static json_t *warming_json(const watch_results *r)
{
    return !r->tried ? json_null()
                     : json_pack("{s:f, s:o, s:o}", "seconds", WATCH_ADAPTED_S, "plain",
                                 adapt_json(&r->plain), "adapted", adapt_json(&r->adapted));
}

static double per_million(const watch_clean *c)
{
    return 1e6 * (double)c->alarms / c->cycles;
}

static json_t *clean_json(const watch_clean *c)
{
    json_t *passed = json_array();
    for (int n = 1; n < WATCH_LEVELS && passed != NULL; n++) {
        passed = json_appended(passed, json_integer(c->passed[n]));
    }
    return json_pack("{s:f, s:i, s:f, s:f, s:o}", "cycles", c->cycles, "alarms", (int)c->alarms,
                     "alarms_per_million", per_million(c), "highest", c->highest, "passed", passed);
}

/* One object for each condition, by its key. */
static json_t *conditions_json(const watch_results *r)
{
    json_t *all = json_object();
    for (int n = 0; n < WATCH_CONDITIONS && all != NULL; n++) {
        if (r->ran[n] && json_object_set_new(all, watch_condition_key[n], clean_json(&r->clean[n])) != 0) {
            json_free(all);
            return NULL;
        }
    }
    return all;
}

static json_t *angle_json(const watch_results *r)
{
    json_t *all = json_array();
    for (int n = 0; n < WATCH_ANGLE_FAULTS && all != NULL && r->tried; n++) {
        const watch_angle_trial *t = &r->angle[n];
        all = json_appended(all,
                            json_pack("{s:s, s:i, s:i, s:i, s:o, s:o}", "fault", watch_angle_key[n], "trials",
                                      t->trials, "right", t->right, "early", t->early, "latest_s",
                                      json_number(t->latest_s), "amount_off_deg", json_number(t->off_deg)));
    }
    return all;
}

json_t *watch_results_json(const motor *m, const watch_results *r)
{
    json_t *trials = json_array();
    bool ok = trials != NULL;
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES && ok && r->tried; n++) {
        ok = json_array_append_new(trials, trial_json((watch_change)n, &r->of[n])) == 0;
    }
    if (!ok) {
        json_free(trials);
        return NULL;
    }
    return json_pack("{s:i, s:s, s:f, s:f, s:f, s:o, s:o, s:o, s:o, s:o}", "schema", 1, "motor", m->name,
                     "f_pwm_Hz", m->f_pwm_Hz, "noise_pu", WATCH_NOISE, "L_fall", r->fall, "trials", trials,
                     "clean", r->ran[WATCH_CONSTANT] ? clean_json(&r->clean[WATCH_CONSTANT]) : json_null(),
                     "conditions", conditions_json(r), "warming", warming_json(r), "angle_sensor",
                     angle_json(r));
}

/* A dash where no drive has a value. */
static void print_value(FILE *out, int width, int decimals, double value)
{
    if (isfinite(value)) {
        fprintf(out, "%*.*f", width, decimals, value);
    } else {
        fprintf(out, "%*s", width, "-");
    }
}

static void print_trials(const watch_results *r, FILE *out)
{
    fprintf(out, "  %-28s%8s%8s%8s%12s%12s%10s\n", "what changes", "drives", "noted", "right", "median, s",
            "latest, s", "early");
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES; n++) {
        const watch_trial *t = &r->of[n];
        fprintf(out, "  %-28s%8d%8d%8d", watch_change_text[n], t->trials, t->noted, t->right);
        print_value(out, 12, 3, t->median_s);
        print_value(out, 12, 3, t->latest_s);
        fprintf(out, "%10d\n", t->early);
    }
}

static void print_angle(const watch_results *r, FILE *out)
{
    fprintf(out, "  %-28s%8s%8s%12s%14s%10s\n", "angle sensor", "drives", "right", "latest, s", "off by, deg",
            "early");
    for (int n = 0; n < WATCH_ANGLE_FAULTS; n++) {
        const watch_angle_trial *t = &r->angle[n];
        fprintf(out, "  %-28s%8d%8d", watch_angle_text[n], t->trials, t->right);
        print_value(out, 12, 3, t->latest_s);
        print_value(out, 14, 2, t->off_deg);
        fprintf(out, "%10d\n", t->early);
    }
}

static void print_clean(const watch_results *r, FILE *out)
{
    fprintf(out, "  %-38s%10s%10s%22s%14s\n", "no change", "cycles", "alarms", "alarms per 10^6",
            "highest sum");
    for (int n = 0; n < WATCH_CONDITIONS; n++) {
        const watch_clean *c = &r->clean[n];
        if (r->ran[n]) {
            fprintf(out, "  %-38s%10.3g%10ld%22.3g%14.2f\n", watch_condition_text[n], c->cycles, c->alarms,
                    per_million(c), c->highest);
        }
    }
    fprintf(out, "an alarm needs a sum of %.2f\n", IQFOC_WATCH_THRESHOLD);
}

static void print_adapted(const char *how, const adapt_trial *t, FILE *out)
{
    fprintf(out,
            "winding and magnet warm, %s: error of R %+.1f %%, of psi_f %+.2f %% at the end, prediction "
            "error %.3f %%%s\n",
            how, t->r_percent, t->psi_percent, t->error_percent, t->alarm ? ", alarm" : "");
}

void watch_results_print(const motor *m, const watch_results *r, FILE *out)
{
    fprintf(out, "%s at %g Hz, noise %g %% of the rated peak a sample\n", m->name, m->f_pwm_Hz,
            100.0 * WATCH_NOISE);
    if (r->fall > 0.0) {
        fprintf(
            out,
            "L falls by up to %.3g %% at currents up to the rated peak (the motor file's saturation); the "
            "detector allows for it\n",
            100.0 * r->fall);
    }
    if (r->tried) {
        print_trials(r, out);
        print_angle(r, out);
    }
    print_clean(r, out);
    if (r->tried) {
        print_adapted("fixed model", &r->plain, out);
        print_adapted("adapted model (iqfoc/adapt.h)", &r->adapted, out);
    }
}
