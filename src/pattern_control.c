/* Control of a pulse pattern by its flux trajectory (include/iqfoc/pattern_control.h). */
#include "iqfoc/pattern_control.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/overmodulation.h"
#include "iqfoc/transform.h"

#include "pattern_leg.h"

#include <stddef.h>

/* Moved edges of a leg in a cycle: with one that the least time has delayed, within IQFOC_PATTERN_EDGES_MAX. */
#define PASSED_MAX (IQFOC_PATTERN_EDGES_MAX - 1)

/* Largest flux that an edge ahead of its time leaves, and latest time of an edge that is looked for: cycles. */
#define AHEAD_MAX IQ24(16.0)
#define TIME_MAX  IQ24(64.0)

#define Q28_2_PI   INT32_C(1686629713)
#define Q32_1_2_PI INT32_C(683565276)

/* ---- Set-up ---- */

/* Range: k_u >= 1/8 gives l <= 8, so that k_psi l <= 64 and rho l <= 8. */
iqfoc_error_t iqfoc_pattern_control_init(iqfoc_pattern_control_t *control,
                                         const iqfoc_pattern_control_config_t *config,
                                         const iqfoc_pattern_t *table, iq24_t least)
{
    if (control == NULL || config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    iqfoc_pattern_control_t made = {0};
    const iqfoc_error_t error = iqfoc_pattern_init(&made.modulator, table, least);
    if (error != IQFOC_OK) {
        return error;
    }
    const iqfoc_exact_winding_t *winding = &config->winding;
    if (!iq24_within(winding->rho_q30, 0, INT32_C(1) << 30) ||
        !iq24_within(winding->k_u_q26, INT32_C(1) << 23, INT32_C(1) << 30) ||
        !iq24_within(winding->k_psi_q27, 0, INT32_C(1) << 30)) {
        return IQFOC_ERROR_PREDICTOR;
    }
    made.l = iq24_div(INT32_C(1) << 26, winding->k_u_q26);
    made.r = iq24_mul_shift(winding->rho_q30, made.l, 30);
    made.psi = iq24_mul_shift(winding->k_psi_q27, made.l, 27);
    if (made.psi > IQ24(16.0)) {
        return IQFOC_ERROR_PREDICTOR;
    }
    if (!iq24_within(config->correction, 0, IQ24_ONE) || !iq24_within(config->disturbance, 0, IQ24(0.25))) {
        return IQFOC_ERROR_GAINS;
    }
    made.law = iqfoc_exact_prediction(winding, IQ24_ONE);
    made.correction = config->correction;
    made.disturbance_l = iq24_mul_round(config->disturbance, made.l);
    made.u_dc = IQ24_ONE;
    made.u_dc_inverse = IQ24_ONE;
    *control = made;
    return IQFOC_OK;
}

void iqfoc_pattern_control_change(iqfoc_pattern_control_t *control, const iqfoc_pattern_t *table)
{
    control->wanted = table;
    control->waited = 0;
    control->nearest_q48 = INT64_C(1) << 62; /* more than any, and 1.5 times that fits */
}

/* ---- The trajectory ---- */

/* The level is even about 1/4 turn, so that its integral from there is odd. Range: |flux| <= 1/4 turn. */
static void trace(iqfoc_pattern_trajectory_t *t, const iqfoc_pattern_shape_t *shape, int32_t angles)
{
    const int32_t edges = 2 * angles + 1;
    iq24_t flux = 0;
    iq24_t above = PATTERN_QUARTER_TURN;
    int32_t level = angles % 2 != 0 ? -shape->start : shape->start;
    for (int32_t k = angles; k > 0; k--) {
        const iq24_t angle = shape->angle[k - 1];
        flux -= level * (above - angle);
        t->angle[k] = angle;
        t->flux[k] = flux;
        t->angle[edges - k] = PATTERN_HALF_TURN - angle;
        t->flux[edges - k] = -flux;
        above = angle;
        level = -level;
    }
    t->angle[0] = 0;
    t->flux[0] = flux - level * above;
    t->angle[edges] = PATTERN_HALF_TURN;
    t->angle[edges + 1] = PATTERN_HALF_TURN + t->angle[1];
    t->edges = edges;
}

/* Numbers of edges and levels are those of one family and one number of angles: the legs take the pattern's. */
static void restart_legs(iqfoc_pattern_control_t *control, int32_t start)
{
    control->trajectory.start = start;
    for (int32_t k = 0; k < 3; k++) {
        control->leg[k].place = 0;
        control->leg[k].level = 0;
    }
}

/* ---- The place of a leg ---- */

typedef struct {
    iq24_t y;      /* angle in the half turn: 0 ... 1/2, 1/2 excluded */
    int32_t level; /* the pattern's */
    iq24_t flux;   /* integral of the level: within +-1/4 */
} place_t;

/* n: number of the last edge at or before the place, in its half turn; in the cycle before, and now. */
static inline place_t place_of(const iqfoc_pattern_trajectory_t *t, iq24_t x, int32_t *n)
{
    const iq24_t y = x & (PATTERN_HALF_TURN - 1);
    int32_t k = *n;
    /* These end at angle[0] = 0 and angle[edges] = 1/2. */
    while (t->angle[k] > y) {
        k--;
    }
    while (t->angle[k + 1] <= y) {
        k++;
    }
    *n = k;
    /* The second half turn and each edge change the sign. */
    const int32_t sign = (x & PATTERN_HALF_TURN) != 0 ? -1 : 1;
    const int32_t level = k % 2 != 0 ? -t->start : t->start;
    const place_t place = {y, sign * level, sign * (t->flux[k] + level * (y - t->angle[k]))};
    return place;
}

/* The angles of the legs at a rotor angle: 0 <= x < 1, but for whole turns. */
static inline void angles_of(const iqfoc_pattern_trajectory_t *t, iq24_t theta, iq24_t x[3])
{
    const iq24_t a = (iq24_add_wrap(theta, t->u_angle) & (IQ24_ONE - 1)) + PATTERN_QUARTER_TURN;
    x[0] = a;
    x[1] = a - PATTERN_THIRD_TURN;
    x[2] = a + PATTERN_THIRD_TURN;
    if (t->turns < 0) {
        /* x becomes 1/2 - x: the level is the same, and time goes forward. */
        for (int32_t k = 0; k < 3; k++) {
            x[k] = PATTERN_HALF_TURN - x[k];
        }
    }
}

/* ---- Change of the table ---- */

/* Square of the distance between the flux of two tables at the start of the next cycle: cycles of the link. Range: 2 (2/3 64)^2. */
static iq24_acc_t distance_q48(const iqfoc_pattern_control_t *control,
                               const iqfoc_pattern_trajectory_t *other)
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    iq24_t x[3];
    iq24_t apart[3];
    angles_of(t, iq24_add_wrap(control->theta, t->turns), x);
    for (int32_t k = 0; k < 3; k++) {
        int32_t n = control->leg[k].place;
        int32_t m = 0;
        apart[k] = place_of(other, x[k], &m).flux - place_of(t, x[k], &n).flux;
    }
    const iqfoc_abc_t legs = {apart[0], apart[1], apart[2]};
    const iqfoc_ab_t flux = iqfoc_clarke3(legs);
    const iq24_t alpha = iq24_mul_round(flux.alpha, 2 * t->cycles_q22);
    const iq24_t beta = iq24_mul_round(flux.beta, 2 * t->cycles_q22);
    return iq24_acc_mac(iq24_acc_mul(alpha, alpha), beta, beta);
}

