/* Replay of the firmware's observer (observe.h). */
#include "observe.h"

#include "sensor_error.h"

#include "base/vector_complex.h"
#include "extension_host.h"

#include "iqfoc/sensorless.h"
#include "iqfoc/transform.h"

#include <math.h>
#include <stdlib.h>

const double observe_speed_share[OBSERVE_SPEEDS + 1] = {0.0, 0.1, 0.25, 0.5, 0.75, INFINITY};
const double observe_current_share[OBSERVE_CURRENTS + 1] = {0.0, 0.25, 0.5, 0.75, INFINITY};

typedef struct replay {
    const recording *r;
    const motor *m; /* with the recording's cycle */
    per_unit base;
    pwm_updates pwm;
    sensor_error encoder;
    iqfoc_extension_t extension;
    iqfoc_observer_config_t config;
    iqfoc_observer_t observer;
    long since_lock;    /* rows */
    long seeking;       /* rows */
    spread faster;      /* observed minus recorded speed, turns per cycle */
    chart_data *series; /* or NULL */
    double *off_rad;    /* of the rows of a stretch: observed minus recorded angle, NAN if not settled */
    double *speed;      /* the same: observed speed, per cycle */
    double *theta_mech_rad;
} replay;

static int part_of(const double *share, int parts, double x)
{
    int n = 0;
    while (n < parts - 1 && x >= share[n + 1]) {
        n++;
    }
    return n;
}

static bool configure(replay *p, double bandwidth_rad_s, error *e)
{
    if (!extension_from_motor(p->m, &p->extension, e) || !observer_from_motor(p->m, &p->config, e)) {
        return false;
    }
    if (bandwidth_rad_s > 0.0) {
        const double most_rad_s = OBSERVER_LOOP_RAD_MOST / p->base.T_s;
        if (bandwidth_rad_s > most_rad_s) {
            return error_input(
                e, NULL, 0, 0,
                "observe: --bandwidth %g is above 1/T of this recording; expected at most %.6g",
                bandwidth_rad_s, most_rad_s);
        }
        observer_set_loop(&p->config, bandwidth_rad_s * p->base.T_s);
    }
    (void)iqfoc_observer_init(&p->observer, &p->config); /* checked before */
    return true;
}

