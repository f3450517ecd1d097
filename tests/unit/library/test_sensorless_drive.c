/*
 * A drive without an angle sensor (include/iqfoc/sensorless.h): the library's cycle, start and observer on the machine of
 * switched_machine.h, from standstill to 5 periods per turn and back, the changes of the source, and a lost lock.
 */
#include "sensorless_fixture.h"

#include <stddef.h>

static double speed_control(double speed)
{
    return fmax(-1.0, fmin(1.0, 40.0 * (speed - to_double(iqfoc_observer_speed(&drive.observer)))));
}

static void test_from_standstill_to_top_speed_and_back(void)
{
    iqfoc_sensorless_start(&drive);
    int begun = 0;
    double before = 0.0;
    while (drive.source != IQFOC_ANGLE_OBSERVED && begun < 30000) {
        before = torque;
        period(0.0);
        begun++;
    }
    printf("  observed after %d periods, angle %.1f degrees off, torque %.3f and %.3f\n", begun, off, before,
           torque);
    TEST_ASSERT_EQUAL_INT(IQFOC_ANGLE_OBSERVED, drive.source);
    TEST_ASSERT_TRUE(fabs(off) <= 10.0);
    double most = 0.0;
    for (int k = 0; k < 12000; k++) {
        period(speed_control(k < 6000 ? 0.2 : 0.03));
        TEST_ASSERT_TRUE(drive.observer.locked);
        most = k > 300 ? fmax(most, fabs(off)) : most;
        if (k == 5999) {
            TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, m.speed);
        }
    }
    printf("  to SFFR 5 and back: angle at most %.2f degrees off\n", most);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.03, m.speed);
    TEST_ASSERT_TRUE(most <= 4.0 && most > 0.5);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

/* On the sensor and back, at constant speed and the rated current. */
static void test_change_of_source_makes_no_step(void)
{
    turns_freely = false;
    m.speed = 0.1;
    for (int k = 0; k < 500; k++) {
        period(1.0);
        TEST_ASSERT_EQUAL_INT(IQFOC_ANGLE_MEASURED, drive.source);
    }
    TEST_ASSERT_TRUE(drive.observer.locked);
    TEST_ASSERT_TRUE(fabs(to_double(drive.difference)) <= 0.003);
    for (int n = 0; n < 4; n++) {
        iqfoc_sensorless_use(&drive, n % 2 == 0);
        double most = 0.0;
        for (int k = 0; k < 200; k++) {
            period(1.0);
            most = fmax(most, fabs(torque - 1.0));
            TEST_ASSERT_EQUAL_INT(n % 2 == 0 ? IQFOC_ANGLE_OBSERVED : IQFOC_ANGLE_MEASURED, drive.source);
        }
        printf("  %s: torque within %.3f\n", n % 2 == 0 ? "observed" : "measured", most);
        TEST_ASSERT_TRUE(most <= 0.06 && most > 0.0);
    }
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

/* The gates go on at any angle, with a speed up to 50 % off. */
static void test_catches_a_turning_machine(void)
{
    uint64_t seed = 5;
    int longest = 0;
    double most = 0.0;
    for (int n = 0; n < 40; n++) {
        setUp();
        turns_freely = false;
        m.speed = (n % 2 == 0 ? 1.0 : -1.0) * uniform(&seed, 0.03, 0.15);
        m.theta = uniform(&seed, 0.0, 1.0);
        m.psi = switched_flux(&m, 0.0, m.theta);
        iqfoc_sensorless_catch(&drive, to_iq24(m.speed * uniform(&seed, 0.5, 1.5)));
        int cycles = 0;
        while (drive.source != IQFOC_ANGLE_OBSERVED && cycles < 400) {
            period(0.0);
            most = fmax(most, cabs(switched_current(&m, m.psi, m.theta)));
            cycles++;
        }
        longest = cycles > longest ? cycles : longest;
        for (int k = 0; k < 100; k++) {
            period(0.0);
        }
        TEST_ASSERT_TRUE(drive.observer.locked && fabs(off) <= 3.0);
        TEST_ASSERT_EQUAL_UINT32(0, cycle.status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    }
    printf("  caught after at most %d periods, current at most %.2f of the rated\n", longest, most);
    TEST_ASSERT_TRUE(longest <= 150 && most <= 4.0);
}

/* Gates off: no current, and without a known angle no flux, at any inductance. */
static void test_catch_begins_at_no_flux(void)
{
    iqfoc_observer_config_t c = observer_config;
    iqfoc_sensorless_t s;
    c.machine.l_d = c.machine.l_q = IQ24(4.0);
    c.machine.k_d = c.machine.k_q = IQ24(0.25);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_sensorless_init(&s, &c, NULL, NULL));
    iqfoc_sensorless_catch(&s, IQ24(0.1));
    TEST_ASSERT_EQUAL_INT32(0, s.observer.psi.alpha | s.observer.psi.beta);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.1), iqfoc_observer_speed(&s.observer));
}

