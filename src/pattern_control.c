/*
 * Control of a pulse pattern by its flux trajectory (include/iqfoc/pattern_control.h): set-up, and the moved edges of each cycle.
 */
#include "iqfoc/pattern_control.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include "pattern_place.h"

#include <stddef.h>

/* Moved edges of a leg in a cycle: with one that the least time has delayed, within IQFOC_PATTERN_EDGES_MAX. */
#define PASSED_MAX (IQFOC_PATTERN_EDGES_MAX - 1)

#define Q31_PI_6 INT32_C(1124419809)

/* 1/6 and 1/sqrt(12). */
#define Q28_1_6       INT32_C(44739243)
#define Q28_1_SQRT_12 INT32_C(77490641)

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
    /*@ assert pattern_l: 1048576 <= made.l <= 134217728; */
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
    made.keeps = iq24_mul_shift(IQ24_ONE - config->correction, made.law.stays_q26, 26);
    made.later_q31 = iq24_mul_shift(winding->rho_q30, Q31_PI_6, 30);
    made.disturbance_l = iq24_mul_round(config->disturbance, made.l);
    made.trajectory.angle[table->angles] = PATTERN_QUARTER_TURN; /* until a row is known: no long levels */
    made.u_dc = IQ24_ONE;
    made.u_dc_inverse = IQ24_ONE;
    *control = made;
    return IQFOC_OK;
}

/* The link is u_dc at once. */
static void take_link(iqfoc_pattern_control_t *control, iq24_t u_dc)
{
    control->u_dc = u_dc;
    control->u_slope = 0;
    control->u_mean = u_dc;
    control->u_dc_inverse = iq24_div(IQ24_ONE, u_dc);
    /*@ assert pattern_link: 10811692 <= control->u_dc_inverse <= 34673033; */
}

void iqfoc_pattern_control_restart(iqfoc_pattern_control_t *control, const iqfoc_pattern_t *table,
                                   iq24_t u_dc)
{
    const iqfoc_ab_t none = {0, 0};
    control->modulator.table = table;
    control->wanted = NULL;
    control->miss = none;
    control->carried = none;
    take_link(control, u_dc);
    control->trajectory.start = 0;
}

/* ---- The edges of a leg ---- */

typedef struct {
    const iqfoc_pattern_trajectory_t *t;
    iq24_t origin; /* the place's angle from the start of the edge's half turn */
    int32_t n;     /* of the edge in its half turn */
} walk_t;

/* The next edge: its angle from the place. */
static inline iq24_t next_angle(walk_t *w)
{
    w->n++;
    if (w->n == w->t->edges) {
        w->n = 0;
        w->origin -= PATTERN_HALF_TURN;
    }
    return w->t->angle[w->n] - w->origin;
}

/*
 * Moves the edges of a leg that may have one in the cycle. All angles are from the place.
 *
 * later: the movement of the next edge that makes the leg's error good. The edge ends a level that adds to the flux: more flux needs a later one.
 *
 * ahead: 0; 1 if the edge after the place has been moved ahead of it, so that its level makes flux before its time; -1 if the place's
 * edge is still due.
 *
 * Range: |later| <= 5.5, and an edge ahead is below a turn. A moved edge reduces it, or is at most an eighth of a turn later than due: below
 * 9 in all, and 10 with an edge's angle. An angle in the cycle is at most the movement less 1 LSB, and cycles_q22 is off by
 * half its unit, so that its time is below 1.
 */
static void move_edges(pattern_leg_t *leg, iqfoc_pattern_control_leg_t *state,
                       const iqfoc_pattern_trajectory_t *t, iq24_t y, int32_t ahead, iq24_t later)
{
    walk_t walk = {t, y, state->place};
    iq24_t earliest = 0;
    if (ahead > 0) {
        earliest = next_angle(&walk);
        later -= earliest;
    }
    iq24_t due = 0; /* of the place's edge, if that is the next one */
    if (ahead >= 0) {
        due = next_angle(&walk);
    }
    for (int32_t passed = 0; passed < PASSED_MAX; passed++) {
        /*@ assert pattern_later: -150994944 <= later <= 150994944; */
        const int32_t edge = walk.n;
        const iq24_t pushed = due + later;
        iq24_t at = pushed;
        iq24_t next = due;
        if (pushed < t->speed_abs || due < t->speed_abs) { /* else its neighbour is later still */
            next = next_angle(&walk);
            at = iq24_max(iq24_min(pushed, next), earliest);
        }
        if (at >= t->speed_abs) {
            break;
        }
        const iq24_t time = iq24_shift_wrap(IQ24_MUL64(at, t->cycles_q22), 22);
        /*@ assert pattern_moved_time: 0 <= time <= 16777215; */
        pattern_leg_follow(leg, time);
        leg->wanted = -leg->wanted;
        leg->since = time;
        later = at - due - later; /* less what the edge has made good, and the next one has the other sense */
        state->edge = edge;
        earliest = iq24_max(at, due);
        due = next;
    }
}

