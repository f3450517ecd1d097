/*
 * Modulator by pulse pattern against the pattern's definition in double: the edges of all four quarters by the two
 * symmetries, sorted; the fundamental by integration; the least time by the times of all edges.
 */
#include "pattern_reference.h"

#include <complex.h>

#define SEED      UINT64_C(31415926)
#define PI_OVER_4 0.78539816339744830962

enum { DRAWS = 200000, CYCLES = 1000000 };

void setUp(void)
{
}

void tearDown(void)
{
}

static iqfoc_pattern_modulator_t modulator_of(double least)
{
    iqfoc_pattern_modulator_t m;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_init(&m, &table, to_iq24(least)));
    return m;
}

/* ---- Edges ---- */

/* Compares a leg's cycle; false if an edge is too near to the start, the end or another edge to say on which side it is. */
static bool compared(const pattern *p, double x, double speed, const iqfoc_pattern_edges_t *got, worst *time)
{
    double distance[EDGES];
    const double movement = fabs(speed);
    const double unsure = 3.0 / 16777216.0;
    const int all = distances(p, x, speed < 0.0 ? -1.0 : 1.0, distance);
    double before = all > 0 ? distance[all - 1] - 1.0 : -1.0;
    int count = 0;
    for (int k = 0; k < all; k++) {
        if (distance[k] - before < unsure || distance[k] < unsure || fabs(distance[k] - movement) < unsure) {
            return false;
        }
        before = distance[k];
        count += distance[k] < movement;
    }
    if (distance[all - 1] > 1.0 - unsure) {
        return false;
    }
    TEST_ASSERT_EQUAL_INT32(count, got->edges);
    TEST_ASSERT_EQUAL_INT32(level_at(p, x + (speed < 0.0 ? -0.5 : 0.5) * fmin(distance[0], movement)),
                            got->level);
    double high = got->level > 0 ? 1.0 : 0.0;
    for (int k = 0; k < count; k++) {
        const double lsb = fabs(got->instant[k] - 16777216.0 * distance[k] / movement);
        /* Beyond 0.5 LSB, as a multiple of one LSB of angle. */
        time->lsb = fmax(time->lsb, (lsb - 0.5) * movement);
        const double up = (k % 2 == 0) == (got->level > 0) ? -1.0 : 1.0;
        high += up * (1.0 - to_double(got->instant[k]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, high, to_double(got->high));
    return true;
}

static void test_edges_are_those_of_the_pattern(void)
{
    uint64_t seed = SEED;
    worst time = {"an edge's time beyond 0.5 LSB, times the movement in turns", 0.0};
    int64_t edges = 0;
    int sure = 0;
    for (int n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        if (n % 100 == 0) {
            drawn_table(&seed);
        }
        iqfoc_pattern_modulator_t m = modulator_of(0.0);
        const iq24_t index = random_iq24(&seed, 0.2, 1.1);
        const iq24_t angle = iq24_from_bits((uint32_t)random_bits(&seed));
        const double speed = exp(uniform(&seed, log(1e-3), log(0.125))) * (n % 2 == 0 ? 1.0 : -1.0);
        const iq24_t movement = to_iq24(speed);
        pattern p;
        if (!pattern_at(to_double(index), &p)) {
            continue;
        }
        for (int leg = 0; leg < 3; leg++) {
            const double x = fraction(angle / 16777216.0 + 0.25 - leg / 3.0);
            m.leg[leg].level = level_at(&p, x + (speed < 0.0 ? -1e-8 : 1e-8));
        }
        iqfoc_pattern_edges_t got[3];
        iqfoc_pattern_step(&m, angle, movement, index, got);
        for (int leg = 0; leg < 3; leg++) {
            const double x = fraction(angle / 16777216.0 + 0.25 - leg / 3.0);
            if (compared(&p, x, to_double(movement), &got[leg], &time)) {
                sure++;
                edges += got[leg].edges;
            }
        }
    }
    printf("%s: %.3f LSB, of %d legs and %.0f edges\n", time.what, time.lsb, sure, (double)edges);
    TEST_ASSERT_TRUE(time.lsb <= 1.5);
    TEST_ASSERT_TRUE(sure > DRAWS / IQFOC_TEST_STRIDE);
}

/* Integral of e^(-j 2 pi x) over a turn of leg a, in `cycles` cycles from an angle. */
static double complex fundamental(iqfoc_pattern_modulator_t *m, int cycles, int sense, iq24_t index, int leg)
{
    double complex sum = 0.0;
    const iq24_t speed = sense * (IQ24_ONE / cycles);
    for (int n = 0; n < 2 * cycles; n++) {
        iqfoc_pattern_edges_t got[3];
        iqfoc_pattern_step(m, n * speed, speed, index, got);
        if (n < cycles) {
            continue; /* the first turn starts with a level that may be another one */
        }
        double from = n;
        int level = got[leg].level;
        for (int k = 0; k <= got[leg].edges; k++) {
            const double to = n + (k < got[leg].edges ? to_double(got[leg].instant[k]) : 1.0);
            const double w = sense * TWO_PI / cycles;
            sum += level * (cexp(-I * w * to) - cexp(-I * w * from)) / (-I * w);
            from = to;
            level = -level;
        }
    }
    return 2.0 * sum / cycles;
}

/* The amplitude is the index times 4/pi, on the voltage's angle, in each leg, both families, forward and backward. */
static void test_fundamental_is_the_index(void)
{
    for (int family = 0; family < 2; family++) {
        three_pulses(family == 0 ? 1 : -1);
        for (int k = 0; k < 40; k++) {
            const int leg = k % 3;
            const double index = 0.3 + 0.01 * (17 * k % ROWS);
            iqfoc_pattern_modulator_t m = modulator_of(0.0);
            const double complex got =
                fundamental(&m, 16 << (k % 3), k % 2 == 0 ? 1 : -1, to_iq24(index), leg) * PI_OVER_4;
            const double complex want = index * cexp(-I * TWO_PI / 3.0 * leg);
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, creal(want), creal(got));
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, cimag(want), cimag(got));
        }
    }
}

