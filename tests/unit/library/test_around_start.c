/*
 * The first start of a drive without any known value, against the switching plant: sensors with offsets, a quantised
 * encoder with any zero, a rotor at any angle. Offset, alignment, encoder with its index, tracker, then the closed
 * loop; and the open-loop run-up with a handover while it turns.
 */
#include "around_drive.h"

#include "iqfoc/encoder.h"
#include "iqfoc/offset.h"
#include "iqfoc/start.h"
#include "iqfoc/tracker.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>

#define COUNTS   4096
#define U_DC_V   300.0
#define T_S      2e-4
#define I_RUN_PU 0.3

static const iqfoc_offset_limits_t offset_limits = {20, 9, IQ24(0.25), IQ24(0.02)};
static const iqfoc_start_config_t alignment = {IQ24(0.5), 1000, 2500, 0, 0};
static const iqfoc_tracker_config_t tracking = IQFOC_TRACKER_GAINS(400.0, T_S, IQ24(0.1), 50);

static around_drive d;
static iqfoc_offset_t offset;
static iqfoc_start_t start;
static iqfoc_encoder_t encoder;
static iqfoc_tracker_t tracker;

void setUp(void)
{
}

void tearDown(void)
{
}

static plant_config truth_with(double theta_mech_turns)
{
    plant_config truth = around_plant(U_DC_V);
    truth.shaft.theta_mech_start_rad = VEC_TWO_PI * theta_mech_turns;
    truth.sensors.current_offset_A[0] = 1.7;
    truth.sensors.current_offset_A[1] = -1.1;
    truth.sensors.current_offset_A[2] = 0.6;
    return truth;
}

static void calibrate(void)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&offset, &offset_limits));
    while (offset.verdict == IQFOC_OFFSET_BUSY) {
        const iqfoc_sample_t valley = around_valley(&d);
        (void)iqfoc_offset_step(&offset, valley.i);
        (void)around_peak(&d);
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_GOOD, offset.verdict);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.7, iq24_to_double(offset.offset.a) * d.base.I_A);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -1.1, iq24_to_double(offset.offset.b) * d.base.I_A);
}

/* A cycle on the start's angle, from its valley's sample on. */
static void forced_on(iqfoc_sample_t sample, iq24_t sensor_theta)
{
    iqfoc_start_step(&start, sensor_theta);
    d.cycle.i_ref = start.i_ref;
    sample.i = iqfoc_offset_removed(&offset, sample.i);
    sample.theta = start.theta;
    sample.speed = start.speed;
    around_valley_handler(&d, &sample);
    sample = around_peak(&d);
    sample.i = iqfoc_offset_removed(&offset, sample.i);
    sample.theta = iqfoc_start_theta(&start, sample.instant);
    sample.speed = start.speed;
    around_peak_handler(&d, &sample);
}

static void forced_cycle(iq24_t sensor_theta)
{
    forced_on(around_valley(&d), sensor_theta);
}

/* The encoder at this valley. It is read late, as a handler does, and says when. */
static void track(double zero_turns)
{
    const double late = 0.05;
    const double at_valley = d.truth.theta_e_rad;
    d.truth.theta_e_rad += d.truth.omega_e_rad_s * T_S * late;
    const uint32_t count = around_encoder(&d, COUNTS, zero_turns);
    d.truth.theta_e_rad = at_valley;
    iqfoc_tracker_step(&tracker, iqfoc_encoder_theta(&encoder, count), iq24_from_double(late), true);
}

/* A valley's sample as the tracker sees it. */
static iqfoc_sample_t tracked_valley(double zero_turns)
{
    iqfoc_sample_t sample = around_valley(&d);
    track(zero_turns);
    sample.i = iqfoc_offset_removed(&offset, sample.i);
    sample.theta = iqfoc_tracker_theta(&tracker, 0);
    sample.speed = iqfoc_tracker_speed(&tracker);
    return sample;
}

/* The rest of that cycle. */
static void tracked_on(iqfoc_sample_t sample)
{
    around_valley_handler(&d, &sample);
    sample = around_peak(&d);
    sample.i = iqfoc_offset_removed(&offset, sample.i);
    sample.theta = iqfoc_tracker_theta(&tracker, sample.instant);
    sample.speed = iqfoc_tracker_speed(&tracker);
    around_peak_handler(&d, &sample);
}

/* One cycle on the tracker's angle. */
static void tracked_cycle(double zero_turns)
{
    tracked_on(tracked_valley(zero_turns));
}

static iq24_t shown(double zero_turns)
{
    return iqfoc_encoder_theta(&encoder, around_encoder(&d, COUNTS, zero_turns));
}

