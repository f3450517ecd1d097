/* What current sensors show of a true current: gains, offsets and their drift, a filter, a late sample. */
#include "diagnose_bench.h"
#include "model/sensor_lag.h"
#include "model/sensor_nonlinearity.h"

#include <math.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void sensors_invert(void)
{
    averaged_drive d = {.L_d_H = 1.0, .L_q_H = 1.0, .g = {0.95, 1.04, 1.01}, .offset_ab_A = {0.3, -0.2}};
    const vec_ab i = {3.0, -4.0};
    for (int missing = MISSING_NONE; missing < MISSING_PHASES; missing++) {
        sensor_map map = sensor_map_of(&d, (missing_phase)missing);
        vec_ab shown = sensor_map_measure(&map, i);
        vec_ab back = sensor_map_unmeasure(&map, shown);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.alpha, back.alpha);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.beta, back.beta);
    }
    /* Phase A alone reads g_a i_a + (2 o_a - o_b - o_c)/3 when two sensors make the vector. */
    sensor_map two = sensor_map_of(&d, MISSING_C);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.95 * 3.0 + 0.3, sensor_map_measure(&two, i).alpha);
}

/* Each phase in turn is minus the sum of what the other two's sensors show, gains and offsets with a common part. */
static void a_phase_that_is_not_measured(void)
{
    static const double g[3] = {0.95, 1.04, 1.01};
    static const double o[3] = {0.5, -0.2, 0.3};
    const vec_ab i = {3.0, -4.0};
    const vec_ab o_ab = vec_from_phases(o);
    const averaged_drive d = {
        .g = {g[0], g[1], g[2]}, .offset_ab_A = {o_ab.alpha, o_ab.beta}, .offset_zero_A = 0.2};
    const sensor_course course = sensor_course_of(&d, SENSORS_TWO_LOWEST);
    TEST_ASSERT_TRUE(course.changes);
    for (int x = 0; x < 3; x++) {
        const cycle_row row = {.missing = (missing_phase)(MISSING_A + x)};
        const sensor_map map = sensor_course_at(&course, &row);
        double phase[3];
        double shown[3];
        vec_to_phases(i, phase);
        vec_to_phases(sensor_map_measure(&map, i), shown);
        const int y = (x + 1) % 3;
        const int z = (x + 2) % 3;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, g[y] * phase[y] + o[y], shown[y]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, g[z] * phase[z] + o[z], shown[z]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, -shown[y] - shown[z], shown[x]);
    }
    TEST_ASSERT_FALSE(sensor_course_of(&d, SENSORS_TWO).changes);
}

/* The channel of b shows a share of phase a as well, that of c one of b, that of a one of c; the mean of the three shows their sum. */
static void channels_read_their_neighbours(void)
{
    static const double g[3] = {0.95, 1.04, 1.01};
    static const double share[3] = {0.03, -0.02, 0.05};
    const vec_ab i = {3.0, -4.0};
    const averaged_drive d = {.g = {g[0], g[1], g[2]}, .crosstalk = {share[0], share[1], share[2]}};
    const sensor_map map = sensor_map_of(&d, MISSING_NONE);
    double phase[3];
    vec_to_phases(i, phase);
    const double channel[3] = {g[0] * phase[0] + share[2] * phase[2], g[1] * phase[1] + share[0] * phase[0],
                               g[2] * phase[2] + share[1] * phase[1]};
    const vec_ab wanted = vec_from_phases(channel);
    const vec_ab shown = sensor_map_measure(&map, i);
    const vec_ab back = sensor_map_unmeasure(&map, shown);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, wanted.alpha, shown.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, wanted.beta, shown.beta);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, (channel[0] + channel[1] + channel[2]) / 3.0,
                              map.zero[0] * i.alpha + map.zero[1] * i.beta);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.alpha, back.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.beta, back.beta);
}

