/* Pulse modes: refused configurations, the level over speed and index, and the voltage of a hand-over against its formula in double. */
#include "iqfoc/params.h"
#include "iqfoc/pulse_mode.h"
#include "iqfoc/synchronous_carrier.h"
#include "reference_vectors.h"

#include <stdlib.h>
#include <string.h>

#define R_OHM    0.75
#define L_H      5.2e-3
#define PSI_WB   0.134
#define I_BASE_A 14.849
#define U_DC_V   565.0
#define T_S      1e-4
#define LEAST    IQ24(0.05)

enum { DRAWS = 200000 / IQFOC_TEST_STRIDE, TICKS = 10000 };

static const iqfoc_pattern_row_t rows[2] = {{1, 0, {IQ24(0.19), IQ24(0.22)}},
                                            {-1, 0, {IQ24(0.03), IQ24(0.24)}}};
static const iqfoc_pattern_t five = {rows, 2, 2, IQ24(0.5), IQ24(2.0)};
static const iqfoc_pattern_t three = {rows, 1, 1, IQ24(0.5), IQ24_ONE};
static iqfoc_pulse_level_t level[4] = {
    {NULL, 0, 0, 0, 0},
    {&five, IQ24(0.02), IQ24(0.018), 0, 0},
    {&three, IQ24(0.03), IQ24(0.028), 0, 0},
    {&iqfoc_pattern_six_step, IQ24(0.04), IQ24(0.036), IQ24_ONE, IQ24(0.98)}};
static const iqfoc_pulse_config_t config = {level, 4, TICKS};
static const iqfoc_pattern_control_config_t machine = {
    IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_WB, T_S, I_BASE_A, U_DC_V), IQ24(0.1), IQ24(0.02)};
static const iqfoc_cycle_config_t carrier = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, 4.0 * T_S, I_BASE_A, U_DC_V),
    .gains = IQFOC_GAINS(1000.0, R_OHM, L_H, L_H, PSI_WB, 4.0 * T_S, I_BASE_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .span_max = IQ24_ONE,
    .current_limit = IQ24(4.0),
    .period_ticks = 4 * TICKS};

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Configuration ---- */

static iqfoc_error_t with(int32_t levels, uint32_t ticks)
{
    iqfoc_pulse_mode_t mode;
    const iqfoc_pulse_config_t c = {level, levels, ticks};
    return iqfoc_pulse_mode_init(&mode, &c);
}

/* A field at a value is refused, and at another one accepted. */
#define REFUSED(field, wrong, right)                                                                         \
    do {                                                                                                     \
        const iqfoc_pulse_level_t kept[4] = {level[0], level[1], level[2], level[3]};                        \
        (field) = (wrong);                                                                                   \
        TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PULSE_MODE, with(4, TICKS));                                       \
        memcpy(level, kept, sizeof level);                                                                   \
        (field) = (right);                                                                                   \
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, with(4, TICKS));                                                     \
        memcpy(level, kept, sizeof level);                                                                   \
    } while (0)

static void test_refused(void)
{
    iqfoc_pulse_mode_t mode;
    const iqfoc_pulse_config_t without = {NULL, 4, TICKS};
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pulse_mode_init(NULL, &config));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pulse_mode_init(&mode, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pulse_mode_init(&mode, &without));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PULSE_MODE, with(1, TICKS));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, with(2, TICKS));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PULSE_MODE, with(IQFOC_PULSE_LEVELS_MAX + 1, TICKS));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PULSE_MODE, with(4, 0));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, with(4, 1));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, with(4, IQFOC_PULSE_TICKS_MAX));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PULSE_MODE, with(4, IQFOC_PULSE_TICKS_MAX + 1));
    REFUSED(level[0].table, &five, NULL);
    REFUSED(level[1].on, IQFOC_PATTERN_CONTROL_SPEED_MIN - 1, IQ24(0.03));
    REFUSED(level[2].on, IQ24(0.02) - 1, IQ24(0.029));
    REFUSED(level[3].on, IQFOC_PATTERN_SPEED_MAX + 1, IQFOC_PATTERN_SPEED_MAX);
    REFUSED(level[1].off, IQ24(0.02), IQ24(0.02) - 1);
    REFUSED(level[1].off, -1, 0);
    REFUSED(level[2].off, IQ24(0.018) - 1, IQ24(0.018));
    REFUSED(level[3].index_on, IQ24(2.0) + 1, IQ24(2.0));
    REFUSED(level[3].index_on, IQ24(0.98) - 1, IQ24(0.98));
    REFUSED(level[3].index_off, -1, 0);
    const iqfoc_pattern_t *const kept = level[2].table;
    iqfoc_pattern_t wrong = three;
    level[2].table = NULL;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, with(4, TICKS));
    wrong.angles = -1;
    level[2].table = &wrong;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PATTERN, with(4, TICKS));
    level[2].table = kept;
    mode.level = 77;
    const iqfoc_pulse_config_t one = {level, 1, TICKS};
    (void)iqfoc_pulse_mode_init(&mode, &one);
    TEST_ASSERT_EQUAL_INT32(77, mode.level);
}

