/* Machine and firmware of a run through the pulse modes (pulse_run_up.h). */
#include "pulse_run_up.h"

#include "pulse_samples.h"

#include "base/vector.h"
#include "hal_host.h"
#include "patterns/patterns_table.h"
#include "plant/edge_machine.h"
#include "plant/plant_random.h"
#include "reproduce/paper_2019.h"

#include "iqfoc/cycle_steps.h"
#include "iqfoc/synchronous_carrier.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TICKS    40000 /* of the fixed carrier's period */
#define TOP_S    0.2   /* at constant speed */
#define NOISE_HZ 2.0   /* of the speed that selects the mode */
#define W_T      0.4   /* bandwidth of the current control times the fixed carrier's period */

enum { CARRIER_LEVELS = 4, SIX_STEP = PULSE_LEVELS - 1, SEED = 1 };

static const int pulses_of[PULSE_TABLES] = {9, 7, 5};

static const iqfoc_synchronous_level_t carrier_levels[CARRIER_LEVELS] = {
    {0, 0, 0},
    {21, IQ24(1.0 / 21.0), IQ24(0.95 / 21.0)},
    {15, IQ24(1.0 / 15.0), IQ24(0.95 / 15.0)},
    {9, IQ24(0.095), IQ24(0.09)}};
static const iqfoc_synchronous_config_t carrier_config = {
    carrier_levels, CARRIER_LEVELS, TICKS, TICKS / 8, 2 * TICKS, IQ24_ONE, IQ24(0.125), IQ24(1.0 / 6.0)};

/* ---- The drives ---- */

/* The machine of data/motors/traction_400kw.toml. */
static motor traction_motor(void)
{
    motor m = motor_blank();
    (void)snprintf(m.name, sizeof m.name, "Traction machine 400 kW");
    m.pole_pairs = 6;
    m.R_ohm = 0.018;
    m.L_d_H = 0.7e-3;
    m.L_q_H = 0.7e-3;
    m.psi_f_Wb = 0.312;
    m.I_rated_A_rms = 253.0;
    m.n_max_rpm = 5000.0;
    m.f_pwm_Hz = 2000.0;
    m.u_dc_V = 1500.0;
    return m;
}

pulse_drive pulse_drive_of(pulse_drive_id id)
{
    if (id == PULSE_DRIVE_400_KW) {
        return (pulse_drive){"traction_400kw",
                             "traction drive, 400 kW, 1500 V",
                             traction_motor(),
                             IQFOC_FEEDBACK_MODULATED_MEAN,
                             1e-4,
                             500.0,
                             {270.0, 300.0, 340.0, 380.0},
                             {260.0, 290.0, 330.0, 370.0}};
    }
    pulse_drive p = {"2019",
                     "drive of the 2019 paper, 565 V",
                     paper_2019_motor(),
                     IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                     1e-4,
                     450.0,
                     {275.0, 300.0, 330.0, 345.0},
                     {265.0, 290.0, 320.0, 335.0}};
    p.m.u_dc_V = 565.0;
    p.m.f_pwm_Hz = 2500.0;
    return p;
}

bool pulse_tables_find(pulse_tables *t, error *e)
{
    for (int n = 0; n < PULSE_TABLES; n++) {
        if (!patterns_table_find(pulses_of[n], t->row[n], &t->of[n], e)) {
            return false;
        }
    }
    return true;
}

/* ---- The machine ---- */

typedef struct machine {
    const motor *m;
    double base_A;
    edge_machine circuit;
    double since_s[3]; /* time of the last edge */
    double shortest_s; /* time between two edges of a leg */
    long edges;
    pulse_run_mode mode;
    int jumps;
    pulse_sample *sample;
    long samples, capacity;
} machine;

