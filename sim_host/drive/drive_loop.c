/* The one loop of firmware and drive (drive_loop.h). */
#include "drive_loop.h"

#include <math.h>
#include <string.h>

void drive_loop_begin(drive_loop *l, const motor *m, const plant_config *c, const drive_firmware *firmware)
{
    *l = (drive_loop){.firmware = firmware,
                      .base = per_unit_of(m),
                      .duty = {0.5, 0.5, 0.5},
                      .updates = pwm_updates_plain(),
                      .duty_before = {0.5, 0.5, 0.5}};
    plant_init(&l->drive, c);
}

void drive_loop_put(drive_loop *l, const drive_answer *answer)
{
    const iqfoc_abc_t high = answer->command.duties.high;
    l->duty[0] = iq24_to_double(high.a);
    l->duty[1] = iq24_to_double(high.b);
    l->duty[2] = iq24_to_double(high.c);
    l->interval_s = answer->interval_s;
    l->by_edges = answer->edges != NULL;
    if (l->by_edges) {
        memcpy(l->edges, answer->edges, sizeof l->edges);
    }
}

/* Over the edges on the way. */
static void advance_to(drive_loop *l, double to_s)
{
    int leg = l->by_edges ? 0 : -1;
    while (leg >= 0) {
        double at_s = to_s;
        leg = -1;
        for (int x = 0; x < 3; x++) {
            const int n = l->edge[x];
            const double edge_s = n < l->edges[x].edges
                                      ? iq24_to_double(l->edges[x].instant[n]) * l->drive.duration_s
                                      : INFINITY;
            if (edge_s < at_s) {
                leg = x;
                at_s = edge_s;
            }
        }
        if (leg >= 0) {
            plant_advance_to(&l->drive, at_s);
            plant_switch(&l->drive, leg);
            l->edge[leg]++;
        }
    }
    plant_advance_to(&l->drive, to_s);
}

/* Over the parts first ... last of `parts` that the span is cut into. */
static void advance(drive_loop *l, int first, int last, int parts)
{
    for (int n = first; n <= last; n++) {
        advance_to(l, l->drive.duration_s * n / parts);
        if (l->watch.points > 0) {
            l->watch.point(l->watch.context, &l->drive);
        }
    }
}

static bool begin_cycle(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    if (l->by_edges) {
        const bool high[3] = {l->edges[0].level > 0, l->edges[1].level > 0, l->edges[2].level > 0};
        memset(l->edge, 0, sizeof l->edge);
        plant_begin_interval(&l->drive, high, l->drive.config.T_s);
    } else if (l->halves) {
        plant_begin_half(&l->drive, l->duty, !l->falling);
        l->falling = !l->falling;
    } else {
        plant_begin_cycle(&l->drive, l->duty);
    }
    plant_sample(&l->drive, &row->valley);
    const iqfoc_sample_t sample = hal_host_sample(&row->valley, &l->drive.config.sensors, &l->base, 0);
    return l->firmware->valley(l->firmware->context, i_ref, &sample, e);
}

static void begin_interval(drive_loop *l)
{
    const bool high[3] = {l->duty[0] > 0.5, l->duty[1] > 0.5, l->duty[2] > 0.5};
    plant_begin_interval(&l->drive, high, l->interval_s);
}

/* A converter that averages: what six-step control is fed with. */
static void add_means(const drive_loop *l, iqfoc_sample_t *sample)
{
    const plant_means means = plant_mean(&l->drive);
    sample->i_mean.a = iq24_from_double(means.i_A[0] / l->base.I_A);
    sample->i_mean.b = iq24_from_double(means.i_A[1] / l->base.I_A);
    sample->i_mean.c = iq24_from_double(means.i_A[2] / l->base.I_A);
    sample->has_mean = true;
}

bool drive_loop_open(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    memcpy(row->duty, l->duty, sizeof row->duty);
    row->answer = (drive_answer){.status = 0};
    if (l->interval_s > 0.0) {
        begin_interval(l);
        return true;
    }
    return begin_cycle(l, i_ref, row, e);
}

bool drive_loop_sample(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    const drive_firmware *f = l->firmware;
    const bool interval = l->interval_s > 0.0;
    if (l->halves && !interval) {
        row->peak = row->valley;
    } else {
        plant_sample(&l->drive, &row->peak);
    }
    const iq24_t at = interval || l->halves ? 0 : IQ24(0.5);
    iqfoc_sample_t sample = hal_host_sample(&row->peak, &l->drive.config.sensors, &l->base, at);
    if (interval) {
        add_means(l, &sample);
    }
    return f->peak(f->context, i_ref, &sample, &row->answer, e);
}

