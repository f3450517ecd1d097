/*
 * Scenario files: courses over time, defaults, refusals; and every scenario and motor of the project is read.
 */
#define _XOPEN_SOURCE 700

#include "data/motor.h"
#include "data/scenario.h"
#include "host_files.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

static scenario s;

void setUp(void)
{
    s = (scenario){0};
}

void tearDown(void)
{
    scenario_free(&s);
}

static void expect_read(const char *text)
{
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(scenario_read(scratch_text("s.toml", text), &s, &e), e.text);
}

static void expect_refused(const char *text, const char *where, const char *what)
{
    error e = {0};
    const char *path = scratch_text("s.toml", text);
    TEST_ASSERT_FALSE_MESSAGE(scenario_read(path, &s, &e), text);
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    char start[500];
    snprintf(start, sizeof start, "%s:%s: ", path, where);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(start, e.text, strlen(start), e.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, what), e.text);
    TEST_ASSERT_NULL(s.run);
}

static void test_defaults(void)
{
    expect_read("[[run]]\nduration_s = 0.1\n");
    TEST_ASSERT_EQUAL(1, s.runs);
    TEST_ASSERT_EQUAL(FEEDBACK_MIDPOINT, s.control.feedback);
    TEST_ASSERT_EQUAL(MODULATION_PWM, s.control.modulation);
    TEST_ASSERT_TRUE(s.control.bandwidth_Hz == 0.0);
    TEST_ASSERT_EQUAL(0, s.sensors.current_bits);
    TEST_ASSERT_TRUE(s.log.voltages && s.log.third_current && s.log.mid_currents);
    TEST_ASSERT_FALSE(s.log.duties || s.log.u_dc || s.log.mechanical_angle);
    TEST_ASSERT_EQUAL(200, s.run[0].settle_cycles);
    TEST_ASSERT_EQUAL(SHAFT_GIVEN, s.run[0].shaft);
    TEST_ASSERT_TRUE(profile_at(&s.run[0].i_q_A, 0.05) == 0.0);
    TEST_ASSERT_EQUAL(500, scenario_run_cycles(&s.run[0], 2e-4));
}

static void test_everything_that_can_stand(void)
{
    expect_read(
        "name = \"n\"\n"
        "[control]\nfeedback = \"quasi_discrete_mean\"\nmodulation = \"six_step\"\nbandwidth_Hz = 250\n"
        "[sensors]\ncurrent_bits = 12\ncurrent_full_scale_A = 25\ncurrent_noise_A = 0.02\n"
        "current_offset_A = [0.1, 0, -0.1]\ncurrent_bandwidth_Hz = 1e5\nangle_noise_rad = 0.001\n"
        "speed_noise_rad_s = 0.1\nu_dc_noise_V = 0.5\n"
        "[log]\nvoltages = false\nduties = true\nthird_current = false\nmid_currents = false\n"
        "mechanical_angle = true\n"
        "[[run]]\ncycles = 7\nsettle_cycles = 0\nspeed_rpm = -100\ni_d_A = -1\nu_dc_V = 300\n"
        "theta_mech_start_rad = 0.5\n"
        "[[run]]\nduration_s = 1\n[run.shaft]\nJ_kgm2 = 0.01\nfriction_Nms = 0.1\nstart_rpm = 5\n"
        "load_Nm = { at_s = [0, 1], ramp = [0, 2] }\n");
    TEST_ASSERT_EQUAL_STRING("n", s.name);
    TEST_ASSERT_EQUAL(FEEDBACK_QUASI_DISCRETE_MEAN, s.control.feedback);
    TEST_ASSERT_EQUAL(MODULATION_SIX_STEP, s.control.modulation);
    TEST_ASSERT_TRUE(s.sensors.current_offset_A[0] == 0.1 && s.sensors.current_offset_A[2] == -0.1);
    TEST_ASSERT_TRUE(!s.log.voltages && s.log.duties && s.log.u_dc && s.log.mechanical_angle);
    TEST_ASSERT_EQUAL(2, s.runs);
    TEST_ASSERT_EQUAL(7, scenario_run_cycles(&s.run[0], 2e-4));
    TEST_ASSERT_EQUAL(0, s.run[0].settle_cycles);
    TEST_ASSERT_TRUE(profile_at(&s.run[0].speed_rpm, 0.0) == -100.0);
    TEST_ASSERT_TRUE(s.run[0].u_dc_V == 300.0 && s.run[0].theta_mech_start_rad == 0.5);
    TEST_ASSERT_EQUAL(SHAFT_INERTIA, s.run[1].shaft);
    TEST_ASSERT_TRUE(s.run[1].J_kgm2 == 0.01 && s.run[1].friction_Nms == 0.1);
    TEST_ASSERT_TRUE(profile_at(&s.run[1].speed_rpm, 0.0) == 5.0);
    TEST_ASSERT_TRUE(profile_at(&s.run[1].load_Nm, 0.25) == 0.5);
}