/* ---- The level ---- */

/*
 * Random walks of speed and index, each hand-over done at once or later. The wanted level is one of the neighbours, and moves only where
 * the thresholds say so.
 */
static void test_level_over_speed(void)
{
    uint64_t seed = 1;
    iqfoc_pulse_mode_t mode;
    iqfoc_pattern_control_t control;
    double speed = 0.01;
    double index = 0.7;
    int up[4] = {0};
    int down[4] = {0};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_control_init(&control, &machine, &five, LEAST));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pulse_mode_init(&mode, &config));
    for (int n = 0; n < DRAWS; n++) {
        speed = fmin(fmax(speed + uniform(&seed, -1e-3, 1e-3), 0.01), 0.05);
        index = fmin(fmax(index + uniform(&seed, -0.02, 0.02), 0.8), 1.1);
        const int32_t before = mode.level;
        const iq24_t signed_speed = to_iq24(n % 2 == 0 ? speed : -speed);
        iqfoc_pulse_mode_step(&mode, &control, signed_speed, to_iq24(index));
        TEST_ASSERT_EQUAL_INT32(signed_speed, mode.speed);
        const int32_t now = mode.level;
        TEST_ASSERT_TRUE(now == before || (now > 0 && before > 0 && abs(now - before) == 1));
        TEST_ASSERT_TRUE(mode.wanted >= 0 && mode.wanted < 4 && abs(mode.wanted - now) <= 1);
        if (now > 0 && mode.wanted > 0 && control.wanted != NULL) {
            TEST_ASSERT_TRUE(control.wanted == level[mode.wanted].table);
        } else if (mode.wanted == now) {
            /* It stays: no threshold is passed. */
            TEST_ASSERT_TRUE(now == 3 || to_iq24(speed) < level[now + 1].on ||
                             to_iq24(index) < level[now + 1].index_on);
            TEST_ASSERT_TRUE(now == 0 ||
                             (to_iq24(speed) >= level[now].off && to_iq24(index) >= level[now].index_off));
        }
        /* The hand-over, at times. */
        if (random_bits(&seed) % 4 == 0) {
            if (mode.level == 0 && mode.wanted == 1) {
                mode.level = 1;
                control.modulator.table = level[1].table;
                up[1]++;
            } else if (mode.wanted == 0 && mode.level == 1) {
                mode.level = 0;
                down[1]++;
            } else if (control.wanted != NULL) {
                up[mode.wanted] += mode.wanted > mode.level ? 1 : 0;
                down[mode.level] += mode.wanted < mode.level ? 1 : 0;
                control.modulator.table = control.wanted;
                control.wanted = NULL;
            }
        }
    }
    printf("  level 1: %d up, %d down; 2: %d, %d; 3: %d, %d\n", up[1], down[1], up[2], down[2], up[3],
           down[3]);
    for (int k = 1; k < 4; k++) {
        TEST_ASSERT_TRUE(up[k] > 20 && down[k] > 20);
    }
}