static void begin(double theta_mech_turns)
{
    static const iqfoc_encoder_config_t config = {COUNTS, 3, 4, false, 0};
    const plant_config truth = truth_with(theta_mech_turns);
    around_begin(&d, &truth);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &config));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&tracker, &tracking));
    calibrate();
    d.cycle.enabled = true;
}

static void align(double zero_turns)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&start, &alignment));
    while (start.stage != IQFOC_START_ALIGNED) {
        forced_cycle(shown(zero_turns));
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_START_GOOD, start.verdict);
    iqfoc_encoder_align(&encoder, around_encoder(&d, COUNTS, zero_turns), start.theta);
}

/* Rotors that stand anywhere, those without torque at a quarter turn included, and encoders put on anyhow. */
static void test_from_any_angle(void)
{
    double worst_align = 0.0;
    double worst_theta = 0.0;
    double worst_turns = 0.0;
    for (int32_t n = 0; n < 8; n++) {
        const double zero_turns = 0.137 * n + 0.05;
        begin((n / 8.0 - 0.25) / 3.0);
        align(zero_turns);
        worst_align = fmax(worst_align, fabs(around_off(shown(zero_turns), around_turns(&d))));
        d.cycle.i_ref.d = 0;
        d.cycle.i_ref.q = iq24_from_double(n % 2 == 0 ? I_RUN_PU : -I_RUN_PU);
        uint32_t before = around_encoder(&d, COUNTS, zero_turns);
        for (int32_t k = 0; k < 1500; k++) {
            tracked_cycle(zero_turns);
            const uint32_t count = around_encoder(&d, COUNTS, zero_turns);
            if (before > 3 * COUNTS / 4 && count < COUNTS / 4) {
                TEST_ASSERT_TRUE(iqfoc_encoder_index(&encoder, 0)); /* the timer's capture */
            }
            before = count;
            if (k > 100) {
                worst_theta =
                    fmax(worst_theta,
                         fabs(around_off(iqfoc_tracker_theta(&tracker, IQ24(0.5)), around_turns(&d))));
                worst_turns =
                    fmax(worst_turns, fabs(iq24_to_double(iqfoc_tracker_speed(&tracker)) - around_speed(&d)));
            }
        }
        TEST_ASSERT_EQUAL_UINT32(0, d.cycle.status);
        TEST_ASSERT_FALSE(tracker.lost);
        TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.0, d.mean_dq_A[0]);
        TEST_ASSERT_DOUBLE_WITHIN(0.06, (n % 2 == 0 ? I_RUN_PU : -I_RUN_PU) * d.base.I_A, d.mean_dq_A[1]);
        TEST_ASSERT_TRUE(fabs(around_speed(&d)) > 0.02);
    }
    printf("  aligned to %.4f turns, tracked to %.5f turns (a count is %.5f), speed to %.2e turns a cycle\n",
           worst_align, worst_theta, 3.0 / COUNTS, worst_turns);
    TEST_ASSERT_TRUE(worst_align < 0.004);
    TEST_ASSERT_TRUE(worst_theta < worst_align + 1.0 * 3.0 / COUNTS);
    TEST_ASSERT_TRUE(worst_turns < 1.5e-4);
}

/* Wired wrongly: an encoder that counts backwards, one that stands still, one with other pole pairs. */
static void test_what_the_alignment_finds(void)
{
    static const struct {
        double per_turn;
        iqfoc_start_verdict_t verdict;
    } cases[] = {{1.0, IQFOC_START_GOOD},
                 {-1.0, IQFOC_START_REVERSED},
                 {0.0, IQFOC_START_STUCK},
                 {5.0 / 3.0, IQFOC_START_WRONG_WAY}};
    for (uint32_t n = 0; n < 4; n++) {
        begin(0.21);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&start, &alignment));
        while (start.stage != IQFOC_START_ALIGNED) {
            forced_cycle(iq24_from_double(remainder(cases[n].per_turn * around_turns(&d) + 0.3, 1.0)));
        }
        TEST_ASSERT_EQUAL_INT(cases[n].verdict, start.verdict);
    }
}