/* To this time, with a sample each PULSE_SAMPLE_S. */
static void advance(machine *d, double to_s)
{
    while (d->samples < d->capacity && (double)d->samples * PULSE_SAMPLE_S <= to_s) {
        edge_machine_flow(&d->circuit, (double)d->samples * PULSE_SAMPLE_S);
        d->sample[d->samples++] = (pulse_sample){d->circuit.i * cexp(-I * d->circuit.theta) / d->base_A,
                                                 d->circuit.w,
                                                 d->circuit.theta,
                                                 d->edges,
                                                 d->jumps,
                                                 d->mode};
    }
    edge_machine_flow(&d->circuit, to_s);
}

static void switch_leg(machine *d, int k, int level)
{
    if (d->circuit.level[k] != level) {
        d->circuit.level[k] = level;
        d->shortest_s = fmin(d->shortest_s, d->circuit.time_s - d->since_s[k]);
        d->since_s[k] = d->circuit.time_s;
        d->edges++;
    }
}

/* A cycle with these edges. */
static void play(machine *d, const iqfoc_edges_t *edges, double tick_s)
{
    const double begin_s = d->circuit.time_s;
    int next[3] = {0};
    for (int k = 0; k < 3; k++) {
        switch_leg(d, k, edges->leg[k].level);
    }
    while (true) {
        int first = -1;
        uint32_t at = edges->period_ticks;
        for (int k = 0; k < 3; k++) {
            if (next[k] < edges->leg[k].edges && edges->leg[k].instant[next[k]] < at) {
                first = k;
                at = edges->leg[k].instant[next[k]];
            }
        }
        advance(d, begin_s + at * tick_s);
        if (first < 0) {
            return;
        }
        switch_leg(d, first, -d->circuit.level[first]);
        next[first]++;
    }
}

/* ---- The firmware ---- */

typedef struct firmware {
    iqfoc_pulse_level_t levels[PULSE_LEVELS];
    iqfoc_pulse_config_t config;
    iqfoc_cycle_config_t base;
    iqfoc_pattern_control_config_t control_config;
    iqfoc_synchronous_carrier_t carrier;
    iqfoc_methods_t methods;
    iqfoc_cycle_t cycle;
    iqfoc_pattern_control_t control;
    iqfoc_pulse_mode_t mode;
    iqfoc_cycle_config_t set[3];
    iqfoc_hal_t hal;
    iqfoc_edges_t acting;
    iqfoc_abc_t high;     /* of the present cycle */
    uint32_t time, ticks; /* of the present cycle */
    double tick_s;
    long refused;
    bool patterns; /* act in the present cycle */
    bool resumes;
} firmware;

