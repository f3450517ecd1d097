/*
 * The observer of the diagnosis (sim_host/diagnose/identify/observer.h): the parameters that move only the
 * sensors, by their slopes and by a run of their own; that a row's noise does not predict itself; and a compensation whose sign noise
 * may decide.
 */
#include "diagnose/identify/coordinates.h"
#include "diagnose/identify/observer.h"
#include "diagnose_bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

static motor m;
static recording r;
static diagnose_rows rows;
static coordinate_frame frame;
static averaged_node *nodes;
static observer_step *way;
static averaged_cycle *cycle;
static double *base, *own, *beside;

void setUp(void)
{
    const bench good = {.m = bench_motor(), .noise_A = 0.017, .seed = 20261123};
    error e = {0};
    m = bench_motor();
    r = bench_record(&good);
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&rows, &r, &m, &e), e.text);
    frame = coordinates_of(&m, &rows);
    nodes = calloc(rows.nodes, sizeof *nodes);
    way = calloc(rows.rows, sizeof *way);
    cycle = calloc(rows.rows, sizeof *cycle);
    base = calloc(OBSERVER_OUTPUTS * rows.rows, sizeof *base);
    own = calloc(OBSERVER_OUTPUTS * rows.rows, sizeof *own);
    beside = calloc(OBSERVER_OUTPUTS * rows.rows, sizeof *beside);
    TEST_ASSERT_TRUE(nodes && way && cycle && base && own && beside);
}

void tearDown(void)
{
    free(nodes);
    free(way);
    free(cycle);
    free(base);
    free(own);
    free(beside);
    rows_free(&rows);
    recording_free(&r);
}

/* What a step of one coordinate, or of the gain, changes in all blocks: how far apart the two ways of finding it are, as a part. */
static double apart(const double z[P_COUNT], coordinate_id moved, double more_gain)
{
    double to[P_COUNT];
    double wrong = 0.0;
    double size = 0.0;
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        to[id] = z[id] + (id == moved && more_gain == 0.0 ? coordinate_step(id) : 0.0);
    }
    const averaged_drive d = coordinates_drive(&frame, z, EDGE_CLIPPED);
    const averaged_drive other = coordinates_drive(&frame, to, EDGE_CLIPPED);
    rows_nodes_fill(&rows, &d, nodes);
    for (size_t b = 0; b < rows.blocks; b++) {
        const row_block *block = &rows.block[b];
        observer_cycles(&rows, &d, nodes, block, NULL, cycle);
        observer_way(&rows, &d, cycle, block, 0.3, base, way);
        observer_block(&rows, &d, nodes, block, 0.3, 0.0, own, NULL);
        TEST_ASSERT_EQUAL_DOUBLE_ARRAY(own, base, OBSERVER_OUTPUTS * block->count);
        observer_block(&rows, &other, nodes, block, 0.3 + more_gain, 0.0, own, NULL);
        observer_beside(&rows, &other, cycle, block, 0.3 + more_gain, way, beside);
        for (size_t j = 0; j < OBSERVER_OUTPUTS * block->count; j++) {
            wrong += (own[j] - beside[j]) * (own[j] - beside[j]);
            size += (own[j] - base[j]) * (own[j] - base[j]);
        }
    }
    TEST_ASSERT_TRUE(size > 0.0);
    return sqrt(wrong / size);
}

static void all_apart_by_less_than(const double z[P_COUNT], double most)
{
    size_t seen = 0;
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        if (coordinate_table[id].senses) {
            TEST_ASSERT_DOUBLE_WITHIN(most, 0.0, apart(z, id, 0.0));
            seen++;
        }
    }
    TEST_ASSERT_EQUAL_size_t(22, seen);
    TEST_ASSERT_DOUBLE_WITHIN(most, 0.0, apart(z, P_R, 1e-3));
}

/* By running: 1e-4. */
static void what_moves_only_the_sensors_agrees_with_a_run_of_its_own(void)
{
    const double z[P_COUNT] = {
        [P_SATURATION] = 0.1, [P_THETA_0] = 0.05, [P_GAIN_A] = 0.02, [P_SENSOR_LAG] = 0.03, [P_RING] = 0.05};
    all_apart_by_less_than(z, 5e-4);
}

/* By running: 0.04. A law with corners has no slope there: a step of a coordinate meets other ones than a step of the current. */
static void with_a_clipped_dead_time_it_is_nearly(void)
{
    const double z[P_COUNT] = {[P_V_DEAD] = 1.0, [P_RING] = 0.05};
    all_apart_by_less_than(z, 0.06);
}

/* By running: 0.0035. What a drive's iron remembers by the sensors is left out. */
static void with_iron_a_small_part_is_left_out(void)
{
    const double z[P_COUNT] = {[P_FE] = 1.0, [P_RING] = 0.05};
    all_apart_by_less_than(z, 0.006);
}