static void test_lost_lock_sets_the_status(void)
{
    for (int trips = 0; trips < 2; trips++) {
        setUp();
        config.trips |= trips != 0 ? IQFOC_STATUS_ANGLE_LOST : 0U;
        turns_freely = false;
        m.speed = 0.1;
        iqfoc_sensorless_use(&drive, true);
        for (int k = 0; k < 300; k++) {
            period(0.3);
        }
        TEST_ASSERT_EQUAL_INT(IQFOC_ANGLE_OBSERVED, drive.source);
        TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
        m.psi_f *= 0.6; /* a magnet that is lost */
        for (int k = 0; k < 300 && !cycle.tripped; k++) {
            period(0.3);
        }
        TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_ANGLE_LOST, cycle.status & IQFOC_STATUS_ANGLE_LOST);
        TEST_ASSERT_EQUAL_INT(trips, cycle.tripped);
        if (trips == 0) {
            TEST_ASSERT_TRUE((drive.observer.status & IQFOC_OBSERVER_LOST_FLUX) != 0);
        }
    }
}

/* Gates off: no voltage is known, and the observer waits at the angle of the source. */
static void test_waits_while_the_gates_are_off(void)
{
    turns_freely = false;
    m.speed = 0.05;
    cycle.enabled = false;
    iqfoc_sensorless_use(&drive, false);
    for (int k = 0; k < 20; k++) {
        iqfoc_sample_t valley = sample_of(0);
        const iqfoc_sample_t before = valley;
        iqfoc_sensorless_valley(&drive, &cycle, &valley);
        TEST_ASSERT_EQUAL_INT32(before.theta, valley.theta);
        TEST_ASSERT_EQUAL_INT32(before.speed, valley.speed);
        TEST_ASSERT_TRUE(drive.observer.locked);
        TEST_ASSERT_EQUAL_UINT32(0, drive.on);
        m.theta += m.speed - floor(m.theta + m.speed);
    }
}

