/*
 * Edges in ticks (iqfoc/edges.h): patterns and duties against the same conversion in double, over drawn cycles.
 */
#include "pattern_reference.h"

#include "iqfoc/edges.h"

#define CYCLES 20000

static uint64_t seed = 21;

void setUp(void)
{
}

void tearDown(void)
{
}

static uint32_t drawn_period(void)
{
    const uint32_t periods[4] = {2, IQFOC_EDGES_TICKS_MAX, 17000, 3};
    const uint32_t n = (uint32_t)(random_bits(&seed) % 8);
    return n < 4 ? periods[n] : 2 + (uint32_t)(random_bits(&seed) % (n < 6 ? 40000 : 1u << 23));
}

/* Any edges that rise by 0 or more. */
static iqfoc_pattern_edges_t drawn_leg(void)
{
    iqfoc_pattern_edges_t p = {.level = random_bits(&seed) % 2 != 0 ? 1 : -1,
                               .edges = (int32_t)(random_bits(&seed) % (IQFOC_PATTERN_EDGES_MAX + 1))};
    iq24_t last = 0;
    for (int k = 0; k < p.edges; k++) {
        const iq24_t room = IQ24_ONE - 1 - last;
        const uint64_t width = random_bits(&seed) % 3 == 0 ? 2u : (uint64_t)room / 4 + 1;
        last += (iq24_t)(random_bits(&seed) % (width <= (uint64_t)room ? width : (uint64_t)room + 1));
        p.instant[k] = last;
    }
    return p;
}

/* The level of a leg just after a tick. */
static int level_after(const iqfoc_leg_edges_t *leg, uint32_t tick)
{
    int level = leg->level;
    for (int k = 0; k < leg->edges && leg->instant[k] <= tick; k++) {
        level = -level;
    }
    return level;
}

static void test_each_edge_is_at_its_tick(void)
{
    for (int n = 0; n < CYCLES; n++) {
        const uint32_t period = drawn_period();
        const iqfoc_pattern_edges_t asked[3] = {drawn_leg(), drawn_leg(), drawn_leg()};
        iqfoc_edges_t edges;
        iqfoc_edges_of_pattern(asked, period, &edges);
        TEST_ASSERT_EQUAL_UINT32(period, edges.period_ticks);
        for (int x = 0; x < 3; x++) {
            const iqfoc_leg_edges_t *leg = &edges.leg[x];
            TEST_ASSERT_EQUAL_INT32(asked[x].level, leg->level);
            TEST_ASSERT_TRUE(leg->edges <= asked[x].edges && (asked[x].edges - leg->edges) % 2 == 0);
            for (int k = 0; k < leg->edges; k++) {
                TEST_ASSERT_TRUE(leg->instant[k] < period &&
                                 (k == 0 || leg->instant[k] > leg->instant[k - 1]));
            }
            int level = asked[x].level;
            for (int k = 0; k < asked[x].edges; k++) {
                const double tick = floor(asked[x].instant[k] / 16777216.0 * period);
                const bool last =
                    k + 1 == asked[x].edges || floor(asked[x].instant[k + 1] / 16777216.0 * period) > tick;
                level = -level;
                TEST_ASSERT_TRUE(!last || level_after(leg, (uint32_t)tick) == level);
            }
        }
    }
}

/* From the last edge of a cycle to the first of the next, and within a cycle. */
static void test_least_time_in_ticks(void)
{
    for (int n = 0; n < 200; n++) {
        const uint32_t period = 1000 + (uint32_t)(random_bits(&seed) % 60000);
        const uint32_t least = 1 + (uint32_t)(random_bits(&seed) % (period / 10));
        iqfoc_pattern_modulator_t modulator;
        drawn_table(&seed);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK,
                              iqfoc_pattern_init(&modulator, &table, IQFOC_EDGES_LEAST(least, period)));
        int64_t last[3] = {-1000000, -1000000, -1000000};
        int level[3] = {-1, -1, -1};
        for (int64_t cycle = 0; cycle < 100; cycle++) {
            iqfoc_pattern_edges_t asked[3];
            iqfoc_edges_t edges;
            iqfoc_pattern_step(&modulator, (iq24_t)random_bits(&seed), random_iq24(&seed, -0.12, 0.12),
                               random_iq24(&seed, 0.3, 1.0), asked);
            iqfoc_edges_of_pattern(asked, period, &edges);
            for (int x = 0; x < 3; x++) {
                TEST_ASSERT_EQUAL_INT(level[x], edges.leg[x].level);
                for (int k = 0; k < edges.leg[x].edges; k++) {
                    const int64_t now = cycle * period + edges.leg[x].instant[k];
                    TEST_ASSERT_TRUE(now - last[x] >= least);
                    last[x] = now;
                    level[x] = -level[x];
                }
            }
        }
    }
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, IQFOC_EDGES_LEAST(17000, 17000));
    TEST_ASSERT_EQUAL_INT32(2, IQFOC_EDGES_LEAST(1, IQFOC_EDGES_TICKS_MAX));
    TEST_ASSERT_EQUAL_INT32(IQFOC_PATTERN_TIME_MAX, IQFOC_EDGES_LEAST(8 * 100, 100));
}

static void test_centred_pulses(void)
{
    for (int n = 0; n < CYCLES; n++) {
        const uint32_t period = drawn_period();
        const double share[3] = {uniform(&seed, -0.2, 1.2), uniform(&seed, 0.0, 1.0), n % 2};
        const iqfoc_abc_t high = {to_iq24(share[0]), to_iq24(share[1]), to_iq24(share[2])};
        const iq24_t asked[3] = {high.a, high.b, high.c};
        iqfoc_edges_t edges;
        iqfoc_edges_of_duties(high, period, &edges);
        TEST_ASSERT_EQUAL_UINT32(period, edges.period_ticks);
        for (int x = 0; x < 3; x++) {
            const iqfoc_leg_edges_t *leg = &edges.leg[x];
            const double ticks = fmin(fmax(asked[x] / 16777216.0, 0.0), 1.0) * period;
            const double made = leg->edges == 2   ? (double)leg->instant[1] - leg->instant[0]
                                : leg->level == 1 ? period
                                                  : 0.0;
            TEST_ASSERT_TRUE(leg->edges == 0 || (leg->edges == 2 && leg->level == -1));
            TEST_ASSERT_TRUE(fabs(made - ticks) <= 0.5);
            if (leg->edges == 2) {
                const double middle = 0.5 * ((double)leg->instant[0] + leg->instant[1]);
                TEST_ASSERT_TRUE(leg->instant[0] < leg->instant[1] &&
                                 leg->instant[1] < period + (leg->instant[0] == 0));
                TEST_ASSERT_TRUE(middle <= 0.5 * period && middle >= 0.5 * period - 0.5);
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_edge_is_at_its_tick);
    RUN_TEST(test_least_time_in_ticks);
    RUN_TEST(test_centred_pulses);
    return UNITY_END();
}
