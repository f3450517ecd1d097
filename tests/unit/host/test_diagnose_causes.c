/*
 * Causes that came after the first fifteen, on the bench of diagnose_bench.h: each is named alone, its intervals hold
 * the truth, and what is not there is not reported.
 */
#include "diagnose_look.h"

#include <math.h>
#include <string.h>
#include <unity.h>

static bench good;

void setUp(void)
{
    good = (bench){.m = bench_motor(), .noise_A = 0.017, .seed = 20260101};
}

void tearDown(void)
{
}

/* Each alone, with its mean and its rate, and neither mean nor rate of what stands still. */
static void what_drifts_is_named_with_its_rate(void)
{
    good.m.ext.has[CAUSE_RESISTANCE] = true;
    good.m.R_ohm = 1.03;
    good.m.ext.R_rate_ohm_s = 0.022; /* 27 % in 11 s */
    diagnosis d = look(&good, NULL);
    one_cause(&d, "resistance");
    TEST_ASSERT_EQUAL_size_t(2, d.cause[0].parameters);
    holds(&d.cause[0], "R", 1.03);
    holds(&d.cause[0], "R_rate", 0.022);
    /* The extended file says the same: nothing is left to find with it. */
    recording r = bench_record(&good);
    diagnosis again;
    error e = {0};
    const diagnose_options options = {0};
    TEST_ASSERT_TRUE(diagnose(&again, &r, &d.extended_motor, &options, &e));
    TEST_ASSERT_EQUAL_INT(VERDICT_CLEAN, again.verdict);
    diagnosis_free(&again);
    recording_free(&r);
    diagnosis_free(&d);

    good.m = bench_motor();
    good.m.ext.has[CAUSE_FLUX_LINKAGE] = true;
    good.m.ext.psi_rate_Wb_s = -0.0006; /* 3.5 % in 11 s, about the file's value */
    d = look(&good, NULL);
    one_cause(&d, "flux_linkage");
    holds(&d.cause[0], "psi_f", 0.2);
    holds(&d.cause[0], "psi_f_rate", -0.0006);
    diagnosis_free(&d);

    good.m = bench_motor();
    good.m.ext.has[CAUSE_CURRENT_OFFSET] = true;
    good.m.ext.o_A[0] = 0.06;
    good.m.ext.o_A[1] = good.m.ext.o_A[2] = -0.03;
    good.m.ext.o_rate_A_s[1] = 0.02;
    good.m.ext.o_rate_A_s[0] = good.m.ext.o_rate_A_s[2] = -0.01;
    d = look(&good, NULL);
    one_cause(&d, "current_offset");
    TEST_ASSERT_EQUAL_size_t(6, d.cause[0].parameters);
    holds(&d.cause[0], "o_a", 0.06);
    holds(&d.cause[0], "o_b_rate", 0.02);
    diagnosis_free(&d);

    good.m = bench_motor();
    good.m.ext.has[CAUSE_CURRENT_GAIN] = true;
    good.m.ext.g[0] = 1.02;
    good.m.ext.g[1] = good.m.ext.g[2] = 1.0;
    good.m.ext.g_rate_s[0] = 0.004;
    d = look(&good, NULL);
    one_cause(&d, "current_gain");
    holds(&d.cause[0], "g_a", 1.02);
    holds(&d.cause[0], "g_a_rate", 0.004);
    holds(&d.cause[0], "g_c_rate", 0.0);
    diagnosis_free(&d);
}

static void what_stands_still_has_no_rate(void)
{
    good.m.R_ohm = 1.2;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "resistance");
    TEST_ASSERT_EQUAL_size_t(1, d.cause[0].parameters);
    TEST_ASSERT_FALSE(d.extended_motor.ext.has[CAUSE_RESISTANCE]);
    diagnosis_free(&d);
}

/* Reported are the harmonics that were found: of a back-EMF with the 5th and 7th alone these two. */
static void harmonics_of_the_emf_are_named_to_the_13th(void)
{
    good.m.ext.has[CAUSE_EMF_HARMONICS] = true;
    good.m.ext.psi_11_Wb = 0.0012;
    good.m.ext.psi_13_Wb = -0.0008;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "emf_harmonics");
    holds(&d.cause[0], "psi_11", 0.0012);
    holds(&d.cause[0], "psi_13", -0.0008);
    diagnosis_free(&d);
    good.m.ext.psi_5_Wb = -0.002;
    good.m.ext.psi_7_Wb = 0.001;
    d = look(&good, NULL);
    one_cause(&d, "emf_harmonics");
    holds(&d.cause[0], "psi_5", -0.002);
    holds(&d.cause[0], "psi_7", 0.001);
    holds(&d.cause[0], "psi_11", 0.0012);
    holds(&d.cause[0], "psi_13", -0.0008);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.0008, d.extended_motor.ext.psi_13_Wb);
    diagnosis_free(&d);
    good.m.ext.psi_11_Wb = good.m.ext.psi_13_Wb = 0.0;
    d = look(&good, NULL);
    one_cause(&d, "emf_harmonics");
    TEST_ASSERT_EQUAL_size_t(2, d.cause[0].parameters);
    diagnosis_free(&d);
}

