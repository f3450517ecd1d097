/*
 * Common parts of the cycle's tests: a configuration, one cycle of it that setUp initialises, and the two calls of a
 * healthy carrier period. Each test program includes it once.
 */
#ifndef TESTS_UNIT_CYCLE_FIXTURE_H
#define TESTS_UNIT_CYCLE_FIXTURE_H

#include "iqfoc/cycle.h"
#include "iqfoc/params.h"
#include "reference.h"

/* The 2019 paper's laboratory drive at its f_PWM; bases as docs/units.md has them. */
#define R_OHM  0.75
#define L_H    5.2e-3
#define PSI_WB 0.134
#define T_S    2e-4
#define U_DC_V 750.0
#define I_B_A  IQFOC_I_BASE(10.5)

#define PERIOD 34000U /* ticks: 170 MHz, 5 kHz */

static const iqfoc_cycle_config_t base_config = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .gains = IQFOC_GAINS(1200.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_MIDPOINT,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24(1.0),
    .current_limit = IQ24(2.0),
    .period_ticks = PERIOD,
    .tolerance_ticks = PERIOD / 100,
    .stale_ticks = PERIOD / 4,
    .deadline_ticks = PERIOD / 3,
    .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_STALE | IQFOC_STATUS_LATE | IQFOC_STATUS_OVERCURRENT,
};

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static uint32_t ticks;

void setUp(void)
{
    config = base_config;
    ticks = UINT32_MAX - 3 * PERIOD; /* every test crosses the timer's wrap */
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
}

void tearDown(void)
{
}

static inline iqfoc_sample_t sample_at(iq24_t at)
{
    const iqfoc_sample_t s = {
        .theta = IQ24(0.1), .speed = IQ24(0.02), .u_dc = IQ24_ONE, .instant = at, .time = ticks};
    return s;
}

static inline void valley(void)
{
    const iqfoc_sample_t s = sample_at(0);
    iqfoc_cycle_valley(&cycle, &s, ticks + 10);
    ticks += PERIOD / 2;
}

static inline iqfoc_command_t peak(void)
{
    const iqfoc_sample_t s = sample_at(IQ24(0.5));
    const iqfoc_command_t command = iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks + 10);
    ticks += PERIOD / 2;
    return command;
}

#endif