/*
 * Takes the wanted table where its flux is nearest: the distance has a period of a sixth of a turn, in which its least value is found,
 * and is then within 1.2 of that. After two turns it takes it anyway.
 */
static void change_if_near(iqfoc_pattern_control_t *control, iq24_t index)
{
    iqfoc_pattern_modulator_t other = control->modulator;
    other.table = control->wanted;
    other.row = 0;
    const iqfoc_pattern_shape_t shape = iqfoc_pattern_shape_at(&other, index);
    iqfoc_pattern_trajectory_t next = control->trajectory;
    trace(&next, &shape, other.table->angles);
    next.start = shape.start;
    const iq24_acc_t apart = distance_q48(control, &next);
    const iq24_acc_t nearest = control->nearest_q48;
    const iq24_acc_t enough = iq24_asr64(nearest, 1) - iq24_asr64(nearest, 4) + nearest; /* 1.2^2 */
    control->waited += next.speed;
    if (control->waited > IQ24(2.0) || (control->waited > IQ24(0.1666667) && apart <= enough)) {
        control->wanted = NULL;
        control->modulator = other;
        control->trajectory = next;
        restart_legs(control, shape.start);
    } else if (apart < nearest) {
        control->nearest_q48 = apart;
    }
}

/* ---- The reference ---- */

