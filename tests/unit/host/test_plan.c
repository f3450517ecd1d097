/*
 * The recording that is planned (sim_host/plan): its limits, what it gains, that its outlook is what a recording
 * shows, and that its file is read back as the same scenario.
 */
#include "diagnose/diagnose.h"
#include "drive/drive_scenario.h"
#include "drive/firmware_host.h"
#include "plan/plan_tell.h"
#include "plant/plant_effect.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

static motor compressor;
static plan_report report;
static plan_outlook usual;

void setUp(void)
{
}

void tearDown(void)
{
}

/* As `iqfoc plan --against data/scenarios/identification.toml` has them. */
static void make_once(void)
{
    error e = {0};
    scenario s;
    TEST_ASSERT_TRUE_MESSAGE(motor_read("data/motors/compressor_salient.toml", &compressor, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(scenario_read("data/scenarios/identification.toml", &s, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(plan_look(&compressor, &s, 1, &usual, &e), e.text);
    report.motor = &compressor;
    report.limits = (plan_limits){.current_A = motor_rated_peak_A(&compressor),
                                  .speed_rpm = 4000.0,
                                  .u_dc_V = compressor.u_dc_V,
                                  .seconds = plan_cycles_of(&compressor, &s) / compressor.f_pwm_Hz,
                                  .noise_A = s.sensors.current_noise_A,
                                  .bits = s.sensors.current_bits,
                                  .full_scale_A = s.sensors.current_full_scale_A};
    scenario_free(&s);
    TEST_ASSERT_TRUE_MESSAGE(plan_make(&compressor, &report.limits, 1, &report.plan, &e), e.text);
}

/* Whatever the memory held: evidence of another recording as well. */
static void information_is_of_its_own_recording(void)
{
    static plan_information fresh;
    static plan_information used;
    error e = {0};
    scenario s;
    memset(&used, 0xa5, sizeof used);
    TEST_ASSERT_TRUE_MESSAGE(scenario_read("data/scenarios/identification.toml", &s, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(plan_information_of(&compressor, &s, 1, &fresh, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(plan_information_of(&compressor, &s, 1, &used, &e), e.text);
    TEST_ASSERT_EQUAL_MEMORY(fresh.h, used.h, sizeof fresh.h);
    const plan_information first = used;
    s.run[0].i_q_A.value[0] *= 0.5;
    memset(&fresh, 0, sizeof fresh);
    TEST_ASSERT_TRUE_MESSAGE(plan_information_of(&compressor, &s, 1, &fresh, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(plan_information_of(&compressor, &s, 1, &used, &e), e.text);
    TEST_ASSERT_EQUAL_MEMORY(fresh.h, used.h, sizeof fresh.h);
    const double *const before = (const double *)first.h;
    const double *const now = (const double *)used.h;
    bool differs = false;
    for (size_t k = 0; k < sizeof first.h / sizeof *before; k++) {
        differs = differs || before[k] != now[k];
    }
    TEST_ASSERT_TRUE(differs);
    scenario_free(&s);
}

static void it_keeps_the_limits(void)
{
    const plan *p = &report.plan;
    TEST_ASSERT_TRUE(p->pieces >= 4 && p->pieces <= PLAN_RUNS);
    TEST_ASSERT_TRUE(p->seconds <= report.limits.seconds + 1e-9);
    TEST_ASSERT_TRUE(p->seconds > 0.99 * report.limits.seconds);
    for (size_t k = 0; k < p->pieces; k++) {
        const scenario_run *run = &p->run[k];
        const double T_s = 1.0 / compressor.f_pwm_Hz;
        for (long n = 0; n < run->cycles; n++) {
            const double d = profile_at(&run->i_d_A, (double)n * T_s);
            const double q = profile_at(&run->i_q_A, (double)n * T_s);
            TEST_ASSERT_TRUE(hypot(d, q) <= report.limits.current_A + 2e-3);
            TEST_ASSERT_TRUE(fabs(profile_at(&run->speed_rpm, (double)n * T_s)) <=
                             report.limits.speed_rpm + 0.5);
        }
    }
}

/* Against the scenario that everybody is advised to record, in its time and with its sensors. */
static void it_tells_the_causes_apart_better(void)
{
    const plan_outlook *o = &report.plan.outlook;
    printf("  worst correlation %.3f (%.3f), median interval %.4f (%.4f)\n", o->worst_correlation,
           usual.worst_correlation, o->median_over_least, usual.median_over_least);
    TEST_ASSERT_TRUE(o->worst_correlation < 0.8 && usual.worst_correlation > 0.95);
    TEST_ASSERT_TRUE(o->median_over_least < usual.median_over_least);
    for (int n = 0; n < PLAN_ASKED; n++) {
        TEST_ASSERT_TRUE(o->determined[n]);
        TEST_ASSERT_TRUE(o->half_width[n] > 0.0);
    }
}

/* A locked rotor says nothing of the magnet, and of two things that do the same neither. */
static void what_cannot_be_seen_is_not_reported(void)
{
    error e = {0};
    plan_outlook o;
    const plan_piece piece = {.square_d_A = 3.0, .half_d_cycles = 23};
    scenario_run run = plan_piece_run(&piece, &compressor, &report.limits, 4000);
    const scenario s = plan_scenario(&report.limits, &run, 1);
    TEST_ASSERT_TRUE_MESSAGE(plan_look(&compressor, &s, 1, &o, &e), e.text);
    for (int n = 0; n < PLAN_ASKED; n++) {
        const bool magnet = strncmp(plan_asked_list[n].name, "psi_", 4) == 0;
        TEST_ASSERT_TRUE(!magnet || !o.determined[n]);
    }
    TEST_ASSERT_TRUE(o.over_least[2] > 10.0 * usual.over_least[2]); /* L_q, with i_d alone */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, o.limit[H_FLUX]);
    TEST_ASSERT_TRUE(o.median_over_least > 10.0 * usual.median_over_least);
}

/* One run more lowers what is unknown, whatever it is. */
static void information_adds(void)
{
    error e = {0};
    double h[PLAN_ASKED][PLAN_ASKED] = {{0.0}};
    static plan_information info;
    const double none = plan_unknown(h);
    TEST_ASSERT_TRUE_MESSAGE(plan_information_of(&compressor, &report.plan.scenario, 1, &info, &e), e.text);
    const double once = plan_unknown(info.h);
    for (size_t i = 0; i < PLAN_ASKED; i++) {
        for (size_t j = 0; j < PLAN_ASKED; j++) {
            h[i][j] = 4.0 * info.h[i][j];
        }
    }
    TEST_ASSERT_TRUE(once < none);
    /* Four times the time halves every interval, and leaves correlations: each log(variance) falls by log 4. */
    TEST_ASSERT_DOUBLE_WITHIN(0.02, PLAN_ASKED * log(4.0), once - plan_unknown(h));
}

static void the_file_is_read_back(void)
{
    error e = {0};
    scenario s;
    const char *path = "build/test_plan.toml";
    TEST_ASSERT_TRUE_MESSAGE(plan_write_scenario(&report, path, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(scenario_read(path, &s, &e), e.text);
    (void)remove(path);
    TEST_ASSERT_EQUAL_size_t(report.plan.pieces, s.runs);
    for (size_t k = 0; k < s.runs; k++) {
        const scenario_run *want = &report.plan.run[k];
        const scenario_run *got = &s.run[k];
        TEST_ASSERT_EQUAL_INT(want->cycles, got->cycles);
        TEST_ASSERT_EQUAL_INT(want->settle_cycles, got->settle_cycles);
        TEST_ASSERT_EQUAL_DOUBLE(want->theta_mech_start_rad, got->theta_mech_start_rad);
        for (int n = 0; n < 200; n++) {
            const double t_s = n * 0.0013;
            TEST_ASSERT_EQUAL_DOUBLE(profile_at(&want->i_d_A, t_s), profile_at(&got->i_d_A, t_s));
            TEST_ASSERT_EQUAL_DOUBLE(profile_at(&want->i_q_A, t_s), profile_at(&got->i_q_A, t_s));
            TEST_ASSERT_EQUAL_DOUBLE(profile_at(&want->speed_rpm, t_s), profile_at(&got->speed_rpm, t_s));
        }
    }
    scenario_free(&s);
}

/* The diagnosis of the planned recording of a drive with an effect. */
static void diagnose_with(const char *effect, diagnosis *d)
{
    static drive_host host;
    static recording read;
    error e = {0};
    const scenario *s = &report.plan.scenario;
    const drive_firmware firmware = drive_firmware_host(&host, NULL);
    const diagnose_options options = {0};
    plant_config c = drive_scenario_plant(&compressor, s);
    const drive_scenario all = {&compressor, s, &c, 2, &firmware, NULL, NULL};
    drive_recording out;
    TEST_ASSERT_TRUE_MESSAGE(plant_effect_apply(&c, effect, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(drive_scenario_run(&all, &out, &e), e.text);
    TEST_ASSERT_TRUE(recording_find_stretches(&out.recording));
    read = out.recording;
    read.path = "planned";
    TEST_ASSERT_TRUE_MESSAGE(diagnose(d, &read, &compressor, &options, &e), e.text);
    recording_free(&out.recording);
}

/* The outlook's limits are the diagnosis' own: half as much again is named, half of it is not. */
static void limits_are_what_the_diagnosis_does(void)
{
    static const struct {
        hypothesis_id h;
        const char *format, *id;
        double nominal, per_least;
    } tried[] = {{H_RESISTANCE, "resistance:R=%.6g", "resistance", 0.9, 0.9},
                 {H_FLUX, "flux_linkage:psi_f=%.6g", "flux_linkage", 0.2, 0.2}};
    for (size_t n = 0; n < sizeof tried / sizeof *tried; n++) {
        const double limit = report.plan.outlook.limit[tried[n].h] * hypothesis_table[tried[n].h].least;
        for (int more = 0; more < 2; more++) {
            static diagnosis d;
            char effect[64];
            const double size = (more != 0 ? 1.5 : 0.5) * limit;
            (void)snprintf(effect, sizeof effect, tried[n].format,
                           tried[n].nominal + size * tried[n].per_least);
            diagnose_with(effect, &d);
            printf("  %s: %s\n", effect, d.causes > 0 ? d.cause[0].id : "nothing");
            TEST_ASSERT_EQUAL_size_t((size_t)more, d.causes);
            TEST_ASSERT_TRUE(more == 0 || strcmp(d.cause[0].id, tried[n].id) == 0);
            diagnosis_free(&d);
        }
    }
}

static void limits_that_cannot_be_kept_are_refused(void)
{
    static plan p;
    error e = {0};
    plan_limits l = report.limits;
    l.seconds = 0.5;
    TEST_ASSERT_FALSE(plan_make(&compressor, &l, 1, &p, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL(strstr(e.text, "expected at least"));
    e = (error){0};
    l = report.limits;
    l.u_dc_V = 2.0;
    TEST_ASSERT_FALSE(plan_make(&compressor, &l, 1, &p, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(make_once);
    RUN_TEST(information_is_of_its_own_recording);
    RUN_TEST(it_keeps_the_limits);
    RUN_TEST(it_tells_the_causes_apart_better);
    RUN_TEST(what_cannot_be_seen_is_not_reported);
    RUN_TEST(information_adds);
    RUN_TEST(the_file_is_read_back);
    RUN_TEST(limits_are_what_the_diagnosis_does);
    RUN_TEST(limits_that_cannot_be_kept_are_refused);
    return UNITY_END();
}