static bool start(firmware *f, const pulse_drive *p, const pulse_tables *t, error *e)
{
    const iqfoc_abc_t half = {IQ24(0.5), IQ24(0.5), IQ24(0.5)};
    motor by_patterns = p->m;
    by_patterns.f_pwm_Hz = 1.0 / p->pattern_s;
    memset(f, 0, sizeof *f);
    f->methods = (iqfoc_methods_t){IQFOC_MODEL_QUASI_DISCRETE, p->feedback, IQFOC_CONTROL_PI,
                                   IQFOC_MODULATION_PWM, false};
    for (int n = 1; n < PULSE_LEVELS; n++) {
        f->levels[n] =
            (iqfoc_pulse_level_t){n == SIX_STEP ? &iqfoc_pattern_six_step : &t->of[n - 1],
                                  iq24_from_double(p->on_Hz[n - 1] * p->pattern_s),
                                  iq24_from_double(p->off_Hz[n - 1] * p->pattern_s),
                                  n == SIX_STEP ? IQ24_ONE : 0, n == SIX_STEP ? IQ24(PULSE_RETURN) : 0};
    }
    f->tick_s = 1.0 / (p->m.f_pwm_Hz * TICKS);
    f->config = (iqfoc_pulse_config_t){f->levels, PULSE_LEVELS, (uint32_t)lround(p->pattern_s / f->tick_s)};
    f->base = (iqfoc_cycle_config_t){.feedback = p->feedback,
                                     .span_max = IQ24_ONE,
                                     .current_limit = IQ24(4.0),
                                     .period_ticks = TICKS,
                                     .tolerance_ticks = TICKS / 10,
                                     .stale_ticks = TICKS / 4,
                                     .deadline_ticks = TICKS / 2};
    f->control_config.correction = IQ24(0.1);
    f->control_config.disturbance = IQ24(0.02);
    if (!predictor_from_motor(&p->m, &f->base.predictor, e) ||
        !gains_from_motor(&p->m, W_T * p->m.f_pwm_Hz / VEC_TWO_PI, &f->base.gains, e) ||
        !winding_from_motor(&by_patterns, &f->control_config.winding, e)) {
        return false;
    }
    if (iqfoc_synchronous_carrier_init(&f->carrier, &carrier_config) != IQFOC_OK ||
        iqfoc_cycle_init_by(f->methods, &f->cycle, &f->base) != IQFOC_OK ||
        iqfoc_pattern_control_init(&f->control, &f->control_config, &t->of[0], IQ24(PULSE_LEAST)) !=
            IQFOC_OK ||
        iqfoc_pulse_mode_init(&f->mode, &f->config) != IQFOC_OK) {
        return error_failure(e, 0, "pulse modes: the library refuses the %s", p->text);
    }
    f->cycle.enabled = true;
    f->ticks = TICKS;
    f->high = half;
    iqfoc_edges_of_duties(half, TICKS, &f->acting);
    return true;
}

static iq24_t wrapped(double rad)
{
    const double turns = rad / VEC_TWO_PI;
    return iq24_from_double(turns - floor(turns));
}

/* What the converters hold `later_s` after the present valley; the current is that of the valley. */
static void convert(firmware *f, const machine *d, double later_s)
{
    const double complex i = d->circuit.i / d->base_A;
    const iqfoc_ab_t ab = {iq24_from_double(creal(i)), iq24_from_double(cimag(i))};
    const iqfoc_sample_t sample = {
        .i = iqfoc_clarke_inverse(ab),
        .theta = wrapped(d->circuit.theta + d->circuit.w * later_s),
        .speed = iq24_from_double(d->circuit.w * f->ticks * f->tick_s / VEC_TWO_PI),
        .u_dc =
            iq24_from_double(edge_machine_link_V(&d->circuit, d->circuit.time_s + later_s) / d->m->u_dc_V),
        .instant = later_s > 0.0 ? IQ24(0.5) : 0,
        .time = f->time + (later_s > 0.0 ? f->ticks / 2 : 0)};
    hal_host_interrupt(&f->hal, &sample);
}

static void write_duties(firmware *f, iqfoc_abc_t high, uint32_t ticks)
{
    iqfoc_edges_t edges;
    f->high = high;
    iqfoc_edges_of_duties(high, ticks, &edges);
    iqfoc_hal_write_edges(&f->hal, &edges);
}

static void write_pattern(firmware *f, const iqfoc_pattern_edges_t pattern[3])
{
    iqfoc_edges_t edges;
    f->high = (iqfoc_abc_t){pattern[0].high, pattern[1].high, pattern[2].high};
    f->carrier.ticks = f->config.period_ticks;
    iqfoc_edges_of_pattern(pattern, f->config.period_ticks, &edges);
    iqfoc_hal_write_edges(&f->hal, &edges);
}