/* At a threshold: up at `on`, down below `off`. */
static void test_thresholds(void)
{
    iqfoc_pulse_mode_t mode;
    iqfoc_pattern_control_t control;
    (void)iqfoc_pattern_control_init(&control, &machine, &five, LEAST);
    (void)iqfoc_pulse_mode_init(&mode, &config);
    iqfoc_pulse_mode_step(&mode, &control, level[1].on - 1, 0);
    TEST_ASSERT_EQUAL_INT32(0, mode.wanted);
    iqfoc_pulse_mode_step(&mode, &control, level[1].on, 0);
    TEST_ASSERT_EQUAL_INT32(1, mode.wanted);
    mode.level = 1;
    iqfoc_pulse_mode_step(&mode, &control, -level[1].off, 0);
    TEST_ASSERT_EQUAL_INT32(1, mode.wanted);
    iqfoc_pulse_mode_step(&mode, &control, -level[1].off + 1, 0);
    TEST_ASSERT_EQUAL_INT32(0, mode.wanted);
    mode.level = mode.wanted = 2;
    control.modulator.table = &three;
    iqfoc_pulse_mode_step(&mode, &control, level[3].on, IQ24_ONE - 1);
    TEST_ASSERT_EQUAL_INT32(2, mode.wanted);
    iqfoc_pulse_mode_step(&mode, &control, level[3].on, IQ24_ONE);
    TEST_ASSERT_EQUAL_INT32(3, mode.wanted);
    TEST_ASSERT_TRUE(control.wanted == &iqfoc_pattern_six_step);
    control.modulator.table = control.wanted;
    control.wanted = NULL;
    iqfoc_pulse_mode_step(&mode, &control, level[3].on, IQ24(0.98));
    TEST_ASSERT_EQUAL_INT32(3, mode.level);
    TEST_ASSERT_EQUAL_INT32(3, mode.wanted);
    iqfoc_pulse_mode_step(&mode, &control, level[3].on, IQ24(0.98) - 1);
    TEST_ASSERT_EQUAL_INT32(2, mode.wanted);
    iqfoc_pulse_mode_step(&mode, &control, INT32_MIN, IQ24_ONE);
    TEST_ASSERT_EQUAL_INT32(-IQFOC_PATTERN_SPEED_MAX, mode.speed);
}

/* ---- Carrier to pattern ---- */

