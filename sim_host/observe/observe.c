/* Replay of the firmware's observer (observe.h). */
#include "observe.h"

#include "extension_host.h"

#include "iqfoc/sensorless.h"
#include "iqfoc/transform.h"

#include <math.h>

const double observe_speed_share[OBSERVE_SPEEDS + 1] = {0.0, 0.1, 0.25, 0.5, 0.75, INFINITY};
const double observe_current_share[OBSERVE_CURRENTS + 1] = {0.0, 0.25, 0.5, 0.75, INFINITY};

typedef struct replay {
    const recording *r;
    const motor *m; /* with the recording's cycle */
    per_unit base;
    iqfoc_extension_t extension;
    iqfoc_observer_config_t config;
    iqfoc_observer_t observer;
    long since_lock; /* rows */
    long seeking;    /* rows */
    double speed_squares;
    chart_data *series; /* or NULL */
} replay;

/* Sums, until `closed` makes the figures of them. */
static void add(observe_error *x, double degrees)
{
    x->rows++;
    x->bias += degrees;
    x->rms += degrees * degrees;
    x->most = fmax(x->most, fabs(degrees));
}

static void closed(observe_error *x)
{
    if (x->rows == 0) {
        x->bias = x->rms = x->most = NAN;
        return;
    }
    x->bias /= (double)x->rows;
    x->rms = sqrt(fmax(0.0, x->rms / (double)x->rows - x->bias * x->bias));
}

static int part_of(const double *share, int parts, double x)
{
    int n = 0;
    while (n < parts - 1 && x >= share[n + 1]) {
        n++;
    }
    return n;
}

static bool configure(replay *p, error *e)
{
    return extension_from_motor(p->m, &p->extension, e) && observer_from_motor(p->m, &p->config, e) &&
           iqfoc_observer_init(&p->observer, &p->config) == IQFOC_OK;
}

/* A row's currents, angle and speed as the firmware corrects them. `mid`: the currents at the cycle's middle. */
static iqfoc_sample_t sample_of(const replay *p, size_t k, bool mid)
{
    const recording *r = p->r;
    double *const *i = mid ? r->i_mid_A : r->i_A;
    iqfoc_sample_t s = {.theta = turns_from_rad(r->theta_e_rad[k]),
                        .turns = turns_from_speed(r->omega_e_rad_s[k], p->base.T_s),
                        .u_dc = IQ24_ONE};
    s.i.a = iq24_from_double(fmax(-15.0, fmin(15.0, i[0][k] / p->base.I_A)));
    s.i.b = iq24_from_double(fmax(-15.0, fmin(15.0, i[1][k] / p->base.I_A)));
    s.i.c = iq24_from_double(fmax(-15.0, fmin(15.0, i[2][k] / p->base.I_A)));
    s.turns = iq24_clamp(s.turns, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX);
    iqfoc_extension_sample(&p->extension, &s);
    return s;
}

static iqfoc_ab_t middle_of(iqfoc_ab_t x, iqfoc_ab_t y)
{
    const iqfoc_ab_t middle = {iq24_asr32(x.alpha + y.alpha, 1), iq24_asr32(x.beta + y.beta, 1)};
    return middle;
}

static iqfoc_ab_t current_of(const replay *p, size_t k, bool mid)
{
    return iqfoc_clarke3(sample_of(p, k, mid).i);
}

static double complex commanded(const replay *p, size_t k)
{
    double u_V[3];
    recording_voltage(p->r, k, u_V);
    return (2.0 * u_V[0] - u_V[1] - u_V[2]) / 3.0 + I * (u_V[1] - u_V[2]) * VEC_1_SQRT3;
}

/* The voltage of the cycle that begins with row k: with a voltage delay, commands of rows before it. */
static double complex voltage_of(const replay *p, const stretch *s, size_t k)
{
    const double delay = p->m->ext.voltage_delay_cycles;
    const double whole = floor(delay);
    const size_t back = (size_t)whole;
    const size_t room = k - s->first;
    const double complex late = commanded(p, k - (back < room ? back : room));
    const double complex later = commanded(p, k - (back + 1 < room ? back + 1 : room));
    return late + (delay - whole) * (later - late);
}

static void step(replay *p, const stretch *s, size_t k)
{
    const bool has_middle = p->r->i_mid_A[0] != NULL;
    const iqfoc_ab_t start = current_of(p, k, false);
    const iqfoc_ab_t end = current_of(p, k + 1, false);
    const iqfoc_ab_t middle = has_middle ? current_of(p, k, true) : middle_of(start, end);
    const iqfoc_ab_t mean = has_middle ? iqfoc_observer_mean(start, middle, end) : middle;
    const double complex u = voltage_of(p, s, k);
    const iqfoc_ab_t u_pu =
        ab_from_complex(cabs(u) > p->base.U_V ? u * p->base.U_V / cabs(u) : u, p->base.U_V);
    iqfoc_observer_step(&p->observer, iqfoc_sensorless_acting(&p->extension, u_pu, start, middle, end), mean,
                        end);
}

