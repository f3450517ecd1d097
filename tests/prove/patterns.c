/*
 * Control of a pulse pattern (pattern_control.h) and pulse modes (pulse_mode.h): their parts one by one, from any state within the ranges
 * that the headers state. Each function that changes a state is shown to keep them. The parts of the control: a leg's place, a leg's
 * edges, a trajectory, a change of the table, and the peak. Each is proved for a number of angles at a time, as it says which edges there
 * are.
 */
#include "any_drive.h"

#include "iqfoc/pulse_mode.h"

#include "pattern_place.h"

#define FROM                                                                                                 \
    control->trajectory, control->leg[k], control->modulator.least, control->modulator.leg[k], *place,       \
        error, k

/* What prove_pattern_control_leg shows. The other functions here take it in place of the source: three legs multiply their states. */
/*@ requires error: -159383552 <= error <= 159383552;
    requires leg: 0 <= k <= 2;
    requires y: 0 <= place->y <= 8388607;
    requires place_level: -1 <= place->level <= 1;
    requires place: 0 <= control->leg[k].place <= control->trajectory.edges - 1;
    requires edge_before: -1 <= control->leg[k].edge < IQFOC_PATTERN_EDGES_HALF;
    requires level_before: -1 <= control->leg[k].level <= 1;
    requires output_before: -1 <= control->modulator.leg[k].level <= 1;
    requires since_before: 0 <= control->modulator.leg[k].since <= 134217728;
    requires least: 0 <= control->modulator.least <= 134217728;
    requires speed: 131072 <= control->trajectory.speed_abs <= 2097152;
    requires cycles: 33554432 <= control->trajectory.cycles_q22 <= 536870912;
    requires angles: \forall integer n; 0 <= n <= control->trajectory.edges + 1 ==> -4194304 <= control->trajectory.angle[n] <= 20971520;
    assigns control->modulator.leg[k] \from FROM;
    assigns control->leg[k].edge \from FROM;
    assigns control->leg[k].level \from FROM;
    assigns out->level \from FROM;
    assigns out->edges \from FROM;
    assigns out->high \from FROM;
    assigns out->instant[0 .. 15] \from FROM;
    ensures written: \initialized(&out->high) && \initialized(&out->edges) && \initialized(&out->level);
    ensures output: -1 <= control->modulator.leg[k].level <= 1;
    ensures since: 0 <= control->modulator.leg[k].since <= 134217728;
    ensures edge: -1 <= control->leg[k].edge < IQFOC_PATTERN_EDGES_HALF;
    ensures level: -1 <= control->leg[k].level <= 1;
    ensures edges: 0 <= out->edges <= IQFOC_PATTERN_EDGES_MAX;
    ensures high: 0 <= out->high <= 16777216;
    ensures first: -1 <= out->level <= 1; */
IQFOC_STEP void move_leg(iqfoc_pattern_control_t *control, int32_t k, const pattern_place_t *place,
                         iq24_t error, iqfoc_pattern_edges_t *out);

#include "pattern_control.c"
#include "pattern_trajectory.c"

/* The bounds of 1/u_dc, times the mean of the link within 1/30 of 1. */
#define INVERSE_LOW  10811692
#define INVERSE_HIGH 34673033

static void check(int32_t x, int32_t low, int32_t high)
{
    /*@ assert within_its_range: low <= x <= high; */
    (void)(x >= low && x <= high);
}

static iqfoc_pattern_row_t row[IQFOC_PATTERN_ROWS_MAX];

/* Any table within pattern.h. */
static iqfoc_pattern_t any_table(int32_t angles)
{
    for (int32_t n = 0; n < IQFOC_PATTERN_ROWS_MAX; n++) {
        row[n].start = any_bool() ? 1 : -1;
        row[n].joined = any_within(0, 1);
        for (int32_t k = 0; k < IQFOC_PATTERN_ANGLES_MAX; k++) {
            row[n].angle[k] = any_within(0, PATTERN_QUARTER_TURN);
        }
    }
    const iqfoc_pattern_t table = {row, any_within(1, IQFOC_PATTERN_ROWS_MAX), angles,
                                   any_within(0, IQ24_ONE), any_within(IQ24_ONE, IQ24(100.0))};
    return table;
}

