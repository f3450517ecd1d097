/* Control of a pulse pattern by its flux trajectory (include/iqfoc/pattern_control.h). */
#include "iqfoc/pattern_control.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include "pattern_leg.h"

#include <stddef.h>

/* Moved edges of a leg in a cycle: with one that the least time has delayed, within IQFOC_PATTERN_EDGES_MAX. */
#define PASSED_MAX (IQFOC_PATTERN_EDGES_MAX - 1)

#define Q28_2_PI   INT32_C(1686629713)
#define Q32_1_2_PI INT32_C(683565276)
#define Q31_PI_6   INT32_C(1124419809)
#define Q30_PI2_6  INT32_C(1766234505)

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

void iqfoc_pattern_control_change(iqfoc_pattern_control_t *control, const iqfoc_pattern_t *table)
{
    control->wanted = table;
    control->waited = 0;
    control->nearest_q48 = INT64_C(1) << 62; /* more than any, and 1.5 times that fits */
}

/* ---- The trajectory ---- */

/*
 * The level is even about 1/4 turn, so that its integral from there is odd, as is the level's sign. `back`: the integral from 1/4 turn
 * times the level at an angle, which changes its sign at each edge. Range: |back| <= 1/4 turn.
 */
static void trace(iqfoc_pattern_trajectory_t *t, const pattern_rows_t *rows, int32_t angles)
{
    const int32_t edges = 2 * angles + 1;
    iq24_t back = 0;
    iq24_t above = PATTERN_QUARTER_TURN;
    for (int32_t k = angles; k > 0; k--) {
        const iq24_t angle = pattern_angle(rows, k - 1);
        const iq24_t mirrored = PATTERN_HALF_TURN - angle;
        back -= above - angle;
        t->angle[k] = angle;
        t->ahead[k] = back - angle;
        t->angle[edges - k] = mirrored;
        t->ahead[edges - k] = back - mirrored;
        back = -back;
        above = angle;
    }
    t->angle[0] = 0;
    t->ahead[0] = back - above;
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
    /* These end at angle[0] = 0 and angle[edges] = 1/2. */
    const iq24_t *angle = &t->angle[*n];
    while (*angle > y) {
        angle--;
    }
    while (angle[1] <= y) {
        angle++;
    }
    const int32_t k = (int32_t)(angle - t->angle);
    *n = k;
    /* The second half turn and each edge change the sign. */
    const uint32_t changes = (uint32_t)k + ((uint32_t)x >> 23);
    const int32_t level = (changes & 1U) != 0 ? -t->start : t->start;
    const place_t place = {y, level, level * (y + t->ahead[k])};
    return place;
}

/* The angle of leg a at a rotor angle, but for whole turns: -1 ... 2. Those of the others are third_turn further each. */
static inline iq24_t angle_of(const iqfoc_pattern_trajectory_t *t, iq24_t theta)
{
    return t->sense * (theta & (IQ24_ONE - 1)) + t->u_place;
}

/* ---- The rows at a place of the table ---- */

/*
 * Beyond a row without a joined one there, its angles go on as from the one before: otherwise the fundamental would remain that of the row.
 * At most one row further, and only if the angles stay in order up to there.
 */
static pattern_rows_t rows_beyond(const iqfoc_pattern_t *table, int32_t n, iq24_t place)
{
    const iq24_t part = iq24_clamp(place - n * IQ24_ONE, -IQ24_ONE, IQ24_ONE);
    const int32_t before = part > 0 ? n - 1 : n + 1;
    const iqfoc_pattern_row_t *row = &table->row[n];
    pattern_rows_t rows = {row, row, 0};
    if (before < 0 || before >= table->rows || table->row[part > 0 ? before : n].joined == 0) {
        return rows;
    }
    const iqfoc_pattern_row_t *next = &table->row[before];
    iq24_t lowest = 0;
    for (int32_t k = 0; k < table->angles; k++) {
        const iq24_t end = 2 * row->angle[k] - next->angle[k];
        if (!iq24_within(end, lowest, PATTERN_QUARTER_TURN)) {
            return rows;
        }
        lowest = end;
    }
    rows.next = next;
    rows.part = part > 0 ? -part : part;
    return rows;
}

/* ---- Change of the table ---- */