/* Range: |miss| <= 16 a component and disturbance_l <= 2: 45, and 1/2. */
static void learn(iqfoc_pattern_control_t *control)
{
    const iqfoc_dq_t seen = iqfoc_park(control->miss, control->sc);
    const iq24_t d = control->v.d + iq24_mul_round(control->disturbance_l, seen.d);
    const iq24_t q = control->v.q + iq24_mul_round(control->disturbance_l, seen.q);
    control->v.d = IQ24_HOLD_POWER(d, 23);
    control->v.q = IQ24_HOLD_POWER(q, 23);
}

/* The mean of the link, and one Newton step of its inverse: r (2 - u r). Range: it moves by at most 1/64, so |1 - u r| < 1/30. */
static void follow_link(iqfoc_pattern_control_t *control)
{
    control->u_mean += iq24_asr32(control->u_dc - control->u_mean + 32, 6);
    const iq24_t rest = IQ24_ONE - iq24_mul_round(control->u_mean, control->u_dc_inverse);
    control->u_dc_inverse += iq24_mul_round(control->u_dc_inverse, rest);
}

/*
 * Range: l i_ref + psi <= 80 and phi <= 0.79: below 64; r i_ref <= 64. cycles_q22 <= 2^29; 1/phi <= 20.4, so
 * that steady <= 2 (20.4 + 16). The voltage's square is at most 32.
 */
void iqfoc_pattern_control_aim(iqfoc_pattern_control_t *control, iqfoc_dq_t i_ref, iq24_t turns)
{
    iqfoc_pattern_trajectory_t *t = &control->trajectory;
    learn(control);
    follow_link(control);
    const iq24_t speed = iq24_clamp(turns < 0 ? -iq24_max(turns, -IQFOC_PATTERN_TURNS_MAX) : turns,
                                    IQFOC_PATTERN_CONTROL_TURNS_MIN, IQFOC_PATTERN_TURNS_MAX);
    t->turns = turns < 0 ? -speed : speed;
    t->cycles_q22 = iq24_div(INT32_C(1) << 22, speed);
    t->speed = speed;
    t->l = iq24_mul_round(control->l, control->u_dc_inverse);

    const iq24_t phi = iq24_mul_shift(t->turns, Q28_2_PI, 28);
    const iq24_t drop_d = iq24_mul_round(control->r, i_ref.d) - control->v.d;
    const iq24_t drop_q = iq24_mul_round(control->r, i_ref.q) - control->v.q;
    const iqfoc_dq_t drop = {IQ24_HOLD_POWER(drop_d, 24), IQ24_HOLD_POWER(drop_q, 24)};
    const iq24_t u_d = drop.d - iq24_mul_round(phi, iq24_mul_round(control->l, i_ref.q));
    const iq24_t u_q = drop.q + iq24_mul_round(phi, iq24_mul_round(control->l, i_ref.d) + control->psi);
    const iqfoc_dq_t u = {IQ24_HOLD_POWER(u_d, 26), IQ24_HOLD_POWER(u_q, 26)};
    const iq24_t length = iq24_sqrt(iq24_acc_round(iq24_acc_mac(iq24_acc_mul(u.d, u.d), u.q, u.q)));
    t->u_angle = iq24_atan2(u.q, u.d);

    const iq24_t per_phi = iq24_mul_shift(t->cycles_q22, turns < 0 ? -Q32_1_2_PI : Q32_1_2_PI, 30);
    const iq24_t steady_d = -iq24_mul_round(drop.q, per_phi) - control->psi;
    t->steady.d = iq24_mul_round(steady_d, control->u_dc_inverse);
    t->steady.q = iq24_mul_round(iq24_mul_round(drop.d, per_phi), control->u_dc_inverse);
    t->u_share = iqfoc_modulated_voltage(control->high, IQ24_ONE);

    /* In the rotor frame at the cycle's end, where the angle at mid-cycle is half the movement behind. */
    const iq24_sincos_t sc_half = iq24_sincos(-iq24_asr32(t->turns, 1));
    const iqfoc_ab_t none = {0, 0};
    const iqfoc_exact_t exact = iqfoc_exact_at_speed_inline(&control->law, t->turns);
    const iqfoc_ab_t drift = iqfoc_exact_step(&exact, none, iqfoc_park_inverse(control->v, sc_half), sc_half);
    t->drift.d = drift.alpha;
    t->drift.q = drift.beta;

    const iq24_t index = iqfoc_pattern_index(length, control->u_dc_inverse);
    const iqfoc_pattern_shape_t shape = iqfoc_pattern_shape_at(&control->modulator, index);
    trace(t, &shape, control->modulator.table->angles);
    if (shape.start != t->start) {
        restart_legs(control, shape.start);
    }
    if (control->wanted != NULL) {
        change_if_near(control, index);
    }
}

