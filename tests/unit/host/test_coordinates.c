/*
 * The bounds of the parameters that a diagnosis fits (sim_host/diagnose/identify/coordinates.h): wherever a step leads, the
 * bounded drive is one that can exist.
 */
#include "diagnose/identify/coordinates.h"
#include "diagnose_bench.h"

#include <math.h>
#include <string.h>
#include <unity.h>

enum { DRAWN = 20000 };

static uint64_t drawn = 20261130;
static recording r;

void setUp(void)
{
    const bench b = {.m = bench_motor(), .noise_A = 0.017, .seed = 20261130};
    r = bench_record(&b);
}

void tearDown(void)
{
    recording_free(&r);
}

/* Far beyond any bound, in most parameters at once. */
static void draw(double z[P_COUNT])
{
    for (size_t id = 0; id < P_COUNT; id++) {
        z[id] = 2.0 * bench_normal(&drawn) * fmax(bench_normal(&drawn), 0.0);
    }
}

static void exists(const averaged_drive *d)
{
    TEST_ASSERT_TRUE(d->R_ohm > 0.0 && d->L_d_H > 0.0 && d->L_q_H > 0.0 && d->psi_f_Wb >= 0.0 &&
                     d->k_u > 0.0);
    for (size_t x = 0; x < 3; x++) {
        TEST_ASSERT_TRUE(d->R_ohm + d->dR_ohm[x] > 0.0);
        TEST_ASSERT_TRUE(fmin(d->L_d_H, d->L_q_H) + d->dL_H[x] > 0.0);
    }
}

static void a_bounded_drive_exists_and_is_not_bounded_again(void)
{
    for (double salient = 1.0; salient < 20.0; salient *= 3.0) {
        motor m = bench_motor();
        diagnose_rows rows;
        error e = {0};
        m.L_q_H = salient * m.L_d_H;
        TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&rows, &r, &m, &e), e.text);
        const coordinate_frame frame = coordinates_of(&m, &rows);
        for (int n = 0; n < DRAWN; n++) {
            double z[P_COUNT];
            double again[P_COUNT];
            draw(z);
            coordinates_bound(&frame, z);
            const averaged_drive d = coordinates_drive(&frame, z, EDGE_CHARGED);
            exists(&d);
            memcpy(again, z, sizeof again);
            coordinates_bound(&frame, again);
            TEST_ASSERT_EQUAL_MEMORY(z, again, sizeof z);
        }
        rows_free(&rows);
    }
}

static void the_motor_files_drive_is_within_bounds(void)
{
    const motor m = bench_motor();
    const double nominal[P_COUNT] = {0.0};
    double z[P_COUNT] = {0.0};
    diagnose_rows rows;
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&rows, &r, &m, &e), e.text);
    const coordinate_frame frame = coordinates_of(&m, &rows);
    coordinates_bound(&frame, z);
    TEST_ASSERT_EQUAL_MEMORY(nominal, z, sizeof z);
    rows_free(&rows);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_bounded_drive_exists_and_is_not_bounded_again);
    RUN_TEST(the_motor_files_drive_is_within_bounds);
    return UNITY_END();
}