/* The interrupts of a cycle. */
static void interrupts(firmware *f, const machine *d, uint32_t n)
{
    iqfoc_pattern_edges_t pattern[3];
    iqfoc_sample_t sample;
    convert(f, d, 0.0);
    iqfoc_hal_read_valley(&f->hal, &sample);
    iqfoc_cycle_config_t *set = &f->set[n % 3];
    const uint32_t ticks = iqfoc_synchronous_carrier_step(&f->carrier, sample.theta, sample.speed);
    iqfoc_synchronous_carrier_set(&f->base, ticks, set);
    if (f->patterns) {
        iqfoc_duties_t duties;
        iqfoc_pattern_control_aim(&f->control, f->cycle.i_ref, sample.speed);
        if (iqfoc_pulse_mode_to_carrier(&f->mode, &f->control, &f->cycle, set,
                                        iqfoc_clarke2(sample.i.a, sample.i.b), sample.theta, sample.u_dc,
                                        pattern, &duties)) {
            f->refused += duties.scale < IQ24_ONE ? 1 : 0;
            f->patterns = false;
            f->resumes = true;
            write_duties(f, duties.high, ticks);
            return;
        }
    } else {
        f->refused += iqfoc_cycle_offer_by(f->methods, &f->cycle, set) != IQFOC_OK ? 1 : 0;
        (void)iqfoc_cycle_valley_by(f->methods, &f->cycle, &sample, iqfoc_hal_now(&f->hal));
        if (f->resumes) {
            iqfoc_pulse_mode_resume(&f->control, &f->cycle);
            f->resumes = false;
        }
        iqfoc_synchronous_carrier_keep_flux(&f->carrier, &f->cycle);
        f->patterns =
            iqfoc_pulse_mode_to_pattern(&f->mode, &f->control, &f->cycle, f->high, sample.u_dc, pattern);
        if (!f->patterns) {
            convert(f, d, 0.5 * f->ticks * f->tick_s);
            const iq24_t at_valley = sample.u_dc;
            iqfoc_hal_read_peak(&f->hal, &sample);
            sample.u_dc += sample.u_dc - at_valley; /* at the next valley, where the voltage begins */
            const iqfoc_command_t command = iqfoc_cycle_peak_by(f->methods, &f->cycle, &sample,
                                                                IQFOC_HAL_OUTPUT_MID, iqfoc_hal_now(&f->hal));
            write_duties(f, command.duties.high, ticks);
            return;
        }
    }
    write_pattern(f, pattern);
}

/* ---- The run ---- */

/* i_d at which the index is this. */
static double weakening(const motor *m, double w, double i_q, double index)
{
    double low = -1.7;
    double high = 0.5;
    for (int n = 0; n < 40; n++) {
        const double middle = 0.5 * (low + high);
        const bool above = patterns_index_of(m, w, middle, i_q) > index;
        high = above ? middle : high;
        low = above ? low : middle;
    }
    return low;
}

/* The level by the speed with its noise, and the reference. */
static void choose(firmware *f, const machine *d, const pulse_case *c, double noise_Hz, double pattern_s)
{
    const double i_q = c->i_q;
    const double way = d->circuit.w < 0.0 ? -1.0 : 1.0;
    const double seen_w = d->circuit.w + way * VEC_TWO_PI * c->early_Hz;
    const double turns = (seen_w / VEC_TWO_PI + way * noise_Hz) * pattern_s;
    const double needed = patterns_index_of(d->m, d->circuit.w, 0.0, i_q);
    iqfoc_pulse_mode_step(&f->mode, &f->control, iq24_from_double(turns),
                          iq24_from_double(patterns_index_of(d->m, seen_w, 0.0, i_q)));
    const bool six_step = f->mode.wanted == SIX_STEP;
    const double i_d = needed > PULSE_LINEAR || six_step
                           ? weakening(d->m, d->circuit.w, i_q, six_step ? 1.0 : PULSE_LINEAR)
                           : 0.0;
    f->cycle.i_ref.d = iq24_from_double(i_d);
    f->cycle.i_ref.q = iq24_from_double(i_q);
}

