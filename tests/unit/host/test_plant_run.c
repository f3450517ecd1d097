/*
 * The plant as its callers use it: stops on the way, traces, long runs, what a configuration may not be.
 */
#include "plant/plant.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static plant_config drive(void)
{
    motor m;
    memset(&m, 0, sizeof m);
    m.pole_pairs = 4;
    m.R_ohm = 0.5;
    m.L_d_H = 3e-3;
    m.L_q_H = 5e-3;
    m.psi_f_Wb = 0.1;
    m.I_rated_A_rms = 10.0;
    m.f_pwm_Hz = 8000.0;
    m.u_dc_V = 500.0;
    plant_config c = plant_config_from_motor(&m);
    c.shaft.omega_e_start_rad_s = 1100.0;
    return c;
}

static const double duty[3] = {0.62, 0.41, 0.5};

/* Stopping at the peak or anywhere else changes rounding only. */
static void test_stops_do_not_matter(void)
{
    for (int nonlinear = 0; nonlinear < 2; nonlinear++) {
        plant_config c = drive();
        if (nonlinear == 1) {
            c.inverter.t_dead_s = 1e-6;
            c.inverter.v_diode_V = 1.0;
        }
        plant whole, stopped;
        plant_init(&whole, &c);
        plant_init(&stopped, &c);
        for (int cycle = 0; cycle < 200; cycle++) {
            plant_begin_cycle(&whole, duty);
            plant_advance_to(&whole, c.T_s);
            plant_begin_cycle(&stopped, duty);
            for (int k = 1; k <= 13; k++) {
                plant_advance_to(&stopped, c.T_s * k / 13.0);
            }
            plant_advance_to(&stopped, 2.0 * c.T_s); /* no further than the cycle's end */
            TEST_ASSERT_TRUE(stopped.t_cycle_s == c.T_s);
            const plant_means a = plant_mean(&whole), b = plant_mean(&stopped);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * c.I_scale_A, a.i_dq_A.d, b.i_dq_A.d);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * c.I_scale_A, a.i_dq_A.q, b.i_dq_A.q);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * c.inverter.u_dc_V, a.u_V[0], b.u_V[0]);
        }
    }
}

/* What a caller leaves of a cycle is run before the next begins. */
static void test_unfinished_cycle_is_finished(void)
{
    const plant_config c = drive();
    plant a, b;
    plant_init(&a, &c);
    plant_init(&b, &c);
    for (int k = 0; k < 20; k++) {
        plant_cycle(&a, duty, NULL, NULL, NULL);
        plant_begin_cycle(&b, duty);
        plant_advance_to(&b, 0.5 * c.T_s);
    }
    plant_advance_to(&b, c.T_s);
    TEST_ASSERT_TRUE(plant_now(&a).i_A[0] == plant_now(&b).i_A[0]);
    TEST_ASSERT_TRUE(plant_now(&a).t_s == plant_now(&b).t_s);
}

typedef struct traced {
    plant_point last;
    long points;
    double volt_seconds, ampere_seconds, longest_s;
} traced;

static void take(void *context, const plant_point *point)
{
    traced *t = context;
    if (t->points > 0) {
        const double dt = point->t_s - t->last.t_s;
        TEST_ASSERT_TRUE(dt >= 0.0);
        t->longest_s = fmax(t->longest_s, dt);
        t->volt_seconds += 0.5 * dt * (point->u_V[0] + t->last.u_V[0]);
        t->ampere_seconds += 0.5 * dt * (point->i_A[0] + t->last.i_A[0]);
    }
    t->last = *point;
    t->points++;
}

/*
 * The trapezoidal rule over the traced points gives the means that the plant computed exactly: the voltage to
 * rounding, for both sides of every edge are points; the current to the rule's own error over 1 us.
 */