/* A row's currents, angle and speed as the firmware corrects them. `mid`: the currents at the cycle's middle. */
static iqfoc_sample_t sample_of(const replay *p, size_t k, bool mid)
{
    const recording *r = p->r;
    double *const *i = mid ? r->i_mid_A : r->i_A;
    iqfoc_sample_t s = {.theta = turns_from_rad(r->theta_e_rad[k]),
                        .speed = turns_from_speed(r->omega_e_rad_s[k], p->base.T_s),
                        .u_dc = IQ24_ONE};
    s.i.a = iq24_from_double(fmax(-15.0, fmin(15.0, i[0][k] / p->base.I_A)));
    s.i.b = iq24_from_double(fmax(-15.0, fmin(15.0, i[1][k] / p->base.I_A)));
    s.i.c = iq24_from_double(fmax(-15.0, fmin(15.0, i[2][k] / p->base.I_A)));
    s.speed = iq24_clamp(s.speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    iqfoc_extension_sample(&p->extension, &s);
    return s;
}

static iqfoc_ab_t middle_of(iqfoc_ab_t x, iqfoc_ab_t y)
{
    const iqfoc_ab_t middle = {iq24_asr32(x.alpha + y.alpha, 1), iq24_asr32(x.beta + y.beta, 1)};
    return middle;
}

/* Held as in iqfoc_sensorless_valley. */
static iqfoc_ab_t current_of(const replay *p, size_t k, bool mid)
{
    const iqfoc_ab_t i = iqfoc_clarke3(sample_of(p, k, mid).i);
    const iqfoc_ab_t held = {IQ24_HOLD_BITS(i.alpha, 28), IQ24_HOLD_BITS(i.beta, 28)};
    return held;
}

static double complex commanded(const replay *p, size_t k)
{
    double u_V[3];
    recording_voltage(p->r, k, u_V);
    return (2.0 * u_V[0] - u_V[1] - u_V[2]) / 3.0 + I * (u_V[1] - u_V[2]) * VEC_1_SQRT3;
}

/*
 * The mean voltage of a cycle as its PWM puts out the commands. A row holds the command of its cycle; the drive turns it
 * on by the recorded speed.
 */
static double complex put_out(const replay *p, const stretch *s, size_t k)
{
    const double complex now = commanded(p, k);
    const double complex before = k > s->first ? commanded(p, k - 1) : now;
    return pwm_updates_is_plain(&p->pwm)
               ? now
               : vec_complex_ab(pwm_updates_mean(&p->pwm, vec_ab_of(now), vec_ab_of(before),
                                                 p->r->omega_e_rad_s[k] * p->base.T_s));
}

/* The voltage of the cycle that begins with row k: with a voltage delay, commands of rows before it. */
static double complex voltage_of(const replay *p, const stretch *s, size_t k)
{
    const double delay = p->m->ext.voltage_delay_cycles;
    const double whole = floor(delay);
    const size_t back = (size_t)whole;
    const size_t room = k - s->first;
    const double complex late = put_out(p, s, k - (back < room ? back : room));
    const double complex later = put_out(p, s, k - (back + 1 < room ? back + 1 : room));
    return late + (delay - whole) * (later - late);
}

/*
 * The edges are known where a row's command acts in its cycle, once, and the row has the current at the carrier's peak. A log without it
 * may have several carrier periods in a cycle.
 */
static iqfoc_ab_t acting(const replay *p, size_t k, iqfoc_ab_t u, const iqfoc_ab_t i[3])
{
    const bool known =
        p->r->i_mid_A[0] != NULL && pwm_updates_is_plain(&p->pwm) && p->m->ext.voltage_delay_cycles == 0.0;
    const double inverse = p->r->u_dc_V == NULL ? 1.0 : fmin(p->base.U_V / p->r->u_dc_V[k], 2.0);
    return iqfoc_sensorless_acting(&p->extension, known ? &p->config.machine : NULL, u,
                                   iq24_from_double(inverse), i);
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
    const iqfoc_ab_t i[3] = {start, middle, end};
    iqfoc_observer_step(&p->observer, acting(p, k, u_pu, i), mean, end);
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
static double rpm_of(const motor *m, double per_cycle)
{
    return per_cycle * m->f_pwm_Hz * 60.0 / m->pole_pairs;
}

/* A row's observed minus recorded angle, rad; NAN if it is not settled. */
static double off_of(const replay *p, const iqfoc_sample_t *s)
{
    if (p->since_lock <= OBSERVE_SETTLED_ROWS || iq24_abs_sat(s->speed) < p->config.speed_min) {
        return NAN;
    }
    const double off = iq24_to_double(iqfoc_observer_theta(&p->observer, 0)) - iq24_to_double(s->theta);
    return VEC_TWO_PI * remainder(off, 1.0);
}

static void note_error(replay *p, observe_result *result, size_t k, const iqfoc_sample_t *s, double degrees,
                       double turns)
{
    const double top = motor_speed_rad_s(p->m, p->m->n_max_rpm);
    const double current = cabs(complex_from_ab(iqfoc_clarke3(s->i), 1.0));
    const double speed = fabs(p->r->omega_e_rad_s[k]) / top;
    spread_add(&result->all, degrees);
    if (speed >= observe_speed_share[1]) {
        spread_add(&result->fast, degrees);
    }
    spread_add(&result->by_speed[part_of(observe_speed_share, OBSERVE_SPEEDS, speed)], degrees);
    spread_add(&result->by_current[part_of(observe_current_share, OBSERVE_CURRENTS, current)], degrees);
    spread_add(&p->faster, turns - iq24_to_double(s->speed));
}

/* Row j of a stretch, once its mechanical angle is known. rows: those of the stretches before, and this one. */
static void note_row(replay *p, observe_result *result, const stretch *at, size_t j, long rows)
{
    const iqfoc_sample_t s = sample_of(p, at->first + j, false);
    double degrees = NAN;
    if (!isnan(p->off_rad[j])) {
        const double encoder = sensor_error_at(&p->encoder, p->theta_mech_rad[j]);
        degrees = remainder(360.0 / VEC_TWO_PI * (p->off_rad[j] + encoder), 360.0);
        note_error(p, result, at->first + j, &s, degrees, p->speed[j]);
    }
    if (p->series != NULL) {
        chart_data_add(p->series, (double[OBSERVE_COLUMNS]){(double)rows * p->base.T_s,
                                                            rpm_of(p->m, iq24_to_double(s.speed)),
                                                            rpm_of(p->m, p->speed[j]), degrees});
    }
}

static void replay_stretch(replay *p, const stretch *s, observe_result *result)
{
    const iqfoc_sample_t first = sample_of(p, s->first, false);
    const long rows = result->rows;
    iqfoc_observer_start(&p->observer, current_of(p, s->first, false), 0, first.speed, false);
    p->since_lock = 0;
    p->seeking = 0;
    p->off_rad[0] = NAN;
    for (size_t j = 1; j < s->count; j++) {
        step(p, s, s->first + j - 1);
        note_lock(p, result);
        const iqfoc_sample_t sample = sample_of(p, s->first + j, false);
        p->off_rad[j] = off_of(p, &sample);
        p->speed[j] = iq24_to_double(iqfoc_observer_speed(&p->observer));
    }
    const int turned = sensor_error_turned(&p->encoder, p->r, s, p->off_rad, p->theta_mech_rad);
    sensor_error_angles(p->r, s, p->m->pole_pairs, turned, p->theta_mech_rad);
    for (size_t j = 1; j < s->count; j++) {
        note_row(p, result, s, j, rows + (long)j);
    }
}

static bool replay_all(replay *p, observe_result *result, error *e)
{
    size_t longest = 1;
    for (size_t n = 0; n < p->r->stretches; n++) {
        longest = p->r->stretch[n].count > longest ? p->r->stretch[n].count : longest;
    }
    double *room = calloc(3 * longest, sizeof *room);
    if (room == NULL) {
        return error_failure(e, 0, "observe: out of memory");
    }
    p->off_rad = room;
    p->speed = room + longest;
    p->theta_mech_rad = room + 2 * longest;
    for (size_t n = 0; n < p->r->stretches; n++) {
        replay_stretch(p, &p->r->stretch[n], result);
    }
    free(room);
    return true;
}

bool observe_recording(const recording *r, const motor *m, double bandwidth_rad_s, observe_result *result,
                       chart_data *series, error *e)
{
    motor own = *m;
    *result = (observe_result){.pull_in = -1};
    if (!(r->T_s > 0.0)) {
        return error_input(e, r->path, 0, 0, "observe: no two rows are consecutive");
    }
    own.f_pwm_Hz = 1.0 / r->T_s;
    replay p = {.r = r,
                .m = &own,
                .base = per_unit_of(&own),
                .pwm = r->pwm_stated ? r->pwm : m->pwm,
                .encoder = sensor_error_of(&own),
                .series = series};
    if (!configure(&p, bandwidth_rad_s, e) || !replay_all(&p, result, e)) {
        return false;
    }
    result->bandwidth_rad_s = bandwidth_rad_s > 0.0 ? bandwidth_rad_s : observer_loop_rad(&own) / p.base.T_s;
    result->least_rpm = rpm_of(&own, iq24_to_double(p.config.speed_min));
    result->speed_rms_rpm = rpm_of(&own, spread_rms(&p.faster));
    return true;
}
