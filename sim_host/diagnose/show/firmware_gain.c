/* Prediction of the recording by the firmware code (firmware_gain.h). */
#include "firmware_gain.h"

#include "base/vector.h"
#include "data/current_sensors.h"
#include "extension_host.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include <math.h>
#include <stdio.h>

typedef struct firmware {
    const motor *m;
    per_unit base;
    iqfoc_extension_t extension;
    iqfoc_flux_predictor_t predictor;
    firmware_map map; /* if it is there, in place of `predictor` */
    double late;      /* cycles by which the voltage acts late, 0 to 2 */
} firmware;

static bool firmware_of(const recording *rec, const motor *m, firmware *f, error *e)
{
    f->m = m;
    f->base = per_unit_of(m);
    f->late = m->ext.has[CAUSE_VOLTAGE_DELAY] ? m->ext.voltage_delay_cycles : 0.0;
    motor unnamed = *m;
    unnamed.path = NULL; /* messages then name no file */
    f->map = firmware_map_of(rec, &unnamed);
    return extension_from_motor(&unnamed, &f->extension, e) &&
           (f->map.there || flux_predictor_from_motor(&unnamed, &f->predictor, e));
}

/* Phase values, per unit, to a vector. */
static iqfoc_abc_t per_unit_phases(const double x[3], double base)
{
    const iqfoc_abc_t pu = {iq24_from_double(x[0] / base), iq24_from_double(x[1] / base),
                            iq24_from_double(x[2] / base)};
    return pu;
}

/* What the sensors of a drive with this motor's extension show of a true current; what the file does not say is
 * no error. */
static vec_ab sensed(const firmware *f, missing_phase missing, iqfoc_ab_t i)
{
    const iqfoc_abc_t phase = iqfoc_clarke_inverse(i);
    const motor_extension *x = &f->m->ext;
    double i_A[3] = {iq24_to_double(phase.a) * f->base.I_A, iq24_to_double(phase.b) * f->base.I_A,
                     iq24_to_double(phase.c) * f->base.I_A};
    for (int n = 0; n < 3; n++) {
        i_A[n] = x->g[n] * i_A[n] + x->o_A[n];
    }
    current_sensors_leave_out(missing, i_A);
    return vec_from_phases(i_A);
}

/* The same in per unit. */
static void leave_out(missing_phase missing, iqfoc_abc_t *i)
{
    switch (missing) {
    case MISSING_A:
        i->a = iq24_sub_wrap(0, iq24_add_wrap(i->b, i->c));
        break;
    case MISSING_B:
        i->b = iq24_sub_wrap(0, iq24_add_wrap(i->c, i->a));
        break;
    case MISSING_C:
        i->c = iq24_sub_wrap(0, iq24_add_wrap(i->a, i->b));
        break;
    case MISSING_NONE:
    case MISSING_PHASES:
    default:
        break;
    }
}

/* One cycle in fixed point, from row k to what row k + 1 will show. */
static vec_ab predict(const firmware *f, const recording *rec, const pwm_updates *pwm, sensor_set sensors,
                      size_t k)
{
    const double i_A[3] = {rec->i_A[0][k], rec->i_A[1][k], rec->i_A[2][k]};
    /* A firmware that keeps its commands mixes the two that act in this cycle. */
    const size_t whole = (size_t)f->late;
    const double part = f->late - (double)whole;
    double u_V[3];
    double before_V[3];
    recording_voltage(rec, k - whole, u_V);
    recording_voltage(rec, part > 0.0 ? k - whole - 1 : k - whole, before_V);
    for (int x = 0; x < 3; x++) {
        u_V[x] += part * (before_V[x] - u_V[x]);
    }
    iqfoc_sample_t sample = {.i = per_unit_phases(i_A, f->base.I_A),
                             .theta = turns_from_rad(rec->theta_e_rad[k]),
                             .speed = turns_from_speed(rec->omega_e_rad_s[k], rec->T_s),
                             .u_dc = IQ24_ONE};
    iqfoc_extension_sample(&f->extension, &sample);
    leave_out(current_sensors_missing(rec, pwm, sensors, k, 1), &sample.i);
    const iqfoc_ab_t i = iqfoc_clarke3(sample.i);
    const iqfoc_ab_t u = iqfoc_clarke3(per_unit_phases(u_V, f->base.U_V));
    const iq24_sincos_t start = iq24_sincos(sample.theta);
    const iq24_sincos_t end = iq24_sincos(iq24_add_wrap(sample.theta, sample.speed));
    const iqfoc_ab_t next = f->map.there
                                ? iqfoc_flux_map_step(&f->map.map, &f->extension, i, u, start, end)
                                : iqfoc_flux_predictor_step(&f->predictor, &f->extension, i, u, start, end);
    return sensed(f, current_sensors_missing(rec, pwm, sensors, k + 1, 1), next);
}

static double error_percent(const firmware *f, const recording *rec, const pwm_updates *pwm,
                            const unsigned char *held_out)
{
    const sensor_set sensors = current_sensors_of(rec, pwm);
    double wrong = 0.0;
    double current = 0.0;
    for (size_t n = 0; n < rec->stretches; n++) {
        const stretch *s = &rec->stretch[n];
        /* From the third row on, so that every model is measured on the same rows, with or without a voltage delay. */
        for (size_t k = s->first + 2; k + 1 < s->first + s->count; k++) {
            if (!held_out[k] || !held_out[k + 1]) {
                continue;
            }
            const vec_ab shown = predict(f, rec, pwm, sensors, k);
            const vec_ab i = recording_current(rec, k + 1);
            const vec_ab off = {i.alpha - shown.alpha, i.beta - shown.beta};
            wrong += off.alpha * off.alpha + off.beta * off.beta;
            current += i.alpha * i.alpha + i.beta * i.beta;
        }
    }
    return current > 0.0 ? 100.0 * sqrt(wrong / current) : NAN;
}

firmware_gain firmware_gain_measure(const recording *rec, const unsigned char *held_out, const motor *nominal,
                                    const motor *extended)
{
    firmware_gain g = {.nominal = NAN, .extended = NAN, .gain = NAN};
    const motor *const machine[] = {nominal, extended};
    double *const percent[] = {&g.nominal, &g.extended};
    const pwm_updates *pwm = rec->pwm_stated ? &rec->pwm : &nominal->pwm;
    for (size_t k = 0; k < sizeof machine / sizeof machine[0]; k++) {
        firmware f;
        error e = {0};
        const bool held = firmware_of(rec, machine[k], &f, &e);
        g.map = f.map;
        if (!held) {
            snprintf(g.reason, sizeof g.reason, "%s", e.text);
            continue;
        }
        *percent[k] = error_percent(&f, rec, pwm, held_out);
        if (isnan(*percent[k])) {
            snprintf(g.reason, sizeof g.reason, "no held-out rows with a current");
        }
    }
    g.measured = !isnan(g.nominal) || !isnan(g.extended);
    g.gain = g.extended > 0.0 ? g.nominal / g.extended : NAN;
    return g;
}

void firmware_gain_tell(const firmware_gain *g, json_t *json)
{
    json_object_set_new(json, "firmware",
                        g->measured
                            ? json_pack("{s:o, s:o, s:o}", "nominal", json_number(g->nominal), "extended",
                                        json_number(g->extended), "gain", json_number(g->gain))
                            : json_null());
}
