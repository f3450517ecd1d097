/*
 * modulation = "pattern" of a scenario: the drive of the 2019 paper at 565 V on the switching-level plant, next to PWM with slightly more
 * switchings. Currents are shares of the rated peak.
 */
#include "data/scenario.h"
#include "drive/drive_scenario.h"
#include "drive/firmware_host.h"
#include "host_files.h"
#include "patterns/pattern_drive.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

#define SPEED_RPM  4800.0 /* 240 Hz: 5.2 periods of the carrier below in a turn */
#define CARRIER_HZ 1250.0
#define CYCLE_HZ   5000.0

enum { PULSES = 5, POINTS = 32 };

static motor m;
static scenario s;

static const char steady[] =
    "speed_rpm = 4800\ni_q_A = 10\ni_d_A = -2\nduration_s = 0.5\nsettle_cycles = 500\n";

void setUp(void)
{
    m = motor_blank();
    m.pole_pairs = 3;
    m.R_ohm = 0.75;
    m.L_d_H = m.L_q_H = 5.2e-3;
    m.psi_f_Wb = 0.134;
    m.I_rated_A_rms = 10.5;
    m.n_max_rpm = 5500.0;
    m.f_pwm_Hz = CYCLE_HZ;
    m.u_dc_V = 565.0;
}

void tearDown(void)
{
    scenario_free(&s);
}

static const char *read_scenario(const char *control, const char *run)
{
    char text[1000];
    error e = {0};
    snprintf(text, sizeof text, "[control]\n%s[[run]]\n%s", control, run);
    const char *path = scratch_text("s.toml", text);
    TEST_ASSERT_TRUE_MESSAGE(scenario_read(path, &s, &e), e.text);
    return path;
}

typedef struct sums {
    double complex i;
    double square;
    long points, edges, cycles;
} sums;

static void add_point(void *context, const plant *now)
{
    sums *sum = context;
    const plant_point at = plant_now(now);
    const double complex i = (at.i_dq_A.d + I * at.i_dq_A.q) / motor_rated_peak_A(&m);
    sum->i += i;
    sum->square += creal(i * conj(i));
    sum->points++;
}

/* The one run of the scenario. */
static sums run(const drive_firmware *firmware)
{
    drive_loop l;
    iqfoc_cycle_config_t config;
    error e = {0};
    sums sum = {.i = 0.0};
    const plant_config c = drive_scenario_plant(&m, &s);
    TEST_ASSERT_TRUE_MESSAGE(config_from_motor(&m, &s.control, &config, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(drive_run_begin(&l, &m, &c, &s.run[0], &config, firmware, &e), e.text);
    const long cycles = scenario_run_cycles(&s.run[0], l.base.T_s);
    for (long k = -s.run[0].settle_cycles; k < cycles; k++) {
        drive_row row = {.run = 1};
        if (k == 0) {
            l.watch = (drive_watch){&sum, POINTS, add_point};
        }
        const iqfoc_dq_t i_ref = drive_run_cycle(&l, &m, &s.run[0], k);
        for (int x = 0; x < 3 && k >= 0 && l.by_edges; x++) {
            sum.edges += l.edges[x].edges;
        }
        TEST_ASSERT_TRUE_MESSAGE(drive_loop_span(&l, i_ref, &row, &e), e.text);
        double u_V[3];
        recording_commanded(row.duty, row.valley.u_dc_V, u_V);
        for (int x = 0; x < 3 && k >= 0 && l.by_edges; x++) { /* the row holds what the machine got */
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, row.truth.u_V[x], u_V[x]);
        }
    }
    sum.cycles = cycles;
    return sum;
}

static double distortion(const sums *sum)
{
    const double complex mean = sum->i / (double)sum->points;
    return sqrt(sum->square / (double)sum->points - creal(mean * conj(mean)));
}

/* By the sum over the harmonics of the table's row: no resistance, open loop. */
static double by_harmonics(double i_d, double i_q)
{
    static patterns_result found;
    error e = {0};
    const patterns_request asked = {.pulses = PULSES};
    TEST_ASSERT_TRUE_MESSAGE(patterns_find(&asked, &found, &e), e.text);
    const double w = motor_speed_rad_s(&m, SPEED_RPM);
    const double index = patterns_index_of(&m, w, i_d, i_q);
    const double place = (index - patterns_index(0)) * PATTERNS_ROWS_PER_INDEX;
    const int n = (int)place;
    const double between =
        found.row[n].distortion + (place - n) * (found.row[n + 1].distortion - found.row[n].distortion);
    return between * index * 2.0 / acos(-1.0) * m.u_dc_V / w / (m.L_d_H * motor_rated_peak_A(&m));
}

static void test_current_follows_and_ripples_less(void)
{
    static pattern_drive pattern;
    static drive_host host;
    drive_firmware firmware;
    error e = {0};
    const char *path = read_scenario("modulation = \"pattern\"\npulses = 5\n", steady);
    TEST_ASSERT_TRUE_MESSAGE(pattern_drive_begin(&pattern, &m, &s, path, &firmware, &e), e.text);
    const sums got = run(&firmware);
    const double complex wanted = (-2.0 + 10.0 * I) / motor_rated_peak_A(&m);
    const double off = cabs(got.i / (double)got.points - wanted);
    const double own = by_harmonics(creal(wanted), cimag(wanted));
    const double turns = motor_speed_rad_s(&m, SPEED_RPM) / 2.0 / acos(-1.0) * (double)got.cycles / CYCLE_HZ;
    scenario_free(&s);

    m.f_pwm_Hz = CARRIER_HZ;
    read_scenario("feedback = \"quasi_discrete_mean\"\n", steady);
    firmware = drive_firmware_host(&host, NULL);
    const sums pwm = run(&firmware);
    printf("  mean current off by %.4f; distortion %.4f, by its harmonics %.4f, PWM %.4f; pulses a turn "
           "%.3f, PWM %.3f\n",
           off, distortion(&got), own, distortion(&pwm), (double)got.edges / 6.0 / turns,
           CARRIER_HZ * (double)got.cycles / CYCLE_HZ / turns);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, PULSES, (double)got.edges / 6.0 / turns);
    TEST_ASSERT_TRUE(off < 0.005);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * own, own, distortion(&got));
    TEST_ASSERT_TRUE(distortion(&got) < distortion(&pwm));
}

