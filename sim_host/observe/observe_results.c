/* The replay's results as JSON and as text (observe.h). */
#include "observe.h"

#include <math.h>

static json_t *error_json(const spread *x)
{
    return json_pack("{s:i, s:o, s:o, s:o}", "rows", (int)x->count, "bias_deg", json_number(spread_mean(x)),
                     "rms_deg", json_number(spread_deviation(x)), "most_deg", json_number(spread_most(x)));
}

/* One object for each part, with its ends in `unit`. */
static json_t *parts_json(const spread *part, const double *share, int parts, double unit, const char *low,
                          const char *high)
{
    json_t *all = json_array();
    for (int n = 0; n < parts && all != NULL; n++) {
        json_t *one = json_pack("{s:f, s:o, s:o}", low, share[n] * unit, high,
                                json_number(share[n + 1] * unit), "error", error_json(&part[n]));
        all = json_appended(all, one);
    }
    return all;
}

json_t *observe_json(const motor *m, const observe_result *r)
{
    return json_pack(
        "{s:i, s:s, s:i, s:i, s:{s:i, s:i, s:i}, s:i, s:f, s:f, s:o, s:o, s:f, s:o, s:o, s:o}", "schema", 1,
        "motor", m->name, "rows", (int)r->rows, "locked", (int)r->locked, "lost", "angle", (int)r->lost[0],
        "flux", (int)r->lost[1], "slow", (int)r->lost[2], "pull_in_rows", (int)r->pull_in, "bandwidth_rad_s",
        r->bandwidth_rad_s, "least_rpm", r->least_rpm, "speed_rms_rpm", json_number(r->speed_rms_rpm),
        "error", error_json(&r->all), "fast_rpm", observe_speed_share[1] * m->n_max_rpm, "fast",
        error_json(&r->fast), "by_speed",
        parts_json(r->by_speed, observe_speed_share, OBSERVE_SPEEDS, m->n_max_rpm, "low_rpm", "high_rpm"),
        "by_current",
        parts_json(r->by_current, observe_current_share, OBSERVE_CURRENTS, motor_rated_peak_A(m), "low_A",
                   "high_A"));
}

static void print_parts(const spread *part, const double *share, int parts, double unit, const char *name,
                        FILE *out)
{
    fprintf(out, "\n  %-18s%10s%10s%10s%10s\n", name, "rows", "bias", "rms", "most");
    for (int n = 0; n < parts; n++) {
        if (part[n].count > 0) {
            fprintf(out, "  from %-13.4g%10ld%10.2f%10.2f%10.2f\n", share[n] * unit, part[n].count,
                    spread_mean(&part[n]), spread_deviation(&part[n]), spread_most(&part[n]));
        }
    }
}

static void print_error(const char *what, double rpm, const spread *x, FILE *out)
{
    fprintf(out, "  %sabove %.4g rpm: bias %.2f, rms %.2f, at most %.2f degrees\n", what, rpm, spread_mean(x),
            spread_deviation(x), spread_most(x));
}

void observe_print(const motor *m, const observe_result *r, FILE *out)
{
    fprintf(out,
            "%s: locked in %ld of %ld rows; lost %ld times by the angle, %ld by the flux, %ld by low speed\n",
            m->name, r->locked, r->rows, r->lost[0], r->lost[1], r->lost[2]);
    if (r->pull_in >= 0) {
        fprintf(out, "  longest pull-in: %ld rows\n", r->pull_in);
    }
    if (r->all.count == 0) {
        fprintf(out, "  no settled row above %.4g rpm: no error to show\n", r->least_rpm);
        return;
    }
    print_error("angle, observed minus recorded, ", r->least_rpm, &r->all, out);
    if (r->fast.count > 0) {
        print_error("", observe_speed_share[1] * m->n_max_rpm, &r->fast, out);
    }
    fprintf(out, "  speed: rms %.4g rpm\n", r->speed_rms_rpm);
    print_parts(r->by_speed, observe_speed_share, OBSERVE_SPEEDS, m->n_max_rpm, "speed, rpm", out);
    print_parts(r->by_current, observe_current_share, OBSERVE_CURRENTS, motor_rated_peak_A(m), "current, A",
                out);
}