/* Whether a drive goes the same way through the cycles of another, bit by bit. */
static bool goes_through(const averaged_drive *drive, const averaged_drive *of)
{
    bool same = true;
    averaged_node *by_its_own = rows_nodes(&rows, drive);
    TEST_ASSERT_NOT_NULL(by_its_own);
    rows_nodes_fill(&rows, of, nodes);
    for (size_t b = 0; b < rows.blocks; b++) {
        const row_block *block = &rows.block[b];
        observer_cycles(&rows, of, nodes, block, NULL, cycle);
        observer_through(&rows, drive, cycle, block, 0.3, beside);
        observer_block(&rows, drive, by_its_own, block, 0.3, 0.0, own, NULL);
        same = same && memcmp(own, beside, OBSERVER_OUTPUTS * block->count * sizeof *own) == 0;
    }
    free(by_its_own);
    return same;
}

/* Whether the rotor is at the same place in every row. */
static bool same_rotors(const averaged_drive *one, const averaged_drive *other)
{
    bool same = true;
    for (size_t k = 0; k < rows.rows; k++) {
        const vec_rotor a = averaged_drive_rotor(one, &rows.row[k]);
        const vec_rotor b = averaged_drive_rotor(other, &rows.row[k]);
        same = same && a.cos == b.cos && a.sin == b.sin;
    }
    return same;
}

/* Of every coordinate: either it leaves the cycles as they are, and is said to, or it does not. */
static void whose_cycles_are_alike_goes_through_the_same(void)
{
    const double z[P_COUNT] = {[P_SATURATION] = 0.1, [P_V_DEAD] = 1.0, [P_FE] = 1.0, [P_THETA_0] = 0.05};
    const averaged_drive d = coordinates_drive(&frame, z, EDGE_CLIPPED);
    size_t alike = 0;
    size_t apart_ones = 0;
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        double to[P_COUNT];
        memcpy(to, z, sizeof to);
        to[id] += coordinate_step(id);
        const averaged_drive other = coordinates_drive(&frame, to, EDGE_CLIPPED);
        const bool said = averaged_drive_cycles_alike(&other, &d);
        TEST_ASSERT_EQUAL_MESSAGE(said, goes_through(&other, &d), "a coordinate's cycles");
        TEST_ASSERT_EQUAL_MESSAGE(averaged_drive_rotors_alike(&other, &d), same_rotors(&other, &d),
                                  "a coordinate's rotor");
        alike += said ? 1 : 0;
        apart_ones += said ? 0 : 1;
    }
    TEST_ASSERT_TRUE(alike > 20 && apart_ones > 8);
}

/* A drive that compensates more than its dead time, and phase b's current at the noise's size. */
static averaged_drive near_zero(const double z[P_COUNT])
{
    averaged_drive d = coordinates_drive(&frame, z, EDGE_CLIPPED);
    d.compensation_knee_A = 1e-3;
    d.sign_is_doubted = true;
    for (size_t k = 0; k < rows.rows; k++) {
        const double b = rows.noise_A * (double)((int)(k * 7 % 5) - 2);
        rows.row[k].i_A = vec_from_phases((const double[3]){5.0, b, -5.0 - b});
    }
    return d;
}

/* What noise may have decided is not counted along that phase; the rest is. */
static void a_doubtful_sign_is_not_counted(void)
{
    const double z[P_COUNT] = {[P_COMPENSATION] = 2.0};
    const averaged_drive d = near_zero(z);
    const row_block *block = &rows.block[0];
    double *share = calloc(block->count, sizeof *share);
    double across = 0.0;
    TEST_ASSERT_NOT_NULL(share);
    rows_nodes_fill(&rows, &d, nodes);
    observer_block(&rows, &d, nodes, block, 0.3, 0.0, own, share);
    for (size_t j = OBSERVER_START; j < block->count; j++) {
        const double *e = own + OBSERVER_OUTPUTS * j;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, vec_phase((vec_ab){e[0], e[1]}, 1));
        TEST_ASSERT_EQUAL_DOUBLE(0.5, share[j]);
        across += fabs(e[0]);
    }
    free(share);
    TEST_ASSERT_TRUE(across > 0.0);
}

/* A row whose error says nothing of its voltage: only of such a drive, and only where noise may have turned the sign. */
static void which_signs_are_unsure(void)
{
    const double z[P_COUNT] = {[P_COMPENSATION] = 2.0};
    averaged_drive d = near_zero(z);
    const vec_ab far = vec_from_phases((const double[3]){5.0, -2.0, -3.0});
    TEST_ASSERT_TRUE(observer_sign_is_unsure(&rows, &d, rows.row[0].missing, rows.row[0].i_A));
    TEST_ASSERT_FALSE(observer_sign_is_unsure(&rows, &d, rows.row[0].missing, far));
    /* 4.5 deviations of the vector's noise, of a phase with a sensor and of one without. */
    const double A = 4.5 * rows.noise_A;
    const vec_ab near = vec_from_phases((const double[3]){A, -5.0 - A, 5.0});
    TEST_ASSERT_FALSE(observer_sign_is_unsure(&rows, &d, MISSING_NONE, near));
    TEST_ASSERT_FALSE(observer_sign_is_unsure(&rows, &d, MISSING_B, near));
    TEST_ASSERT_TRUE(observer_sign_is_unsure(&rows, &d, MISSING_A, near));
    d.sign_is_doubted = false;
    TEST_ASSERT_FALSE(observer_sign_is_unsure(&rows, &d, rows.row[0].missing, rows.row[0].i_A));
}

