/*
 * Numbers that leave the firmware: errors of set-up functions, bits of a status and of sensors, limits that a header publishes, and channel
 * numbers of the recorder's line. Logs and hosts store them, so no number is ever reused.
 */
#include "iqfoc/adapt.h"
#include "iqfoc/iqfoc.h"
#include "iqfoc/pattern_control.h"

#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_errors(void)
{
    static const int wanted[][2] = {
        {IQFOC_OK, 0},
        {IQFOC_ERROR_NULL, -1},
        {IQFOC_ERROR_PREDICTOR, -2},
        {IQFOC_ERROR_GAINS, -3},
        {IQFOC_ERROR_SPAN, -4},
        {IQFOC_ERROR_CURRENT_LIMIT, -5},
        {IQFOC_ERROR_CHOICE, -6},
        {IQFOC_ERROR_TIMES, -7},
        {IQFOC_ERROR_METHODS, -8},
        {IQFOC_ERROR_CURRENT_SENSOR, -10},
        {IQFOC_ERROR_ANGLE, -11},
        {IQFOC_ERROR_VOLTAGE, -12},
        {IQFOC_ERROR_SATURATION, -13},
        {IQFOC_ERROR_INDUCTANCE_D, -20},
        {IQFOC_ERROR_INDUCTANCE_Q, -21},
        {IQFOC_ERROR_RESISTANCE, -22},
        {IQFOC_ERROR_FLUX, -23},
        {IQFOC_ERROR_FLUX_PART, -24},
        {IQFOC_ERROR_SALIENCY, -25},
        {IQFOC_ERROR_WEAKENING, -26},
        {IQFOC_ERROR_CHANNELS, -30},
        {IQFOC_ERROR_MEMORY, -31},
        {IQFOC_ERROR_PERIOD, -32},
        {IQFOC_ERROR_TRIGGER, -33},
        {IQFOC_ERROR_OFFSET_LIMITS, -40},
        {IQFOC_ERROR_START, -41},
        {IQFOC_ERROR_TRACKER, -42},
        {IQFOC_ERROR_ENCODER, -43},
        {IQFOC_ERROR_RESOLVER, -44},
        {IQFOC_ERROR_HALLS, -45},
        {IQFOC_ERROR_SHUNTS, -46},
        {IQFOC_ERROR_PATTERN, -50},
        {IQFOC_ERROR_RESTART, -47},
        {IQFOC_ERROR_SUPERVISION, -48},
        {IQFOC_ERROR_SPEED_CONTROL, -51},
        {IQFOC_ERROR_WATCH_ANGLE, -53},
        {IQFOC_ERROR_COMMISSION, -55},
        {IQFOC_ERROR_OBSERVER, -49},
    };
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        TEST_ASSERT_EQUAL_INT(wanted[k][1], wanted[k][0]);
    }
}

static void test_columns(void)
{
    static const int in_order[] = {
        IQFOC_RECORDER_I_A,     IQFOC_RECORDER_I_B,     IQFOC_RECORDER_I_C,     IQFOC_RECORDER_I_ALPHA,
        IQFOC_RECORDER_I_BETA,  IQFOC_RECORDER_THETA_E, IQFOC_RECORDER_OMEGA_E, IQFOC_RECORDER_U_A,
        IQFOC_RECORDER_U_B,     IQFOC_RECORDER_U_C,     IQFOC_RECORDER_U_ALPHA, IQFOC_RECORDER_U_BETA,
        IQFOC_RECORDER_D_A,     IQFOC_RECORDER_D_B,     IQFOC_RECORDER_D_C,     IQFOC_RECORDER_U_DC,
        IQFOC_RECORDER_I_MID_A, IQFOC_RECORDER_I_MID_B, IQFOC_RECORDER_I_MID_C, IQFOC_RECORDER_THETA_MECH,
        IQFOC_RECORDER_TEMP,
    };
    for (size_t k = 0; k < sizeof in_order / sizeof *in_order; k++) {
        TEST_ASSERT_EQUAL_INT((int)k + 1, in_order[k]);
    }
}

