/*
 * Two drives through all pulse modes and back (sim_host/loops/pulse_run_up.h): carrier, synchronous carrier, patterns of 9, 7 and 5 pulses,
 * six-step.
 */
#include "data/motor.h"
#include "loops/pulse_run_ups.h"
#include "plant/plant_random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unity.h>

#define PI 3.14159265358979323846

enum { SIX_STEP = PULSE_LEVELS - 1 };

static const char *const event_names[PULSE_EVENTS] = {
    [PULSE_EVENT_CARRIER] = "carrier, its periods per turn change",
    [PULSE_EVENT_TO_PATTERN] = "carrier to 9 pulses",
    [PULSE_EVENT_TO_CARRIER] = "9 pulses to carrier",
    [PULSE_EVENT_PATTERNS] = "between 9, 7 and 5 pulses",
    [PULSE_EVENT_TO_SIX_STEP] = "5 pulses to six-step",
    [PULSE_EVENT_FROM_SIX_STEP] = "six-step to 5 pulses",
    [PULSE_EVENT_JUMP] = "jump of the angles in a table",
    [PULSE_EVENT_TOP] = "six-step at constant speed",
};
static pulse_tables tables;
static double worst_of[PULSE_DRIVES][2][PULSE_EVENTS]; /* constant link, ripple */

void setUp(void)
{
}

void tearDown(void)
{
}

static void find_tables(void)
{
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(pulse_tables_find(&tables, &e), e.text);
}

/* Up through all levels and down again, each once. */
static const pulse_run_up *run(const pulse_drive *p, const pulse_case *c)
{
    static pulse_run_up r;
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(pulse_run_up_run(p, &tables, c, &r, &e), e.text);
    TEST_ASSERT_EQUAL_INT(SIX_STEP, r.highest);
    TEST_ASSERT_EQUAL_INT(2 * SIX_STEP, r.changes);
    TEST_ASSERT_EQUAL_INT32(0, r.last);
    TEST_ASSERT_EQUAL_HEX32(0, r.status);
    TEST_ASSERT_EQUAL_INT(0, r.refused);
    TEST_ASSERT_TRUE(r.shortest_s >= PULSE_LEAST * p->pattern_s - 1e-9);
    return &r;
}

static void torque_of(pulse_drive_id id, int runs)
{
    static const double i_q[] = {1.0, 0.5, -0.6, 1.0};
    const pulse_drive p = pulse_drive_of(id);
    double(*worst)[PULSE_EVENTS] = worst_of[id];
    for (int n = 0; n < runs; n++) {
        const pulse_case c = {100.0,         1.0, i_q[n / 2 % 4], n % 2 != 0, n / 2 % 4 == 3 ? -1.0 : 1.0,
                              (n / 8) / 9.0, 0.0};
        const pulse_run_up *r = run(&p, &c);
        for (int k = 0; k < PULSE_EVENTS; k++) {
            worst[n % 2][k] = fmax(worst[n % 2][k], r->worst_percent[k]);
        }
    }
    for (int k = 0; k < PULSE_EVENTS; k++) {
        TEST_ASSERT_TRUE(fmax(worst[0][k], worst[1][k]) <= 1.8);
    }
    TEST_ASSERT_TRUE(worst[0][PULSE_EVENT_TOP] <= 0.5);
}

/* ---- The share of a hand-over ---- */

#define EARLY_HZ 6.0

enum { TORQUES = 44000 };

/* Torque at each instant of three runs: with the change at its speed, later, and earlier. */
typedef enum when { AT_ITS_SPEED, LATER, EARLIER, WHENS } when;
static pulse_torque torque[WHENS][TORQUES];

typedef struct share {
    double steady, added; /* the largest, % */
} share;

static share shares[PULSE_DRIVES][PULSE_EVENTS];

static pulse_event hand_over(pulse_run_mode before, pulse_run_mode after)
{
    return before <= PULSE_CARRIER_9  ? PULSE_EVENT_TO_PATTERN
           : after <= PULSE_CARRIER_9 ? PULSE_EVENT_TO_CARRIER
           : after == PULSE_SIX_STEP  ? PULSE_EVENT_TO_SIX_STEP
           : before == PULSE_SIX_STEP ? PULSE_EVENT_FROM_SIX_STEP
                                      : PULSE_EVENT_PATTERNS;
}

