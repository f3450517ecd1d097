/*
 * What a diagnosis found is put into the motor file: with it another recording of the same drive is clean, and what has changed
 * since is named alone.
 */
#include "diagnose_look.h"

#include <unity.h>

static bench drive;

void setUp(void)
{
    drive = (bench){.m = bench_motor(), .noise_A = 0.017, .seed = 20260401};
}

void tearDown(void)
{
}

static diagnosis with_file(const motor *file)
{
    recording r = bench_record(&drive);
    diagnosis d;
    error e = {0};
    const diagnose_options options = {0};
    drive.seed++;
    TEST_ASSERT_TRUE_MESSAGE(diagnose(&d, &r, file, &options, &e), e.text);
    recording_free(&r);
    /* The next recording begins an electrical turn later. */
    drive.m.ext.harmonic_phase_rad += drive.m.ext.harmonic_order * VEC_TWO_PI / drive.m.pole_pairs;
    return d;
}

/* One recording finds the cause. Of two more the first is clean, and the second's winding is warmer. */
static void once_and_again(const char *id)
{
    const motor file = bench_motor();
    diagnosis d = with_file(&file);
    one_cause(&d, id);
    const motor knows = d.extended_motor;
    diagnosis_free(&d);
    d = with_file(&knows);
    TEST_ASSERT_EQUAL_INT(VERDICT_CLEAN, d.verdict);
    TEST_ASSERT_EQUAL_size_t(0, d.causes);
    TEST_ASSERT_TRUE(d.nominal < 1.1 * d.noise_floor);
    diagnosis_free(&d);
    drive.m.R_ohm *= 1.3;
    d = with_file(&knows);
    one_cause(&d, "resistance");
    holds(&d.cause[0], "R", drive.m.R_ohm);
    diagnosis_free(&d);
}

/* Its time constant is the file's, whatever would suit an iron that had yet to be found. */
static void iron(void)
{
    static const double tau_cycles[] = {0.3, 4.0};
    for (size_t k = 0; k < sizeof tau_cycles / sizeof *tau_cycles; k++) {
        setUp();
        drive.noise_A = 0.03;
        drive.R_iron_ohm = 300.0;
        drive.tau_iron_s = tau_cycles[k] / drive.m.f_pwm_Hz;
        once_and_again("iron_loss");
    }
}

/* Which revolution a recording began in is not known: every stretch is turned to what the file says. */
static void an_error_of_the_revolution(void)
{
    static const double order[] = {1.0, 2.0, 1.0};
    static const double phase_rad[] = {0.7, 2.8, -1.7};
    for (size_t k = 0; k < 3; k++) {
        setUp();
        drive.m.ext.has[CAUSE_ANGLE_HARMONIC] = true;
        drive.m.ext.harmonic_order = order[k];
        drive.m.ext.harmonic_amplitude_rad = 0.03;
        drive.m.ext.harmonic_phase_rad = phase_rad[k];
        once_and_again("angle_harmonic");
    }
}

static void a_late_voltage(void)
{
    drive.m.ext.has[CAUSE_VOLTAGE_DELAY] = true;
    drive.m.ext.voltage_delay_cycles = 1.0;
    once_and_again("voltage_delay");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(iron);
    RUN_TEST(an_error_of_the_revolution);
    RUN_TEST(a_late_voltage);
    return UNITY_END();
}