/* The index' angle kept from an earlier day: no alignment, and lost counts are put right at the next index. */
static void test_index_instead_of_alignment(void)
{
    const double zero_turns = 0.3;
    begin(0.02);
    align(zero_turns);
    d.cycle.i_ref.d = 0;
    d.cycle.i_ref.q = IQ24(I_RUN_PU);
    uint32_t lost = 0;
    int32_t slip = 0;
    double worst = 0.0;
    double best = 1.0;
    uint32_t before = around_encoder(&d, COUNTS, zero_turns);
    for (int32_t k = 0; k < 3000; k++) {
        /* Interference: 40 counts are lost for good at cycle 1000, 0.03 turn. */
        lost = k >= 1000 ? 40 : 0;
        tracked_cycle(zero_turns + lost / (double)COUNTS);
        const uint32_t count = around_encoder(&d, COUNTS, zero_turns);
        if (before > 3 * COUNTS / 4 && count < COUNTS / 4) {
            slip = iqfoc_encoder_index(&encoder, (COUNTS - lost) % COUNTS) ? slip : encoder.slip;
        }
        before = count;
        const double off = fabs(around_off(iqfoc_tracker_theta(&tracker, IQ24(0.5)), around_turns(&d)));
        worst = k > 1000 ? fmax(worst, off) : worst;
        best = k > 2900 ? off : best;
    }
    printf("  40 counts lost: %.4f turns off, %.4f again after the index\n", worst, best);
    TEST_ASSERT_TRUE(worst > 0.02);
    TEST_ASSERT_TRUE(best < 0.004);
    TEST_ASSERT_EQUAL_UINT32(1, encoder.slips);
    TEST_ASSERT_EQUAL_INT32(-40, slip);
    /* The electrical angle of the index, as it would be kept. */
    TEST_ASSERT_TRUE(fabs(around_off(iqfoc_encoder_index_theta(&encoder), 3.0 * zero_turns)) < 0.004);
}

/*
 * Drawn along by an angle that turns by itself, to a steady speed; the tracker also follows the encoder, which was
 * aligned on the way.
 */
static void run_open_loop(iq24_t speed_end, double zero_turns)
{
    static iqfoc_start_config_t run_up = {IQ24(0.5), 1000, 2500, 0, 5000};
    run_up.speed_end = speed_end;
    begin(0.11);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&start, &run_up));
    while (start.stage != IQFOC_START_RUN_UP) {
        forced_cycle(shown(zero_turns));
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_START_GOOD, start.verdict);
    iqfoc_encoder_align(&encoder, around_encoder(&d, COUNTS, zero_turns), start.theta);
    while (start.stage != IQFOC_START_OPEN_LOOP || start.done < 3000) {
        const iqfoc_sample_t sample = around_valley(&d);
        track(zero_turns);
        forced_on(sample, 0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.002, iq24_to_double(speed_end), around_speed(&d));
}

/* Handed over to the tracker: the most by which the torque of a cycle leaves that of the last before, percent of
 * rated. The machine has no saliency: torque is i_q. */
static double bump_of_handover(bool whole, double zero_turns)
{
    iqfoc_sample_t sample = tracked_valley(zero_turns);
    iqfoc_start_step(&start, 0);
    const double before_A = d.mean_dq_A[1];
    if (whole) {
        iqfoc_cycle_hand_over(&d.cycle, start.theta, &sample);
    } else {
        d.cycle.i_ref = iqfoc_start_handover(&start, sample.theta);
    }
    tracked_on(sample);
    double most_A = 0.0;
    for (int32_t k = 0; k < 500; k++) {
        tracked_cycle(zero_turns);
        most_A = fmax(most_A, fabs(d.mean_dq_A[1] - before_A));
    }
    TEST_ASSERT_TRUE(!whole || d.cycle.status == 0);
    return 100.0 * most_A / d.base.I_A;
}

static void test_open_loop_and_handover(void)
{
    static const double speeds[] = {0.01, -0.01, 0.025, -0.03};
    const double zero_turns = 0.21;
    for (uint32_t n = 0; n < 4; n++) {
        const iq24_t speed_end = iq24_from_double(speeds[n]);
        run_open_loop(speed_end, zero_turns);
        const double behind = around_off(start.theta, around_turns(&d));
        const double bump = bump_of_handover(true, zero_turns);
        run_open_loop(speed_end, zero_turns);
        const double by_reference = bump_of_handover(false, zero_turns);
        printf("  %.3f turns a cycle, load angle %.3f turns: torque moves by %.2f %% of rated, by i_ref "
               "alone %.1f %%\n",
               speeds[n], behind, bump, by_reference);
        TEST_ASSERT_TRUE(bump < 2.0);
        TEST_ASSERT_TRUE(by_reference > 4.0 * bump);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_from_any_angle);
    RUN_TEST(test_what_the_alignment_finds);
    RUN_TEST(test_index_instead_of_alignment);
    RUN_TEST(test_open_loop_and_handover);
    return UNITY_END();
}