/* The legs are those of centred pulses, no edge comes before the least time, and the flux error is the control's. */
static void test_to_pattern(void)
{
    uint64_t seed = 2;
    iqfoc_pattern_control_t control;
    iqfoc_pulse_mode_t mode;
    long taken = 0;
    (void)iqfoc_pattern_control_init(&control, &machine, &five, LEAST);
    for (int n = 0; n < DRAWS / 10; n++) {
        iqfoc_pattern_edges_t edges[3];
        iqfoc_cycle_t cycle;
        iqfoc_cycle_config_t set = carrier;
        const double speed = uniform(&seed, 0.02, 0.06) * (n % 2 == 0 ? 1.0 : -1.0);
        const double period = uniform(&seed, 1.0, 4.0);
        iq24_t high[3];
        set.period_ticks = (uint32_t)lround(period * TICKS);
        (void)iqfoc_cycle_init(&cycle, &set);
        (void)iqfoc_pulse_mode_init(&mode, &config);
        iqfoc_pulse_mode_step(&mode, &control, to_iq24(speed), 0);
        cycle.i_next.alpha = random_iq24(&seed, -1.0, 1.0);
        cycle.i_next.beta = random_iq24(&seed, -1.0, 1.0);
        cycle.i_ref.q = random_iq24(&seed, -1.0, 1.0);
        cycle.theta_valley = random_iq24(&seed, 0.0, 1.0);
        cycle.rotor = iqfoc_rotor_from_speed(to_iq24(speed * period));
        for (int k = 0; k < 3; k++) {
            const uint64_t which = random_bits(&seed) % 8;
            high[k] = which == 0 ? 0 : which == 1 ? IQ24_ONE : random_iq24(&seed, 0.0, 1.0);
        }
        const iqfoc_abc_t duties = {high[0], high[1], high[2]};
        TEST_ASSERT_EQUAL_INT32(1, mode.wanted);
        const int wait = (int)(random_bits(&seed) % 2);
        mode.waited = wait == 0 ? IQ24(2.0) : 0;
        TEST_ASSERT_EQUAL_INT(wait == 0, iqfoc_pulse_mode_to_pattern(&mode, &control, &cycle, duties,
                                                                     random_iq24(&seed, 0.8, 1.2), edges));
        TEST_ASSERT_EQUAL_INT32(wait == 0 ? 1 : 0, mode.level);
        taken += wait == 0 ? 1 : 0;
        TEST_ASSERT_EQUAL_INT32(to_iq24(speed), control.trajectory.speed);
        TEST_ASSERT_EQUAL_INT32(cycle.i_next.alpha, control.i_next.alpha);
        TEST_ASSERT_EQUAL_INT32(iq24_add_wrap(cycle.theta_valley, cycle.rotor.speed), control.theta);
        for (int k = 0; k < 3; k++) {
            const bool whole = high[k] == 0 || high[k] == IQ24_ONE;
            const double since = whole ? 8.0 : 0.5 * (1.0 - to_double(high[k])) * set.period_ticks / TICKS;
            TEST_ASSERT_EQUAL_INT32(high[k] == IQ24_ONE ? 1 : -1, edges[k].level);
            if (edges[k].edges > 0) {
                TEST_ASSERT_TRUE(to_double(edges[k].instant[0]) + since >= to_double(LEAST) - 1e-6);
            } else {
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, fmin(since + 1.0, 8.0),
                                          to_double(control.modulator.leg[k].since));
            }
        }
        /* Nothing with another level. */
        mode.level = 0;
        mode.wanted = 0;
        TEST_ASSERT_FALSE(iqfoc_pulse_mode_to_pattern(&mode, &control, &cycle, duties, IQ24_ONE, edges));
        mode.level = mode.wanted = 1;
        TEST_ASSERT_FALSE(iqfoc_pulse_mode_to_pattern(&mode, &control, &cycle, duties, IQ24_ONE, edges));
    }
    TEST_ASSERT_TRUE(taken > DRAWS / 40);
}

/* ---- Pattern to carrier ---- */

static double complex of_dq(iqfoc_dq_t x)
{
    return to_double(x.d) + I * to_double(x.q);
}

/* R i_ref - v + decoupling, over s1. */
static double complex steady(const iqfoc_pattern_control_t *control, const iqfoc_current_control_gains_t *g,
                             double complex i_ref, double speed, double s1)
{
    const double complex flux = to_double(g->x_d) * i_ref + to_double(g->emf);
    return (to_double(control->r) * i_ref - of_dq(control->v) + I * speed * flux) / s1;
}