/* ---- Least times ---- */

/* Angle, movement, index and link jump: no time between two edges is below the least one, and the levels are continuous. */
static void test_no_time_is_below_the_least(void)
{
    uint64_t seed = SEED;
    edges_so_far so_far = no_edges_yet;
    drawn_table(&seed);
    const iq24_t least = IQ24(0.06);
    iqfoc_pattern_modulator_t m = modulator_of(0.06);
    iq24_t angle = 0;
    iq24_t speed = IQ24(0.03);
    iq24_t index = IQ24(0.5);
    for (int n = 0; n < CYCLES / IQFOC_TEST_STRIDE; n++) {
        const uint64_t event = random_bits(&seed) % 16;
        if (event == 0) {
            speed = random_iq24(&seed, -0.2, 0.2);
        } else if (event == 1) {
            angle = random_iq24(&seed, -2.0, 2.0);
        } else if (event < 6) {
            index = random_iq24(&seed, 0.0, 1.2);
        }
        iqfoc_pattern_edges_t got[3];
        iqfoc_pattern_step(&m, angle, speed, index, got);
        angle = iq24_add_wrap(angle, speed);
        check_edges(got, n, &so_far);
    }
    printf("shortest time: %.0f LSB above the least, in %d cycles; most edges %d\n",
           (double)(so_far.shortest - least), CYCLES / IQFOC_TEST_STRIDE, so_far.most);
    TEST_ASSERT_TRUE(so_far.shortest >= least);
}

/* Without a least time, seven angles near 0: 15 edges in a cycle of an eighth of a turn, and one that is due from before. */
static void test_most_edges(void)
{
    three_pulses(1);
    iqfoc_pattern_row_t one = {1, 0, {0}};
    for (int k = 0; k < IQFOC_PATTERN_ANGLES_MAX; k++) {
        one.angle[k] = IQ24(0.001) * (k + 1);
    }
    const iqfoc_pattern_t small = {&one, 1, IQFOC_PATTERN_ANGLES_MAX, IQ24(0.3), IQ24_ONE};
    for (int late = 0; late < 2; late++) {
        for (int sense = -1; sense <= 1; sense += 2) {
            iqfoc_pattern_modulator_t m;
            iqfoc_pattern_edges_t got[3];
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_init(&m, &small, 0));
            /* Leg a from 1/16 turn before its angle 1/2: low forward, high backward. */
            m.leg[0].level = (late == 0 ? -1 : 1) * sense;
            iqfoc_pattern_step(&m, IQ24(0.25) - sense * IQ24(0.0625), sense > 0 ? INT32_MAX : INT32_MIN, 0,
                               got);
            TEST_ASSERT_EQUAL_INT32(15 + late, got[0].edges);
            TEST_ASSERT_EQUAL_INT32(0, late * got[0].instant[0]);
        }
    }
}