IQFOC_STEP void move_leg(iqfoc_pattern_control_t *control, int32_t k, const pattern_place_t *place,
                         iq24_t error, iqfoc_pattern_edges_t *out)
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    iqfoc_pattern_control_leg_t *state = &control->leg[k];
    iqfoc_pattern_leg_t *output = &control->modulator.leg[k];
    const int32_t n = state->place;
    const int32_t wanted = state->level != 0 ? state->level : place->level;
    const iq24_t later = wanted * error;
    /* The next edge, at most 1/2 turn away, is later wherever the error moves it, and so is its neighbour. */
    const bool stays = wanted == place->level && output->level == wanted &&
                       t->angle[n + 2] - place->y >= t->speed_abs &&
                       t->angle[n + 1] - place->y + later >= t->speed_abs;
    if (stays) {
        state->level = wanted;
        pattern_leg_stay(output, out);
    } else {
        pattern_leg_t leg = pattern_leg_begin(output, control->modulator.least, wanted, out);
        if (wanted == place->level) {
            move_edges(&leg, state, t, place->y, 0, later);
        } else {
            /* In six-step, the edges before and after have one number: the nearer one has moved past the place. */
            const bool moved = t->edges > 1 ? state->edge == n + 1 || (state->edge == 0 && n + 1 == t->edges)
                                            : place->y >= PATTERN_QUARTER_TURN;
            move_edges(&leg, state, t, place->y, moved ? 1 : -1, later);
        }
        state->level = leg.wanted;
        pattern_leg_end(&leg, output);
    }
}

/* ---- The cycle ---- */

/*
 * The current at the start of the cycle that is to be commanded: i' = E i + k_u u + drift. Range: |i| <= 8 a component, as it lies
 * between two such; |k_u u| <= 16; |drift| <= 32 a component, 45.3 turned: 70 in all, which fits Q50 and Q24.
 */
static inline void predict(iqfoc_pattern_control_t *control, iqfoc_ab_t i, iq24_t u_dc, iq24_sincos_t sc)
{
    if (!control->predicted) {
        control->i_next = i;
        take_link(control, u_dc);
        control->predicted = true;
    }
    control->u_slope = u_dc - control->u_dc;
    control->u_dc = u_dc;
    const iqfoc_ab_t miss = {i.alpha - control->i_next.alpha, i.beta - control->i_next.beta};
    control->miss = miss;
    const iqfoc_ab_t now = {control->i_next.alpha + iq24_mul_trunc(control->correction, miss.alpha),
                            control->i_next.beta + iq24_mul_trunc(control->correction, miss.beta)};
    const iqfoc_ab_t by_link = control->trajectory.per_link_q26;
    const iqfoc_dq_t drift = control->trajectory.drift_q26;
    const int32_t stays = control->law.stays_q26;
    int64_t alpha = IQ24_MAC64(INT64_C(1) << 25, now.alpha, stays);
    int64_t beta = IQ24_MAC64(INT64_C(1) << 25, now.beta, stays);
    alpha = IQ24_MAC64(IQ24_MAC64(IQ24_MAC64(alpha, by_link.alpha, u_dc), drift.d, sc.cos), drift.q, -sc.sin);
    beta = IQ24_MAC64(IQ24_MAC64(IQ24_MAC64(beta, by_link.beta, u_dc), drift.d, sc.sin), drift.q, sc.cos);
    const iqfoc_ab_t next = {IQ24_HOLD_BITS(iq24_shift_wrap(alpha, 26), 28),
                             IQ24_HOLD_BITS(iq24_shift_wrap(beta, 26), 28)};
    control->i_next = next;
}

/*
 * With long levels, one leg at a time has edges. The same error on all legs makes no flux: half of what this leg has in addition makes the
 * sum of the other two zero, so that its edges correct all of the error on its axis and not 2/3 of it. Range: held to 4 a component.
 */
IQFOC_STEP void move_legs(iqfoc_pattern_control_t *control, const pattern_place_t place[3],
                          iqfoc_pattern_edges_t edges[3])
{
    iqfoc_ab_t e = control->error;
    if (control->trajectory.long_levels) {
        e.alpha = IQ24_HOLD_BITS(e.alpha + iq24_asr32(e.alpha, 1), 27);
        e.beta = IQ24_HOLD_BITS(e.beta + iq24_asr32(e.beta, 1), 27);
    }
    const iqfoc_abc_t legs = iqfoc_clarke_inverse(e);
    const iq24_t error[3] = {legs.a, legs.b, legs.c};
    for (int32_t k = 0; k < 3; k++) {
        move_leg(control, k, &place[k], error[k], &edges[k]);
    }
    const iqfoc_abc_t high = {edges[0].high, edges[1].high, edges[2].high};
    control->high = high;
}