static void run(firmware *f, machine *d, const pulse_drive *p, const pulse_case *c, pulse_run_up *result)
{
    const double total_s = 2.0 * c->ramp_s + TOP_S;
    plant_random noise;
    plant_random_seed(&noise, SEED, 0);
    for (uint32_t n = 0; d->circuit.time_s < total_s; n++) {
        const double from_top_s = fmax(fabs(d->circuit.time_s - 0.5 * total_s) - 0.5 * TOP_S, 0.0);
        const double hz = p->high_Hz - (p->high_Hz - c->low_Hz) / c->ramp_s * from_top_s;
        const int level = f->mode.level;
        const int family = f->control.trajectory.start;
        d->circuit.w = c->way * VEC_TWO_PI * hz;
        choose(f, d, c, NOISE_HZ * (2.0 * plant_random_uniform(&noise) - 1.0), p->pattern_s);
        const iqfoc_pattern_t *table = f->control.modulator.table;
        const int32_t row = f->control.modulator.row;
        interrupts(f, d, n);
        const bool jumped = table == f->control.modulator.table && f->control.modulator.row != row &&
                            f->control.trajectory.start != family;
        d->jumps += jumped ? 1 : 0;
        d->mode = (pulse_run_mode)(f->patterns ? PULSE_CARRIER_9 + f->mode.level : f->carrier.level);
        result->changes += f->mode.level != level ? 1 : 0;
        result->highest = f->mode.level > result->highest ? f->mode.level : result->highest;
        play(d, &f->acting, f->tick_s);
        f->acting = f->hal.edges;
        f->time += f->ticks;
        f->ticks = f->acting.period_ticks;
    }
}

/* Samples of the run, from malloc, in d; false with *e set. */
static bool record(const pulse_drive *p, const pulse_tables *t, const pulse_case *c, machine *d,
                   pulse_run_up *result, error *e)
{
    firmware f;
    const double base_A = motor_rated_peak_A(&p->m);
    *d = (machine){.m = &p->m,
                   .base_A = base_A,
                   .circuit = {.R_ohm = p->m.R_ohm,
                               .L_s_H = p->m.L_d_H,
                               .psi_f_Wb = p->m.psi_f_Wb,
                               .u_dc_V = p->m.u_dc_V,
                               .ripple = c->ripple ? PULSE_RIPPLE : 0.0,
                               .i = I * c->i_q * base_A * cexp(I * VEC_TWO_PI * c->angle),
                               .theta = VEC_TWO_PI * c->angle,
                               .level = {-1, -1, -1}},
                   .since_s = {-1.0, -1.0, -1.0},
                   .shortest_s = 1.0,
                   .capacity = lround((2.0 * c->ramp_s + TOP_S) / PULSE_SAMPLE_S)};
    if (!start(&f, p, t, e)) {
        return false;
    }
    d->sample = malloc((size_t)d->capacity * sizeof *d->sample);
    if (d->sample == NULL) {
        return error_failure(e, 0, "out of memory for the run-up through the pulse modes");
    }
    memset(result, 0, sizeof *result);
    run(&f, d, p, c, result);
    result->shortest_s = d->shortest_s;
    result->last = f.mode.level;
    result->status = f.cycle.status;
    result->refused = f.refused;
    return true;
}

bool pulse_run_up_run(const pulse_drive *p, const pulse_tables *t, const pulse_case *c, pulse_run_up *result,
                      error *e)
{
    machine d;
    if (!record(p, t, c, &d, result, e)) {
        return false;
    }
    pulse_samples_measure(d.sample, d.samples, &p->m, c->i_q, result);
    free(d.sample);
    return true;
}

long pulse_run_up_torque(const pulse_drive *p, const pulse_tables *t, const pulse_case *c,
                         pulse_torque *torque, long capacity, error *e)
{
    machine d;
    pulse_run_up *counts = malloc(sizeof *counts);
    if (counts == NULL) {
        (void)error_failure(e, 0, "out of memory for the run-up through the pulse modes");
        return -1;
    }
    const bool ok = record(p, t, c, &d, counts, e);
    free(counts);
    if (!ok) {
        return -1;
    }
    const long n = pulse_samples_torque(d.sample, d.samples, c->i_q, torque, capacity);
    free(d.sample);
    return n;
}
