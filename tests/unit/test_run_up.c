/*
 * The run-up through overmodulation into six-step and back (sim_host/loops/run_up.h) against what it promises:
 * no transition costs more than 2 % of the rated torque, with and without ripple of the DC link.
 */
#include "loops/run_up.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const double pi = 3.14159265358979323846;
static run_up of[RUN_UP_CASES];

enum { LINEAR, SIX_STEP, LINK_300, LINK_100, OVER, MIDPOINT, TIMER, TIMER_300, TIMER_100 };

void setUp(void)
{
}

void tearDown(void)
{
}

static void the_transitions_cost_no_torque(void)
{
    for (int n = SIX_STEP; n <= OVER; n++) {
        printf("  %-36s %+.2f %+.2f %% of rated\n", run_up_cases[n].text, of[n].step_up_percent,
               of[n].step_down_percent);
        TEST_ASSERT_TRUE(of[n].top_rpm > RUN_UP_RPM);
        TEST_ASSERT_TRUE(run_up_step_percent(&of[n]) < RUN_UP_STEP);
    }
    /* Without the ripple of six-step, with room for it above the voltage asked for, it is a fifth of that. */
    TEST_ASSERT_TRUE(run_up_step_percent(&of[OVER]) < 0.25 * RUN_UP_STEP);
    TEST_ASSERT_TRUE(run_up_step_percent(&of[LINEAR]) < 0.25 * RUN_UP_STEP);
}

/* It really is six-step up there: its fundamental but for s1 = sin(h)/h, h = phi/2 at 12.5 cycles a turn, and two
 * pulses per leg and turn beside the one of six-step itself, for an edge takes a cycle. */
static void it_is_six_step_at_the_top(void)
{
    const double h = pi / 12.5;
    const double most = (h / sin(h) + cos(h)) / pi;
    TEST_ASSERT_TRUE(of[SIX_STEP].voltage_most > most);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 3.0, of[SIX_STEP].pulses_top);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 12.5, of[LINEAR].pulses_top);
    TEST_ASSERT_TRUE(of[SIX_STEP].six_step_from_rpm < 7300.0);
    TEST_ASSERT_TRUE(of[SIX_STEP].linear_to_rpm > 6000.0 && of[SIX_STEP].linear_to_rpm < 6600.0);
    TEST_ASSERT_TRUE(isnan(of[LINEAR].linear_to_rpm));
    /* Linear modulation needs so much more weakening. */
    TEST_ASSERT_TRUE(of[LINEAR].i_d_least < 1.5 * of[SIX_STEP].i_d_least);
    TEST_ASSERT_TRUE(of[SIX_STEP].i_d_least < -0.1);
}

/* From the carrier to a timer and back, with and without ripple of the link: there is one pulse a turn up there, the
 * timer was reached under driving torque and left under braking torque, each once, and neither costs torque. */
static void to_a_timer_and_back(void)
{
    for (int n = TIMER; n <= TIMER_100; n++) {
        printf("  %-36s %+.2f %+.2f %% of rated, timer from %.0f to %.0f rpm, %.2f pulses\n",
               run_up_cases[n].text, of[n].step_up_percent, of[n].step_down_percent, of[n].to_timer_rpm,
               of[n].to_carrier_rpm, of[n].pulses_top);
        TEST_ASSERT_TRUE(of[n].top_rpm > RUN_UP_RPM);
        TEST_ASSERT_TRUE(run_up_step_percent(&of[n]) < RUN_UP_STEP);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 1.0, of[n].pulses_top);
        TEST_ASSERT_EQUAL_INT(2, of[n].transitions);
        TEST_ASSERT_TRUE(of[n].to_timer_rpm > 7000.0 && of[n].to_timer_rpm < 7900.0);
        TEST_ASSERT_TRUE(of[n].to_carrier_rpm > 7000.0 && of[n].to_carrier_rpm < 7900.0);
    }
    TEST_ASSERT_EQUAL_INT(0, of[SIX_STEP].transitions);
}

/* Mid-point feedback errs by what 2016 corrects, here 1 % of the current at 12.5 cycles a turn. */
static void the_midpoint_carries_more(void)
{
    TEST_ASSERT_TRUE(of[MIDPOINT].step_up_percent > of[SIX_STEP].step_up_percent + 0.5);
}

int main(void)
{
    error e = {0};
    UNITY_BEGIN();
    if (!run_ups_run(of, &e)) {
        printf("%s\n", e.text);
        return 1;
    }
    RUN_TEST(the_transitions_cost_no_torque);
    RUN_TEST(it_is_six_step_at_the_top);
    RUN_TEST(to_a_timer_and_back);
    RUN_TEST(the_midpoint_carries_more);
    return UNITY_END();
}