static void test_to_carrier(void)
{
    uint64_t seed = 3;
    iqfoc_pattern_control_t control;
    iqfoc_pulse_mode_t mode;
    worst voltage = {"u_dq of the first period", 0.0};
    worst next = {"u_dq of the next one", 0.0};
    long taken = 0;
    long delayed = 0;
    (void)iqfoc_pulse_mode_init(&mode, &config);
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_cycle_t cycle;
        iqfoc_cycle_config_t set;
        iqfoc_pattern_edges_t edges[3];
        iqfoc_duties_t duties;
        iqfoc_sample_t sample = {.time = 0};
        const iq24_t speed = random_iq24(&seed, 0.01, 0.03) * (n % 2 == 0 ? 1 : -1);
        iqfoc_synchronous_carrier_set(&carrier, (uint32_t)uniform(&seed, 1.0 * TICKS, 4.0 * TICKS), &set);
        (void)iqfoc_pattern_control_init(&control, &machine, &five, LEAST);
        (void)iqfoc_cycle_init(&cycle, &carrier);
        control.v.d = random_iq24(&seed, -0.1, 0.1);
        control.v.q = random_iq24(&seed, -0.1, 0.1);
        cycle.i_ref.d = random_iq24(&seed, -1.0, 1.0);
        cycle.i_ref.q = random_iq24(&seed, -1.0, 1.0);
        for (int k = 0; k < 3; k++) {
            control.modulator.leg[k].level = random_bits(&seed) % 2 == 0 ? 1 : -1;
            control.modulator.leg[k].since = random_iq24(&seed, 0.0, 0.3);
        }
        bool may = true;
        for (int k = 0; k < 3; k++) {
            may = may && (control.modulator.leg[k].level < 0 || control.modulator.leg[k].since >= LEAST);
        }
        mode.level = 1;
        mode.wanted = n % 16 == 0 ? 1 : 0;
        mode.speed = speed;
        mode.waited = IQ24(2.0);
        mode.nearest_q48 = INT64_C(1) << 60;
        const iqfoc_ab_t i = {random_iq24(&seed, -1.4, 1.4), random_iq24(&seed, -1.4, 1.4)};
        iqfoc_pattern_control_aim(&control, cycle.i_ref, speed);
        const bool goes = iqfoc_pulse_mode_to_carrier(&mode, &control, &cycle, &set, i,
                                                      random_iq24(&seed, 0.0, 1.0), IQ24_ONE, edges, &duties);
        TEST_ASSERT_EQUAL_INT(may && n % 16 != 0, goes);
        delayed += may ? 0 : 1;
        if (!goes) {
            TEST_ASSERT_EQUAL_INT32(1, mode.level);
            continue;
        }
        taken++;
        const double period = (double)set.period_ticks / TICKS;
        const double moved = to_double(speed) * period;
        const double half = TWO_PI / 2.0 * moved;
        const double s1 = sin(half) / half;
        const double complex i_ref = of_dq(cycle.i_ref);
        const double complex now = (to_double(control.i_next.alpha) + I * to_double(control.i_next.beta)) *
                                   cexp(-I * TWO_PI * to_double(control.theta));
        const double complex flux = to_double(set.gains.x_d) * (now - i_ref / (s1 * s1)) -
                                    to_double(set.gains.emf) * (1.0 / (s1 * s1) - 1.0);
        const double complex u =
            steady(&control, &set.gains, i_ref, moved, s1) - flux / TWO_PI * cexp(-I * half);
        worst_add(&voltage, cycle.u_dq.d, creal(u));
        worst_add(&voltage, cycle.u_dq.q, cimag(u));
        TEST_ASSERT_EQUAL_INT32(0, mode.level);
        TEST_ASSERT_TRUE(cycle.config == &set && cycle.next == &set && cycle.offered == &set);
        TEST_ASSERT_EQUAL_HEX32(IQFOC_CYCLE_DUE_NOTHING, cycle.phase);
        /* The duties make that voltage in the middle of the period. */
        const double complex ab = u * cexp(I * (TWO_PI * to_double(control.theta) + half));
        if (duties.scale == IQ24_ONE) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, creal(ab), to_double(cycle.u_ab.alpha));
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, cimag(ab), to_double(cycle.u_ab.beta));
        }
        /* The next valley. */
        cycle.enabled = true;
        sample.theta = control.theta;
        sample.speed = to_iq24(moved);
        sample.u_dc = IQ24_ONE;
        (void)iqfoc_cycle_valley(&cycle, &sample, 0);
        iqfoc_pulse_mode_resume(&control, &cycle);
        const double complex later = steady(&control, &set.gains, i_ref, to_double(sample.speed), s1);
        worst_add(&next, cycle.u_dq.d, creal(later));
        worst_add(&next, cycle.u_dq.q, cimag(later));
        const iqfoc_dq_t none = cycle.i_ref;
        const iqfoc_dq_t asked =
            iqfoc_current_control_voltage(&cycle.control, &set.gains, none, none, cycle.rotor.speed);
        TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.d, asked.d);
        TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.q, asked.q);
    }
    TEST_ASSERT_TRUE(taken > DRAWS / 4 && delayed > DRAWS / 20);
    worst_check(&voltage, 25.0);
    worst_check(&next, 3.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_refused);
    RUN_TEST(test_level_over_speed);
    RUN_TEST(test_thresholds);
    RUN_TEST(test_to_pattern);
    RUN_TEST(test_to_carrier);
    return UNITY_END();
}