static iqfoc_pattern_leg_t any_leg(void)
{
    const iqfoc_pattern_leg_t leg = {any_bool() ? 1 : -1, any_within(0, IQFOC_PATTERN_TIME_MAX)};
    return leg;
}

/* Its first angle is 0 and the one of number `edges` is 1/2: a place ends between these. */
static iqfoc_pattern_trajectory_t any_trajectory(int32_t edges)
{
    iqfoc_pattern_trajectory_t t;
    t.speed = any_within(-IQFOC_PATTERN_SPEED_MAX, IQFOC_PATTERN_SPEED_MAX);
    t.sense = any_bool() ? 1 : -1;
    t.u_place = any_within(-PATTERN_QUARTER_TURN, 3 * PATTERN_QUARTER_TURN);
    t.third_turn = any_bool() ? PATTERN_THIRD_TURN : -PATTERN_THIRD_TURN;
    t.speed_abs = any_within(IQFOC_PATTERN_CONTROL_SPEED_MIN, IQFOC_PATTERN_SPEED_MAX);
    t.l_q28 = any_within(0, 1 << 30);
    t.steady_q28.d = any_within(-(1 << 30) - (1 << 28), (1 << 30) + (1 << 28));
    t.steady_q28.q = any_within(-(1 << 30) - (1 << 28), (1 << 30) + (1 << 28));
    t.per_link_q26.alpha = any();
    t.per_link_q26.beta = any();
    t.drift_q26.d = any();
    t.drift_q26.q = any();
    t.cycles_q22 = any_within(1 << 25, 1 << 29);
    t.long_levels = any_bool();
    t.start = any_within(-1, 1);
    t.edges = edges;
    for (int32_t k = 0; k < IQFOC_PATTERN_EDGES_HALF + 2; k++) {
        t.angle[k] = any_within(-PATTERN_QUARTER_TURN, 5 * PATTERN_QUARTER_TURN);
    }
    for (int32_t k = 0; k < IQFOC_PATTERN_EDGES_HALF; k++) {
        t.ahead[k] = any_within(-IQ24(8.0), IQ24(8.0));
    }
    t.angle[0] = 0;
    t.angle[edges] = PATTERN_HALF_TURN;
    return t;
}

static void check_trajectory(const iqfoc_pattern_trajectory_t *t, int32_t edges)
{
    check(t->speed, -IQFOC_PATTERN_SPEED_MAX, IQFOC_PATTERN_SPEED_MAX);
    check(t->sense, -1, 1);
    check(t->u_place, -PATTERN_QUARTER_TURN, 3 * PATTERN_QUARTER_TURN);
    check(t->third_turn, -PATTERN_THIRD_TURN, PATTERN_THIRD_TURN);
    check(t->speed_abs, IQFOC_PATTERN_CONTROL_SPEED_MIN, IQFOC_PATTERN_SPEED_MAX);
    check(t->l_q28, 0, 1 << 30);
    check(t->steady_q28.d, -(1 << 30) - (1 << 28), (1 << 30) + (1 << 28));
    check(t->steady_q28.q, -(1 << 30) - (1 << 28), (1 << 30) + (1 << 28));
    check(t->cycles_q22, 1 << 25, 1 << 29);
    check(t->start, -1, 1);
    check(t->edges, edges, edges);
    for (int32_t k = 0; k < edges + 2; k++) {
        check(t->angle[k], -PATTERN_QUARTER_TURN, 5 * PATTERN_QUARTER_TURN);
    }
    for (int32_t k = 0; k < edges; k++) {
        check(t->ahead[k], -IQ24(8.0), IQ24(8.0));
    }
    check(t->angle[0], 0, 0);
    check(t->angle[edges], PATTERN_HALF_TURN, PATTERN_HALF_TURN);
}

/* The numbers of the winding, from iqfoc_pattern_control_init. */
static void any_winding(iqfoc_pattern_control_t *c)
{
    const iqfoc_exact_winding_t winding = {any_within(0, 1 << 30), any_within(1 << 23, 1 << 30),
                                           any_within(0, 1 << 30)};
    c->law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    c->l = any_within(IQ24_ONE / 16, IQ24(8.0));
    c->r = any_within(0, IQ24(8.0));
    c->psi = any_within(0, IQ24(16.0));
    c->correction = any_within(0, IQ24_ONE);
    c->keeps = any_within(0, IQ24_ONE);
    c->later_q31 = any_within(0, Q31_PI_6);
    c->disturbance_l = any_within(0, IQ24(2.0));
}

