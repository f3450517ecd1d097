/* The trials' results told (watch_results.h). */
#include "watch_results.h"

#include "base/json_file.h"

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

json_t *watch_results_json(const motor *m, const watch_results *r)
{
    json_t *trials = json_array();
    json_t *passed = json_array();
    bool ok = trials != NULL && passed != NULL;
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES && ok && r->tried; n++) {
        ok = json_array_append_new(trials, trial_json((watch_change)n, &r->of[n])) == 0;
    }
    for (int n = 1; n < WATCH_LEVELS && ok; n++) {
        ok = json_array_append_new(passed, json_integer(r->clean.passed[n])) == 0;
    }
    if (!ok) {
        json_free(trials);
        json_free(passed);
        return NULL;
    }
    return json_pack("{s:i, s:s, s:f, s:f, s:o, s:{s:f, s:i, s:f, s:o}, s:o}", "schema", 1, "motor", m->name,
                     "f_pwm_Hz", m->f_pwm_Hz, "noise_pu", WATCH_NOISE, "trials", trials, "clean", "cycles",
                     r->clean.cycles, "alarms", (int)r->clean.alarms, "highest", r->clean.highest, "passed",
                     passed, "warming", warming_json(r));
}

static void print_trials(const watch_results *r, FILE *out)
{
    fprintf(out, "  %-26s%8s%8s%8s%12s%12s%10s\n", "what changes", "drives", "noted", "right", "median, s",
            "latest, s", "early");
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES; n++) {
        const watch_trial *t = &r->of[n];
        fprintf(out, "  %-26s%8d%8d%8d%12.3f%12.3f%10d\n", watch_change_text[n], t->trials, t->noted,
                t->right, t->median_s, t->latest_s, t->early);
    }
}

static void print_adapted(const char *how, const adapt_trial *t, FILE *out)
{
    fprintf(out,
            "winding and magnet warm, %s: R %+.1f %%, psi_f %+.2f %% off at the end, prediction error %.3f "
            "%%%s\n",
            how, t->r_percent, t->psi_percent, t->error_percent, t->alarm ? ", alarm" : "");
}

void watch_results_print(const motor *m, const watch_results *r, FILE *out)
{
    fprintf(out, "%s at %g Hz, noise %g %% of the rated peak a sample\n", m->name, m->f_pwm_Hz,
            100.0 * WATCH_NOISE);
    if (r->tried) {
        print_trials(r, out);
    }
    fprintf(out, "nothing, %.3g cycles: %ld alarms, the highest detector at %.2f of %.2f\n", r->clean.cycles,
            r->clean.alarms, r->clean.highest, IQFOC_WATCH_THRESHOLD);
    if (r->tried) {
        print_adapted("as the firmware was told", &r->plain, out);
        print_adapted("followed (iqfoc/adapt.h)", &r->adapted, out);
    }
}