/* At any time the map is that of the gains and offsets which the rates have led to. */
static void sensors_drift_evenly(void)
{
    const averaged_drive d = {.g = {0.95, 1.04, 1.01},
                              .offset_ab_A = {0.3, -0.2},
                              .offset_zero_A = 0.1,
                              .g_rate_s = {0.02, -0.01, 0.03},
                              .offset_rate_ab_A_s = {-0.4, 0.5}};
    const vec_ab i = {3.0, -4.0};
    for (int missing = MISSING_NONE; missing < MISSING_PHASES; missing++) {
        const sensor_set sensors = missing == MISSING_NONE ? SENSORS_THREE : SENSORS_TWO_LOWEST;
        const sensor_course course = sensor_course_of(&d, sensors);
        TEST_ASSERT_TRUE(course.drifts);
        for (double s = -2.0; s <= 2.0; s += 0.5) {
            averaged_drive by_then = {.g = {0.95 + 0.02 * s, 1.04 - 0.01 * s, 1.01 + 0.03 * s},
                                      .offset_ab_A = {0.3 - 0.4 * s, -0.2 + 0.5 * s},
                                      .offset_zero_A = 0.1};
            const cycle_row row = {.missing = (missing_phase)missing, .elapsed_s = s};
            const sensor_map is = sensor_course_at(&course, &row);
            const sensor_map wanted = sensor_map_of(&by_then, row.missing);
            const vec_ab shown = sensor_map_measure(&is, i);
            const vec_ab right = sensor_map_measure(&wanted, i);
            const vec_ab back = sensor_map_unmeasure(&is, shown);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, right.alpha, shown.alpha);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, right.beta, shown.beta);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, wanted.zero[0], is.zero[0]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, wanted.zero[1], is.zero[1]);
            TEST_ASSERT_EQUAL_DOUBLE(0.1, is.zero_offset_A);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.alpha, back.alpha);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.beta, back.beta);
        }
    }
}

/* Seen by sensors of this lag, a machine without resistance at theta = 0.7. */
static vec_ab seen_by(double tau_s, const double fell[3], vec_ab i)
{
    motor m = bench_motor();
    m.ext.has[CAUSE_SENSOR_LAG] = true;
    m.ext.sensor_lag_s = tau_s;
    averaged_drive d = averaged_drive_of(&m);
    d.R_ohm = 0.0;
    const cycle_row row = {.cos_theta = cos(0.7),
                           .sin_theta = sin(0.7),
                           .omega_rad_s = 900.0,
                           .rise = {0.2, 0.2, 0.2},
                           .fell = {fell[0], fell[1], fell[2]},
                           .u_dc_V = 565.0};
    const sensor_map plain = sensor_map_of(&d, MISSING_NONE);
    lag_memory none = {.own = {.row = NULL}};
    const sensor_map map =
        sensor_lag_map(&d, &row, 250e-6, &plain, averaged_drive_rotor(&d, &row), NULL, i, &none);
    const vec_ab seen = sensor_map_measure(&map, i);
    const vec_ab back = sensor_map_unmeasure(&map, seen);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, i.alpha, back.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, i.beta, back.beta);
    return seen;
}

/* Of each measured phase its own edge by e^(-fell/share), and all of them by another factor; a third phase is minus the two. */
static void an_edge_still_rings_in_a_sample(void)
{
    cycle_row rows[2] = {{.no_fall = {0.0, 1.0, 0.0}}, {.fell = {0.1, 0.2, 0.4}, .history = 1}};
    const averaged_drive d = {.ring_A = 2.0, .ring_sum_A = 0.5, .ring_share = 0.25};
    const double a = exp(-0.4);
    const double c = exp(-1.6); /* leg b was held */
    const double sum = 0.5 * (a + c);
    double zero;
    TEST_ASSERT_TRUE(sensor_nonlinearity_present(&d));
    const vec_ab three = sensor_nonlinearity_error(&d, &rows[1], (vec_ab){0.0, 0.0}, &zero);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0 / 3.0 * (a + c) + sum, zero);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0 * a - 2.0 / 3.0 * (a + c), three.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -2.0 * c / sqrt(3.0), three.beta);
    rows[1].missing = MISSING_C;
    const vec_ab two = sensor_nonlinearity_error(&d, &rows[1], (vec_ab){0.0, 0.0}, &zero);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, zero);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0 * a + sum, two.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, (2.0 * sum + 2.0 * a + sum) / sqrt(3.0), two.beta);
    const vec_ab back = sensor_nonlinearity_remove(&d, &rows[1], (vec_ab){two.alpha + 1.0, two.beta - 3.0});
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, back.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -3.0, back.beta);
}