/* ---- The edges of a leg ---- */

typedef struct {
    const iqfoc_pattern_trajectory_t *t;
    iq24_t origin; /* the place's angle from the start of the edge's half turn */
    int32_t n;     /* of the edge in its half turn */
} walk_t;

/* An angle ahead, below a turn, as a time: below 128 cycles. Rounded down. */
static inline iq24_t time_of(const iqfoc_pattern_trajectory_t *t, iq24_t distance)
{
    return iq24_shift_wrap(IQ24_MUL64(distance, t->cycles_q22), 22);
}

static inline iq24_t next_time(walk_t *w)
{
    w->n++;
    if (w->n == w->t->edges) {
        w->n = 0;
        w->origin -= PATTERN_HALF_TURN;
    }
    return time_of(w->t, w->t->angle[w->n] - w->origin);
}

/*
 * Moves the edges of a leg that has one in the cycle.
 *
 * ahead: 0; 1 if the edge after the place has been moved ahead of it, so that its level makes flux before its time; -1 if the place's
 * edge is still due.
 *
 * Range: |error| <= 22 + 16. A moved edge reduces it, or is at most a cycle later than due: 53 in all, and 117 with the time. Distances
 * of edges are below a turn, since angle 0 of each half turn has one.
 */
static void move_edges(pattern_leg_t *leg, iqfoc_pattern_control_leg_t *state,
                       const iqfoc_pattern_trajectory_t *t, iq24_t y, int32_t ahead, iq24_t error)
{
    walk_t walk = {t, y, state->place};
    iq24_t before = 0;
    if (ahead > 0) {
        before = iq24_clamp(next_time(&walk), 0, AHEAD_MAX);
        error -= leg->wanted * before;
    } else if (ahead < 0) {
        walk.n--; /* the next one is the place's */
    }
    iq24_t now = next_time(&walk);
    for (int32_t passed = 0; passed < PASSED_MAX; passed++) {
        const int32_t edge = walk.n;
        const iq24_t next = next_time(&walk);
        const iq24_t due = iq24_clamp(now, 0, TIME_MAX);
        /* The edge ends a level that adds to the flux: more flux needs a later edge. */
        const iq24_t moved = iq24_min(due + leg->wanted * error, next);
        const iq24_t at = iq24_max(moved, iq24_max(leg->since, before));
        if (at >= IQ24_ONE) {
            break;
        }
        pattern_leg_follow(leg, at);
        leg->wanted = -leg->wanted;
        leg->since = at;
        error += leg->wanted * (at - due);
        state->edge = edge;
        before = now;
        now = next;
    }
}

static inline void step_leg(iqfoc_pattern_control_t *control, int32_t k, const place_t *place, iq24_t error,
                            iqfoc_pattern_edges_t *out)
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    iqfoc_pattern_control_leg_t *state = &control->leg[k];
    const int32_t n = state->place;
    const int32_t wanted = state->level != 0 ? state->level : place->level;
    int32_t ahead = 0;
    if (wanted != place->level) {
        ahead = state->edge == n + 1 || (state->edge == 0 && n + 1 == t->edges) ? 1 : -1;
    }
    pattern_leg_t leg = pattern_leg_begin(&control->modulator.leg[k], control->modulator.least, wanted, out);
    /* Else the next edge, at most 1/2 turn away, is later wherever the error moves it, and so is its neighbour. */
    if (ahead != 0 || t->angle[n + 2] - place->y < t->speed ||
        time_of(t, t->angle[n + 1] - place->y) + wanted * error < IQ24_ONE) {
        move_edges(&leg, state, t, place->y, ahead, error);
    }
    state->level = leg.wanted;
    pattern_leg_end(&leg, &control->modulator.leg[k]);
}

/* ---- The cycle ---- */

/*
 * The current at the start of the cycle that is to be commanded: i' = E i + k_u u + drift. Range: |i| <= 8 a component, as it lies
 * between two such; |k_u u| <= 16; |drift| <= 16.8 + 16.
 */
