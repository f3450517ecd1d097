/* Restart: which faults latch, how long it waits, how often it tries, and when the tries return to 0. */
#include "bits.h"

#include "iqfoc/restart.h"

#include <stddef.h>

#define GENTLE UINT32_C(0x6)
#define HARD   UINT32_C(0x8)

static const iqfoc_restart_config_t usual = {GENTLE, 10, 3, 50};
static iqfoc_restart_t r;

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_restart_init(&r, &usual));
}

void tearDown(void)
{
}

static void expect(uint32_t faults, uint32_t cycles, iqfoc_restart_action_t want)
{
    for (uint32_t k = 0; k < cycles; k++) {
        TEST_ASSERT_EQUAL_INT(want, iqfoc_restart_step(&r, faults));
    }
}

static void test_waits_and_tries(void)
{
    expect(0, 100, IQFOC_RESTART_RUN);
    for (uint32_t n = 0; n < 3; n++) {
        expect(2, 1, IQFOC_RESTART_WAIT);
        expect(0, 9, IQFOC_RESTART_WAIT);
        expect(0, 1, IQFOC_RESTART_TRY);
        expect(0, 5, IQFOC_RESTART_RUN);
    }
    expect(4, 1, IQFOC_RESTART_LATCHED); /* three tries in a row did not help */
    expect(0, 1000, IQFOC_RESTART_LATCHED);
    TEST_ASSERT_EQUAL_UINT32(6, r.faults);
}

static void test_a_cause_that_stays_holds_the_try_back(void)
{
    expect(2, 200, IQFOC_RESTART_WAIT);
    expect(0, 9, IQFOC_RESTART_WAIT);
    expect(4, 1, IQFOC_RESTART_WAIT); /* another one while it waits: no try is used up */
    expect(0, 9, IQFOC_RESTART_WAIT);
    expect(0, 1, IQFOC_RESTART_TRY);
    TEST_ASSERT_EQUAL_UINT32(1, r.tried);
    expect(2, 1, IQFOC_RESTART_WAIT); /* at once again */
}

static void test_tries_are_forgotten(void)
{
    for (uint32_t n = 0; n < 20; n++) {
        expect(2, 1, IQFOC_RESTART_WAIT);
        expect(0, 9, IQFOC_RESTART_WAIT);
        expect(0, 1, IQFOC_RESTART_TRY);
        TEST_ASSERT_EQUAL_UINT32(1, r.tried);
        expect(0, 50, IQFOC_RESTART_RUN);
        TEST_ASSERT_EQUAL_UINT32(0, r.tried);
    }
}

static void test_hard_faults_latch(void)
{
    expect(HARD | 2, 1, IQFOC_RESTART_LATCHED);
    expect(0, 100, IQFOC_RESTART_LATCHED);
    expect(2, 1, IQFOC_RESTART_LATCHED);
    iqfoc_restart_acknowledge(&r);
    expect(0, 9, IQFOC_RESTART_WAIT);
    expect(HARD, 1, IQFOC_RESTART_LATCHED); /* still there */
    iqfoc_restart_acknowledge(&r);
    TEST_ASSERT_EQUAL_UINT32(0, r.faults);
    expect(0, 9, IQFOC_RESTART_WAIT);
    expect(0, 1, IQFOC_RESTART_TRY);
    iqfoc_restart_acknowledge(&r); /* not latched: nothing happens */
    TEST_ASSERT_EQUAL_UINT32(1, r.tried);
    expect(0, 1, IQFOC_RESTART_RUN);
}

static void test_no_tries_at_all(void)
{
    const iqfoc_restart_config_t none = {UINT32_MAX, 1, 0, 1};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_restart_init(&r, &none));
    expect(2, 1, IQFOC_RESTART_LATCHED);
}

static void test_counters_stop_at_their_ends(void)
{
    const iqfoc_restart_config_t longest = {UINT32_MAX, 1, UINT32_MAX, UINT32_C(1) << 31};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_restart_init(&r, &longest));
    r.quiet = UINT32_MAX;
    expect(0, 2, IQFOC_RESTART_RUN);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, r.quiet);
    r.tried = UINT32_MAX - 1;
    expect(1, 1, IQFOC_RESTART_WAIT);
    expect(0, 1, IQFOC_RESTART_TRY);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, r.tried);
    expect(1, 1, IQFOC_RESTART_LATCHED);
    r.action = IQFOC_RESTART_WAIT;
    expect(0, 1, IQFOC_RESTART_TRY);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, r.tried);
}