/* Any state with a table of `angles`. `n`: the edge before each leg's place; the legs are moved one by one. */
static iqfoc_pattern_control_t any_control(const iqfoc_pattern_t *table, int32_t n)
{
    iqfoc_pattern_control_t c;
    c.modulator.table = table;
    c.modulator.least = any_within(0, IQFOC_PATTERN_TIME_MAX);
    c.modulator.row = any_within(0, IQFOC_PATTERN_ROWS_MAX - 1);
    any_winding(&c);
    c.trajectory = any_trajectory(2 * table->angles + 1);
    for (int32_t k = 0; k < 3; k++) {
        c.modulator.leg[k] = any_leg();
        c.leg[k].place = n;
        c.leg[k].edge = any_within(-1, IQFOC_PATTERN_EDGES_HALF - 1);
        c.leg[k].level = any_within(-1, 1);
    }
    c.wanted = NULL;
    c.waited = any_within(0, IQ24_ONE);
    c.nearest_q48 = any_bool() ? INT64_C(1) << 62 : (iq24_acc_t)any_within(0, IQ24_MAX) * IQ24_MAX;
    c.theta = any();
    c.predicted = any_bool();
    c.high = any_abc(0, IQ24_ONE);
    c.i_next = any_ab(IQ24(8.0));
    c.miss = any_ab(IQ24(16.0));
    c.carried = any_ab(IQ24(16.0));
    c.sc = any_sincos();
    c.sc_sample = any_sincos();
    c.v = any_dq(IQ24(0.5));
    c.u_dc = any_within(IQ24(0.5), IQ24(1.5));
    c.u_slope = any_within(-IQ24_ONE, IQ24_ONE);
    c.u_mean = any_within(IQ24(0.5), IQ24(1.5));
    c.u_dc_inverse = any_within(INVERSE_LOW, INVERSE_HIGH);
    c.error = any_ab(IQ24(4.0));
    return c;
}

/* What a cycle changes, but for the trajectory. */
static void check_control(const iqfoc_pattern_control_t *c, int32_t edges)
{
    for (int32_t k = 0; k < 3; k++) {
        check(c->modulator.leg[k].level, -1, 1);
        check(c->modulator.leg[k].since, 0, IQFOC_PATTERN_TIME_MAX);
        check(c->leg[k].place, 0, edges - 1);
        check(c->leg[k].edge, -1, IQFOC_PATTERN_EDGES_HALF - 1);
        check(c->leg[k].level, -1, 1);
    }
    check(c->modulator.row, 0, IQFOC_PATTERN_ROWS_MAX - 1);
    check(c->high.a, 0, IQ24_ONE);
    check(c->i_next.alpha, -IQ24(8.0), IQ24(8.0));
    check(c->i_next.beta, -IQ24(8.0), IQ24(8.0));
    check(c->miss.alpha, -IQ24(16.0), IQ24(16.0));
    check(c->carried.alpha, -IQ24(16.0), IQ24(16.0));
    check(c->sc_sample.cos, -IQ24_ONE, IQ24_ONE);
    check(c->v.d, -IQ24(0.5), IQ24(0.5));
    check(c->v.q, -IQ24(0.5), IQ24(0.5));
    check(c->u_dc, IQ24(0.5), IQ24(1.5));
    check(c->u_slope, -IQ24_ONE, IQ24_ONE);
    check(c->u_mean, IQ24(0.5), IQ24(1.5));
    check(c->u_dc_inverse, INVERSE_LOW, INVERSE_HIGH);
    check(c->error.alpha, -IQ24(4.0), IQ24(4.0));
}

