/* A quantity over time: its value, and its TOML (profile.h). */
#include "profile.h"

#include "../base/vector.h"

profile profile_constant(double value)
{
    profile p = {.points = 1};
    p.value[0] = value;
    return p;
}

double profile_base_at(const profile *p, double t_s)
{
    size_t next = 0; /* the first point that is still to come */
    while (next < p->points && p->t_s[next] <= t_s) {
        next++;
    }
    if (next == 0) {
        return p->value[0];
    }
    const double before = p->value[next - 1];
    if (next == p->points || !p->ramps) {
        return before;
    }
    const double share = (t_s - p->t_s[next - 1]) / (p->t_s[next] - p->t_s[next - 1]);
    return before + share * (p->value[next] - before);
}

double profile_at(const profile *p, double t_s)
{
    const double base = profile_base_at(p, t_s);
    if (p->excitation == EXCITATION_NONE) {
        return base;
    }
    /* Cycle starts lie on multiples of T, and a half period often is one: rounding must not move the edge. */
    const double turns = t_s / p->period_s + 1e-9;
    const double phase = turns - floor(turns);
    if (p->excitation == EXCITATION_SQUARE) {
        return phase < 0.5 ? base + p->amplitude : base - p->amplitude;
    }
    return base + p->amplitude * sin(VEC_TWO_PI * t_s / p->period_s);
}

/* ---- reading ---- */

static void read_points(toml_table *t, const char *key, toml_range range, profile *p)
{
    const bool is_ramp = toml_has(t, "ramp");
    const char *values_key = is_ramp ? "ramp" : "steps";
    const size_t times = toml_numbers(t, "at_s", TOML_NOT_NEGATIVE, p->t_s, PROFILE_POINTS_MAX);
    const size_t values = toml_numbers(t, values_key, range, p->value, PROFILE_POINTS_MAX);
    if (!toml_has(t, "at_s")) {
        toml_refuse(t, values_key, "%s needs at_s, the times of its %s", key, values_key);
        return;
    }
    if (times != values) {
        toml_refuse(t, "at_s", "at_s and %s of %s must have as many numbers, not %zu and %zu", values_key,
                    key, times, values);
        return;
    }
    for (size_t i = 1; i < times; i++) {
        if (p->t_s[i] <= p->t_s[i - 1]) {
            toml_refuse(t, "at_s", "at_s of %s must rise: %g does not follow %g", key, p->t_s[i],
                        p->t_s[i - 1]);
            return;
        }
    }
    if (times > 0) {
        p->points = times;
        p->ramps = is_ramp;
    }
}

static void read_excitation(toml_table *t, const char *key, profile *p)
{
    toml_table *square = toml_table_inner_or_null(t, "square");
    toml_table *sine = toml_table_inner_or_null(t, "sine");
    if (square != NULL && sine != NULL) {
        toml_refuse(t, "sine", "%s may have a square or a sine, not both", key);
    }
    toml_table *shape = square != NULL ? square : sine;
    if (shape != NULL) {
        p->excitation = square != NULL ? EXCITATION_SQUARE : EXCITATION_SINE;
        p->amplitude = toml_number(shape, "amplitude", TOML_ANY);
        p->period_s = toml_number(shape, "period_s", TOML_POSITIVE);
    }
}

profile profile_read(toml_table *table, const char *key, toml_range range, double absent)
{
    if (!toml_is_table(table, key)) {
        return profile_constant(toml_number_or(table, key, range, absent));
    }
    profile p = profile_constant(absent);
    toml_table *t = toml_table_inner(table, key);
    const int forms =
        (toml_has(t, "value") ? 1 : 0) + (toml_has(t, "steps") ? 1 : 0) + (toml_has(t, "ramp") ? 1 : 0);
    if (forms != 1) {
        toml_refuse(table, key, "%s must have one of value, steps or ramp", key);
    } else if (toml_has(t, "value")) {
        p.value[0] = toml_number(t, "value", range);
    } else {
        read_points(t, key, range, &p);
    }
    read_excitation(t, key, &p);
    return p;
}