static void refused(uint32_t wait, uint32_t forget, iqfoc_error_t want)
{
    const iqfoc_restart_config_t config = {0, wait, 0, forget};
    iqfoc_restart_t fresh = {.tried = 9};
    TEST_ASSERT_EQUAL_INT(want, iqfoc_restart_init(&fresh, &config));
    TEST_ASSERT_EQUAL_UINT32(want == IQFOC_OK ? 0 : 9, fresh.tried);
}

static void test_limits(void)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_restart_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_restart_init(&r, NULL));
    refused(1, 1, IQFOC_OK);
    refused(UINT32_C(1) << 31, UINT32_C(1) << 31, IQFOC_OK);
    refused(0, 1, IQFOC_ERROR_RESTART);
    refused(1, 0, IQFOC_ERROR_RESTART);
    refused((UINT32_C(1) << 31) + 1, 1, IQFOC_ERROR_RESTART);
    refused(1, (UINT32_C(1) << 31) + 1, IQFOC_ERROR_RESTART);
}

/* Any faults at any time, acknowledged now and then, against the rules of the header. */
static void test_any_faults(void)
{
    uint64_t seed = 1;
    for (int run = 0; run < 300; run++) {
        const iqfoc_restart_config_t c = {
            (uint32_t)bits_random(&seed, 0, 7), (uint32_t)bits_random(&seed, 1, 6),
            (uint32_t)bits_random(&seed, 0, 3), (uint32_t)bits_random(&seed, 1, 9)};
        iqfoc_restart_action_t action = IQFOC_RESTART_RUN;
        uint32_t all = 0;
        uint32_t quiet = 0;
        uint32_t tried = 0;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_restart_init(&r, &c));
        TEST_ASSERT_EQUAL_UINT32(0, r.faults | r.quiet | r.tried);
        for (int n = 0; n < 300; n++) {
            const uint32_t faults = bits_random(&seed, 0, 5) == 0 ? (uint32_t)bits_random(&seed, 1, 7) : 0;
            const bool running = action == IQFOC_RESTART_RUN || action == IQFOC_RESTART_TRY;
            quiet = faults != 0 ? 0 : quiet + 1;
            all |= faults;
            if (faults != 0) {
                const bool hard = (faults & ~c.may_restart) != 0 || (running && tried >= c.tries);
                action = hard || action == IQFOC_RESTART_LATCHED ? IQFOC_RESTART_LATCHED : IQFOC_RESTART_WAIT;
            } else if (running) {
                tried = quiet >= c.forget_cycles ? 0 : tried;
                action = IQFOC_RESTART_RUN;
            } else if (action == IQFOC_RESTART_WAIT && quiet == c.wait_cycles) {
                quiet = 0;
                tried++;
                action = IQFOC_RESTART_TRY;
            }
            TEST_ASSERT_EQUAL_INT(action, iqfoc_restart_step(&r, faults));
            if (bits_random(&seed, 0, 20) == 0) {
                const bool latched = action == IQFOC_RESTART_LATCHED;
                iqfoc_restart_acknowledge(&r);
                action = latched ? IQFOC_RESTART_WAIT : action;
                all = latched ? 0 : all;
                quiet = latched ? 0 : quiet;
                tried = latched ? 0 : tried;
            }
            TEST_ASSERT_EQUAL_UINT32(all, r.faults);
            TEST_ASSERT_EQUAL_UINT32(quiet, r.quiet);
            TEST_ASSERT_EQUAL_UINT32(tried, r.tried);
        }
    }
}

/* Both counts stop at their ends. */
static void test_counts_end(void)
{
    const iqfoc_restart_config_t c = {GENTLE, 1, UINT32_MAX, UINT32_C(1) << 31};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_restart_init(&r, &c));
    for (uint32_t off = 0; off < 2; off++) {
        r.tried = 0;
        expect(2, 1, IQFOC_RESTART_WAIT);
        r.tried = UINT32_MAX - off;
        expect(0, 1, IQFOC_RESTART_TRY);
        TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, r.tried);
    }
    expect(2, 1, IQFOC_RESTART_LATCHED);
    r.quiet = UINT32_MAX - 1;
    expect(0, 3, IQFOC_RESTART_LATCHED);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, r.quiet);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_any_faults);
    RUN_TEST(test_counts_end);
    RUN_TEST(test_waits_and_tries);
    RUN_TEST(test_a_cause_that_stays_holds_the_try_back);
    RUN_TEST(test_tries_are_forgotten);
    RUN_TEST(test_hard_faults_latch);
    RUN_TEST(test_no_tries_at_all);
    RUN_TEST(test_counters_stop_at_their_ends);
    RUN_TEST(test_limits);
    return UNITY_END();
}