/*
 * A hand-over at instant `at`: within a turn of it the torque of the run, that of both modes without the hand-over, and the difference. The
 * mean torque has the weights 1 + cos over 2/3 of a turn: their part after the hand-over is that of the new mode. Both modes are in the
 * runs with the change earlier and later.
 */
static void add_hand_over(long at, long count, share *s)
{
    const pulse_run_mode before = torque[AT_ITS_SPEED][at - 1].mode;
    const pulse_run_mode after = torque[AT_ITS_SPEED][at].mode;
    const double turn_s = torque[AT_ITS_SPEED][at].turn_s;
    const when old_one = torque[LATER][at].mode == before ? LATER : EARLIER;
    const when new_one = old_one == LATER ? EARLIER : LATER;
    const long turn = lround(turn_s / PULSE_TORQUE_S);
    for (long k = at - turn; k <= at + turn && k < count; k++) {
        TEST_ASSERT_EQUAL_INT(before, torque[old_one][k].mode);
        TEST_ASSERT_EQUAL_INT(after, torque[new_one][k].mode);
        const double x = fmax(fmin((double)(k - at) * PULSE_TORQUE_S / (turn_s / 3.0), 1.0), -1.0);
        const double weight = 0.5 + 0.5 * x + sin(PI * x) / (2.0 * PI);
        const double steady =
            (1.0 - weight) * torque[old_one][k].percent + weight * torque[new_one][k].percent;
        s->steady = fmax(s->steady, fabs(steady));
        s->added = fmax(s->added, fabs(torque[AT_ITS_SPEED][k].percent - steady));
    }
}

/* With a ripple of the link, what the modes have without a hand-over, and what it adds. */
static void shares_of(pulse_drive_id id)
{
    const pulse_drive p = pulse_drive_of(id);
    for (int n = 0; n < 2; n++) {
        const double early_Hz[WHENS] = {0.0, -EARLY_HZ, EARLY_HZ};
        long count = 0;
        for (int k = 0; k < WHENS; k++) {
            const pulse_case c = {100.0, 1.0, 1.0, true, 1.0, n / 9.0, early_Hz[k]};
            error e = {0};
            count = pulse_run_up_torque(&p, &tables, &c, torque[k], TORQUES, &e);
            TEST_ASSERT_TRUE_MESSAGE(count > 0, e.text);
        }
        for (long k = 1; k < count; k++) {
            const pulse_run_mode before = torque[AT_ITS_SPEED][k - 1].mode;
            const pulse_run_mode after = torque[AT_ITS_SPEED][k].mode;
            if (before != after && (before > PULSE_CARRIER_9 || after > PULSE_CARRIER_9)) {
                add_hand_over(k, count, &shares[id][hand_over(before, after)]);
            }
        }
    }
}

static void test_share_of_the_hand_over(void)
{
    static const pulse_event shown[] = {PULSE_EVENT_TO_PATTERN, PULSE_EVENT_TO_CARRIER, PULSE_EVENT_PATTERNS,
                                        PULSE_EVENT_TO_SIX_STEP, PULSE_EVENT_FROM_SIX_STEP};
    shares_of(PULSE_DRIVE_2019);
    shares_of(PULSE_DRIVE_400_KW);
    printf("| link +-1 %% at 300 Hz, %% of the rated torque | both modes steadily | the hand-over adds | 400 "
           "kW, "
           "steadily | 400 kW, adds |\n| --- | ---: | ---: | ---: | ---: |\n");
    for (size_t n = 0; n < sizeof shown / sizeof shown[0]; n++) {
        const share *a = &shares[PULSE_DRIVE_2019][shown[n]];
        const share *b = &shares[PULSE_DRIVE_400_KW][shown[n]];
        TEST_ASSERT_TRUE(fmax(a->added, b->added) <= 1.5);
        TEST_ASSERT_TRUE(fmax(a->steady, b->steady) <= 1.6);
        printf("| %s | %.2f | %.2f | %.2f | %.2f |\n", event_names[shown[n]], a->steady, a->added, b->steady,
               b->added);
    }
}

