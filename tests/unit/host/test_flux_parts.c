/* Parts that saturate in place of a map (sim_host/model/flux_parts.h): of drawn maps, at drawn currents. */
#include "model/flux_map.h"
#include "model/flux_parts.h"
#include "unity.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>

enum { DRIVES = 60, CURRENTS = 200 };

static const uint64_t SEED = 20261130;

void setUp(void)
{
}

void tearDown(void)
{
}

static double drawn(uint64_t *state, double low, double high)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(*state >> 11) / 9007199254740992.0;
}

static void currents_drawn(uint64_t *seed, double most_A, vec_dq i[CURRENTS])
{
    for (size_t k = 0; k < CURRENTS; k++) {
        const double length_A = most_A * sqrt(drawn(seed, 0.0, 1.0));
        const double angle = drawn(seed, 0.25 * VEC_TWO_PI, 0.75 * VEC_TWO_PI);
        i[k] = (vec_dq){length_A * cos(angle), length_A * sin(angle)};
    }
}

static averaged_drive drive_drawn(uint64_t *seed, double rated_A)
{
    const double L_H = exp(drawn(seed, -9.0, -3.0));
    const iron_part none = {0.0, rated_A, rated_A, 0.0};
    return (averaged_drive){.R_ohm = 1.0,
                            .L_d_H = L_H,
                            .L_q_H = L_H * drawn(seed, 0.5, 3.0),
                            .psi_f_Wb = 0.1,
                            .iron = {none, none}};
}

static const flux_parts_limits *limits_of(const averaged_drive *d, double rated_A)
{
    static flux_parts_limits limits;
    const double L_H = fmax(d->L_d_H, d->L_q_H);
    limits = (flux_parts_limits){.L_low_H = 0.02 * fmin(d->L_d_H, d->L_q_H),
                                 .L_high_H = L_H,
                                 .E_high_J = 30.0 * L_H * rated_A * rated_A,
                                 .I_low_A = 0.1 * rated_A,
                                 .I_high_A = 10.0 * rated_A,
                                 .I_c_high_A = rated_A};
    return &limits;
}

/* The share by which the flux of one drive is off that of another, rms. */
static double off_by(const averaged_drive *is, const averaged_drive *wanted, const vec_dq i[CURRENTS])
{
    double wrong = 0.0;
    double all = 0.0;
    for (size_t k = 0; k < CURRENTS; k++) {
        const vec_dq a = flux_map_flux(is, i[k]);
        const vec_dq b = flux_map_flux(wanted, i[k]);
        wrong += (a.d - b.d) * (a.d - b.d) + (a.q - b.q) * (a.q - b.q);
        all += b.d * b.d + b.q * b.q;
    }
    return sqrt(wrong / all);
}

/* By the best inductances, without saturation. */
static double off_straight(const averaged_drive *wanted, const vec_dq i[CURRENTS])
{
    vec_dq by = {0.0, 0.0};
    vec_dq of = {0.0, 0.0};
    for (size_t k = 0; k < CURRENTS; k++) {
        const vec_dq flux = flux_map_flux(wanted, i[k]);
        by = (vec_dq){by.d + flux.d * i[k].d, by.q + flux.q * i[k].q};
        of = (vec_dq){of.d + i[k].d * i[k].d, of.q + i[k].q * i[k].q};
    }
    const averaged_drive straight = {.L_d_H = by.d / of.d, .L_q_H = by.q / of.q};
    return off_by(&straight, wanted, i);
}

static bool inside(double x, double low, double high)
{
    return x >= low * (1.0 - 1e-12) && x <= high * (1.0 + 1e-12);
}

