/*
 * The plant against CVODE (test_plant_reference.h), edge to edge over closed-loop-like duties: currents,
 * their true means over each cycle in both frames, angle and speed. Bound 1e-9 of the current's size; the
 * measured error is next to each bound.
 */
#include "test_plant_compare.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

/* SFFR = f_pwm / f_e. */
static double speed_of_sffr(double sffr)
{
    return 2.0 * VEC_PI * 5000.0 / sffr;
}

static void exact(const char *name, plant_config c, double i_q)
{
    plant p;
    plant_init(&p, &c);
    TEST_ASSERT_TRUE(p.linear);
    const comparison w = compare_run(name, &c, i_q, 300);
    compare_check(&w, 1e-9);
}

static void test_round_rotor(void)
{
    exact("round, SFFR 33", compare_drive(1.0, speed_of_sffr(33.3)), 10.0);
}

static void test_salient(void)
{
    exact("salient, SFFR 33", compare_drive(2.5, speed_of_sffr(33.3)), 10.0);
}

static void test_standstill(void)
{
    exact("round, standstill", compare_drive(1.0, 0.0), 10.0);
    exact("salient, standstill", compare_drive(2.5, 0.0), 10.0);
}

static void test_reverse(void)
{
    exact("round, reverse", compare_drive(1.0, -speed_of_sffr(20.0)), -8.0);
    exact("salient, reverse", compare_drive(0.4, -speed_of_sffr(20.0)), -8.0);
}

static void test_low_sffr(void)
{
    exact("round, SFFR 3", compare_drive(1.0, speed_of_sffr(3.0)), 5.0);
    exact("salient, SFFR 3", compare_drive(2.5, speed_of_sffr(3.0)), 5.0);
}

static void test_no_resistance_and_rl_load(void)
{
    plant_config c = compare_drive(2.5, speed_of_sffr(12.5));
    c.machine.R_ohm = 0.0;
    exact("salient, R = 0", c, 5.0);
    c = compare_drive(1.0, speed_of_sffr(50.0));
    c.machine.psi_f_Wb = 0.0;
    c.machine.R_ohm = 20.0;
    exact("RL load", c, 8.0);
}

static void six_step(const char *name, plant_config c)
{
    plant p;
    plant_init(&p, &c);
    reference r = compare_reference(&c);
    comparison w = {0};
    for (int k = 0; k < 200; k++) {
        /*
         * Six states in turn, following the rotor, each held for a sixth of a period or a bit more or less.
         */
        const double theta = p.state.y[STATE_THETA_E] + 0.5 * VEC_PI;
        const double duration = VEC_PI / 3.0 / fabs(c.shaft.omega_e_start_rad_s) * (1.0 + 0.3 * sin(k));
        bool high[3];
        for (int x = 0; x < 3; x++) {
            high[x] = cos(theta - 2.0 * VEC_PI / 3.0 * x) > 0.0;
            r.u_leg[x] = high[x] ? c.inverter.u_dc_V : 0.0;
        }
        plant_begin_interval(&p, high, duration);
        plant_advance_to(&p, 0.4 * duration); /* a stop on the way must not matter */
        plant_advance_to(&p, duration);
        reference_clear(&r);
        reference_advance(&r, duration);
        compare_note(&w, &p, &r);
    }
    printf("%-22s current %.1e mean %.1e mean dq %.1e\n", name, w.current, w.mean, w.mean_dq);
    reference_close(&r);
    compare_check(&w, 1e-9);
}

static void test_six_step(void)
{
    plant_config c = compare_drive(1.0, 2.0 * VEC_PI * 105.0);
    c.inverter.u_dc_V = 200.0;
    six_step("six-step, round", c);
    c.machine.L_q_H *= 2.0;
    six_step("six-step, salient", c);
}

/* A free shaft and a ramp are integrated numerically: the integrator's stated bound is 1e-9 over these 300 cycles too. */
static void test_inertia(void)
{
    plant_config c = compare_drive(2.0, 500.0);
    c.shaft.mode = PLANT_SHAFT_INERTIA;
    c.shaft.J_kgm2 = 1e-3;
    c.shaft.friction_Nms = 2e-3;
    c.shaft.T_load_Nm = 3.0;
    const comparison w = compare_run("inertia, salient", &c, 12.0, 300);
    compare_check(&w, 1e-9);
}

static void test_ramp_through_zero(void)
{
    plant_config c = compare_drive(1.0, -300.0);
    c.shaft.accel_e_rad_s2 = 10000.0;
    const comparison w = compare_run("ramp through zero", &c, 6.0, 300);
    compare_check(&w, 1e-9);
}

/*
 * The integrator and the exact path are two ways to the same answer: force the first where the second serves.
 */
static void test_both_paths_agree(void)
{
    plant_config c = compare_drive(1.7, speed_of_sffr(15.0));
    plant exact_path, solver_path;
    plant_init(&exact_path, &c);
    plant_init(&solver_path, &c);
    solver_path.linear = false;
    double worst_A = 0.0;
    for (int cycle = 0; cycle < 500; cycle++) {
        double duty[3];
        plant_means a, b;
        compare_duties(&exact_path, cycle, 9.0, duty);
        plant_cycle(&exact_path, duty, NULL, NULL, &a);
        plant_cycle(&solver_path, duty, NULL, NULL, &b);
        worst_A = fmax(worst_A, hypot(a.i_dq_A.d - b.i_dq_A.d, a.i_dq_A.q - b.i_dq_A.q));
        worst_A = fmax(worst_A, hypot(a.u_ab_V.alpha - b.u_ab_V.alpha, a.u_ab_V.beta - b.u_ab_V.beta) * 0.01);
    }
    printf("both paths             %.1e of rated current\n", worst_A / c.I_scale_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, worst_A / c.I_scale_A);
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
    RUN_TEST(test_round_rotor);
    RUN_TEST(test_salient);
    RUN_TEST(test_standstill);
    RUN_TEST(test_reverse);
    RUN_TEST(test_low_sffr);
    RUN_TEST(test_no_resistance_and_rl_load);
    RUN_TEST(test_six_step);
    RUN_TEST(test_inertia);
    RUN_TEST(test_ramp_through_zero);
    RUN_TEST(test_both_paths_agree);
    return UNITY_END();
}
