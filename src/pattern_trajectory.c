/* The flux trajectory of a pulse pattern for the reference, at each peak, and the change of its table (include/iqfoc/pattern_control.h). */
#include "iqfoc/pattern_control.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/transform.h"

#include "pattern_place.h"

#include <stddef.h>

#define Q28_2_PI   INT32_C(1686629713)
#define Q32_1_2_PI INT32_C(683565276)
#define Q30_PI2_6  INT32_C(1766234505)
#define Q32_1_PI2  INT32_C(435171098)

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
        /*@ assert pattern_order: 0 <= angle <= 4194304; */
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

/* ---- The rows at a place of the table ---- */

/* How far a place is beyond row n. */
static inline iq24_t place_beyond(iq24_t place, int32_t n)
{
    return place - n * IQ24_ONE;
}

/*
 * Beyond a row without a joined one there, its angles go on as from the one before: otherwise the fundamental would remain that of the row.
 * At most two rows further, and only if the angles stay in order up to there.
 */
static pattern_rows_t rows_beyond(const iqfoc_pattern_t *table, int32_t n, iq24_t place)
{
    const iq24_t part = iq24_clamp(place_beyond(place, n), -2 * IQ24_ONE, 2 * IQ24_ONE);
    const int32_t before = part > 0 ? n - 1 : n + 1;
    const iqfoc_pattern_row_t *row = &table->row[n];
    pattern_rows_t rows = {row, row, 0};
    if (before < 0 || before >= table->rows || table->row[part > 0 ? before : n].joined == 0) {
        return rows;
    }
    const iqfoc_pattern_row_t *next = &table->row[before];
    iq24_t lowest = 0;
    for (int32_t k = 0; k < table->angles; k++) {
        const iq24_t end = 3 * row->angle[k] - 2 * next->angle[k];
        if (!iq24_within(end, lowest, PATTERN_QUARTER_TURN)) {
            return rows;
        }
        lowest = end;
    }
    rows.next = next;
    rows.part = part > 0 ? -part : part;
    return rows;
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
    const iq24_t rest = IQ24_ONE - iq24_mul_trunc(control->u_mean, control->u_dc_inverse);
    control->u_dc_inverse += iq24_mul_trunc(control->u_dc_inverse, rest);
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
            control->nearest_q48 = PATTERN_NEAR_Q48;
            control->waited = IQ24_ONE;
        }
        /* To two rows beyond, the angles go on, so that there is time for a small distance; farther on there is not. */
        if (!iq24_within(place_beyond(place, n), -2 * IQ24_ONE, 2 * IQ24_ONE)) {
            control->nearest_q48 = pattern_risen(control->nearest_q48, 0);
        }
    } else if (control->wanted == table) {
        control->wanted = NULL;
    }
    return rows.next == rows.row ? rows_beyond(table, n, place) : rows;
}

/* Six-step has one length of the voltage. Its d component remains, and with it i_q; i_d is what the length makes. */
static iq24_t q_of_six_step(const iqfoc_pattern_control_t *control, iqfoc_dq_t u)
{
    const iq24_t length = iq24_mul_round(control->u_mean, IQ24(0.63661977236758134308));
    const iq24_acc_t rest = iq24_acc_mac(iq24_acc_mul(length, length), -u.d, u.d);
    const iq24_t q = iq24_sqrt(iq24_acc_round(rest > 0 ? rest : 0));
    return u.q < 0 ? -q : q;
}

/* The link less its mean: extrapolated over two cycles, to the start of the cycle, and `later`. Held to 1/8. */
static iq24_t link_ahead(const iqfoc_pattern_control_t *control, iq24_t later)
{
    return IQ24_HOLD_BITS(control->u_dc + 2 * control->u_slope - control->u_mean + later, 22);
}

/*
 * The flux along the d axis that keeps the torque, before 1/u_dc. The link is extrapolated to the middle of the next sixth of a turn, about
 * five cycles after the sample, and further by tan(delta)/omega. Range: |u_d| is held to 1, so that it is at most 37 cycles.
 */
static iq24_t flux_of_long_levels(const iqfoc_pattern_control_t *control, const iqfoc_pattern_trajectory_t *t,
                                  iq24_t u_d)
{
    const iq24_t cycles = IQ24(3.0) - iq24_mul_trunc(IQ24_HOLD_BITS(u_d, 25), t->cycles_q22);
    return iq24_mul_high_round(link_ahead(control, iq24_mul_trunc(cycles, control->u_slope)), Q32_1_PI2);
}

/*
 * Angle and additional flux of a trajectory. drop: R i_ref + v. If no edge of a leg is farther than 1/8 turn from the zero crossings, its
 * levels are long. Range: the inverse of the link is at most 2.07, so that the flux is below 0.26 (1/6) u.
 */