static void check(const averaged_drive *d, const vec_dq i[CURRENTS], double rated_A, size_t parts,
                  double *off)
{
    const flux_parts_limits *limits = limits_of(d, rated_A);
    averaged_drive other;
    *off = flux_parts_closest(d, i, CURRENTS, limits, parts, &other);
    /* What it says is what the model of parts has, and no current has no flux but the magnet's. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, off_by(&other, d, i), *off);
    const vec_dq none = flux_map_flux(&other, (vec_dq){0.0, 0.0});
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * d->L_q_H * rated_A, 0.0, none.d);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, none.q);
    flux_map_slope straight = flux_map_at(&other, (vec_dq){0.0, 0.0}).slope;
    for (size_t k = 0; k < IRON_PARTS; k++) {
        const iron_part *part = &other.iron[k];
        const flux_map_slope its = flux_map_part_slope(part);
        straight.dd -= its.dd;
        straight.qq -= its.qq;
        TEST_ASSERT_TRUE(inside(part->E_J, 0.0, limits->E_high_J) &&
                         inside(part->I_d_A, limits->I_low_A, limits->I_high_A) &&
                         inside(part->I_q_A, limits->I_low_A, limits->I_high_A) &&
                         fabs(part->I_c_A) <= limits->I_c_high_A);
    }
    TEST_ASSERT_TRUE(inside(straight.dd, limits->L_low_H, limits->L_high_H) &&
                     inside(straight.qq, limits->L_low_H, limits->L_high_H));
    TEST_ASSERT_TRUE(parts == 2 || other.iron[1].E_J == 0.0);
}

/* A map of one part is found again; two parts come at least as close as one, and one closer than straight iron. */
static void test_parts(void)
{
    uint64_t seed = SEED;
    vec_dq i[CURRENTS];
    printf("  seed %llu\n", (unsigned long long)SEED);
    for (int n = 0; n < DRIVES; n++) {
        const double rated_A = exp(drawn(&seed, 0.0, 6.0));
        averaged_drive d = drive_drawn(&seed, rated_A);
        const double I_d_A = rated_A * exp(drawn(&seed, -0.7, 0.7));
        const double I_q_A = rated_A * exp(drawn(&seed, -0.7, 0.7));
        const double E_J = drawn(&seed, 0.3, 0.9) * fmin(d.L_d_H * I_d_A * I_d_A, d.L_q_H * I_q_A * I_q_A);
        d.iron[0] = (iron_part){E_J, I_d_A, I_q_A, rated_A * drawn(&seed, -0.4, 0.4)};
        double one;
        double two;
        currents_drawn(&seed, 1.5 * rated_A, i);
        check(&d, i, rated_A, 1, &one);
        check(&d, i, rated_A, 2, &two);
        TEST_ASSERT_TRUE(one < 1e-3 && two <= one);
    }
}

/* Terms of third and fourth order with I_sat, as mild saturation has them. */
static void test_terms(void)
{
    uint64_t seed = SEED + 1;
    vec_dq i[CURRENTS];
    double most[2] = {0.0, 0.0};
    for (int n = 0; n < DRIVES; n++) {
        const double rated_A = exp(drawn(&seed, 0.0, 6.0));
        averaged_drive d = drive_drawn(&seed, rated_A);
        const double third = 0.5 * (d.L_d_H + d.L_q_H) / (3.0 * rated_A);
        const double fourth = 0.5 * (d.L_d_H + d.L_q_H) / (4.0 * rated_A * rated_A);
        d.saturation = drawn(&seed, 0.0, 0.4) / (rated_A * rated_A);
        d.w_ddd = third * drawn(&seed, -0.05, 0.05);
        d.w_dqq = third * drawn(&seed, -0.1, 0.1);
        d.w_dddd = -fourth * drawn(&seed, 0.0, 0.1);
        d.w_qqqq = -fourth * drawn(&seed, 0.0, 0.1);
        double off[2];
        currents_drawn(&seed, rated_A, i);
        for (size_t parts = 1; parts <= 2; parts++) {
            check(&d, i, rated_A, parts, &off[parts - 1]);
            most[parts - 1] = fmax(most[parts - 1], off[parts - 1]);
        }
        TEST_ASSERT_TRUE(off[1] <= off[0] && off[0] < off_straight(&d, i));
    }
    printf("  largest error of the flux: %.2f %% by one part, %.2f %% by two\n", 100.0 * most[0],
           100.0 * most[1]);
    TEST_ASSERT_TRUE(most[0] < 0.03 && most[1] < 0.015);
}

/* A current that is always the same: the flux there is right, whatever the parts are. */
static void test_one_current(void)
{
    vec_dq i[CURRENTS];
    uint64_t seed = SEED + 2;
    averaged_drive d = drive_drawn(&seed, 10.0);
    d.saturation = 0.3 / 100.0;
    for (size_t k = 0; k < CURRENTS; k++) {
        i[k] = (vec_dq){-3.0, 8.0};
    }
    double off;
    check(&d, i, 10.0, 2, &off);
    TEST_ASSERT_TRUE(off < 1e-3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_parts);
    RUN_TEST(test_terms);
    RUN_TEST(test_one_current);
    return UNITY_END();
}