/* Of two sensors' noise, whose Clarke vector has 1 and 5/3 of it; of three, whose vector has 2/3 in either axis, as each phase has. */
static void a_phase_without_a_sensor_has_two_sensors_noise(void)
{
    const double of_two = sqrt(0.5 * (1.0 + 5.0 / 3.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, rows_phase_noise(of_two, MISSING_C, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, rows_phase_noise(of_two, MISSING_C, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(2.0), rows_phase_noise(of_two, MISSING_C, 2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(2.0), rows_phase_noise(of_two, MISSING_A, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(2.0 / 3.0), rows_phase_noise(sqrt(2.0 / 3.0), MISSING_NONE, 1));
}

/*
 * A compensation by a current near zero drives it away from there: by the run's own current, whose sign a small change of a parameter
 * turns, the innovations would leap. Twice a change is twice the difference. By running: 0.027 at most.
 */
static void a_doubtful_sign_makes_no_leap(void)
{
    static const coordinate_id moved[] = {P_R, P_PSI, P_V_DEAD, P_COMPENSATION, P_K_U};
    const double z[P_COUNT] = {[P_V_DEAD] = -0.5, [P_COMPENSATION] = 2.0};
    for (size_t k = 0; k < sizeof moved / sizeof *moved; k++) {
        double bent = 0.0;
        double size = 0.0;
        for (size_t b = 0; b < rows.blocks; b++) {
            double *to[] = {base, own, beside};
            for (int n = 0; n < 3; n++) {
                double at[P_COUNT];
                memcpy(at, z, sizeof at);
                at[moved[k]] += n * coordinate_step(moved[k]);
                const averaged_drive d = near_zero(at);
                rows_nodes_fill(&rows, &d, nodes);
                observer_block(&rows, &d, nodes, &rows.block[b], 0.05, 0.0, to[n], NULL);
            }
            for (size_t j = 0; j < OBSERVER_OUTPUTS * rows.block[b].count; j++) {
                const double twice = beside[j] - base[j];
                const double apart_A = twice - 2.0 * (own[j] - base[j]);
                bent += apart_A * apart_A;
                size += twice * twice;
            }
        }
        printf("  coordinate %d: bent by %.2g\n", (int)moved[k], sqrt(bent / size));
        TEST_ASSERT_TRUE(size > 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.0, sqrt(bent / size));
    }
}

/*
 * A prediction that follows the noise of its own row explains noise, so that a fit takes it for an effect: a filter that saw a saturated
 * machine about the recorded current was named in clean recordings. A row's reading moves its innovation by as much, and by no more.
 */
static void a_prediction_does_not_know_its_own_row(void)
{
    const double off_A = 0.05;
    const double z[P_COUNT] = {[P_SATURATION] = 0.3, [P_SENSOR_LAG] = 0.1, [P_FE] = 1.0, [P_V_DEAD] = 1.0};
    const averaged_drive d = coordinates_drive(&frame, z, EDGE_CHARGED);
    const row_block *block = &rows.block[0];
    rows_nodes_fill(&rows, &d, nodes);
    observer_block(&rows, &d, nodes, block, 0.1, 0.0, base, NULL);
    for (size_t j = OBSERVER_START + 2; j < block->count; j += 7) {
        double *alpha = &rows.row[block->first + j].i_A.alpha;
        const double before = *alpha;
        *alpha += off_A;
        observer_block(&rows, &d, nodes, block, 0.1, 0.0, own, NULL);
        *alpha = before;
        const double *at = own + OBSERVER_OUTPUTS * j;
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, off_A, at[0] - base[OBSERVER_OUTPUTS * j]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, at[1] - base[OBSERVER_OUTPUTS * j + 1]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(whose_cycles_are_alike_goes_through_the_same);
    RUN_TEST(what_moves_only_the_sensors_agrees_with_a_run_of_its_own);
    RUN_TEST(with_a_clipped_dead_time_it_is_nearly);
    RUN_TEST(with_iron_a_small_part_is_left_out);
    RUN_TEST(a_prediction_does_not_know_its_own_row);
    RUN_TEST(a_doubtful_sign_is_not_counted);
    RUN_TEST(which_signs_are_unsure);
    RUN_TEST(a_phase_without_a_sensor_has_two_sensors_noise);
    RUN_TEST(a_doubtful_sign_makes_no_leap);
    return UNITY_END();
}