static void test_refuses_what_its_parts_refuse(void)
{
    iqfoc_observer_config_t no_magnet = observer_config;
    iqfoc_start_config_t no_current = start_config;
    no_magnet.k1 = 0;
    no_current.i_align = 0;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_sensorless_init(NULL, &observer_config, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_sensorless_init(&drive, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, iqfoc_sensorless_init(&drive, &no_magnet, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_START,
                          iqfoc_sensorless_init(&drive, &observer_config, &no_current, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_sensorless_init(&drive, &observer_config, NULL, NULL));
}

static double lost_of(const iqfoc_extension_t *x, double i)
{
    return to_double(x->v_dead) * fmax(-1.0, fmin(1.0, i * to_double(x->knee_inverse)));
}

static double complex acting_of(const iqfoc_extension_t *x, double complex u, double complex i)
{
    double lost[3];
    for (int k = 0; k < 3; k++) {
        lost[k] = lost_of(x, phase_of(i, k));
    }
    return to_double(x->k_u) * u - vector_of(lost);
}

/* Largest difference of two phases. */
static double span_of(double complex u)
{
    const double ab = fabs(phase_of(u, 0) - phase_of(u, 1));
    const double bc = fabs(phase_of(u, 1) - phase_of(u, 2));
    return fmax(fmax(ab, bc), fabs(phase_of(u, 2) - phase_of(u, 0)));
}

/* The time at which leg x rises, as a share of half a period: legs are high around the peak. */
static double rise_of(double complex u, int x, double u_dc)
{
    const double most = fmax(phase_of(u, 0), fmax(phase_of(u, 1), phase_of(u, 2)));
    return 0.5 - (phase_of(u, x) - most + 0.5 * span_of(u)) / u_dc;
}

/*
 * The loss at the edges from the switching states: the ripple is the integral of the leg's voltage less its mean, from the valley to the
 * leg's edge. NAN if rounding may decide whether the leg switches.
 */
static double complex at_edges(const iqfoc_extension_t *x, const iqfoc_flux_predictor_t *machine,
                               double complex u, double u_dc, const double complex i[3])
{
    const double v = to_double(x->v_dead);
    const double slope = 1.5 * (to_double(machine->l_d) + to_double(machine->l_q));
    double lost[3] = {0.0, 0.0, 0.0};
    double t[3];
    for (int n = 0; n < 3; n++) {
        t[n] = rise_of(u, n, u_dc);
    }
    for (int n = 0; n < 3; n++) {
        const double nearest = fmin(t[n], 1.0 - t[n]) - fabs(v) / u_dc;
        if (fabs(nearest) < 1e-5) {
            return NAN;
        }
        if (nearest > 0.0) {
            double mean = -phase_of(u, n) * t[n];
            for (int y = 0; y < 3; y++) {
                mean -= u_dc / 3.0 * fmax(0.0, t[n] - t[y]);
            }
            const double ripple = 0.5 * 3.0 / slope * mean;
            const double s = phase_of(i[0], n), p = phase_of(i[1], n), e = phase_of(i[2], n);
            /* Lagrange's parabola through 0, 1 and 2 halves. */
            const double a = t[n], b = 2.0 - t[n];
            const double rise = s * (a - 1) * (a - 2) / 2 + p * a * (2 - a) + e * a * (a - 1) / 2 + ripple;
            const double fall = s * (b - 1) * (b - 2) / 2 + p * b * (2 - b) + e * b * (b - 1) / 2 - ripple;
            lost[n] =
                copysign(1.0, v) * 0.5 *
                (fmax(-fabs(v), fmin(fabs(v), slope * rise)) + fmax(-fabs(v), fmin(fabs(v), slope * fall)));
        }
    }
    return to_double(x->k_u) * u - vector_of(lost);
}

static iqfoc_extension_t random_losses(uint64_t *seed)
{
    const iqfoc_extension_t x = {.k_u = random_iq24(seed, 0.5, 2.0),
                                 .v_dead = random_iq24(seed, -0.25, 0.25),
                                 .knee_inverse = random_iq24(seed, 0.0, 127.0)};
    return x;
}

/* Without a machine the mean of both halves; the bounds that sensorless.h states, in LSB. */
static void test_voltage_that_acts(void)
{
    uint64_t seed = 31;
    double least_room = INFINITY;
    int compared = 0;
    for (int n = 0; n < 300000; n++) {
        const double reach = n % 2 == 0 ? 7.9 : 0.5;
        const iqfoc_extension_t x = random_losses(&seed);
        const iqfoc_ab_t u = random_ab_in_square(&seed, 0.6);
        const iq24_t u_dc_inverse = random_iq24(&seed, 0.5, fmin(2.0, 1.0 / span_of(complex_of_ab(u))));
        const iqfoc_flux_predictor_t machine = {.l_d = random_iq24(&seed, 0.0625, 8.0),
                                                .l_q = random_iq24(&seed, 0.0625, 8.0)};
        iqfoc_ab_t i[3];
        double complex exact[3];
        for (int k = 0; k < 3; k++) {
            i[k] = random_ab_in_square(&seed, reach);
            exact[k] = complex_of_ab(i[k]);
        }
        const double complex mean = 0.5 * (acting_of(&x, complex_of_ab(u), 0.5 * (exact[0] + exact[1])) +
                                           acting_of(&x, complex_of_ab(u), 0.5 * (exact[1] + exact[2])));
        const double complex wrong =
            complex_of_ab(iqfoc_sensorless_acting(&x, NULL, u, u_dc_inverse, i)) - mean;
        const double knee = fabs(to_double(x.v_dead)) * to_double(x.knee_inverse);
        TEST_ASSERT_DOUBLE_WITHIN((2.6 + knee) / 16777216.0, 0.0,
                                  fmax(fabs(creal(wrong)), fabs(cimag(wrong))));

        const double complex edges =
            at_edges(&x, &machine, complex_of_ab(u), 1.0 / to_double(u_dc_inverse), exact);
        if (!isnan(creal(edges))) {
            const double complex apart =
                complex_of_ab(iqfoc_sensorless_acting(&x, &machine, u, u_dc_inverse, i)) - edges;
            const double l = 0.5 * (to_double(machine.l_d) + to_double(machine.l_q));
            const double most = fmax(fabs(creal(apart)), fabs(cimag(apart))) * 16777216.0;
            least_room = fmin(least_room, 6.0 + 36.0 * l - most);
            compared++;
        }
        TEST_ASSERT_EQUAL_INT32(u.beta, iqfoc_sensorless_acting(NULL, &machine, u, u_dc_inverse, i).beta);
    }
    TEST_ASSERT_GREATER_THAN_INT(299000, compared);
    TEST_ASSERT_TRUE(least_room >= 0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_from_standstill_to_top_speed_and_back);
    RUN_TEST(test_change_of_source_makes_no_step);
    RUN_TEST(test_catches_a_turning_machine);
    RUN_TEST(test_catch_begins_at_no_flux);
    RUN_TEST(test_lost_lock_sets_the_status);
    RUN_TEST(test_waits_while_the_gates_are_off);
    RUN_TEST(test_voltage_that_acts);
    RUN_TEST(test_refuses_what_its_parts_refuse);
    return UNITY_END();
}