/* While no leg is high the flux stands still and the rotor turns under it. */
static void a_late_sample_sees_the_flux_with_the_rotor_further_on(void)
{
    static const double fell[3] = {0.2, 0.2, 0.2};
    const motor m = bench_motor();
    const vec_ab i = {3.0, -2.0};
    const vec_rotor then = {cos(0.7), sin(0.7)};
    const vec_rotor now = {cos(0.7 + 900.0 * 4e-6), sin(0.7 + 900.0 * 4e-6)};
    const vec_dq i_dq = vec_to_dq(i, then);
    const vec_ab flux = vec_to_ab((vec_dq){m.L_d_H * i_dq.d + m.psi_f_Wb, m.L_q_H * i_dq.q}, then);
    const vec_dq flux_dq = vec_to_dq(flux, now);
    const vec_ab late = vec_to_ab((vec_dq){(flux_dq.d - m.psi_f_Wb) / m.L_d_H, flux_dq.q / m.L_q_H}, now);
    const vec_ab seen = seen_by(-4e-6, fell, i);
    const double moved = hypot(late.alpha - i.alpha, late.beta - i.beta);
    TEST_ASSERT_TRUE(moved > 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * moved, late.alpha, seen.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * moved, late.beta, seen.beta);
}

/* An edge close to the sample: what the filter still holds of it, added up step by step. */
static void a_filter_still_sees_the_last_edges(void)
{
    static const double early[3] = {0.04, 0.2, 0.2};
    static const double same[3] = {0.2, 0.2, 0.2};
    const motor m = bench_motor();
    const double T_s = 250e-6;
    const double tau_s = 15e-6;
    const double step_s = 2e-8;
    const vec_ab i = {3.0, -2.0};
    double more_Vs = 0.0; /* of leg a, which is high for longer */
    for (double s = 0.5 * step_s; s < 40.0 * tau_s; s += step_s) {
        const double at = fmod(s, T_s) / T_s;
        const bool wide = at > 0.04 && at < 0.96;
        const bool narrow = at > 0.2 && at < 0.8;
        more_Vs += (wide != narrow ? 565.0 : 0.0) * exp(-s / tau_s) * step_s;
    }
    const vec_rotor r = {cos(0.7), sin(0.7)};
    const vec_dq push = vec_to_dq((vec_ab){2.0 / 3.0 * more_Vs, 0.0}, r);
    const vec_ab less = vec_to_ab((vec_dq){push.d / m.L_d_H, push.q / m.L_q_H}, r);
    const vec_ab one = seen_by(tau_s, early, i);
    const vec_ab two = seen_by(tau_s, same, i);
    TEST_ASSERT_TRUE(fabs(less.alpha) > 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(less.alpha), -less.alpha, one.alpha - two.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(less.alpha), -less.beta, one.beta - two.beta);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(sensors_invert);
    RUN_TEST(a_phase_that_is_not_measured);
    RUN_TEST(channels_read_their_neighbours);
    RUN_TEST(sensors_drift_evenly);
    RUN_TEST(an_edge_still_rings_in_a_sample);
    RUN_TEST(a_late_sample_sees_the_flux_with_the_rotor_further_on);
    RUN_TEST(a_filter_still_sees_the_last_edges);
    return UNITY_END();
}