/* Square of the distance between the flux of two tables at the start of the next cycle, in turns. Range: 2 (2/3)^2. */
static iq24_acc_t distance_q48(const iqfoc_pattern_control_t *control,
                               const iqfoc_pattern_trajectory_t *other)
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    iq24_t apart[3];
    const iq24_t a = angle_of(t, iq24_add_wrap(control->theta, t->turns));
    for (int32_t k = 0; k < 3; k++) {
        const iq24_t x = a + k * t->third_turn;
        int32_t n = control->leg[k].place;
        int32_t m = 0;
        apart[k] = place_of(other, x, &m).flux - place_of(t, x, &n).flux;
    }
    const iqfoc_abc_t legs = {apart[0], apart[1], apart[2]};
    const iqfoc_ab_t flux = iqfoc_clarke3(legs);
    return iq24_acc_mac(iq24_acc_mul(flux.alpha, flux.alpha), flux.beta, flux.beta);
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
    const iq24_t place = pattern_place(other.table, index);
    pattern_rows_t rows = pattern_rows_at(&other, place);
    if (rows.next == rows.row) {
        rows = rows_beyond(other.table, other.row, place);
    }
    iqfoc_pattern_trajectory_t next = control->trajectory;
    trace(&next, &rows, other.table->angles);
    next.start = rows.row->start;
    const iq24_acc_t apart = distance_q48(control, &next);
    const iq24_acc_t nearest = control->nearest_q48;
    const iq24_acc_t enough = iq24_asr64(nearest, 1) - iq24_asr64(nearest, 4) + nearest; /* 1.2^2 */
    control->waited += next.speed;
    if (control->waited > IQ24(2.0) || (control->waited > IQ24(0.1666667) && apart <= enough)) {
        control->wanted = NULL;
        control->modulator = other;
        control->trajectory = next;
        restart_legs(control, next.start);
    } else if (apart < nearest) {
        control->nearest_q48 = apart;
    }
}

/* ---- The reference ---- */

/* Range: the innovation is held to 16 a component, so that |seen| <= 16 sqrt(2). With disturbance_l <= 2 and v <= 1/2: below 46. */
static void learn(iqfoc_pattern_control_t *control)
{
    const iqfoc_ab_t miss = control->miss;
    const iq24_t alpha = miss.alpha - control->carried.alpha;
    const iq24_t beta = miss.beta - control->carried.beta;
    const iqfoc_ab_t innovation = {IQ24_HOLD_BITS(alpha, 29), IQ24_HOLD_BITS(beta, 29)};
    const iqfoc_dq_t seen = iqfoc_park(innovation, control->sc_sample);
    const iq24_t d = control->v.d + iq24_mul_round(control->disturbance_l, seen.d);
    const iq24_t q = control->v.q + iq24_mul_round(control->disturbance_l, seen.q);
    control->v.d = IQ24_HOLD_BITS(d, 24);
    control->v.q = IQ24_HOLD_BITS(q, 24);
    control->carried.alpha = iq24_mul_trunc(control->keeps, miss.alpha);
    control->carried.beta = iq24_mul_trunc(control->keeps, miss.beta);
    control->sc_sample = control->sc;
}

/* The mean of the link, and one Newton step of its inverse: r (2 - u r). Range: it moves by at most 1/64, so |1 - u r| < 1/30. */
static void follow_link(iqfoc_pattern_control_t *control)
{
    control->u_mean += iq24_asr32(control->u_dc - control->u_mean + 32, 6);
    const iq24_t rest = IQ24_ONE - iq24_mul_round(control->u_mean, control->u_dc_inverse);
    control->u_dc_inverse += iq24_mul_round(control->u_dc_inverse, rest);
    /*@ assert pattern_link: 8388608 <= control->u_mean <= 25165824; */
    /*@ assert pattern_link: 10811692 <= control->u_dc_inverse <= 34673033; */
}

/*
 * The rows at an index, but those before a jump of the angles until the legs may take the others: a jump is a change to the same table.
 */
static pattern_rows_t rows_kept(iqfoc_pattern_control_t *control, iq24_t index)
{
    iqfoc_pattern_modulator_t *modulator = &control->modulator;
    const iqfoc_pattern_t *table = modulator->table;
    const int32_t before = modulator->row;
    const iq24_t place = pattern_place(table, index);
    pattern_rows_t rows = pattern_rows_at(modulator, place);
    if (rows.next != rows.row && modulator->row == before && control->wanted != table) {
        return rows;
    }
    int32_t n = control->trajectory.start != 0 ? before : modulator->row;
    while (n < modulator->row && table->row[n].joined != 0) {
        n++;
    }
    while (n > modulator->row && table->row[n - 1].joined != 0) {
        n--;
    }
    if (n != modulator->row) {
        modulator->row = n;
        rows.next = rows.row;
        if (control->wanted == NULL) {
            iqfoc_pattern_control_change(control, table);
        }
    } else if (control->wanted == table) {
        control->wanted = NULL;
    }
    return rows.next == rows.row ? rows_beyond(table, n, place) : rows;
}

/*
 * The share of the voltage by which the link is off, times the mean angle between two edges of a leg: turns. The link is extrapolated to the
 * start of the cycle, two after the sample. Range: the link is off by at most 1/8, its inverse at most 2.07: below 0.26 (1/6).
 */