/* Control of a pulse pattern, set-up: any configuration, any least time. */
void prove_pattern_control_init(void)
{
    const iqfoc_pattern_t table = any_table(any_within(0, IQFOC_PATTERN_ANGLES_MAX));
    const iqfoc_pattern_control_config_t config = {{any(), any(), any()}, any(), any()};
    iqfoc_pattern_control_t c;
    if (iqfoc_pattern_control_init(&c, &config, &table, any()) == IQFOC_OK) {
        check(c.l, IQ24_ONE / 16, IQ24(8.0));
        check(c.r, 0, IQ24(8.0));
        check(c.psi, 0, IQ24(16.0));
        check(c.keeps, 0, IQ24_ONE);
        check(c.later_q31, 0, Q31_PI_6);
        check(c.disturbance_l, 0, IQ24(2.0));
        iqfoc_pattern_control_change(&c, &table);
    }
}

/* Its place of a leg: any angle, from any edge. */
void prove_pattern_control_place(void)
{
    for (int32_t edges = 1; edges <= IQFOC_PATTERN_EDGES_HALF; edges += 2) {
        for (int32_t before = 0; before < edges; before++) {
            const iqfoc_pattern_trajectory_t t = any_trajectory(edges);
            int32_t n = before;
            const pattern_place_t place = pattern_place_of(&t, any_within(-IQ24(2.0), IQ24(3.0)), &n);
            check(n, 0, edges - 1);
            check(place.y, 0, PATTERN_HALF_TURN - 1);
            check(place.level, -1, 1);
        }
    }
}

/* Its trajectory: any table, at each number of angles. */
void prove_pattern_control_trace(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles++) {
        const iqfoc_pattern_t table = any_table(angles);
        iqfoc_pattern_modulator_t modulator = {&table, 0, any_within(0, IQFOC_PATTERN_ROWS_MAX - 1), {{0}}};
        const pattern_rows_t rows = pattern_rows_at(&modulator, pattern_place(&table, any()));
        iqfoc_pattern_trajectory_t t = any_trajectory(3);
        trace(&t, &rows, angles);
        check_trajectory(&t, 2 * angles + 1);
    }
}

/* Its change of the table: any table, from any trajectory of as many angles. */
void prove_pattern_control_change(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles++) {
        for (int32_t n = 0; n <= 2 * angles; n++) {
            const iqfoc_pattern_t table = any_table(angles);
            iqfoc_pattern_control_t c = any_control(&table, n);
            c.wanted = &table;
            change_if_near(&c, any(), any_dq(IQ24(4.0)), any_dq(IQ24_ONE));
            check_trajectory(&c.trajectory, 2 * angles + 1);
            check_control(&c, 2 * angles + 1);
        }
    }
}

/* Its peak: any reference, any speed. */
void prove_pattern_control_aim(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles++) {
        const iqfoc_pattern_t table = any_table(angles);
        iqfoc_pattern_control_t c = any_control(&table, any_within(0, 2 * angles));
        iqfoc_pattern_control_aim(&c, any_dq(IQ24(8.0)), any());
        check_trajectory(&c.trajectory, 2 * angles + 1);
        check_control(&c, 2 * angles + 1);
    }
}

/* Its edges of a leg: any place, any error. */
void prove_pattern_control_leg(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles++) {
        const int32_t edges = 2 * angles + 1;
        const iqfoc_pattern_t table = any_table(angles);
        iqfoc_pattern_control_t c = any_control(&table, any_within(0, edges - 1));
        const pattern_place_t place = {any_within(0, PATTERN_HALF_TURN - 1), any_bool() ? 1 : -1, 0};
        iqfoc_pattern_edges_t out;
        move_leg(&c, 0, &place, any_within(-IQ24(9.5), IQ24(9.5)), &out);
        check_control(&c, edges);
        check(out.edges, 0, IQFOC_PATTERN_EDGES_MAX);
        check(out.high, 0, IQ24_ONE);
    }
}

/* Its valley: any sample, angle and link. The places end where those of prove_pattern_control_place do, whatever edge they begin from. */
void prove_pattern_control_step(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles++) {
        const iqfoc_pattern_t table = any_table(angles);
        iqfoc_pattern_control_t c = any_control(&table, angles);
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_step(&c, any_ab(IQ24(8.0)), any(), any_within(IQ24(0.5), IQ24(1.5)), edges);
        check_control(&c, 2 * angles + 1);
    }
}