static inline iqfoc_ab_t predict(iqfoc_pattern_control_t *control, iqfoc_ab_t i, iq24_t u_dc,
                                 iq24_sincos_t sc)
{
    if (!control->predicted) {
        control->i_next = i;
        control->u_mean = u_dc;
        control->u_dc_inverse = iq24_div(IQ24_ONE, u_dc);
        control->predicted = true;
    }
    control->u_dc = u_dc;
    const iqfoc_ab_t miss = {i.alpha - control->i_next.alpha, i.beta - control->i_next.beta};
    control->miss = miss;
    const iqfoc_ab_t now = {control->i_next.alpha + iq24_mul_trunc(control->correction, miss.alpha),
                            control->i_next.beta + iq24_mul_trunc(control->correction, miss.beta)};
    const iqfoc_ab_t share = control->trajectory.u_share;
    const iqfoc_ab_t u = {iq24_mul_trunc(share.alpha, u_dc), iq24_mul_trunc(share.beta, u_dc)};
    const iqfoc_ab_t drift = iqfoc_park_inverse(control->trajectory.drift, sc);
    const iqfoc_exact_law_t *law = &control->law;
    const iq24_t alpha =
        drift.alpha +
        iq24_shift_wrap(
            IQ24_MAC64(IQ24_MAC64(INT64_C(1) << 25, now.alpha, law->stays_q26), u.alpha, law->k_u_q26), 26);
    const iq24_t beta =
        drift.beta +
        iq24_shift_wrap(
            IQ24_MAC64(IQ24_MAC64(INT64_C(1) << 25, now.beta, law->stays_q26), u.beta, law->k_u_q26), 26);
    const iqfoc_ab_t next = {IQ24_HOLD_POWER(alpha, 27), IQ24_HOLD_POWER(beta, 27)};
    control->i_next = next;
    return next;
}

/*
 * Flux error of an axis from its sum of products: cycles of the link. Range: the integral of three legs within 1/4 is at most 1/3, times
 * 64: 22; steady is within 72.8 sqrt(2), l i within 128: 253 in all, which fits Q23.
 */
static inline iq24_t held_error(iq24_acc_t e_q48)
{
    const int32_t e_q23 = iq24_shift_wrap(e_q48, 25);
    return 2 * IQ24_HOLD_POWER(e_q23, 27);
}

void iqfoc_pattern_control_step(iqfoc_pattern_control_t *control, iqfoc_ab_t i, iq24_t theta, iq24_t u_dc,
                                iqfoc_pattern_edges_t edges[3])
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    const iq24_t end = iq24_add_wrap(theta, t->turns);
    const iq24_sincos_t sc = iq24_sincos(end);
    control->sc = sc;
    const iqfoc_ab_t i_next = predict(control, i, u_dc, sc);

    control->theta = end;
    iq24_t x[3];
    angles_of(t, end, x);
    place_t place[3];
    for (int32_t k = 0; k < 3; k++) {
        place[k] = place_of(t, x[k], &control->leg[k].place);
    }
    const iqfoc_abc_t integrals = {place[0].flux, place[1].flux, place[2].flux};
    const iqfoc_ab_t integral = iqfoc_clarke3(integrals);
    const iq24_t cycles_half = 2 * t->cycles_q22;
    iq24_acc_t alpha = iq24_acc_mul(integral.alpha, cycles_half);
    iq24_acc_t beta = iq24_acc_mul(integral.beta, cycles_half);
    alpha = iq24_acc_mac(alpha, t->steady.d, sc.cos);
    beta = iq24_acc_mac(beta, t->steady.d, sc.sin);
    alpha = iq24_acc_mac(alpha, t->steady.q, -sc.sin);
    beta = iq24_acc_mac(beta, t->steady.q, sc.cos);
    const iqfoc_ab_t e = {held_error(iq24_acc_mac(alpha, -t->l, i_next.alpha)),
                          held_error(iq24_acc_mac(beta, -t->l, i_next.beta))};
    control->error = e;
    const iqfoc_abc_t legs = iqfoc_clarke_inverse(e);
    const iq24_t error[3] = {legs.a, legs.b, legs.c};
    for (int32_t k = 0; k < 3; k++) {
        step_leg(control, k, &place[k], error[k], &edges[k]);
    }
    const iqfoc_abc_t high = {edges[0].high, edges[1].high, edges[2].high};
    control->high = high;
}