static void test_courses(void)
{
    expect_read(
        "[[run]]\nduration_s = 1\n"
        "i_d_A = { at_s = [0.1, 0.5], steps = [2, 8] }\n"
        "i_q_A = { at_s = [0.0, 0.5, 0.75], ramp = [-8, 8, 0] }\n"
        "speed_rpm = { value = 5, square = { amplitude = 2, period_s = 0.25 } }\n"
        "[[run]]\nduration_s = 1\ni_q_A = { value = 1, sine = { amplitude = 2, period_s = 0.25 } }\n");
    const profile *steps = &s.run[0].i_d_A;
    TEST_ASSERT_TRUE(profile_at(steps, 0.0) == 2.0 && profile_at(steps, 0.49) == 2.0);
    TEST_ASSERT_TRUE(profile_at(steps, 0.5) == 8.0 && profile_at(steps, 9.0) == 8.0);
    const profile *ramp = &s.run[0].i_q_A;
    TEST_ASSERT_TRUE(profile_at(ramp, 0.0) == -8.0 && profile_at(ramp, 0.25) == 0.0);
    TEST_ASSERT_TRUE(profile_at(ramp, 0.625) == 4.0 && profile_at(ramp, 1.0) == 0.0);
    const profile *square = &s.run[0].speed_rpm;
    TEST_ASSERT_TRUE(profile_at(square, 0.0) == 7.0 && profile_at(square, 0.125) == 3.0);
    TEST_ASSERT_TRUE(profile_at(square, 0.25) == 7.0 && profile_base_at(square, 0.2) == 5.0);
    const profile *sine = &s.run[1].i_q_A;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, profile_at(sine, 0.0625));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -1.0, profile_at(sine, 0.1875));
}