/* One angle at 0.01 turns, 0.02 turns a cycle: a short pulse is lengthened, a change that is taken back is dropped. */
static void test_early_edges_are_delayed_or_dropped(void)
{
    three_pulses(1);
    rows[0].angle[0] = IQ24(0.01);
    iqfoc_pattern_modulator_t m = modulator_of(0.75);
    iqfoc_pattern_edges_t got[3];
    /* Leg a from 0.005 turns before angle 0: up after 0.25 cycles, down after 0.75, which is too early: at 1.0. */
    m.leg[0].since = IQFOC_PATTERN_TIME_MAX;
    iqfoc_pattern_step(&m, IQ24(0.75) - IQ24(0.005), IQ24(0.02), 0, got);
    TEST_ASSERT_EQUAL_INT32(1, got[0].edges);
    TEST_ASSERT_INT32_WITHIN(100, IQ24(0.25), got[0].instant[0]);
    TEST_ASSERT_INT32_WITHIN(100, IQ24(0.75), m.leg[0].since);
    iqfoc_pattern_step(&m, IQ24(0.75) + IQ24(0.015), IQ24(0.02), 0, got);
    TEST_ASSERT_EQUAL_INT32(1, got[0].edges);
    TEST_ASSERT_INT32_WITHIN(100, 0, got[0].instant[0]);
    /* The last edge 0.3 cycles before the start: up not before 0.45; down at 0.75, and so no pulse is shorter than 0.75. */
    m.leg[0].level = -1;
    m.leg[0].since = IQ24(0.3);
    iqfoc_pattern_step(&m, IQ24(0.75) - IQ24(0.005), IQ24(0.02), 0, got);
    TEST_ASSERT_EQUAL_INT32(1, got[0].edges);
    TEST_ASSERT_INT32_WITHIN(1, IQ24(0.45), got[0].instant[0]);
    /* The last edge at the start: up not before 0.75, where the pattern takes it back. */
    m.leg[0].level = -1;
    m.leg[0].since = 0;
    iqfoc_pattern_step(&m, IQ24(0.75) - IQ24(0.0051), IQ24(0.02), 0, got);
    const int32_t edges = got[0].edges;
    TEST_ASSERT_EQUAL_INT32(1, edges); /* 0.755: up at 0.75, down later */
    m.leg[0].level = -1;
    m.leg[0].since = 0;
    iqfoc_pattern_step(&m, IQ24(0.75) - IQ24(0.0049), IQ24(0.02), 0, got);
    TEST_ASSERT_EQUAL_INT32(0, got[0].edges);
    TEST_ASSERT_EQUAL_INT32(0, got[0].high);
}

/* ---- Index ---- */

static void test_rows_that_jump_are_not_mixed(void)
{
    three_pulses(1);
    rows[20].joined = 0;
    rows[21].start = -1;
    rows[21].joined = 0;
    rows[19].joined = 0;
    rows[21].angle[0] = IQ24(0.05);
    iqfoc_pattern_modulator_t m = modulator_of(0.0);
    /* Index in rows, and the row that is taken. */
    static const struct {
        double place;
        int row;
    } walk[] = {{20.0, 20}, {20.7, 20}, {20.8, 21}, {20.3, 21}, {20.2, 20},
                {20.5, 20}, {21.0, 21}, {20.5, 21}, {-5.0, 0}};
    for (size_t k = 0; k < sizeof walk / sizeof walk[0]; k++) {
        const iqfoc_pattern_shape_t got =
            iqfoc_pattern_shape_at(&m, to_iq24(0.3 + 0.01 * walk[k].place + 1e-6));
        TEST_ASSERT_EQUAL_INT32(rows[walk[k].row].start, got.start);
        TEST_ASSERT_INT32_WITHIN(walk[k].row == 0 ? 0 : 200, rows[walk[k].row].angle[0], got.angle[0]);
    }
    const iqfoc_pattern_shape_t top = iqfoc_pattern_shape_at(&m, IQ24_MAX);
    TEST_ASSERT_EQUAL_INT32(rows[ROWS - 1].angle[0], top.angle[0]);
    const iqfoc_pattern_shape_t bottom = iqfoc_pattern_shape_at(&m, IQ24_MIN);
    TEST_ASSERT_EQUAL_INT32(rows[0].angle[0], bottom.angle[0]);
}