/* As a resolver errs: by its windings' offsets once, by their gains twice per electrical turn. */
static void an_angle_error_of_the_electrical_turn_is_named(void)
{
    static const double order[] = {3.0, 6.0};
    good.m.ext.has[CAUSE_ANGLE_HARMONIC] = true;
    good.m.ext.harmonic_amplitude_rad = 0.03;
    good.m.ext.harmonic_phase_rad = 0.7;
    for (size_t k = 0; k < 2; k++) {
        good.m.ext.harmonic_order = order[k];
        diagnosis d = look(&good, NULL);
        one_cause(&d, "angle_harmonic");
        holds(&d.cause[0], "order", order[k]);
        holds(&d.cause[0], "amplitude", 0.03);
        holds(&d.cause[0], "phase", 0.7);
        diagnosis_free(&d);
    }
}

/* It looks like an angle delay, a voltage gain and a resistance, each in a part of the speed range. */
static void iron_loss_is_named(void)
{
    static const double R_ohm[] = {300.0, 800.0};
    static const double tau_cycles[] = {0.3, 0.7, 4.0};
    good.noise_A = 0.03;
    for (size_t k = 0; k < 6; k++) {
        good.R_iron_ohm = R_ohm[k / 3];
        good.tau_iron_s = tau_cycles[k % 3] / good.m.f_pwm_Hz;
        diagnosis d = look(&good, NULL);
        one_cause(&d, "iron_loss");
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * good.R_iron_ohm, good.R_iron_ohm, d.cause[0].parameter[0].value);
        TEST_ASSERT_DOUBLE_WITHIN(0.15 * good.tau_iron_s, good.tau_iron_s, d.cause[0].parameter[1].value);
        diagnosis_free(&d);
    }
}

static void an_angle_delay_with_iron_loss_is_still_named(void)
{
    good.R_iron_ohm = 800.0;
    good.tau_iron_s = 0.5 / good.m.f_pwm_Hz;
    good.m.ext.has[CAUSE_ANGLE_DELAY] = true;
    good.m.ext.t_delay_s = 1e-4;
    diagnosis d = look(&good, NULL);
    bool delay = false;
    for (size_t k = 0; k < d.causes; k++) {
        delay = delay || strcmp(d.cause[k].id, "angle_delay") == 0;
        TEST_ASSERT_TRUE(strcmp(d.cause[k].id, "angle_delay") == 0 ||
                         strcmp(d.cause[k].id, "iron_loss") == 0);
    }
    TEST_ASSERT_TRUE(delay);
    diagnosis_free(&d);
}

/* What stands for the iron while the delay is not known must not choose its time constant. */
static void iron_loss_with_a_voltage_delay_is_named(void)
{
    static const double tau_cycles[] = {0.5, 4.0};
    for (size_t k = 0; k < 2; k++) {
        good.R_iron_ohm = 300.0;
        good.tau_iron_s = tau_cycles[k] / good.m.f_pwm_Hz;
        good.m.ext.has[CAUSE_VOLTAGE_DELAY] = true;
        good.m.ext.voltage_delay_cycles = 1.0;
        diagnosis d = look(&good, NULL);
        TEST_ASSERT_EQUAL_size_t(2, d.causes);
        TEST_ASSERT_EQUAL_STRING("voltage_delay", d.cause[0].id);
        TEST_ASSERT_EQUAL_STRING("iron_loss", d.cause[1].id);
        TEST_ASSERT_DOUBLE_WITHIN(15.0, 300.0, d.cause[1].parameter[0].value);
        diagnosis_free(&d);
    }
}

/* R and psi_f of the file are those at the recording's mean temperature: symmetric about it on this bench. */
static void what_follows_the_temperature_is_named(void)
{
    good.m.ext.has[CAUSE_TEMPERATURE] = true;
    good.m.ext.alpha_R = 0.0039;
    good.m.ext.alpha_psi = -0.0011;
    good.mean_C = 60.0;
    good.swing_K = 25.0;
    diagnosis d = look(&good, NULL);
    bool found = false;
    for (size_t k = 0; k < d.causes; k++) {
        if (strcmp(d.cause[k].id, "temperature") == 0) {
            found = true;
            TEST_ASSERT_DOUBLE_WITHIN(0.0004, 0.0039, d.cause[k].parameter[0].value);
            TEST_ASSERT_DOUBLE_WITHIN(0.0001, -0.0011, d.cause[k].parameter[1].value);
        }
    }
    TEST_ASSERT_TRUE(found);
    TEST_ASSERT_EQUAL_INT(VERDICT_EXPLAINED, d.verdict);
    diagnosis_free(&d);
    /* A temperature that swings while nothing follows it is no cause. */
    good.m = bench_motor();
    d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(0, d.causes);
    diagnosis_free(&d);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_drifts_is_named_with_its_rate);
    RUN_TEST(what_stands_still_has_no_rate);
    RUN_TEST(harmonics_of_the_emf_are_named_to_the_13th);
    RUN_TEST(an_angle_error_of_the_electrical_turn_is_named);
    RUN_TEST(iron_loss_is_named);
    RUN_TEST(an_angle_delay_with_iron_loss_is_still_named);
    RUN_TEST(iron_loss_with_a_voltage_delay_is_named);
    RUN_TEST(what_follows_the_temperature_is_named);
    return UNITY_END();
}