static void test_refusals(void)
{
    expect_refused("name = \"no runs\"\n", "1:1", "no [[run]]");
    expect_refused("[run]\nduration_s = 1\n", "1:1", "run must be tables [[run]], not a table");
    expect_refused("[[run]]\n", "1:1", "cycles or duration_s is missing");
    expect_refused("[[run]]\ncycles = 1\nduration_s = 1\n", "3:14", "not both");
    expect_refused("[[run]]\nduration_s = -1\n", "2:14", "duration_s must be");
    expect_refused("[[run]]\ncycles = 2.5\n", "2:10", "whole number");
    expect_refused("[[run]]\ncycles = 1\nspeed = 5\n", "3:1", "unknown key speed in [run 1]");
    expect_refused("[[run]]\ncycles = 1\n[[run]]\ncycles = 1\ni_Q_A = 5\n", "5:1",
                   "in [run 2]; did you mean i_q_A?");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = \"5\"\n", "3:9",
                   "i_q_A must be a finite number, not text \"5\"");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = {}\n", "3:9", "one of value, steps or ramp");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = { value = 1, ramp = [1] }\n", "3:9",
                   "one of value, steps or ramp");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = { steps = [1] }\n", "3:19", "needs at_s");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = { at_s = [0, 1], steps = [1] }\n", "3:18",
                   "as many numbers, not 2 and 1");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = { at_s = [1, 1], steps = [1, 2] }\n", "3:18", "must rise");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = { at_s = [0, 1], steps = [1, nan] }\n", "3:38",
                   "finite number, not nan");
    expect_refused("[[run]]\ncycles = 1\ni_q_A = { value = 1, square = { amplitude = 1 } }\n", "3:31",
                   "period_s is missing in [run 1.i_q_A.square]");
    expect_refused("[[run]]\ncycles = 1\nspeed_rpm = 1\n[run.shaft]\nJ_kgm2 = 1\n", "3:13", "not both");
    expect_refused("[[run]]\ncycles = 1\n[run.shaft]\nJ_kgm2 = 0\n", "4:10", "J_kgm2 must be a number > 0");
    expect_refused(
        "[control]\nfeedback = \"mid\"\n[[run]]\ncycles = 1\n", "2:12",
        "feedback must be \"midpoint\", \"corrected_mean\" or \"quasi_discrete_mean\", not text \"mid\"");
    expect_refused("[sensors]\ncurrent_bits = 12\n[[run]]\ncycles = 1\n", "2:16",
                   "needs current_full_scale_A");
    expect_refused("[sensors]\ncurrent_offset_A = [1]\n[[run]]\ncycles = 1\n", "2:20", "three phases");
    expect_refused("[control]\nmodulation = \"pattern\"\n[[run]]\ncycles = 1\n", "1:1", "together");
    expect_refused("[control]\npulses = 5\n[[run]]\ncycles = 1\n", "2:10", "together");
    const struct {
        const char *line, *where, *what;
    } with_pattern[] = {
        {"pulses = 6", "3:10", "pulses = 6, expected an odd number from 3 to 15"},
        {"pulses = 17", "3:10", "15"},
        {"pulses = 5\nfeedback = \"midpoint\"", "4:12", "feedback needs duties"},
        {"pulses = 5\nbandwidth_Hz = 100", "4:16", "bandwidth_Hz needs duties"},
        {"pulses = 5\nupdates = 2", "4:11", "modulation = \"pwm\""},
        {"pulses = 5\nangle = \"observed\"", "4:9", "modulation = \"pwm\""},
        {"pulses = 5\n[pwm]\nperiods_per_cycle = 2", "4:1", "modulation = \"pwm\""},
        {"pulses = 5\n[sensors]\nshunts = \"two_lowest\"", "1:1", "modulation = \"pwm\""},
    };
    for (size_t k = 0; k < sizeof with_pattern / sizeof with_pattern[0]; k++) {
        char text[300];
        snprintf(text, sizeof text, "[control]\nmodulation = \"pattern\"\n%s\n[[run]]\ncycles = 1\n",
                 with_pattern[k].line);
        expect_refused(text, with_pattern[k].where, with_pattern[k].what);
    }
    expect_refused("[log]\nvoltages = false\n[[run]]\ncycles = 1\n", "2:12", "voltages or duties");
    expect_refused("[log]\nvoltages = 1\n[[run]]\ncycles = 1\n", "2:12", "true or false, not 1");
    expect_refused("[log]\nduties = true\nu_dc = false\n[[run]]\ncycles = 1\n", "3:8", "duties need u_dc");
}

/* ctest runs in the project's root. */
static size_t read_all(const char *folder, bool is_motor)
{
    DIR *open = opendir(folder);
    TEST_ASSERT_NOT_NULL_MESSAGE(open, folder);
    size_t count = 0;
    for (struct dirent *d; (d = readdir(open)) != NULL;) {
        if (strstr(d->d_name, ".toml") == NULL) {
            continue;
        }
        char path[400];
        snprintf(path, sizeof path, "%s/%s", folder, d->d_name);
        error e = {0};
        motor m;
        const bool ok = is_motor ? motor_read(path, &m, &e) : scenario_read(path, &s, &e);
        scenario_free(&s);
        TEST_ASSERT_TRUE_MESSAGE(ok, e.text);
        count++;
    }
    closedir(open);
    return count;
}

static void test_the_project_s_own_files_are_read(void)
{
    TEST_ASSERT_GREATER_OR_EQUAL(5, read_all("data/motors", true));
    TEST_ASSERT_GREATER_OR_EQUAL(4, read_all("data/scenarios", false));
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_defaults);
    RUN_TEST(test_everything_that_can_stand);
    RUN_TEST(test_courses);
    RUN_TEST(test_refusals);
    RUN_TEST(test_the_project_s_own_files_are_read);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