void drive_loop_close(drive_loop *l, drive_row *row)
{
    row->truth = plant_mean(&l->drive);
    drive_loop_put(l, &row->answer);
}

void drive_loop_update(drive_loop *l, const pwm_updates *updates)
{
    plant_config c = l->drive.config;
    l->updates = *updates;
    if (updates->periods > 1) {
        c.T_s /= updates->periods;
        plant_set_config(&l->drive, &c);
    }
}

/* The legs' duties for a command that is turned on, both zero vectors alike. */
static void turn(const double duty[3], double angle_rad, double turned[3])
{
    const vec_ab command = vec_from_phases(duty);
    const double c = cos(angle_rad);
    const double s = sin(angle_rad);
    vec_to_phases((vec_ab){c * command.alpha - s * command.beta, s * command.alpha + c * command.beta},
                  turned);
    const double highest = fmax(turned[0], fmax(turned[1], turned[2]));
    const double lowest = fmin(turned[0], fmin(turned[1], turned[2]));
    for (int x = 0; x < 3; x++) {
        turned[x] += 0.5 - 0.5 * (highest + lowest);
    }
}

/* The shunt of the leg with the highest duty has no time: its current is what the other two leave. */
static void sample_shunts(drive_loop *l, plant_samples *sample)
{
    plant_sample(&l->drive, sample);
    if (l->updates.two_lowest) {
        int highest = 0;
        for (int x = 1; x < 3; x++) {
            highest = l->in_force[x] > l->in_force[highest] ? x : highest;
        }
        sample->i_A[highest] = -sample->i_A[(highest + 1) % 3] - sample->i_A[(highest + 2) % 3];
    }
}

/* What the gates get in period j of a control cycle. */
static void duties_of_period(const drive_loop *l, const drive_row *row, int j, double duty[3])
{
    const pwm_updates *u = &l->updates;
    const double at = (double)j / u->periods;
    const bool late = at < u->delay_cycles - 1e-9;
    const double turned_rad =
        u->turned ? row->valley.omega_e_rad_s * l->base.T_s * (late ? 1.0 + at : at) : 0.0;
    turn(late ? l->duty_before : row->duty, turned_rad, duty);
}

/* A control cycle of several PWM periods: samples at its start and in its middle. */
static bool span_of_periods(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    const drive_firmware *f = l->firmware;
    const int periods = l->updates.periods;
    memcpy(row->duty, l->duty, sizeof row->duty);
    row->answer = (drive_answer){.status = 0};
    plant_advance_to(&l->drive, l->drive.duration_s);
    sample_shunts(l, &row->valley);
    const iqfoc_sample_t valley = hal_host_sample(&row->valley, &l->drive.config.sensors, &l->base, 0);
    if (!f->valley(f->context, i_ref, &valley, e)) {
        return false;
    }
    for (int j = 0; j < periods; j++) {
        double duty[3];
        duties_of_period(l, row, j, duty);
        plant_begin_cycle(&l->drive, duty);
        memcpy(l->in_force, duty, sizeof duty);
        if (j == periods / 2) {
            plant_advance_to(&l->drive, periods % 2 == 0 ? 0.0 : 0.5 * l->drive.duration_s);
            sample_shunts(l, &row->peak);
            const iqfoc_sample_t peak =
                hal_host_sample(&row->peak, &l->drive.config.sensors, &l->base, IQ24(0.5));
            if (!f->peak(f->context, i_ref, &peak, &row->answer, e)) {
                return false;
            }
        }
        plant_advance_to(&l->drive, l->drive.duration_s);
    }
    memcpy(l->duty_before, row->duty, sizeof row->duty);
    drive_loop_close(l, row);
    return true;
}

bool drive_loop_span(drive_loop *l, iqfoc_dq_t i_ref, drive_row *row, error *e)
{
    if (l->interval_s == 0.0 && !l->halves && !pwm_updates_is_plain(&l->updates)) {
        return span_of_periods(l, i_ref, row, e);
    }
    const bool interval = l->interval_s > 0.0;
    const int least = interval ? 1 : 2;
    const int parts = l->watch.points > least ? l->watch.points : least;
    const int sampled = interval ? parts : parts / 2;
    if (!drive_loop_open(l, i_ref, row, e)) {
        return false;
    }
    advance(l, 1, sampled, parts);
    if (!drive_loop_sample(l, i_ref, row, e)) {
        return false;
    }
    advance(l, sampled + 1, parts, parts);
    drive_loop_close(l, row);
    return true;
}
