/*
 * The next experiment (sim_host/diagnose/next): recordings of the switching-level drive that cannot distinguish
 * two causes, the same with the advised run, and the same with a run that should help little.
 */
#include "data/plan_pieces.h"
#include "diagnose/diagnose.h"
#include "drive/drive_scenario.h"
#include "drive/firmware_host.h"
#include "plant/plant_effect.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

static motor machine;
static diagnosis alone;
static diagnosis more;

static const plan_limits sensors = {.noise_A = 0.025, .bits = 12, .full_scale_A = 25.0};

static void take(const char *path)
{
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(motor_read(path, &machine, &e), e.text);
}

void setUp(void)
{
    take("data/motors/compressor_salient.toml");
}

void tearDown(void)
{
    diagnosis_free(&alone);
    diagnosis_free(&more);
}

/* Records pieces, a run each, with a drive that has the effect, and diagnoses them with the plain file. */
static void record(const plan_piece *piece, const double *seconds, size_t pieces, const char *effect,
                   long seed, diagnosis *d)
{
    enum { MOST = 3 };
    static drive_host host;
    static scenario_run run[MOST];
    error e = {0};
    plan_limits limits = sensors;
    limits.u_dc_V = machine.u_dc_V;
    for (size_t n = 0; n < pieces; n++) {
        run[n] = plan_piece_run(&piece[n], &machine, &limits, lround(seconds[n] * machine.f_pwm_Hz));
    }
    const scenario s = plan_scenario(&limits, run, pieces);
    const drive_firmware firmware = drive_firmware_host(&host, NULL);
    const diagnose_options options = {0};
    plant_config c = drive_scenario_plant(&machine, &s);
    const drive_scenario all = {&machine, &s, &c, seed, &firmware, NULL, NULL};
    drive_recording out;
    TEST_ASSERT_TRUE_MESSAGE(plant_effect_apply(&c, effect, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(drive_scenario_run(&all, &out, &e), e.text);
    TEST_ASSERT_TRUE(recording_find_stretches(&out.recording));
    TEST_ASSERT_TRUE_MESSAGE(diagnose(d, &out.recording, &machine, &options, &e), e.text);
    recording_free(&out.recording);
}

static bool explains(const diagnosis *d, const char *id)
{
    bool found = false;
    for (size_t k = 0; k < d->explanations; k++) {
        found = found || strcmp(d->explanation[k].words, id) == 0;
    }
    return found;
}

/* Whether the recording does not show which of the two it is: one is named with the other, or neither is. */
static bool confuses(const diagnosis *d, const char *a, const char *b)
{
    if (explains(d, a) && explains(d, b)) {
        return true;
    }
    for (size_t k = 0; k < d->causes; k++) {
        for (size_t n = 0; n < d->cause[k].confused; n++) {
            if ((strcmp(d->cause[k].id, a) == 0 && strcmp(d->cause[k].confused_with[n], b) == 0) ||
                (strcmp(d->cause[k].id, b) == 0 && strcmp(d->cause[k].confused_with[n], a) == 0)) {
                return true;
            }
        }
    }
    return false;
}

/* The recording, with the run at a place of the ranking. */
static void record_in_addition(const plan_piece *poor, double seconds, const char *effect, size_t place)
{
    const plan_piece both[] = {*poor, alone.experiment.candidate[place].piece};
    const double lengths[] = {seconds, alone.experiment.seconds};
    diagnosis_free(&more);
    record(both, lengths, 2, effect, 7, &more);
}

typedef struct trade {
    const char *motor, *effect, *cause, *rival;
    plan_piece poor;
    bool any_tells; /* even the last of the ranking */
} trade;

/* One operating point: at standstill a resistance is a voltage's gain, at one speed a flux, and an angle that is late is
 * one that is off. */
static const trade trades[] = {
    {"data/motors/compressor_salient.toml",
     "voltage_gain:k_u=1.05",
     "voltage_gain",
     "resistance",
     {.words = "", .i_q_A = {6.0, 6.0}},
     true},
    {"data/motors/compressor_salient.toml",
     "resistance:R=1.1",
     "resistance",
     "flux_linkage",
     {.words = "", .rpm = {600.0, 600.0}, .i_q_A = {6.0, 6.0}},
     true},
    {"data/motors/jarzebowicz2019.toml",
     "angle_offset:theta_0=0.05",
     "angle_offset",
     "angle_delay",
     {.words = "", .rpm = {1500.0, 1500.0}, .i_q_A = {6.0, 6.0}, .square_q_A = 0.5, .half_q_cycles = 37},
     false},
};

static void the_advised_run_separates(void)
{
    const double seconds = 0.5;
    for (size_t n = 0; n < sizeof trades / sizeof *trades; n++) {
        const trade *t = &trades[n];
        diagnosis_free(&alone);
        take(t->motor);
        record(&t->poor, &seconds, 1, t->effect, 3, &alone);
        const diagnosis_experiment *x = &alone.experiment;
        printf("  %s\n", alone.next_experiment);
        TEST_ASSERT_TRUE(confuses(&alone, t->cause, t->rival));
        TEST_ASSERT_NOT_NULL(x->tell[0]);
        TEST_ASSERT_TRUE(strcmp(x->tell[0], t->cause) == 0 || strcmp(x->tell[0], t->rival) == 0);
        TEST_ASSERT_TRUE(strcmp(x->tell[1], t->cause) == 0 || strcmp(x->tell[1], t->rival) == 0);
        TEST_ASSERT_TRUE(x->candidate[0].enough);
        TEST_ASSERT_TRUE(fabs(x->correlation) > 0.95 && fabs(x->candidate[0].correlation) < 0.8);
        TEST_ASSERT_NOT_NULL(strstr(alone.next_experiment, "the correlation of"));

        record_in_addition(&t->poor, seconds, t->effect, 0);
        TEST_ASSERT_EQUAL_size_t(1, more.causes);
        TEST_ASSERT_EQUAL_STRING(t->cause, more.cause[0].id);
        TEST_ASSERT_EQUAL_size_t(0, more.cause[0].confused);

        record_in_addition(&t->poor, seconds, t->effect, x->candidates - 1);
        TEST_ASSERT_EQUAL(t->any_tells, x->candidate[x->candidates - 1].enough);
        TEST_ASSERT_EQUAL(!t->any_tells, confuses(&more, t->cause, t->rival));
    }
}

/* The intervals that are promised are those that come, of the plant and its firmware. */
static void what_is_promised_comes(void)
{
    const plan_piece poor = {.words = "", .rpm = {600.0, 600.0}, .i_q_A = {6.0, 6.0}};
    const double seconds = 0.5;
    record(&poor, &seconds, 1, "resistance:R=1.1", 3, &alone);
    const diagnosis_experiment *x = &alone.experiment;
    record_in_addition(&poor, seconds, "resistance:R=1.1", 0);
    const diagnosis_parameter *R = &more.cause[0].parameter[0];
    const double half = 0.5 * (R->high - R->low);
    TEST_ASSERT_EQUAL_STRING("R", x->number[0].name);
    printf("  R +-%.4f promised, +-%.4f came\n", x->candidate[0].half_width[0], half);
    TEST_ASSERT_TRUE(half < 2.0 * x->candidate[0].half_width[0]);
    TEST_ASSERT_TRUE(half > 0.4 * x->candidate[0].half_width[0]);
    TEST_ASSERT_TRUE(R->low < 1.1 && R->high > 1.1);
}

/* All pieces keep what the recording kept. */
static void the_recordings_limits_hold(void)
{
    const plan_piece poor = {.words = "", .rpm = {600.0, 600.0}, .i_q_A = {6.0, 6.0}};
    const double seconds = 0.5;
    record(&poor, &seconds, 1, "resistance:R=1.1", 3, &alone);
    for (size_t k = 0; k < alone.experiment.candidates; k++) {
        const plan_piece *p = &alone.experiment.candidate[k].piece;
        TEST_ASSERT_TRUE(fmax(fabs(p->rpm[0]), fabs(p->rpm[1])) < 606.0);
        const double d = fmax(fabs(p->i_d_A[0]), fabs(p->i_d_A[1])) + p->square_d_A;
        const double q = fmax(fabs(p->i_q_A[0]), fabs(p->i_q_A[1])) + p->square_q_A;
        TEST_ASSERT_TRUE(hypot(d, q) < 6.2);
        TEST_ASSERT_TRUE(k == 0 ||
                         alone.experiment.candidate[k - 1].open <= alone.experiment.candidate[k].open);
    }
}

/* A locked rotor shows no magnet: what turns it is advised, and tells. */
static void what_is_not_excited_is_excited(void)
{
    const plan_piece poor = {.words = "",
                             .i_d_A = {3.0, 3.0},
                             .square_d_A = 1.0,
                             .square_q_A = 1.0,
                             .half_d_cycles = 23,
                             .half_q_cycles = 37};
    const double seconds = 0.5;
    record(&poor, &seconds, 1, "resistance:R=1.1", 3, &alone);
    const diagnosis_experiment *x = &alone.experiment;
    printf("  %s\n", alone.next_experiment);
    TEST_ASSERT_FALSE(alone.estimate[3].excited);
    TEST_ASSERT_EQUAL_size_t(1, x->numbers);
    TEST_ASSERT_EQUAL_STRING("psi_f", x->number[0].name);
    TEST_ASSERT_NULL(x->tell[0]);
    TEST_ASSERT_TRUE(x->candidate[0].piece.rpm[0] != 0.0 || x->candidate[0].piece.rpm[1] != 0.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, x->candidate[x->candidates - 1].piece.rpm[0]);
    record_in_addition(&poor, seconds, "resistance:R=1.1", 0);
    TEST_ASSERT_TRUE(more.estimate[3].excited);
    record_in_addition(&poor, seconds, "resistance:R=1.1", x->candidates - 1);
    TEST_ASSERT_FALSE(more.estimate[3].excited);
}

/* Where nothing is open nothing is computed. */
static void nothing_open_nothing_advised(void)
{
    const plan_piece rich[] = {{.words = "",
                                .rpm = {600.0, 600.0},
                                .i_q_A = {4.0, 4.0},
                                .square_d_A = 1.0,
                                .square_q_A = 1.0,
                                .half_d_cycles = 23,
                                .half_q_cycles = 37},
                               {.words = "",
                                .rpm = {-1500.0, -1500.0},
                                .i_q_A = {-2.0, -2.0},
                                .square_d_A = 1.0,
                                .square_q_A = 1.0,
                                .half_d_cycles = 23,
                                .half_q_cycles = 37}};
    const double seconds[] = {0.5, 0.5};
    record(rich, seconds, 2, "resistance:R=1.1", 3, &alone);
    TEST_ASSERT_EQUAL_size_t(0, alone.experiment.numbers);
    TEST_ASSERT_EQUAL_size_t(0, alone.experiment.candidates);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_advised_run_separates);
    RUN_TEST(what_is_promised_comes);
    RUN_TEST(the_recordings_limits_hold);
    RUN_TEST(what_is_not_excited_is_excited);
    RUN_TEST(nothing_open_nothing_advised);
    return UNITY_END();
}
