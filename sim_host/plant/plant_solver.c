/* Dormand and Prince's pair with changes of conduction located (plant_solver.h). */
#include "plant_solver.h"

#include "plant_low_pass.h"

#include <math.h>
#include <string.h>

#define STAGES 7

/* While a flow can change, no step is longer than this many control cycles: a current that touches zero and
 * turns back within a step would be missed. */
#define STEP_MOST_CYCLES (1.0 / 8.0)
#define EVENTS_AT_ONCE   20

/* A step grows or shrinks by these factors at most; it grows by the most where the error is below GROWS_MOST tolerances. */
#define SHRINK_MOST 0.2
#define GROW_MOST   5.0
#define GROWS_MOST  1.8e-4 /* a little less than (0.9/GROW_MOST)^5 */

typedef struct solver {
    const plant_config *config;
    conduction k;
    double t_begin_s;
    bool link_swings;
    bool more_states; /* those from STATE_PLAIN on act on the others */
    double scale[STATE_CONTROLLED];
    double I_scale_A, u_scale_V;
    double rate[STAGES][STATE_COUNT]; /* of the last step's stages; [0] at its start */
} solver;

/* The rates of a stage, with the machine's terms at hand. */
static void rates(solver *v, const plant_state *s, const machine_terms *t, int stage)
{
    machine_rates(v->config, s, t, conduction_voltage(&v->k, t), v->rate[stage]);
}

static void evaluate(solver *v, double t_s, const plant_state *s, int stage, machine_terms *t)
{
    if (v->link_swings) {
        conduction_bounds(&v->k, &v->config->inverter, v->t_begin_s + t_s);
    }
    machine_linearise(v->config, s, t);
    rates(v, s, t, stage);
}

/* Four states from the given one on: s plus the weighted rates of the first stages. Groups may overlap. */
static void advance_four(const solver *v, const double weight[], int stages, int from, const plant_state *s,
                         plant_state *end)
{
    double y[4];
    for (int n = 0; n < 4; n++) {
        y[n] = s->y[from + n];
    }
    for (int j = 0; j < stages; j++) {
        for (int n = 0; n < 4; n++) {
            y[n] += weight[j] * v->rate[j][from + n];
        }
    }
    for (int n = 0; n < 4; n++) {
        end->y[from + n] = y[n];
    }
}