static void test_index_of_a_voltage(void)
{
    uint64_t seed = SEED;
    worst index = {"index", 0.0};
    for (int n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const iq24_t inverse = random_iq24(&seed, 1e-3, 2.0);
        const iq24_t u = random_iq24(&seed, 0.0, fmin(32.0, 2.0 / PI_OVER_4 / 4.0 / to_double(inverse)));
        const double want = 2.0 * PI_OVER_4 * to_double(u) * to_double(inverse);
        index.lsb = fmax(index.lsb, fabs(iqfoc_pattern_index(u, inverse) - 16777216.0 * want));
    }
    printf("%s: %.3f LSB\n", index.what, index.lsb);
    TEST_ASSERT_TRUE(index.lsb <= 1.7);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 128.0 * PI_OVER_4, to_double(iqfoc_pattern_index(IQ24(32.0), IQ24(2.0))));
}

/* ---- Set-up ---- */

static void refused(void)
{
    iqfoc_pattern_modulator_t m = {NULL, 7, 8, {{0}}};
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PATTERN, iqfoc_pattern_init(&m, &table, 0));
    TEST_ASSERT_TRUE(m.table == NULL && m.least == 7 && m.row == 8);
}

#define REFUSED(field, bad, good)                                                                            \
    do {                                                                                                     \
        (field) = (bad);                                                                                     \
        refused();                                                                                           \
        (field) = (good);                                                                                    \
        (void)modulator_of(0.0);                                                                             \
    } while (0)

static void test_bad_tables_are_refused(void)
{
    iqfoc_pattern_modulator_t m;
    three_pulses(1);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pattern_init(NULL, &table, 0));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pattern_init(&m, NULL, 0));
    REFUSED(table.rows, 0, ROWS);
    REFUSED(table.rows, IQFOC_PATTERN_ROWS_MAX + 1, ROWS);
    REFUSED(table.angles, -1, 0);
    REFUSED(table.angles, IQFOC_PATTERN_ANGLES_MAX + 1, 1);
    REFUSED(table.index_low, -1, 0);
    REFUSED(table.index_low, IQ24_ONE + 1, IQ24(0.3));
    REFUSED(table.rows_per_index, IQ24_ONE - 1, IQ24_ONE);
    REFUSED(table.rows_per_index, IQ24(100.0) + 1, IQ24(100.0));
    REFUSED(rows[3].start, 0, 1);
    REFUSED(rows[3].start, -1, 1);
    REFUSED(rows[3].joined, 2, 1);
    REFUSED(rows[3].angle[0], -1, 0);
    REFUSED(rows[3].angle[0], IQ24(0.25) + 1, IQ24(0.25));
    REFUSED(rows[ROWS - 1].joined, 1, 0);
    table.angles = 2;
    refused(); /* the second angle is 0, below the first */
    table.angles = 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PATTERN, iqfoc_pattern_init(&m, &table, -1));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_PATTERN, iqfoc_pattern_init(&m, &table, IQFOC_PATTERN_TIME_MAX + 1));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_pattern_init(&m, &table, IQFOC_PATTERN_TIME_MAX));
    const iqfoc_pattern_t none = {NULL, 1, 1, 0, IQ24_ONE};
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_pattern_init(&m, &none, 0));
}

/* At standstill no edge but the one that brings the level to the pattern's. */
static void test_standstill(void)
{
    three_pulses(1);
    iqfoc_pattern_modulator_t m = modulator_of(0.1);
    iqfoc_pattern_edges_t got[3];
    for (int n = 0; n < 3; n++) {
        iqfoc_pattern_step(&m, IQ24(-0.25) + 100, 0, 0, got);
        TEST_ASSERT_EQUAL_INT32(n == 0 ? 1 : 0, got[0].edges);
        TEST_ASSERT_EQUAL_INT32(IQ24_ONE, got[0].high);
    }
    for (int n = 0; n < 20; n++) {
        iqfoc_pattern_step(&m, IQ24(-0.25) + 100, 0, 0, got);
    }
    TEST_ASSERT_EQUAL_INT32(IQFOC_PATTERN_TIME_MAX, m.leg[0].since);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_edges_are_those_of_the_pattern);
    RUN_TEST(test_fundamental_is_the_index);
    RUN_TEST(test_no_time_is_below_the_least);
    RUN_TEST(test_most_edges);
    RUN_TEST(test_early_edges_are_delayed_or_dropped);
    RUN_TEST(test_rows_that_jump_are_not_mixed);
    RUN_TEST(test_index_of_a_voltage);
    RUN_TEST(test_bad_tables_are_refused);
    RUN_TEST(test_standstill);
    return UNITY_END();
}