IQFOC_STEP void place_trajectory(const iqfoc_pattern_control_t *control, iqfoc_pattern_trajectory_t *t,
                                 int32_t angles, iqfoc_dq_t u, iqfoc_dq_t drop)
{
    /* j drop/omega, the movement times psi, and the flux by the link's deviation. */
    const int32_t radian_q32 = t->sense < 0 ? -Q32_1_2_PI : Q32_1_2_PI;
    iq24_t u_q = u.q;
    iq24_t steady_d =
        -iq24_mul_high_round(drop.q, radian_q32) - iq24_mul_high_round(control->psi, t->speed_abs * 256);
    iq24_t steady_q = iq24_mul_high_round(drop.d, radian_q32);
    t->long_levels = t->angle[angles] < PATTERN_EIGHTH_TURN;
    if (t->long_levels) {
        steady_d += flux_of_long_levels(control, t, u.d);
        u_q = angles > 0 ? u.q : q_of_six_step(control, u);
    } else {
        const int32_t off_q25 = iq24_mul_high_round(link_ahead(control, 0) * 512, control->u_dc_inverse);
        const iq24_t ahead = 256 * iq24_mul_high_round(off_q25, PATTERN_HALF_TURN * 128 / (2 * angles + 1));
        steady_d -= iq24_mul_high_round(ahead, u.d);
        steady_q -= iq24_mul_high_round(ahead, u.q);
    }
    t->steady_q28.d = iq24_shift_wrap(IQ24_MUL64(steady_d, control->u_dc_inverse), 20);
    t->steady_q28.q = iq24_shift_wrap(IQ24_MUL64(steady_q, control->u_dc_inverse), 20);
    /* Backward, x becomes 1/2 - x: the level is the same, and time goes forward. */
    t->u_place = PATTERN_QUARTER_TURN + t->sense * iq24_atan2(u_q, u.d);
}

/* ---- Change of the table ---- */

void iqfoc_pattern_control_change(iqfoc_pattern_control_t *control, const iqfoc_pattern_t *table)
{
    control->wanted = table;
    control->waited = 0;
    control->nearest_q48 = PATTERN_FAR_Q48;
}

/*
 * Takes the wanted table where that costs least: the edges of a copy show it. Both trajectories cross between two valleys. Legs whose level
 * differs then have their edge there. The cost has a period of a sixth of a turn. Range of the error: below 1/3 + 2 a component, held to 2.
 */
static void change_if_near(iqfoc_pattern_control_t *control, iq24_t index, iqfoc_dq_t u, iqfoc_dq_t drop)
{
    const iqfoc_pattern_trajectory_t *t = &control->trajectory;
    iqfoc_pattern_control_t other = *control;
    other.modulator.table = control->wanted;
    other.modulator.row = 0;
    const iq24_t place = pattern_place(control->wanted, index);
    pattern_rows_t rows = pattern_rows_at(&other.modulator, place);
    if (rows.next == rows.row) {
        rows = rows_beyond(control->wanted, other.modulator.row, place);
    }
    iqfoc_pattern_trajectory_t *next = &other.trajectory;
    trace(next, &rows, control->wanted->angles);
    place_trajectory(control, next, control->wanted->angles, u, drop);
    pattern_restart_legs(&other, rows.row->start);
    other.theta = iq24_add_wrap(control->theta, t->speed);
    pattern_place_t at[3];
    iq24_t apart[3];
    for (int32_t k = 0; k < 3; k++) {
        int32_t n = control->leg[k].place;
        const iq24_t turned = k * t->third_turn;
        at[k] = pattern_place_of(next, pattern_angle_at(next, other.theta) + turned, &other.leg[k].place);
        apart[k] = (at[k].flux - pattern_place_of(t, pattern_angle_at(t, other.theta) + turned, &n).flux) / 2;
    }
    const iqfoc_abc_t legs = {apart[0], apart[1], apart[2]};
    const iqfoc_ab_t flux = iqfoc_clarke3(legs);
    const iqfoc_dq_t steady = {iq24_asr32(next->steady_q28.d, 4) - iq24_asr32(t->steady_q28.d, 4),
                               iq24_asr32(next->steady_q28.q, 4) - iq24_asr32(t->steady_q28.q, 4)};
    const iqfoc_ab_t turned = iqfoc_park_inverse(steady, iq24_sincos(other.theta));
    other.error.alpha = IQ24_HOLD_BITS(flux.alpha + turned.alpha, 26);
    other.error.beta = IQ24_HOLD_BITS(flux.beta + turned.beta, 26);
    iqfoc_pattern_edges_t edges[3];
    const iqfoc_pattern_modulator_t modulator = other.modulator;
    pattern_move_legs(&other, at, edges);
    control->waited = iq24_min(control->waited + next->speed_abs, IQ24_ONE);
    if (pattern_near(&control->nearest_q48, pattern_cost_q48(&other, edges),
                     control->waited > IQ24(0.1666667))) {
        control->wanted = NULL;
        control->modulator = modulator;
        control->trajectory = *next;
        pattern_restart_legs(control, next->start);
    }
}