/* Lock and its loss, since the last row. */
static void note_lock(replay *p, observe_result *result)
{
    static const uint32_t reason[OBSERVE_REASONS] = {IQFOC_OBSERVER_LOST_ANGLE, IQFOC_OBSERVER_LOST_FLUX,
                                                     IQFOC_OBSERVER_LOST_SLOW};
    iqfoc_observer_t *o = &p->observer;
    for (int n = 0; n < OBSERVE_REASONS; n++) {
        result->lost[n] += (o->status & reason[n]) != 0;
    }
    o->status = 0;
    p->since_lock = o->locked ? p->since_lock + 1 : 0;
    p->seeking = o->locked ? p->seeking : p->seeking + 1;
    if (p->since_lock == 1) {
        result->pull_in = p->seeking > result->pull_in ? p->seeking : result->pull_in;
        p->seeking = 0;
    }
    result->rows++;
    result->locked += o->locked;
}

/* Turns per cycle to the rotor's rpm. */
static double rpm_of(const motor *m, double turns)
{
    return turns * m->f_pwm_Hz * 60.0 / m->pole_pairs;
}

/* The error at a settled row, degrees; NAN at another. */
static double note_error(replay *p, observe_result *result, size_t k, const iqfoc_sample_t *s)
{
    if (p->since_lock <= OBSERVE_SETTLED_ROWS || iq24_abs_sat(s->turns) < p->config.turns_min) {
        return NAN;
    }
    const double off = iq24_to_double(iqfoc_observer_theta(&p->observer, 0)) - iq24_to_double(s->theta);
    const double degrees = 360.0 * remainder(off, 1.0);
    const double top = motor_speed_rad_s(p->m, p->m->n_max_rpm);
    const double current = cabs(complex_from_ab(iqfoc_clarke3(s->i), 1.0));
    const int speed_part = part_of(observe_speed_share, OBSERVE_SPEEDS, fabs(p->r->omega_e_rad_s[k]) / top);
    add(&result->all, degrees);
    add(&result->by_speed[speed_part], degrees);
    add(&result->by_current[part_of(observe_current_share, OBSERVE_CURRENTS, current)], degrees);
    const double turns_off = iq24_to_double(iqfoc_observer_turns(&p->observer) - s->turns);
    p->speed_squares += turns_off * turns_off;
    return degrees;
}

static void note_row(replay *p, observe_result *result, size_t k)
{
    const iqfoc_sample_t s = sample_of(p, k, false);
    note_lock(p, result);
    const double degrees = note_error(p, result, k, &s);
    if (p->series != NULL) {
        const double observed = rpm_of(p->m, iq24_to_double(iqfoc_observer_turns(&p->observer)));
        chart_data_add(p->series,
                       (double[OBSERVE_COLUMNS]){(double)result->rows * p->base.T_s,
                                                 rpm_of(p->m, iq24_to_double(s.turns)), observed, degrees});
    }
}

static void replay_stretch(replay *p, const stretch *s, observe_result *result)
{
    const iqfoc_sample_t first = sample_of(p, s->first, false);
    iqfoc_observer_start(&p->observer, current_of(p, s->first, false), iq24_add_wrap(first.theta, IQ24(0.5)),
                         first.turns, false);
    p->since_lock = 0;
    p->seeking = 0;
    for (size_t k = s->first; k + 1 < s->first + s->count; k++) {
        step(p, s, k);
        note_row(p, result, k + 1);
    }
}

bool observe_recording(const recording *r, const motor *m, observe_result *result, chart_data *series,
                       error *e)
{
    motor own = *m;
    *result = (observe_result){.pull_in = -1};
    const bool plain = pwm_updates_is_plain(r->pwm_told ? &r->pwm : &m->pwm);
    if (!(r->T_s > 0.0) || !plain) {
        return error_input(e, r->path, 0, 0,
                           plain ? "observe: no two rows are consecutive"
                                 : "observe: only with one command a control cycle, put out at its start");
    }
    own.f_pwm_Hz = 1.0 / r->T_s;
    replay p = {.r = r, .m = &own, .base = per_unit_of(&own), .series = series};
    if (!configure(&p, e)) {
        return false;
    }
    for (size_t n = 0; n < r->stretches; n++) {
        replay_stretch(&p, &r->stretch[n], result);
    }
    result->least_rpm = rpm_of(&own, iq24_to_double(p.config.turns_min));
    result->speed_rms_rpm =
        result->all.rows > 0 ? rpm_of(&own, sqrt(p.speed_squares / (double)result->all.rows)) : NAN;
    closed(&result->all);
    for (int n = 0; n < OBSERVE_SPEEDS; n++) {
        closed(&result->by_speed[n]);
    }
    for (int n = 0; n < OBSERVE_CURRENTS; n++) {
        closed(&result->by_current[n]);
    }
    return true;
}
