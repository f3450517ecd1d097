/*
 * Faults in the interrupts, and a task's iqfoc_cycle_clear between them: the safe command goes out in the interrupt
 * that finds the fault, and a cleared drive starts with a valley. test_clear_boundaries.c (tests/target) interrupts
 * the clear at each of its instructions.
 */
#include "iqfoc/hal.h"

#include "cycle_fixture.h"

#include <unity.h>

struct iqfoc_hal {
    iqfoc_sample_t sample;
    iqfoc_command_t written;
    uint32_t writes;
};

static iqfoc_hal_t hal;
static const iqfoc_methods_t named = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                                      IQFOC_CONTROL_PI, IQFOC_MODULATION_PWM, false};

void iqfoc_hal_read_valley(iqfoc_hal_t *h, iqfoc_sample_t *sample)
{
    *sample = h->sample;
}

void iqfoc_hal_read_peak(iqfoc_hal_t *h, iqfoc_sample_t *sample)
{
    *sample = h->sample;
}

void iqfoc_hal_write(iqfoc_hal_t *h, const iqfoc_command_t *command)
{
    h->written = *command;
    h->writes++;
}

uint32_t iqfoc_hal_now(iqfoc_hal_t *h)
{
    return h->sample.time;
}

static void interrupt_valley(bool by_name, iq24_t i_a)
{
    hal.sample = sample_at(0);
    hal.sample.i.a = i_a;
    hal.sample.i.b = -i_a / 2;
    hal.sample.i.c = -i_a / 2;
    if (by_name) {
        iqfoc_isr_valley_by(named, &cycle, &hal);
    } else {
        iqfoc_isr_valley(&cycle, &hal);
    }
    ticks += PERIOD / 2;
}

static void interrupt_peak(bool by_name)
{
    hal.sample = sample_at(IQ24(0.5));
    if (by_name) {
        iqfoc_isr_peak_by(named, &cycle, &hal);
    } else {
        iqfoc_isr_peak(&cycle, &hal);
    }
    ticks += PERIOD / 2;
}

/* "If the valley or the peak trips, they write the safe command at once." A valley without one writes nothing. */
static void test_valley_that_trips_writes_at_once(void)
{
    for (int by_name = 0; by_name < 2; by_name++) {
        setUp();
        cycle.enabled = true;
        for (int k = 0; k < 3; k++) {
            hal.writes = 0;
            interrupt_valley(by_name, 0);
            TEST_ASSERT_EQUAL_UINT32(0, hal.writes);
            interrupt_peak(by_name);
            TEST_ASSERT_EQUAL_UINT32(1, hal.writes);
            TEST_ASSERT_TRUE(hal.written.gates);
        }
        hal.writes = 0;
        interrupt_valley(by_name, IQ24(5.0));
        TEST_ASSERT_TRUE(cycle.tripped);
        TEST_ASSERT_EQUAL_UINT32(1, hal.writes);
        TEST_ASSERT_FALSE(hal.written.gates);
        interrupt_peak(by_name);
        TEST_ASSERT_FALSE(hal.written.gates);
    }
}

/* A bit that does not trip is noted, and the command stays. */
static void test_valley_with_a_fault_that_does_not_trip(void)
{
    config.trips = 0;
    cycle.enabled = true;
    interrupt_valley(false, 0);
    interrupt_peak(false);
    hal.writes = 0;
    interrupt_valley(false, IQ24(5.0));
    TEST_ASSERT_EQUAL_HEX32(IQFOC_STATUS_OVERCURRENT, cycle.status);
    TEST_ASSERT_EQUAL_UINT32(0, hal.writes);
}

static void test_short_circuit_is_written_too(void)
{
    config.safe_state = IQFOC_SAFE_SHORT_CIRCUIT;
    cycle.enabled = true;
    interrupt_valley(false, 0);
    interrupt_peak(false);
    interrupt_valley(false, IQ24(5.0));
    TEST_ASSERT_TRUE(hal.written.gates);
    TEST_ASSERT_EQUAL_INT32(0, hal.written.duties.high.a | hal.written.duties.high.b |
                                   hal.written.duties.high.c);
}

/* "The output then stays safe until the first peak after a valley", wherever the clear came. */
static void test_cleared_drive_starts_with_a_valley(void)
{
    for (int after_valley = 0; after_valley < 2; after_valley++) {
        setUp();
        cycle.enabled = true;
        interrupt_valley(false, 0);
        interrupt_peak(false);
        interrupt_valley(false, IQ24(5.0));
        if (!after_valley) {
            interrupt_peak(false);
        }
        iqfoc_cycle_clear(&cycle);
        TEST_ASSERT_EQUAL_HEX32(0, cycle.status);
        TEST_ASSERT_FALSE(cycle.tripped);
        if (after_valley) {
            interrupt_peak(false);
            TEST_ASSERT_FALSE(hal.written.gates);
        }
        ticks += 9 * PERIOD; /* however long it was stopped */
        interrupt_valley(false, 0);
        interrupt_peak(false);
        TEST_ASSERT_TRUE(hal.written.gates);
        TEST_ASSERT_EQUAL_HEX32(0, cycle.status);
    }
}

/* Of a drive that runs only the status bits are cleared: its integrators and its output go on. */
static void test_clear_of_a_drive_that_runs(void)
{
    config.trips = 0;
    cycle.enabled = true;
    cycle.i_ref.q = IQ24(0.5);
    for (int k = 0; k < 5; k++) {
        interrupt_valley(false, 0);
        interrupt_peak(false);
    }
    interrupt_valley(false, IQ24(5.0));
    TEST_ASSERT_EQUAL_HEX32(IQFOC_STATUS_OVERCURRENT, cycle.status);
    const int64_t integral = cycle.control.integral_q;
    TEST_ASSERT_TRUE(integral != 0);
    iqfoc_cycle_clear(&cycle);
    TEST_ASSERT_EQUAL_HEX32(0, cycle.status);
    TEST_ASSERT_TRUE(integral == cycle.control.integral_q);
    interrupt_peak(false);
    TEST_ASSERT_TRUE(hal.written.gates);
    TEST_ASSERT_EQUAL_HEX32(0, cycle.status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
}

/* Times that a port should never give leave no undefined behaviour: the sanitizers' builds watch this. */
static void test_extreme_instants(void)
{
    static const iq24_t extremes[] = {INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX - 1, INT32_MAX};
    const size_t n = sizeof extremes / sizeof extremes[0];
    for (size_t k = 0; k < n * n; k++) {
        setUp();
        cycle.enabled = true;
        valley();
        iqfoc_sample_t s = sample_at(extremes[k % n]);
        const iqfoc_command_t c = iqfoc_cycle_peak(&cycle, &s, extremes[k / n], ticks);
        TEST_ASSERT_TRUE(c.duties.high.a >= 0 && c.duties.high.a <= IQ24_ONE);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_valley_that_trips_writes_at_once);
    RUN_TEST(test_valley_with_a_fault_that_does_not_trip);
    RUN_TEST(test_short_circuit_is_written_too);
    RUN_TEST(test_cleared_drive_starts_with_a_valley);
    RUN_TEST(test_clear_of_a_drive_that_runs);
    RUN_TEST(test_extreme_instants);
    return UNITY_END();
}