/* What drawn runs of a drive have: the largest errors, and how many of the runs are over 2 %. */
typedef struct drawn {
    double most[PULSE_EVENTS];
    int over[PULSE_EVENTS];
} drawn;

/* From drawn angles, with drawn ramps and loads. */
static void draw(pulse_drive_id id, bool ripple, long runs, plant_random *random, drawn *out)
{
    const pulse_drive p = pulse_drive_of(id);
    for (long n = 0; n < runs; n++) {
        const double ramp_s = 0.9 + 0.3 * plant_random_uniform(random);
        const double i_q = 0.4 + 0.6 * plant_random_uniform(random);
        const double angle = plant_random_uniform(random);
        const pulse_case c = {100.0, ramp_s, n % 3 == 2 ? -i_q : i_q, ripple, n % 2 == 0 ? 1.0 : -1.0,
                              angle, 0.0};
        const pulse_run_up *r = run(&p, &c);
        for (int k = 0; k < PULSE_EVENTS; k++) {
            out->most[k] = fmax(out->most[k], r->worst_percent[k]);
            out->over[k] += r->worst_percent[k] > 2.0 ? 1 : 0;
        }
    }
}

/* With a ripple of the link: no hand-over comes at a bad instant. */
static void test_torque_of_drawn_runs(void)
{
    enum { RUNS = 12 };
    plant_random random;
    drawn d = {{0.0}, {0}};
    double most = 0.0;
    plant_random_seed(&random, 20261126, 0);
    for (int id = 0; id < PULSE_DRIVES; id++) {
        draw((pulse_drive_id)id, true, RUNS, &random, &d);
    }
    for (int k = PULSE_EVENT_TO_PATTERN; k < PULSE_EVENTS; k++) {
        most = fmax(most, d.most[k]);
    }
    printf("hand-overs of %d drawn runs with a ripple of the link: %.2f %%\n", PULSE_DRIVES * RUNS, most);
    TEST_ASSERT_TRUE(most <= 1.8);
}

/* For the command line: so many runs of each drive and link, other ones than the tests', as a table. */
static void draw_table(long runs)
{
    plant_random random;
    plant_random_seed(&random, 20261129, 0);
    find_tables();
    printf("drive, link: largest error in %% of the rated torque (runs over 2 %%), of %ld runs\n", runs);
    for (int n = 0; n < 2 * PULSE_DRIVES; n++) {
        drawn d = {{0.0}, {0}};
        draw((pulse_drive_id)(n / 2), n % 2 != 0, runs, &random, &d);
        for (int k = 0; k < PULSE_EVENTS; k++) {
            printf("%s, %s link, %s: %.2f (%d)\n", n / 2 == PULSE_DRIVE_2019 ? "2019" : "400 kW",
                   n % 2 != 0 ? "rippled" : "constant", event_names[k], d.most[k], d.over[k]);
        }
    }
}

/* Constant speeds with the index between two rows that are not joined: the torque has no constant error. */
static void test_no_constant_error_near_a_jump(void)
{
    pulse_drive p = pulse_drive_of(PULSE_DRIVE_400_KW);
    double most = 0.0;
    for (p.high_Hz = 329.0; p.high_Hz < 334.0; p.high_Hz += 0.5) {
        const pulse_case c = {p.high_Hz, 0.1, 1.0, false, 1.0, 0.0, 0.0};
        error e = {0};
        const long count = pulse_run_up_torque(&p, &tables, &c, torque[0], TORQUES, &e);
        TEST_ASSERT_TRUE_MESSAGE(count > 0, e.text);
        for (long k = count * 3 / 4; k < count; k++) {
            TEST_ASSERT_EQUAL_INT(PULSE_PATTERN_7, torque[0][k].mode);
            most = fmax(most, fabs(torque[0][k].percent));
        }
    }
    printf("near a jump, at constant speed: %.2f %%\n", most);
    TEST_ASSERT_TRUE(most <= 0.1);
}

static void print_table(void)
{
    printf("| torque off by, %% of the rated torque, at most | constant link | link +-1 %% at 300 Hz | 400 "
           "kW, constant link | 400 kW, link +-1 %% |\n"
           "| --- | ---: | ---: | ---: | ---: |\n");
    for (int k = 0; k < PULSE_EVENTS; k++) {
        printf("| %s | %.2f | %.2f | %.2f | %.2f |\n", event_names[k], worst_of[0][0][k], worst_of[0][1][k],
               worst_of[1][0][k], worst_of[1][1][k]);
    }
}