static void test_trace(void)
{
    plant_config c = drive();
    for (int with_dead_time = 0; with_dead_time < 2; with_dead_time++) {
        c.inverter.t_dead_s = with_dead_time == 1 ? 1e-6 : 0.0;
        plant p;
        traced t = {0};
        plant_init(&p, &c);
        plant_set_current(&p, (vec_dq){-2.0, 9.0});
        p.trace = take;
        p.trace_context = &t;
        p.trace_step_s = 1e-6;
        plant_means m;
        plant_cycle(&p, duty, NULL, NULL, &m);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, m.u_V[0] * c.T_s, t.volt_seconds);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, m.i_A[0] * c.T_s, t.ampere_seconds);
        TEST_ASSERT_TRUE(t.longest_s <= 1.001e-6);
        TEST_ASSERT_TRUE(t.points > 250 && t.points < 300); /* two for each of some 135 spans */
        plant quiet;
        plant_means without;
        plant_init(&quiet, &c);
        plant_set_current(&quiet, (vec_dq){-2.0, 9.0});
        plant_cycle(&quiet, duty, NULL, NULL, &without);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, without.i_dq_A.q, m.i_dq_A.q);
    }
}

/* A million steps of angle: 1e5 cycles at constant speed end where omega t does, to 1e-9 rad. */
static void test_angle_of_a_long_run(void)
{
    const plant_config c = drive();
    plant p;
    plant_init(&p, &c);
    const int cycles = 100000;
    for (int k = 0; k < cycles; k++) {
        plant_cycle(&p, duty, NULL, NULL, NULL);
    }
    const plant_point now = plant_now(&p);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, cycles * c.T_s, now.t_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, remainder(1100.0 * cycles / 8000.0 - now.theta_e_rad, 2.0 * VEC_PI));
    plant_samples s;
    plant_sample(&p, &s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, remainder(4.0 * s.theta_mech_rad - s.theta_e_rad, 2.0 * VEC_PI));
}

/* Duties beyond the range, and the change from 1 to 0 at a valley. */
static void test_duty_range(void)
{
    const plant_config c = drive();
    const double full[3] = {1.7, -0.3, 0.0}, other[3] = {0.0, 1.0, 0.0};
    plant p;
    plant_means m;
    plant_init(&p, &c);
    plant_cycle(&p, full, NULL, NULL, &m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 500.0 * 2.0 / 3.0, m.u_V[0]);
    plant_cycle(&p, other, NULL, NULL, &m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -500.0 / 3.0, m.u_V[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 500.0 * 2.0 / 3.0, m.u_V[1]);
}

/* A shaft that is let go in the middle of a run: load accelerates it backwards by T/J. */
static void test_load(void)
{
    plant_config c = drive();
    c.machine.psi_f_Wb = 0.0;
    c.machine.L_q_H = c.machine.L_d_H; /* no torque at all */
    c.shaft.mode = PLANT_SHAFT_INERTIA;
    c.shaft.J_kgm2 = 2e-3;
    plant p;
    plant_init(&p, &c);
    plant_set_load(&p, 3.0);
    for (int k = 0; k < 80; k++) {
        plant_cycle(&p, duty, NULL, NULL, NULL);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1100.0 - 4.0 * 3.0 / 2e-3 * 0.01, plant_now(&p).omega_e_rad_s);
    plant_set_speed(&p, 50.0, 0.0);
    TEST_ASSERT_TRUE(plant_now(&p).omega_e_rad_s == 50.0);
}

static void refused(const plant_config *c, const char *part)
{
    error e = {0};
    TEST_ASSERT_FALSE(plant_config_check(c, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_TRUE_MESSAGE(strstr(e.text, part) != NULL, e.text);
}

static void test_configuration_is_checked(void)
{
    plant_config c = drive();
    error e = {0};
    TEST_ASSERT_TRUE(plant_config_check(&c, &e));
    c.shaft.mode = PLANT_SHAFT_INERTIA;
    refused(&c, "J is 0, expected greater than 0");
    c = drive();
    c.machine.R_fe_ohm = 100.0;
    refused(&c, "tau_fe");
    c = drive();
    c.sensors.current_bits = 12;
    refused(&c, "ADC full scale");
    c = drive();
    c.shaft.omega_e_start_rad_s = NAN;
    refused(&c, "speed");
    c = drive();
    c.machine.L_q_H = -1e-3;
    refused(&c, "L_q is -0.001, expected greater than 0");
}

void setUp(void)
{
}

void tearDown(void)
{
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_stops_do_not_matter);
    RUN_TEST(test_unfinished_cycle_is_finished);
    RUN_TEST(test_trace);
    RUN_TEST(test_angle_of_a_long_run);
    RUN_TEST(test_duty_range);
    RUN_TEST(test_load);
    RUN_TEST(test_configuration_is_checked);
    return UNITY_END();
}