void pattern_move_legs(iqfoc_pattern_control_t *control, const pattern_place_t place[3],
                       iqfoc_pattern_edges_t edges[3])
{
    move_legs(control, place, edges);
}

/* Range: a leg's flux changes by at most the movement, 1/8, and so does what its pulses make: below 1/3 in all, and |e| <= 2 sqrt(2). */
iq24_acc_t pattern_cost_q48(const iqfoc_pattern_control_t *control, const iqfoc_pattern_edges_t edges[3])
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    const iq24_t a = pattern_angle_at(t, control->theta);
    const iqfoc_ab_t e = control->error;
    iq24_t made[3];
    for (int32_t k = 0; k < 3; k++) {
        int32_t n = control->leg[k].place;
        const iq24_t x = a + k * t->third_turn;
        const iq24_t start = pattern_place_of(t, x, &n).flux;
        const iq24_t end = pattern_place_of(t, x + t->speed_abs, &n).flux;
        made[k] = (end - start) / 2 - iq24_mul_round(edges[k].high - IQ24_ONE / 2, t->speed_abs);
    }
    const iqfoc_abc_t legs = {made[0], made[1], made[2]};
    const iqfoc_ab_t more = iqfoc_clarke3(legs);
    return pattern_square_q48(e.alpha + more.alpha, e.beta + more.beta) +
           iq24_asr64(pattern_square_q48(e.alpha, e.beta), 4);
}

/* Places and flux error of the cycle that begins at the rotor angle control->theta with the current control->i_next. */
IQFOC_STEP void find_error(iqfoc_pattern_control_t *control, pattern_place_t place[3])
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    const iq24_sincos_t sc = control->sc;
    const iqfoc_ab_t i_next = control->i_next;
    const iq24_t a = pattern_angle_at(t, control->theta);
    for (int32_t k = 0; k < 3; k++) {
        place[k] = pattern_place_of(t, a + k * t->third_turn, &control->leg[k].place);
    }
    /* Clarke's transform by half of the link. Range: the sums are within 1, steady within 4.9 sqrt(2), l i within 16: held to 4. */
    int64_t alpha = IQ24_MUL64(2 * place[0].flux - place[1].flux - place[2].flux, Q28_1_6);
    int64_t beta = IQ24_MUL64(place[1].flux - place[2].flux, Q28_1_SQRT_12);
    alpha = IQ24_MAC64(IQ24_MAC64(alpha, t->steady_q28.d, sc.cos), t->steady_q28.q, -sc.sin);
    beta = IQ24_MAC64(IQ24_MAC64(beta, t->steady_q28.d, sc.sin), t->steady_q28.q, sc.cos);
    alpha = IQ24_MAC64(alpha, -t->l_q28, i_next.alpha);
    beta = IQ24_MAC64(beta, -t->l_q28, i_next.beta);
    const iqfoc_ab_t e = {IQ24_HOLD_BITS(iq24_shift_wrap(alpha, 28), 27),
                          IQ24_HOLD_BITS(iq24_shift_wrap(beta, 28), 27)};
    control->error = e;
}

void iqfoc_pattern_control_step(iqfoc_pattern_control_t *control, iqfoc_ab_t i, iq24_t theta, iq24_t u_dc,
                                iqfoc_pattern_edges_t edges[3])
{
    control->theta = iq24_add_wrap(theta, control->trajectory.speed);
    control->sc = iq24_sincos_inline(control->theta);
    predict(control, i, u_dc, control->sc);
    pattern_place_t place[3];
    find_error(control, place);
    move_legs(control, place, edges);
}

void iqfoc_pattern_control_begin(iqfoc_pattern_control_t *control, iqfoc_ab_t i_next, iq24_t theta_next,
                                 const iqfoc_pattern_leg_t leg[3], iqfoc_pattern_edges_t edges[3])
{
    for (int32_t k = 0; k < 3; k++) {
        control->modulator.leg[k] = leg[k];
    }
    pattern_restart_legs(control, control->trajectory.start);
    control->theta = theta_next;
    control->sc = iq24_sincos(theta_next);
    control->i_next = i_next;
    control->predicted = true;
    pattern_place_t place[3];
    find_error(control, place);
    pattern_move_legs(control, place, edges);
}