/* Its restart: any state, table and link. */
void prove_pattern_control_restart(void)
{
    const iqfoc_pattern_t table = any_table(any_within(0, IQFOC_PATTERN_ANGLES_MAX));
    iqfoc_pattern_control_t c = any_control(&table, 0);
    iqfoc_pattern_control_restart(&c, &table, any_within(IQ24(0.5), IQ24(1.5)));
    check_control(&c, 2 * IQFOC_PATTERN_ANGLES_MAX + 1);
}

/* Its first cycle after another modulator: any current, angle and legs. */
void prove_pattern_control_begin(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles++) {
        const iqfoc_pattern_t table = any_table(angles);
        iqfoc_pattern_control_t c = any_control(&table, any_within(0, 2 * angles));
        const iqfoc_pattern_leg_t leg[3] = {any_leg(), any_leg(), any_leg()};
        iqfoc_pattern_edges_t edges[3];
        iqfoc_pattern_control_begin(&c, any_ab(IQ24(8.0)), any(), leg, edges);
        check_control(&c, 2 * angles + 1);
    }
}

/* ---- Pulse modes ---- */

static iqfoc_pulse_level_t level[IQFOC_PULSE_LEVELS_MAX];

/* Levels with this table, but for the carrier. */
static iqfoc_pulse_config_t any_levels(const iqfoc_pattern_t *table, int32_t levels)
{
    for (int32_t n = 0; n < levels; n++) {
        const iqfoc_pulse_level_t one = {n > 0 ? table : NULL, any(), any(), any(), any()};
        level[n] = one;
    }
    const iqfoc_pulse_config_t config = {level, levels, any_count(1, IQFOC_PULSE_TICKS_MAX)};
    return config;
}

/* The analysis does not know that a sum of squares is positive. */
static iqfoc_pulse_mode_t any_mode(const iqfoc_pulse_config_t *config, int32_t present, int32_t wanted)
{
    const iqfoc_pulse_mode_t mode = {config,
                                     present,
                                     wanted,
                                     any_within(-IQFOC_PATTERN_SPEED_MAX, IQFOC_PATTERN_SPEED_MAX),
                                     any_within(0, IQ24(3.0)),
                                     any_bool() ? INT64_C(1) << 62 : (iq24_acc_t)any() * IQ24_MAX};
    return mode;
}

static void check_mode(const iqfoc_pulse_mode_t *mode, int32_t levels)
{
    check(mode->level, 0, levels - 1);
    check(mode->wanted, 0, levels - 1);
    check(mode->speed, -IQFOC_PATTERN_SPEED_MAX, IQFOC_PATTERN_SPEED_MAX);
    check(mode->waited, 0, IQ24(3.0));
    /*@ assert within_its_range: -4611686018427387904 <= mode->nearest_q48 <= 4611686018427387904; */
}

/* A cycle of the carrier: |i_next|, |i_ref| <= 8, and a set of gains within current_control.h. */
static iqfoc_cycle_t any_cycle(iqfoc_cycle_config_t *set)
{
    *set = any_set();
    set->gains.x_d = any_within(0, IQ24(96.0));
    set->gains.x_q = any_within(0, IQ24(96.0));
    set->gains.emf = any_within(0, IQ24(96.0));
    set->period_ticks = any_count(1, INT32_MAX);
    iqfoc_cycle_t cycle;
    cycle.config = set;
    cycle.rotor = iqfoc_rotor_from_speed(any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX));
    cycle.theta_valley = any();
    cycle.i_next = any_ab(IQ24(8.0));
    cycle.i_ref = any_dq(IQ24(8.0));
    cycle.u_dq = any_dq(IQ24(8.0));
    return cycle;
}

/* Pulse modes, set-up: any configuration. */
void prove_pulse_mode_init(void)
{
    const iqfoc_pattern_t table = any_table(any_within(0, IQFOC_PATTERN_ANGLES_MAX));
    const iqfoc_pulse_config_t known = any_levels(&table, IQFOC_PULSE_LEVELS_MAX);
    const iqfoc_pulse_config_t config = {known.level, any(), any_count(0, UINT32_MAX)};
    iqfoc_pulse_mode_t mode;
    if (iqfoc_pulse_mode_init(&mode, &config) == IQFOC_OK) {
        check_mode(&mode, IQFOC_PULSE_LEVELS_MAX);
    }
}