/* One step from s, whose rate is at stage 0; gives the error estimate in the scales. The rate at the end is the last stage's. */
static double step(solver *v, double t_s, double h, const plant_state *s, plant_state *end,
                   machine_terms *terms)
{
    static const double node[STAGES] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
    static const double a[STAGES][STAGES - 1] = {
        {0.0},
        {1.0 / 5},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static const double e[STAGES] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                                     -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    *end = *s;
    for (int i = 1; i < STAGES; i++) {
        double weight[STAGES - 1];
        for (int j = 0; j < i; j++) {
            weight[j] = h * a[i][j];
        }
        advance_four(v, weight, i, 0, s, end);
        if (v->more_states) {
            advance_four(v, weight, i, STATE_CONTROLLED - 4, s, end);
        }
        if (i == STAGES - 1) {
            /* The clock and the integrals, on which nothing else depends. */
            advance_four(v, weight, i, STATE_CLOCK, s, end);
            advance_four(v, weight, i, STATE_COUNT - 4, s, end);
        }
        evaluate(v, t_s + node[i] * h, end, i, terms); /* the last stage's point is the step's end */
    }
    const int states = v->more_states ? STATE_CONTROLLED : STATE_PLAIN;
    double worst = 0.0;
    for (int n = 0; n < states; n++) {
        double estimate = 0.0;
        for (int i = 0; i < STAGES; i++) {
            estimate += e[i] * v->rate[i][n];
        }
        const double scaled = fabs(h * estimate) / v->scale[n];
        worst = scaled > worst ? scaled : worst;
    }
    return worst;
}

/* The length of the next step after one of length h whose error was `miss` tolerances. */
static double next_step(double h, double miss)
{
    const double factor = miss > GROWS_MOST ? 0.9 * pow(miss, -0.2) : GROW_MOST;
    return h * fmin(fmax(factor, SHRINK_MOST), GROW_MOST);
}

/*
 * Takes the step that was made last. The sensors' low-pass passes the pair's continuous extension of fourth order (Hairer, Norsett,
 * Wanner, Solving ODEs I, II.6), a polynomial of the step: exact for any bandwidth.
 */
static void take(solver *v, double h, const plant_state *end, plant_state *s)
{
    static const double d[STAGES] = {-12715105075.0 / 11282082432,  0.0,
                                     87487479700.0 / 32700410799,   -10690763975.0 / 1880347072,
                                     701980252875.0 / 199316789632, -1453857185.0 / 822651844,
                                     69997945.0 / 29380423};
    const double bandwidth_rad_s = plant_current_filter(&v->config->sensors);
    vec_ab seen = end->seen_A;
    if (bandwidth_rad_s > 0.0) {
        double weight[5];
        low_pass_weights(bandwidth_rad_s * h, 5, weight);
        double *const y[2] = {&seen.alpha, &seen.beta};
        for (int n = 0; n < 2; n++) {
            const int at = STATE_I_ALPHA + n;
            double bow = 0.0;
            for (int i = 0; i < STAGES; i++) {
                bow += h * d[i] * v->rate[i][at];
            }
            /* start + x (rise + (1 - x) (in + x (out + (1 - x) bow))) */
            const double start = s->y[at];
            const double rise = end->y[at] - start;
            const double in = h * v->rate[0][at] - rise;
            const double out = rise - h * v->rate[STAGES - 1][at] - in;
            const double c[5] = {start, rise + in, out - in + bow, -out - 2.0 * bow, bow};
            *y[n] *= 1.0 - weight[0];
            for (int k = 0; k < 5; k++) {
                *y[n] += c[k] * weight[k];
            }
        }
    }
    *s = *end;
    s->seen_A = seen;
}

/* The least margin of the legs in the set (bit x for leg x). */
static double least_margin(const solver *v, const machine_terms *t, unsigned set)
{
    double least = INFINITY;
    for (int x = 0; x < 3; x++) {
        if ((set >> x) & 1u) {
            least = fmin(least, conduction_margin(&v->k, t, x, v->I_scale_A, v->u_scale_V));
        }
    }
    return least;
}

/*
 * The length of a step, between 0 and h, at which the least margin of the set has just turned negative; it is
 * negative at h. Illinois' variant of regula falsi on the step itself, so that the located state is as exact
 * as any other. It aims half a tolerance below zero: a clamp whose margin is still a hair inside would hold
 * again.
 */
static double event_at(solver *v, double t_s, double h, const plant_state *s, const machine_terms *start,
                       double margin_h, unsigned set)
{
    const double aim = 0.5 * SOLVER_ZERO_CURRENT;
    plant_state trial;
    machine_terms terms;
    double low = 0.0, above_low = least_margin(v, start, set) + aim;
    double high = h, above_high = margin_h + aim;
    if (above_low <= 0.0) {
        return 0.0;
    }
    if (above_low <= 2.0 * aim) {
        /* It starts at zero, as after a change of flow: did it grow in between, and come back? */
        const double early = h / 16.0;
        (void)step(v, t_s, early, s, &trial, &terms);
        const double above = least_margin(v, &terms, set) + aim;
        *(above > 0.0 ? &low : &high) = early;
        *(above > 0.0 ? &above_low : &above_high) = above;
    }
    int side = 0;
    for (int n = 0; n < 80 && high - low > 1e-15 * v->config->T_s; n++) {
        const double middle = (low * above_high - high * above_low) / (above_high - above_low);
        (void)step(v, t_s, middle, s, &trial, &terms);
        const double above = least_margin(v, &terms, set) + aim;
        if (fabs(above) < aim) {
            return middle;
        }
        if (above < 0.0) {
            high = middle;
            above_high = above;
            above_low *= side < 0 ? 0.5 : 1.0;
            side = -1;
        } else {
            low = middle;
            above_low = above;
            above_high *= side > 0 ? 0.5 : 1.0;
            side = 1;
        }
    }
    return high;
}

/* Settles the legs' flow, and gives terms and rates at the start of a step. */
static void settle(solver *v, double t_s, plant_state *s, double zero_A, machine_terms *start)
{
    conduction_bounds(&v->k, &v->config->inverter, v->t_begin_s + t_s);
    machine_linearise(v->config, s, start);
    if (conduction_settle(&v->k, start, zero_A, s)) {
        machine_linearise(v->config, s, start);
    }
    rates(v, s, start, 0);
}

/* Legs (bit x for leg x) whose flow the step has changed. */
static unsigned changed_flows(const solver *v, const machine_terms *end)
{
    unsigned over = 0;
    for (int x = 0; x < 3 && !v->k.ideal; x++) {
        over |= conduction_margin(&v->k, end, x, v->I_scale_A, v->u_scale_V) < -SOLVER_ZERO_CURRENT ? 1u << x
                                                                                                    : 0u;
    }
    return over;
}

void solver_advance(const plant_config *c, inverter_leg leg[3], double t_begin_s, double from_s, double to_s,
                    plant_state *s)
{
    solver v;
    v.config = c;
    v.t_begin_s = t_begin_s;
    v.I_scale_A = c->I_scale_A;
    v.u_scale_V = c->inverter.u_dc_V;
    v.link_swings = inverter_link_swings(&c->inverter);
    v.more_states = machine_has_more_states(&c->machine);
    for (int n = 0; n < STATE_CONTROLLED; n++) {
        v.scale[n] = c->I_scale_A;
    }
    v.scale[STATE_THETA_E] = 1.0;
    v.scale[STATE_CLOCK] = 1.0;
    v.scale[STATE_OMEGA_E] = fmax(fabs(s->y[STATE_OMEGA_E]), 1.0 / c->T_s * 1e-3);
    v.k.leg = leg;
    for (int x = 0; x < 3; x++) {
        v.k.off[x] = leg_off(&leg[x], from_s);
    }
    const double zero_A = SOLVER_ZERO_CURRENT * c->I_scale_A;
    machine_terms start;
    settle(&v, from_s, s, zero_A, &start);

    double t = from_s;
    const double h_most = v.k.ideal ? INFINITY : STEP_MOST_CYCLES * c->T_s;
    double h_next = fmin(to_s - from_s, h_most);
    int at_once = 0;
    while (t < to_s) {
        const bool last = h_next >= to_s - t;
        const double h = last ? to_s - t : h_next;
        plant_state end;
        machine_terms terms;
        const double miss = step(&v, t, h, s, &end, &terms) / SOLVER_TOLERANCE;
        if (miss > 1.0) {
            h_next = fmin(next_step(h, miss), h_most);
            continue;
        }
        const unsigned over = changed_flows(&v, &terms);
        if (over == 0 || at_once >= EVENTS_AT_ONCE) {
            take(&v, h, &end, s);
            if (last) {
                return;
            }
            memcpy(v.rate[0], v.rate[STAGES - 1], sizeof v.rate[0]);
            start = terms;
            t += h;
            h_next = fmin(next_step(h, miss), h_most);
            at_once = 0;
            continue;
        }
        const double h_event = event_at(&v, t, h, s, &start, least_margin(&v, &terms, over), over);
        if (h_event > 0.0) {
            (void)step(&v, t, h_event, s, &end, &terms);
            take(&v, h_event, &end, s);
            t += h_event;
        }
        at_once = h_event > 0.0 ? 0 : at_once + 1;
        settle(&v, t, s, 10.0 * zero_A, &start);
        h_next = fmin(fmax(to_s - t, 0.0), h_most);
    }
}