static void refused(const char *runs, const char *where, const char *what)
{
    static pattern_drive pattern;
    drive_firmware firmware;
    error e = {0};
    char start[600];
    const char *path = read_scenario("modulation = \"pattern\"\npulses = 3\n", runs);
    TEST_ASSERT_TRUE_MESSAGE(pattern_drive_begin(&pattern, &m, &s, path, &firmware, &e), e.text);
    const plant_config c = drive_scenario_plant(&m, &s);
    const drive_scenario all = {&m, &s, &c, 1, &firmware, NULL, NULL};
    drive_recording out;
    TEST_ASSERT_FALSE(drive_scenario_run(&all, &out, &e));
    recording_free(&out.recording);
    snprintf(start, sizeof start, "%s:%s: ", path, where);
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(start, e.text, strlen(start), e.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, what), e.text);
    scenario_free(&s);
}

static void test_out_of_the_patterns_range(void)
{
    error e = {0};
    static pattern_drive pattern;
    drive_firmware firmware;
    refused("cycles = 5\nspeed_rpm = -500\n", "6:13", "-500 rpm, modulation index 0.06");
    refused("cycles = 5\nspeed_rpm = 13000\n", "6:13", "needs 781 to 12500 rpm, an index of 0.30 to 0.99");
    refused("cycles = 5\nspeed_rpm = 2000\n", "6:13", "modulation index 0.23");
    refused("cycles = 5\nspeed_rpm = 4800\nu_dc_V = 1000\n", "6:13", "a link of 282 to 848 V");
    refused("cycles = 900\nspeed_rpm = { at_s = [0, 0.1], ramp = [4000, 9000] }\n", "6:13", "run 1 at 0.08");
    refused("cycles = 5\n[run.shaft]\nJ_kgm2 = 1\n", "6:1", "0 rpm");
    m.L_q_H = 6e-3;
    const char *path = read_scenario("modulation = \"pattern\"\npulses = 3\n", steady);
    TEST_ASSERT_FALSE(pattern_drive_begin(&pattern, &m, &s, path, &firmware, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "needs a machine without saliency"), e.text);
}

int main(void)
{
    UNITY_BEGIN();
    scratch_begin();
    RUN_TEST(test_current_follows_and_ripples_less);
    RUN_TEST(test_out_of_the_patterns_range);
    scratch_end();
    return UNITY_END();
}