/*
 * 1/speed in Q22 to the nearest, as iq24_div(1 << 22, speed): 2^46 over 2^17 ... 2^21, by 31, 11 and 4 bits. A remainder is below 2^21, so
 * that the next dividend is below 2^32.
 */
static inline int32_t cycles_of_turn(uint32_t speed)
{
    const uint32_t whole = (UINT32_C(1) << 31) / speed;
    const uint32_t rest = ((UINT32_C(1) << 31) - whole * speed) << 11;
    const uint32_t part = rest / speed;
    const uint32_t last = (((rest - part * speed) << 4) + speed / 2) / speed;
    return (int32_t)((whole << 15) + (part << 4) + last);
}

/*
 * Range: l i_ref + psi <= 80 and phi <= 0.79: below 64; r i_ref <= 64. cycles_q22 <= 2^29; 1/phi <= 20.4, so
 * that steady <= 2.07 (0.16 + 2 + 0.17). The voltage's square is at most 32.
 */
void iqfoc_pattern_control_aim(iqfoc_pattern_control_t *control, iqfoc_dq_t i_ref, iq24_t speed)
{
    iqfoc_pattern_trajectory_t *t = &control->trajectory;
    learn(control);
    follow_link(control);
    const iq24_t speed_abs = iq24_clamp(speed < 0 ? -iq24_max(speed, -IQFOC_PATTERN_SPEED_MAX) : speed,
                                        IQFOC_PATTERN_CONTROL_SPEED_MIN, IQFOC_PATTERN_SPEED_MAX);
    t->speed = speed < 0 ? -speed_abs : speed_abs;
    t->cycles_q22 = cycles_of_turn((uint32_t)speed_abs);
    /*@ assert pattern_cycles: 33554432 <= t->cycles_q22 <= 536870912; */
    t->speed_abs = speed_abs;
    t->l_q28 = iq24_mul_trunc(iq24_mul_high_round(control->l * 8, speed_abs * 512), control->u_dc_inverse);

    const iq24_t phi = iq24_mul_high_round(t->speed * 16, Q28_2_PI);
    const iq24_t drop_d = iq24_mul_trunc(control->r, i_ref.d) - control->v.d;
    const iq24_t drop_q = iq24_mul_trunc(control->r, i_ref.q) - control->v.q;
    const iqfoc_dq_t drop = {IQ24_HOLD_BITS(drop_d, 25), IQ24_HOLD_BITS(drop_q, 25)};
    const iq24_t u_d = drop.d - iq24_mul_trunc(phi, iq24_mul_trunc(control->l, i_ref.q));
    const iq24_t u_q = drop.q + iq24_mul_trunc(phi, iq24_mul_trunc(control->l, i_ref.d) + control->psi);
    const iqfoc_dq_t u = {IQ24_HOLD_BITS(u_d, 27), IQ24_HOLD_BITS(u_q, 27)};
    const iq24_t length = iq24_sqrt(iq24_acc_round(iq24_acc_mac(iq24_acc_mul(u.d, u.d), u.q, u.q)));
    t->sense = speed < 0 ? -1 : 1;
    t->third_turn = -t->sense * PATTERN_THIRD_TURN;

    place_trajectory(control, t, control->modulator.table->angles, u, drop);
    /* A pattern's voltage turns with the rotor, and e^-rho weights the cycle's end more than its start: 1 + j rho phi/12. */
    const iqfoc_ab_t share = iqfoc_clarke3(control->high);
    const iqfoc_ab_t per_link = {iq24_mul_trunc(share.alpha, control->law.k_u_q26),
                                 iq24_mul_trunc(share.beta, control->law.k_u_q26)};
    const int32_t later_q32 = iq24_mul_high_round(control->later_q31, t->speed * 512);
    t->per_link_q26.alpha = per_link.alpha - iq24_mul_high_round(per_link.beta, later_q32);
    t->per_link_q26.beta = per_link.beta + iq24_mul_high_round(per_link.alpha, later_q32);

    /*
     * In the rotor frame at the cycle's end, where the angle at mid-cycle is half the movement behind. The mean of v over the cycle is
     * 1 - phi^2/24 of it.
     */
    const iq24_sincos_t sc_half = iq24_sincos_inline(-iq24_asr32(t->speed, 1));
    const iqfoc_exact_t exact = iqfoc_exact_at_speed_inline(&control->law, t->speed);
    const int32_t less_q30 =
        iq24_mul_high_round(iq24_mul_high_round(t->speed * 256, t->speed * 256), Q30_PI2_6);
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
        pattern_restart_legs(control, rows.row->start);
    }
    if (control->wanted != NULL) {
        change_if_near(control, index, u, drop);
    }
}