static void test_bits(void)
{
    static const uint32_t wanted[][2] = {
        {IQFOC_STATUS_MISSED, 0x0001},
        {IQFOC_STATUS_LATE, 0x0002},
        {IQFOC_STATUS_STALE, 0x0004},
        {IQFOC_STATUS_SAMPLE_CLIPPED, 0x0008},
        {IQFOC_STATUS_OVERCURRENT, 0x0010},
        {IQFOC_STATUS_OVERSPEED, 0x0020},
        {IQFOC_STATUS_VOLTAGE_LIMIT, 0x0040},
        {IQFOC_STATUS_DC_LINK, 0x0080},
        {IQFOC_STATUS_NO_INTERVAL, 0x0100},
        {IQFOC_STATUS_ANGLE_LOST, 0x0200},
        {IQFOC_STATUS_LOST_PHASE, 0x00010000},
        {IQFOC_STATUS_LOST_CURRENT_SENSOR, 0x00020000},
        {IQFOC_STATUS_LOST_ANGLE_SENSOR, 0x00040000},
        {IQFOC_STATUS_BREAK, 0x00080000},
        {IQFOC_OBSERVER_LOST_ANGLE, 1},
        {IQFOC_OBSERVER_LOST_FLUX, 2},
        {IQFOC_OBSERVER_LOST_SLOW, 4},
        {IQFOC_HALL_A, 1},
        {IQFOC_HALL_B, 2},
        {IQFOC_HALL_C, 4},
        {IQFOC_HALLS_INVALID, 1},
        {IQFOC_HALLS_SKIPPED, 2},
        {IQFOC_SHUNT_A, 1},
        {IQFOC_SHUNT_B, 2},
        {IQFOC_SHUNT_C, 4},
    };
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        TEST_ASSERT_EQUAL_HEX32(wanted[k][1], wanted[k][0]);
    }
}

/* Numbers and limits that callers size their own data by, or rely on. */
static void test_limits(void)
{
    static const int64_t wanted[][2] = {
        {IQFOC_FINITE_SET_STATES, 8},
        {IQFOC_FINITE_SET_HORIZON, 3},
        {IQFOC_HALLS_SECTORS, 6},
        {IQFOC_RECORDER_CHANNELS_MAX, 16},
        {IQFOC_WATCH_SIGNATURES, 15},
        {IQFOC_WATCH_UNSURE, 3},
        {IQFOC_WATCH_BLOCK_CYCLES, 32},
        {IQFOC_WATCH_BLOCK_BITS, 5},
        {IQFOC_WATCH_NAMING, 64},
        {IQFOC_EXACT_TERMS, 6},
        {IQFOC_PATTERN_ANGLES_MAX, 7},
        {IQFOC_PATTERN_ROWS_MAX, 100},
        {IQFOC_PATTERN_EDGES_MAX, 16},
        {IQFOC_PATTERN_EDGES_HALF, 15},
        {IQFOC_PATTERN_SPEED_MAX, 1 << 21},
        {IQFOC_PATTERN_CONTROL_SPEED_MIN, 1 << 17},
        {IQFOC_PATTERN_TIME_MAX, 8 << 24},
        {IQFOC_ROTOR_SPEED_MAX, (1 << 24) / 3},
        {IQFOC_HAL_OUTPUT_MID, 3 << 23},
        {IQFOC_CYCLE_U_DC_MIN, 1 << 23},
        {IQFOC_CYCLE_U_DC_MAX, 3 << 23},
        {IQFOC_DEADBEAT_LIMIT, 16 << 24},
        {IQFOC_DEADBEAT_DRIFT_LIMIT, 4 << 24},
        {IQFOC_TUNED_K_LEAST_Q26, 1 << 22},
        {IQFOC_TUNED_CURRENT_LIMIT, 8 << 24},
        {IQFOC_TUNED_VOLTAGE_LIMIT, 16 << 24},
        {IQFOC_OVERMODULATION_CIRCLE, 9686330},
        {IQFOC_OVERMODULATION_SIDES, 10217287},
        {IQFOC_OVERMODULATION_MOST, 10677616},
        {IQFOC_ADAPT_FLOOR_Q32, INT64_C(1) << 28},
    };
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        TEST_ASSERT_EQUAL_INT64(wanted[k][1], wanted[k][0]);
    }
    /* A row, an edge or a place more or less is another layout. */
    TEST_ASSERT_EQUAL_INT(16, sizeof((iqfoc_pattern_edges_t *)0)->instant / sizeof(iq24_t));
    TEST_ASSERT_EQUAL_INT(17, sizeof((iqfoc_pattern_trajectory_t *)0)->angle / sizeof(iq24_t));
    TEST_ASSERT_EQUAL_INT(15, sizeof((iqfoc_pattern_trajectory_t *)0)->ahead / sizeof(iq24_t));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_errors);
    RUN_TEST(test_bits);
    RUN_TEST(test_limits);
    RUN_TEST(test_columns);
    return UNITY_END();
}
