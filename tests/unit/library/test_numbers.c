/*
 * Numbers that leave the firmware: errors of set-up functions, and channel numbers of the recorder's line. Logs and
 * hosts store them, so no number is ever reused.
 */
#include "iqfoc/error.h"
#include "iqfoc/recorder.h"

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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_errors);
    RUN_TEST(test_columns);
    return UNITY_END();
}
