/*
 * iqfoc_hal_write_edges of the emulated boards, on the host with a clock that the test sets: what the drive gets in each half period is
 * what was asked, to a tick, and at no other time.
 */
#include "hal_emulated.h"
#include "set_board.h"

#include "unity.h"

#define HALF   1250u
#define PERIOD (2u * HALF)
#define CYCLES 2000

static iqfoc_hal_t hal;
static uint32_t passed_high[3]; /* ticks in the last half period */
static bool passed_gates;

/* ---- The drive, in place of the small one ---- */

void small_drive_start(small_drive_t *drive)
{
    drive->cycle = 0;
}

void small_drive_begin_cycle(small_drive_t *drive)
{
    drive->cycle++;
}

iqfoc_sample_t small_drive_sample(const small_drive_t *drive)
{
    const iqfoc_sample_t sample = {.time = drive->cycle};
    return sample;
}

void small_drive_advance_half(small_drive_t *drive, const iqfoc_command_t *command)
{
    const iq24_t share[3] = {command->duties.high.a, command->duties.high.b, command->duties.high.c};
    (void)drive;
    for (int x = 0; x < 3; x++) {
        passed_high[x] = (uint32_t)(((uint64_t)(uint32_t)share[x] * HALF + (1u << 23)) >> 24);
    }
    passed_gates = command->gates;
}

/* ---- The reference: level by level ---- */

static int level_at(const iqfoc_leg_edges_t *leg, uint32_t tick)
{
    int level = leg->level;
    for (int k = 0; k < leg->edges && leg->instant[k] <= tick; k++) {
        level = -level;
    }
    return level;
}

static void let_half_pass(void)
{
    iqfoc_sample_t sample;
    clock_ticks += HALF;
    iqfoc_hal_read_valley(&hal, &sample);
}

/* The next half period, which begins at tick `from` of the cycle. */
static void expect_half(const iqfoc_edges_t *edges, uint32_t from)
{
    let_half_pass();
    TEST_ASSERT_TRUE(passed_gates);
    for (int x = 0; x < 3; x++) {
        uint32_t high = 0;
        for (uint32_t t = from; t < from + HALF; t++) {
            high += level_at(&edges->leg[x], t) > 0 ? 1 : 0;
        }
        TEST_ASSERT_EQUAL_UINT32(high, passed_high[x]);
    }
}

static void expect_cycle(const iqfoc_edges_t *edges)
{
    expect_half(edges, 0);
    expect_half(edges, HALF);
}

/* Writes in the first half of a cycle, whose second half is still that of `acting`. */
static void write_and_expect(const iqfoc_edges_t *acting, const iqfoc_edges_t *edges)
{
    expect_half(acting, 0);
    iqfoc_hal_write_edges(&hal, edges);
    expect_half(acting, HALF);
}

static const iqfoc_edges_t low = {PERIOD, {{-1, 0, {0}}, {-1, 0, {0}}, {-1, 0, {0}}}};

void setUp(void)
{
    clock_ticks = 0;
    hal_emulated_start(&hal, HALF, 0);
    iqfoc_hal_write_edges(&hal, &low);
    let_half_pass();
    let_half_pass(); /* a cycle begins, with these */
}

void tearDown(void)
{
}

static uint32_t state = 5;

static uint32_t drawn(uint32_t below)
{
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
}

/* None, one, or several edges a leg; the first and the last tick among them. */
static void test_edges_are_those_asked(void)
{
    iqfoc_edges_t acting = low;
    for (int n = 0; n < CYCLES; n++) {
        iqfoc_edges_t next = {.period_ticks = PERIOD};
        for (int x = 0; x < 3; x++) {
            iqfoc_leg_edges_t *leg = &next.leg[x];
            const int32_t most = drawn(3) == 0 ? IQFOC_PATTERN_EDGES_MAX : (int32_t)drawn(3);
            uint32_t at = drawn(3) == 0 ? 0 : drawn(PERIOD);
            leg->level = level_at(&acting.leg[x], PERIOD);
            for (int k = 0; k < most && at < PERIOD; k++) {
                leg->instant[leg->edges++] = at;
                at += drawn(4) == 0 ? PERIOD - 1 - at + (at == PERIOD - 1) : 1 + drawn(PERIOD / 8);
            }
        }
        write_and_expect(&acting, &next);
        acting = next;
    }
}

/* Another level than the last one at the valley changes there. */
static void test_level_changes_at_the_valley(void)
{
    const iqfoc_edges_t high = {PERIOD, {{1, 0, {0}}, {1, 1, {0}}, {1, 1, {PERIOD - 1}}}};
    write_and_expect(&low, &high);
    expect_cycle(&high);
}

static void test_nothing_written_keeps_the_levels(void)
{
    const iqfoc_edges_t last = {PERIOD, {{-1, 3, {7, 20, 1900}}, {-1, 0, {0}}, {1, 2, {0, 1}}}};
    const iqfoc_edges_t held = {PERIOD, {{1, 0, {0}}, {-1, 0, {0}}, {1, 0, {0}}}};
    write_and_expect(&low, &last);
    expect_cycle(&last);
    for (int n = 0; n < 3; n++) {
        expect_cycle(&held);
    }
}

static void test_safe_output_acts_at_once_and_drops_edges(void)
{
    const iqfoc_edges_t high = {PERIOD, {{1, 0, {0}}, {1, 0, {0}}, {1, 0, {0}}}};
    const iqfoc_command_t off = {{{0, 0, 0}, IQ24_ONE}, false};
    write_and_expect(&low, &high);
    expect_half(&high, 0);
    iqfoc_hal_write_edges(&hal, &high);
    iqfoc_hal_write(&hal, &off);
    for (int n = 0; n < 5; n++) {
        let_half_pass();
        TEST_ASSERT_FALSE(passed_gates);
    }
    /* On again, with edges and with duties. */
    iqfoc_hal_write_edges(&hal, &high);
    let_half_pass();
    let_half_pass();
    expect_half(&high, 0);
    const iqfoc_command_t duties = {{{IQ24(0.5), 0, IQ24_ONE}, IQ24_ONE}, true};
    iqfoc_hal_write(&hal, &duties);
    expect_half(&high, HALF);
    let_half_pass();
    TEST_ASSERT_EQUAL_UINT32(HALF / 2, passed_high[0]);
    TEST_ASSERT_EQUAL_UINT32(HALF, passed_high[2]);
}

/* The boards' carrier has one length. */
static void test_another_length_turns_the_gates_off(void)
{
    const iqfoc_edges_t other = {PERIOD + 1, {{1, 0, {0}}, {1, 0, {0}}, {1, 0, {0}}}};
    expect_half(&low, 0);
    iqfoc_hal_write_edges(&hal, &other);
    let_half_pass();
    TEST_ASSERT_FALSE(passed_gates);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_edges_are_those_asked);
    RUN_TEST(test_level_changes_at_the_valley);
    RUN_TEST(test_nothing_written_keeps_the_levels);
    RUN_TEST(test_safe_output_acts_at_once_and_drops_edges);
    RUN_TEST(test_another_length_turns_the_gates_off);
    return UNITY_END();
}