static iq24_t link_ahead(const iqfoc_pattern_control_t *control)
{
    const iq24_t apart = control->u_dc + 2 * control->u_slope - control->u_mean;
    const int32_t off_q25 = iq24_mul_high_round(IQ24_HOLD_BITS(apart, 22) * 512, control->u_dc_inverse);
    return iq24_mul_high_round(off_q25, PATTERN_HALF_TURN * 128 / (2 * control->modulator.table->angles + 1));
}

/* Six-step has one length of the voltage. Its d component remains, and with it i_q; i_d is what the length makes. */
static iq24_t angle_of_six_step(const iqfoc_pattern_control_t *control, iqfoc_dq_t u)
{
    const iq24_t length = iq24_mul_round(control->u_mean, IQ24(0.63661977236758134308));
    const iq24_acc_t rest = iq24_acc_mac(iq24_acc_mul(length, length), -u.d, u.d);
    const iq24_t q = iq24_sqrt(iq24_acc_round(rest > 0 ? rest : 0));
    return iq24_atan2(u.q < 0 ? -q : q, u.d);
}

/*
 * Range: l i_ref + psi <= 80 and phi <= 0.79: below 64; r i_ref <= 64. cycles_q22 <= 2^29; 1/phi <= 20.4, so
 * that steady <= 2.07 (0.16 + 2 + 0.17). The voltage's square is at most 32.
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
    /*@ assert pattern_cycles: 33554432 <= t->cycles_q22 <= 536870912; */
    t->speed = speed;
    t->l_q28 = iq24_mul_trunc(iq24_mul_shift(control->l, speed, 20), control->u_dc_inverse);

    const iq24_t phi = iq24_mul_high_round(t->turns * 16, Q28_2_PI);
    const iq24_t drop_d = iq24_mul_trunc(control->r, i_ref.d) - control->v.d;
    const iq24_t drop_q = iq24_mul_trunc(control->r, i_ref.q) - control->v.q;
    const iqfoc_dq_t drop = {IQ24_HOLD_BITS(drop_d, 25), IQ24_HOLD_BITS(drop_q, 25)};
    const iq24_t u_d = drop.d - iq24_mul_round(phi, iq24_mul_trunc(control->l, i_ref.q));
    const iq24_t u_q = drop.q + iq24_mul_round(phi, iq24_mul_trunc(control->l, i_ref.d) + control->psi);
    const iqfoc_dq_t u = {IQ24_HOLD_BITS(u_d, 27), IQ24_HOLD_BITS(u_q, 27)};
    const iq24_t length = iq24_sqrt(iq24_acc_round(iq24_acc_mac(iq24_acc_mul(u.d, u.d), u.q, u.q)));
    iq24_t u_angle;
    iq24_t ahead = 0;
    if (control->modulator.table->angles > 0) {
        u_angle = iq24_atan2(u.q, u.d);
        ahead = 256 * link_ahead(control);
    } else {
        u_angle = angle_of_six_step(control, u);
    }
    /* Backward, x becomes 1/2 - x: the level is the same, and time goes forward. */
    t->sense = turns < 0 ? -1 : 1;
    t->u_place = PATTERN_QUARTER_TURN + t->sense * u_angle;
    t->third_turn = -t->sense * PATTERN_THIRD_TURN;

    /* j drop/omega, the movement times psi, and the flux that the link's deviation makes until the next edges. */
    const int32_t radian_q32 = turns < 0 ? -Q32_1_2_PI : Q32_1_2_PI;
    const iq24_t steady_d = -iq24_mul_high_round(drop.q, radian_q32) -
                            iq24_mul_high_round(control->psi, speed * 256) - iq24_mul_high_round(ahead, u.d);
    const iq24_t steady_q = iq24_mul_high_round(drop.d, radian_q32) - iq24_mul_high_round(ahead, u.q);
    t->steady_q28.d = iq24_shift_wrap(IQ24_MUL64(steady_d, control->u_dc_inverse), 20);
    t->steady_q28.q = iq24_shift_wrap(IQ24_MUL64(steady_q, control->u_dc_inverse), 20);
    /* A pattern's voltage turns with the rotor, and e^-rho weights the cycle's end more than its start: 1 + j rho phi/12. */
    const iqfoc_ab_t share = iqfoc_clarke3(control->high);
    const iqfoc_ab_t per_link = {iq24_mul_trunc(share.alpha, control->law.k_u_q26),
                                 iq24_mul_trunc(share.beta, control->law.k_u_q26)};
    const int32_t later_q32 = iq24_mul_high_round(control->later_q31, t->turns * 512);
    t->per_link_q26.alpha = per_link.alpha - iq24_mul_high_round(per_link.beta, later_q32);
    t->per_link_q26.beta = per_link.beta + iq24_mul_high_round(per_link.alpha, later_q32);

    /*
     * In the rotor frame at the cycle's end, where the angle at mid-cycle is half the movement behind. The mean of v over the cycle is
     * 1 - phi^2/24 of it.
     */
    const iq24_sincos_t sc_half = iq24_sincos_inline(-iq24_asr32(t->turns, 1));
    const iqfoc_exact_t exact = iqfoc_exact_at_speed_inline(&control->law, t->turns);
    const int32_t less_q30 =
        iq24_mul_high_round(iq24_mul_high_round(t->turns * 256, t->turns * 256), Q30_PI2_6);
    const int32_t k_u_q26 = exact.k_u_q26 - 4 * iq24_mul_high_round(less_q30, exact.k_u_q26);
    const int32_t d_q26 = iq24_mul_trunc(k_u_q26, control->v.d) + exact.w_imag_q26;
    const int32_t q_q26 = iq24_mul_trunc(k_u_q26, control->v.q) - exact.w_real_q26;
    const int64_t half = INT64_C(1) << 25;
    const iqfoc_ab_t drift = {
        iq24_shift_wrap(IQ24_MAC64(IQ24_MAC64(half, d_q26, sc_half.cos), q_q26, -sc_half.sin), 26),
        iq24_shift_wrap(IQ24_MAC64(IQ24_MAC64(half, d_q26, sc_half.sin), q_q26, sc_half.cos), 26)};
    t->drift_q26.d = 4 * IQ24_HOLD_BITS(drift.alpha, 30);
    t->drift_q26.q = 4 * IQ24_HOLD_BITS(drift.beta, 30);

    const iq24_t index = iqfoc_pattern_index(length, control->u_dc_inverse);
    const pattern_rows_t rows = rows_kept(control, index);
    trace(t, &rows, control->modulator.table->angles);
    if (rows.row->start != t->start) {
        restart_legs(control, rows.row->start);
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
        if (pushed < t->speed || due < t->speed) { /* else its neighbour is later still */
            next = next_angle(&walk);
            at = iq24_max(iq24_min(pushed, next), earliest);
        }
        if (at >= t->speed) {
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

IQFOC_STEP void step_leg(iqfoc_pattern_control_t *control, int32_t k, const place_t *place, iq24_t error,
                         iqfoc_pattern_edges_t *out)
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    iqfoc_pattern_control_leg_t *state = &control->leg[k];
    iqfoc_pattern_leg_t *output = &control->modulator.leg[k];
    const int32_t n = state->place;
    const int32_t wanted = state->level != 0 ? state->level : place->level;
    const iq24_t later = wanted * error;
    /* The next edge, at most 1/2 turn away, is later wherever the error moves it, and so is its neighbour. */
    const bool stays = wanted == place->level && output->level == wanted &&
                       t->angle[n + 2] - place->y >= t->speed &&
                       t->angle[n + 1] - place->y + later >= t->speed;
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

/* The edges of the cycle that begins at the rotor angle control->theta with the current control->i_next. */
static void command(iqfoc_pattern_control_t *control, iqfoc_pattern_edges_t edges[3])
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    const iq24_sincos_t sc = control->sc;
    const iqfoc_ab_t i_next = control->i_next;
    const iq24_t a = angle_of(t, control->theta);
    place_t place[3];
    for (int32_t k = 0; k < 3; k++) {
        place[k] = place_of(t, a + k * t->third_turn, &control->leg[k].place);
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
    const iqfoc_abc_t legs = iqfoc_clarke_inverse(e);
    const iq24_t error[3] = {legs.a, legs.b, legs.c};
    for (int32_t k = 0; k < 3; k++) {
        step_leg(control, k, &place[k], error[k], &edges[k]);
    }
    const iqfoc_abc_t high = {edges[0].high, edges[1].high, edges[2].high};
    control->high = high;
}

void iqfoc_pattern_control_step(iqfoc_pattern_control_t *control, iqfoc_ab_t i, iq24_t theta, iq24_t u_dc,
                                iqfoc_pattern_edges_t edges[3])
{
    control->theta = iq24_add_wrap(theta, control->trajectory.turns);
    control->sc = iq24_sincos_inline(control->theta);
    predict(control, i, u_dc, control->sc);
    command(control, edges);
}

void iqfoc_pattern_control_begin(iqfoc_pattern_control_t *control, iqfoc_ab_t i_next, iq24_t theta_next,
                                 const iqfoc_pattern_leg_t leg[3], iqfoc_pattern_edges_t edges[3])
{
    for (int32_t k = 0; k < 3; k++) {
        control->modulator.leg[k] = leg[k];
    }
    restart_legs(control, control->trajectory.start);
    control->theta = theta_next;
    control->sc = iq24_sincos(theta_next);
    control->i_next = i_next;
    control->predicted = true;
    command(control, edges);
}
