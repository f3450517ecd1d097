/* Dormand and Prince's pair with changes of conduction located (plant_solver.h). */
#include "plant_solver.h"

#include <math.h>
#include <string.h>

#define STAGES 7

/* While a flow can change, no step is longer than this many control cycles: a current that touches zero and
 * turns back within a step would be missed. */
#define STEP_MOST_CYCLES (1.0 / 8.0)
#define EVENTS_AT_ONCE   20

typedef struct solver {
    const plant_config *config;
    conduction k;
    double t_begin_s;
    double scale[STATE_CONTROLLED];
    double I_scale_A, u_scale_V;
} solver;

static void evaluate(solver *v, double t_s, const plant_state *s, double rate[STATE_COUNT], machine_terms *t)
{
    if (inverter_link_swings(&v->config->inverter)) {
        conduction_bounds(&v->k, &v->config->inverter, v->t_begin_s + t_s);
    }
    machine_linearise(v->config, s, t);
    machine_rates(v->config, s, t, conduction_voltage(&v->k, t), rate);
}

/* One step from s with its rate k0; gives the error estimate in the scales, and the rate at the end. */
static double step(solver *v, double t_s, double h, const plant_state *s, const double k0[STATE_COUNT],
                   plant_state *end, double k_end[STATE_COUNT], machine_terms *terms)
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
    double k[STAGES][STATE_COUNT];
    memcpy(k[0], k0, sizeof k[0]);
    for (int i = 1; i < STAGES; i++) {
        /* Nothing depends on the integrals: only the step's end needs them. */
        const int states = i == STAGES - 1 ? STATE_COUNT : STATE_CONTROLLED;
        memcpy(end, s, sizeof *end);
        for (int j = 0; j < i; j++) {
            const double weight = h * a[i][j];
            for (int n = 0; n < states; n++) {
                end->y[n] += weight * k[j][n];
            }
        }
        evaluate(v, t_s + node[i] * h, end, k[i], terms); /* the last stage's point is the step's end */
    }
    memcpy(k_end, k[STAGES - 1], sizeof k[0]);
    double worst = 0.0;
    for (int n = 0; n < STATE_CONTROLLED; n++) {
        double estimate = 0.0;
        for (int i = 0; i < STAGES; i++) {
            estimate += e[i] * k[i][n];
        }
        worst = fmax(worst, fabs(h * estimate) / v->scale[n]);
    }
    return worst;
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
static double event_at(solver *v, double t_s, double h, const plant_state *s, const double k0[STATE_COUNT],
                       const machine_terms *start, double margin_h, unsigned set)
{
    const double aim = 0.5 * SOLVER_ZERO_CURRENT;
    plant_state trial;
    machine_terms terms;
    double k_end[STATE_COUNT];
    double low = 0.0, above_low = least_margin(v, start, set) + aim;
    double high = h, above_high = margin_h + aim;
    if (above_low <= 0.0) {
        return 0.0;
    }
    if (above_low <= 2.0 * aim) {
        /* It starts at zero, as after a change of flow: did it grow in between, and come back? */
        const double early = h / 16.0;
        (void)step(v, t_s, early, s, k0, &trial, k_end, &terms);
        const double above = least_margin(v, &terms, set) + aim;
        *(above > 0.0 ? &low : &high) = early;
        *(above > 0.0 ? &above_low : &above_high) = above;
    }
    int side = 0;
    for (int n = 0; n < 80 && high - low > 1e-15 * v->config->T_s; n++) {
        const double middle = (low * above_high - high * above_low) / (above_high - above_low);
        (void)step(v, t_s, middle, s, k0, &trial, k_end, &terms);
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

static void settle(solver *v, double t_s, plant_state *s, double zero_A)
{
    machine_terms terms;
    conduction_bounds(&v->k, &v->config->inverter, v->t_begin_s + t_s);
    machine_linearise(v->config, s, &terms);
    conduction_settle(&v->k, &terms, zero_A, s);
}

void solver_advance(const plant_config *c, inverter_leg leg[3], double t_begin_s, double from_s, double to_s,
                    plant_state *s)
{
    solver v = {
        .config = c, .t_begin_s = t_begin_s, .I_scale_A = c->I_scale_A, .u_scale_V = c->inverter.u_dc_V};
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
    settle(&v, from_s, s, zero_A);

    machine_terms start;
    double k0[STATE_COUNT];
    evaluate(&v, from_s, s, k0, &start);
    double t = from_s;
    const double h_most = v.k.ideal ? INFINITY : STEP_MOST_CYCLES * c->T_s;
    double h_next = fmin(to_s - from_s, h_most);
    int at_once = 0;
    while (t < to_s) {
        const bool last = h_next >= to_s - t;
        const double h = last ? to_s - t : h_next;
        plant_state end;
        machine_terms terms;
        double k_end[STATE_COUNT];
        const double miss = step(&v, t, h, s, k0, &end, k_end, &terms) / SOLVER_TOLERANCE;
        const double grow = miss > 0.0 ? 0.9 * pow(miss, -0.2) : 5.0;
        h_next = fmin(h * fmin(fmax(grow, 0.2), 5.0), h_most);
        if (miss > 1.0) {
            continue;
        }
        unsigned over = 0;
        for (int x = 0; x < 3 && !v.k.ideal; x++) {
            over |= conduction_margin(&v.k, &terms, x, v.I_scale_A, v.u_scale_V) < -SOLVER_ZERO_CURRENT
                        ? 1u << x
                        : 0u;
        }
        if (over == 0 || at_once >= EVENTS_AT_ONCE) {
            *s = end;
            memcpy(k0, k_end, sizeof k0);
            start = terms;
            t = last ? to_s : t + h;
            at_once = 0;
            continue;
        }
        const double h_event = event_at(&v, t, h, s, k0, &start, least_margin(&v, &terms, over), over);
        if (h_event > 0.0) {
            (void)step(&v, t, h_event, s, k0, &end, k_end, &terms);
            *s = end;
            t += h_event;
        }
        at_once = h_event > 0.0 ? 0 : at_once + 1;
        settle(&v, t, s, 10.0 * zero_A);
        evaluate(&v, t, s, k0, &start);
        h_next = fmin(fmax(to_s - t, 0.0), h_most);
    }
}
