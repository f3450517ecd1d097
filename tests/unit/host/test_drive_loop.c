/*
 * The simulator's loop (sim_host/drive/drive_loop.h): when a firmware is asked, when its answer acts, what an
 * interval of six-step is, and that to look on changes nothing.
 */
#include "../laboratory_motor.h"
#include "drive/drive_loop.h"

#include "unity.h"

#include <math.h>
#include <string.h>

/* A firmware that notes its inputs and gives prescribed outputs. */
typedef struct scribe {
    int valleys, peaks;
    iqfoc_sample_t valley, peak;
    iqfoc_dq_t i_ref;
    drive_answer answer;
    bool gone;
} scribe;

static scribe wrote;
static drive_loop loop;

static bool valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    scribe *s = context;
    (void)i_ref;
    (void)e;
    s->valleys++;
    s->valley = *sample;
    return true;
}

static bool peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                 error *e)
{
    scribe *s = context;
    s->peaks++;
    s->peak = *sample;
    s->i_ref = i_ref;
    *answer = s->answer;
    return !s->gone || error_failure(e, 0, "gone");
}

static const drive_firmware firmware = {&wrote, NULL, valley, peak};

static void answer_legs(double a, double b, double c, double interval_s)
{
    wrote.answer.command.duties.high =
        (iqfoc_abc_t){iq24_from_double(a), iq24_from_double(b), iq24_from_double(c)};
    wrote.answer.interval_s = interval_s;
}

static drive_row span(void)
{
    drive_row row = {.run = 0};
    error e = {0, ""};
    const iqfoc_dq_t i_ref = {IQ24(0.25), IQ24(-0.5)};
    TEST_ASSERT_TRUE_MESSAGE(drive_loop_span(&loop, i_ref, &row, &e), e.text);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.5), wrote.i_ref.q);
    return row;
}

void setUp(void)
{
    motor m = laboratory_motor();
    const plant_config c = plant_config_from_motor(&m);
    memset(&wrote, 0, sizeof wrote);
    drive_loop_begin(&loop, &m, &c, &firmware);
    plant_set_speed(&loop.drive, 1000.0, 0.0);
}

void tearDown(void)
{
}

/* Asked at the valley and at the peak; what it answers acts from the next valley on. */
static void a_cycle_is_sampled_twice_and_answered_for_the_next(void)
{
    answer_legs(0.5, 0.75, 0.25, 0.0);
    const drive_row first = span();
    TEST_ASSERT_EQUAL_INT(1, wrote.valleys);
    TEST_ASSERT_EQUAL_INT(1, wrote.peaks);
    TEST_ASSERT_EQUAL_INT32(0, wrote.valley.instant);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5), wrote.peak.instant);
    TEST_ASSERT_EQUAL_UINT32(10000, wrote.peak.time); /* half of 200 us, in ticks of 10 ns */
    TEST_ASSERT_FALSE(wrote.peak.has_mean);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, first.duty[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, first.truth.u_V[1]);
    const drive_row second = span();
    TEST_ASSERT_EQUAL_DOUBLE(0.75, second.duty[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.25 * 750.0, second.truth.u_V[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 200e-6, second.truth.duration_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 200e-6, second.valley.t_s);
}

/* One state for the time asked for; asked at its end alone, with the means over it; then PWM again. */
static void an_interval_is_sampled_at_its_end_with_its_means(void)
{
    answer_legs(1.0, 1.0, 0.0, 137e-6);
    (void)span();
    answer_legs(0.5, 0.5, 0.5, 0.0);
    const drive_row row = span();
    TEST_ASSERT_EQUAL_INT(1, wrote.valleys);
    TEST_ASSERT_EQUAL_INT(2, wrote.peaks);
    TEST_ASSERT_EQUAL_INT32(0, wrote.peak.instant);
    TEST_ASSERT_TRUE(wrote.peak.has_mean);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 137e-6, row.truth.duration_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 337e-6, row.peak.t_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -500.0, row.truth.u_V[2]);
    TEST_ASSERT_INT32_WITHIN(1, iq24_from_double(row.truth.i_A[2] / loop.base.I_A), wrote.peak.i_mean.c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 200e-6, span().truth.duration_s);
    TEST_ASSERT_EQUAL_INT(2, wrote.valleys);
}

typedef struct onlooker {
    int points;
    double t_s[8];
} onlooker;

static void look(void *context, const plant *now)
{
    onlooker *o = context;
    TEST_ASSERT_TRUE(o->points < 8);
    o->t_s[o->points++] = plant_now(now).t_s;
}

static void a_watch_sees_equal_parts_and_changes_nothing(void)
{
    onlooker seen = {0, {0.0}};
    answer_legs(0.5, 0.75, 0.25, 0.0);
    (void)span();
    const drive_loop before = loop;
    const drive_row alone = span();
    loop = before;
    loop.watch = (drive_watch){&seen, 4, look};
    const drive_row watched = span();
    TEST_ASSERT_EQUAL_INT(4, seen.points);
    for (int n = 0; n < 4; n++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 250e-6 + n * 50e-6, seen.t_s[n]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, alone.truth.i_A[0], watched.truth.i_A[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, alone.peak.i_A[1], watched.peak.i_A[1]);
    TEST_ASSERT_EQUAL_DOUBLE(alone.peak.t_s, watched.peak.t_s);
}

static void a_firmware_that_is_gone_ends_the_loop(void)
{
    drive_row row;
    error e = {0, ""};
    wrote.gone = true;
    TEST_ASSERT_FALSE(drive_loop_span(&loop, (iqfoc_dq_t){0, 0}, &row, &e));
    TEST_ASSERT_EQUAL_STRING("gone", e.text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_cycle_is_sampled_twice_and_answered_for_the_next);
    RUN_TEST(an_interval_is_sampled_at_its_end_with_its_means);
    RUN_TEST(a_watch_sees_equal_parts_and_changes_nothing);
    RUN_TEST(a_firmware_that_is_gone_ends_the_loop);
    return UNITY_END();
}
