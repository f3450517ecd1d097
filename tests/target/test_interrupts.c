/*
 * The carrier's interrupts on a target: that they fire, nest and overrun as on a chip, and that the cycle
 * sees it.
 *
 * Runs on an emulated board (port/emulated/board.h); the drive behind the HAL is port/emulated/small_drive.h.
 */
#include "board.h"
#include "board_clock.h"
#include "console.h"
#include "hal_emulated.h"

#include "unity.h"

#define CARRIER_HZ 5000
#define HALF_TICKS ((uint32_t)(BOARD_HZ / CARRIER_HZ / 2))

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static iqfoc_hal_t hal;

/* What the handlers are to do besides their work, and what they saw. */
static volatile uint32_t wait_before_valley; /* ticks */
static volatile uint32_t wait_after_valley;
static volatile uint32_t wait_before_peak;
static volatile bool in_valley;
static volatile uint32_t valleys;
static volatile uint32_t peaks;
static volatile uint32_t nested;

static void wait_ticks(uint32_t ticks)
{
    const uint32_t start = board_ticks();
    while (board_ticks() - start < ticks) {
    }
}

void board_valley_interrupt(void)
{
    in_valley = true;
    valleys++;
    wait_ticks(wait_before_valley);
    iqfoc_isr_valley(&cycle, &hal);
    cycle.i_ref = small_drive_reference(hal.drive.cycle);
    wait_ticks(wait_after_valley);
    in_valley = false;
}

void board_peak_interrupt(void)
{
    peaks++;
    nested += in_valley ? 1 : 0;
    wait_ticks(wait_before_peak);
    iqfoc_isr_peak(&cycle, &hal);
}

/* Lets the main program idle for a number of carrier periods. */
static void run_periods(uint32_t periods)
{
    wait_ticks(periods * 2 * HALF_TICKS);
}

void setUp(void)
{
    config = small_drive_config;
    config.period_ticks = 2 * HALF_TICKS;
    config.tolerance_ticks = HALF_TICKS / 10;
    config.stale_ticks = HALF_TICKS / 2;
    config.deadline_ticks = HALF_TICKS / 2;
    config.trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE;
    TEST_ASSERT_EQUAL_INT32(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
    cycle.enabled = true;
    wait_before_valley = 0;
    wait_after_valley = 0;
    wait_before_peak = 0;
    valleys = 0;
    peaks = 0;
    nested = 0;
    const uint32_t before = board_interrupts_off();
    hal_emulated_start(&hal, HALF_TICKS, board_carrier_start(HALF_TICKS));
    board_interrupts_restore(before);
}

void tearDown(void)
{
    board_carrier_stop();
}

static void test_valley_and_peak_alternate(void)
{
    run_periods(100);
    board_carrier_stop();
    TEST_ASSERT_UINT32_WITHIN(1, 100, valleys);
    TEST_ASSERT_UINT32_WITHIN(1, valleys, peaks);
    TEST_ASSERT_EQUAL_UINT32(0, nested);
    TEST_ASSERT_EQUAL_HEX32(0, cycle.status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    TEST_ASSERT_TRUE(hal.active.gates);
    TEST_ASSERT_FALSE(cycle.tripped);
}

/*
 * A valley whose handler goes on past the peak, its own work done: the peak comes in between and is in time.
 */
static void test_peak_nests_into_a_long_valley(void)
{
    wait_after_valley = HALF_TICKS + HALF_TICKS / 4;
    run_periods(50);
    board_carrier_stop();
    TEST_ASSERT_UINT32_WITHIN(2, 50, nested);
    TEST_ASSERT_UINT32_WITHIN(2, 50, valleys);
    TEST_ASSERT_EQUAL_HEX32(0, cycle.status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    TEST_ASSERT_TRUE(hal.active.gates);
}

/* A valley that gets to its work only after the peak was served: two peaks in a row, and a stale sample. */
static void test_late_valley_is_an_overrun(void)
{
    run_periods(10);
    wait_before_valley = HALF_TICKS + HALF_TICKS / 4;
    run_periods(4);
    board_carrier_stop();
    TEST_ASSERT_BITS_HIGH(IQFOC_STATUS_MISSED | IQFOC_STATUS_STALE, cycle.status);
    TEST_ASSERT_TRUE(cycle.tripped);
    TEST_ASSERT_FALSE(hal.active.gates);
}

/* A peak whose command comes too late to be trusted: the safe one goes out in its place. */
static void test_late_command_is_replaced_by_the_safe_one(void)
{
    config.trips = IQFOC_STATUS_LATE;
    run_periods(10);
    TEST_ASSERT_TRUE(hal.active.gates);
    wait_before_peak = HALF_TICKS * 3 / 4;
    run_periods(2);
    board_carrier_stop();
    TEST_ASSERT_BITS_HIGH(IQFOC_STATUS_LATE, cycle.status);
    TEST_ASSERT_FALSE(hal.active.gates);
    TEST_ASSERT_FALSE(hal.shadow.gates);
}

/* Interrupts held back for three periods: seen, safe, and after a clear the drive runs as before. */
static void test_lost_interrupts_trip_and_clear(void)
{
    run_periods(10);
    const uint32_t before = board_interrupts_off();
    run_periods(3);
    board_interrupts_restore(before);
    run_periods(2);
    TEST_ASSERT_BITS_HIGH(IQFOC_STATUS_MISSED, cycle.status);
    TEST_ASSERT_TRUE(cycle.tripped);
    TEST_ASSERT_FALSE(hal.active.gates);

    const uint32_t again = board_interrupts_off();
    iqfoc_cycle_clear(&cycle);
    board_interrupts_restore(again);
    run_periods(20);
    board_carrier_stop();
    TEST_ASSERT_EQUAL_HEX32(0, cycle.status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    TEST_ASSERT_TRUE(hal.active.gates);
}

/* The loop that the interrupts close does control: after a step the current arrives. */
static void test_current_follows_its_reference(void)
{
    run_periods(480);
    board_carrier_stop();
    const iqfoc_dq_t reference = small_drive_reference(hal.drive.cycle);
    TEST_ASSERT_INT32_WITHIN(IQ24(0.02), reference.d, cycle.i_dq.d);
    TEST_ASSERT_INT32_WITHIN(IQ24(0.02), reference.q, cycle.i_dq.q);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_valley_and_peak_alternate);
    RUN_TEST(test_peak_nests_into_a_long_valley);
    RUN_TEST(test_late_valley_is_an_overrun);
    RUN_TEST(test_late_command_is_replaced_by_the_safe_one);
    RUN_TEST(test_lost_interrupts_trip_and_clear);
    RUN_TEST(test_current_follows_its_reference);
    return UNITY_END();
}