static void test_torque_through_all_modes(void)
{
    torque_of(PULSE_DRIVE_2019, 24);
}

static void test_torque_of_the_traction_drive(void)
{
    torque_of(PULSE_DRIVE_400_KW, 8);
    print_table();
}

/* The command's runs: from standstill, each mode once up and once down. */
static void test_distortion_from_standstill(void)
{
    for (int n = 0; n < PULSE_DRIVES; n++) {
        const pulse_drive p = pulse_drive_of((pulse_drive_id)n);
        const pulse_run_up *r = run(&p, &pulse_run_ups_case);
        for (int m = 0; m < PULSE_RUN_MODES; m++) {
            const pulse_row *row = &r->mode[m];
            TEST_ASSERT_EQUAL_INT(m == PULSE_SIX_STEP ? 1 : 2, row->visits_up + row->visits_down);
            TEST_ASSERT_EQUAL_INT(1, row->visits_up);
            TEST_ASSERT_TRUE(row->distortion > 0.0);
            TEST_ASSERT_TRUE(m == 0 || row->from_Hz > r->mode[m - 1].from_Hz);
            TEST_ASSERT_TRUE(m == 0 || row->down_to_Hz < row->from_Hz);
        }
        for (int k = 0; k < PULSE_EVENTS; k++) {
            TEST_ASSERT_TRUE(r->worst_percent[k] <= 2.0);
        }
        TEST_ASSERT_TRUE(r->points > 100 && r->points < PULSE_POINTS);
        for (int k = 0; k < r->points; k++) {
            const pulse_point *at = &r->point[k];
            const int pulses = pulse_run_mode_pulses[at->mode];
            TEST_ASSERT_TRUE(pulses == 0 || fabs(at->pulses - pulses) < 0.2);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, at->pulses * at->hz, at->switching_Hz);
        }
        /* What is calculated for space vectors is what the synchronous carrier makes, at its one position. */
        for (int m = PULSE_CARRIER_21; m <= PULSE_CARRIER_9; m++) {
            TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0, r->mode[m].distortion / r->mode[m].space_vectors);
        }
        for (int m = PULSE_PATTERN_9; m <= PULSE_PATTERN_7; m++) {
            TEST_ASSERT_TRUE(r->mode[m].distortion < r->mode[m].space_vectors);
        }
    }
}

/* The same machine for the other commands. */
static void test_the_traction_drive_has_a_motor_file(void)
{
    const motor m = pulse_drive_of(PULSE_DRIVE_400_KW).m;
    motor of_file;
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(motor_read("data/motors/traction_400kw.toml", &of_file, &e), e.text);
    TEST_ASSERT_EQUAL_STRING(of_file.name, m.name);
    TEST_ASSERT_EQUAL_INT(of_file.pole_pairs, m.pole_pairs);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.R_ohm, m.R_ohm);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.L_d_H, m.L_d_H);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.L_q_H, m.L_q_H);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.psi_f_Wb, m.psi_f_Wb);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.I_rated_A_rms, m.I_rated_A_rms);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.n_max_rpm, m.n_max_rpm);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.f_pwm_Hz, m.f_pwm_Hz);
    TEST_ASSERT_EQUAL_DOUBLE(of_file.u_dc_V, m.u_dc_V);
}

/* With a number: draws so many runs in place of the tests. */
int main(int argc, char **argv)
{
    const long runs = argc > 1 ? strtol(argv[1], NULL, 10) : 0;
    if (runs > 0) {
        draw_table(runs);
        return 0;
    }
    UNITY_BEGIN();
    RUN_TEST(find_tables);
    RUN_TEST(test_torque_through_all_modes);
    RUN_TEST(test_torque_of_the_traction_drive);
    RUN_TEST(test_torque_of_drawn_runs);
    RUN_TEST(test_share_of_the_hand_over);
    RUN_TEST(test_no_constant_error_near_a_jump);
    RUN_TEST(test_distortion_from_standstill);
    RUN_TEST(test_the_traction_drive_has_a_motor_file);
    return UNITY_END();
}