/* Their level: any speed and index, each level and neighbour. */
void prove_pulse_mode_step(void)
{
    const iqfoc_pattern_t table = any_table(any_within(0, IQFOC_PATTERN_ANGLES_MAX));
    for (int32_t levels = 2; levels <= IQFOC_PULSE_LEVELS_MAX; levels++) {
        const iqfoc_pulse_config_t config = any_levels(&table, levels);
        for (int32_t n = 0; n < levels; n++) {
            for (int32_t wanted = n > 0 ? n - 1 : 0; wanted <= n + 1 && wanted < levels; wanted++) {
                iqfoc_pattern_control_t c = any_control(&table, 0);
                c.modulator.table = any_bool() ? &table : &iqfoc_pattern_six_step;
                iqfoc_pulse_mode_t mode = any_mode(&config, n, wanted);
                iqfoc_pulse_mode_step(&mode, &c, any(), any());
                check_mode(&mode, levels);
            }
        }
    }
}

/* Their way from the carrier to a pattern: any state of both, any duties and link; tables without angles and with the most. */
void prove_pulse_mode_to_pattern(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles += IQFOC_PATTERN_ANGLES_MAX) {
        const iqfoc_pattern_t table = any_table(angles);
        const iqfoc_pulse_config_t config = any_levels(&table, IQFOC_PULSE_LEVELS_MAX);
        iqfoc_pulse_mode_t mode = any_mode(&config, 0, 1);
        iqfoc_pattern_control_t c = any_control(&table, any_within(0, 2 * angles));
        iqfoc_cycle_config_t set;
        const iqfoc_cycle_t cycle = any_cycle(&set);
        iqfoc_pattern_edges_t edges[3];
        (void)iqfoc_pulse_mode_to_pattern(&mode, &c, &cycle, any_abc(0, IQ24_ONE),
                                          any_within(IQ24(0.5), IQ24(1.5)), edges);
        check_mode(&mode, IQFOC_PULSE_LEVELS_MAX);
        check_trajectory(&c.trajectory, 2 * angles + 1);
        check_control(&c, 2 * angles + 1);
    }
}

/* Their way from a pattern to the carrier: any state of both, any sample, angle and link, any set for the first period; such tables. */
void prove_pulse_mode_to_carrier(void)
{
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles += IQFOC_PATTERN_ANGLES_MAX) {
        const iqfoc_pattern_t table = any_table(angles);
        const iqfoc_pulse_config_t config = any_levels(&table, IQFOC_PULSE_LEVELS_MAX);
        iqfoc_pulse_mode_t mode = any_mode(&config, 1, 0);
        iqfoc_pattern_control_t c = any_control(&table, angles);
        iqfoc_cycle_config_t set;
        iqfoc_cycle_t cycle = any_cycle(&set);
        iqfoc_pattern_edges_t edges[3];
        iqfoc_duties_t duties;
        set.span_max = any_within(0, IQ24_ONE);
        (void)iqfoc_pulse_mode_to_carrier(&mode, &c, &cycle, &set, any_ab(IQ24(8.0)), any(),
                                          any_within(IQ24(0.5), IQ24(1.5)), edges, &duties);
        check_mode(&mode, IQFOC_PULSE_LEVELS_MAX);
        check_control(&c, 2 * angles + 1);
        check(cycle.u_dq.d, -IQ24(8.0), IQ24(8.0));
        check(cycle.u_dq.q, -IQ24(8.0), IQ24(8.0));
    }
}

/* The first valley of the carrier after it: any speed and reference. */
void prove_pulse_mode_resume(void)
{
    const iqfoc_pattern_t table = any_table(1);
    const iqfoc_pattern_control_t c = any_control(&table, 0);
    iqfoc_cycle_config_t set;
    iqfoc_cycle_t cycle = any_cycle(&set);
    set.gains.kp_d = any_within(0, IQ24(32.0));
    set.gains.kp_q = any_within(0, IQ24(32.0));
    set.gains.ki_d = any_within(0, IQ24(32.0));
    set.gains.ki_q = any_within(0, IQ24(32.0));
    iqfoc_pulse_mode_resume(&c, &cycle);
    check(cycle.u_dq.d, -IQ24(8.0), IQ24(8.0));
    check(cycle.u_dq.q, -IQ24(8.0), IQ24(8.0));
}
