/*
 * The plant against CVODE (test_plant_reference.h), edge to edge over closed-loop-like duties: currents,
 * their true means over each cycle in both frames, angle and speed. Bound 1e-9 of the current's size; what
 * was measured stands beside each bound.
 */
#include "plant/plant.h"
#include "test_plant_reference.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The 2019 paper's laboratory drive; the salient tests spread its inductances. */
static motor laboratory(void)
{
    motor m;
    memset(&m, 0, sizeof m);
    m.pole_pairs = 3;
    m.R_ohm = 0.75;
    m.L_d_H = 5.2e-3;
    m.L_q_H = 5.2e-3;
    m.psi_f_Wb = 0.134;
    m.I_rated_A_rms = 10.5;
    m.n_max_rpm = 8000.0;
    m.f_pwm_Hz = 5000.0;
    m.u_dc_V = 750.0;
    return m;
}

static reference reference_of(const plant_config *c)
{
    reference r;
    memset(&r, 0, sizeof r);
    r.pole_pairs = c->machine.pole_pairs;
    for (int x = 0; x < 3; x++) {
        r.R[x] = c->machine.R_ohm + c->machine.dR_ohm[x] + c->inverter.r_on_ohm;
    }
    r.L_d = c->machine.L_d_H;
    r.L_q = c->machine.L_q_H;
    r.psi = c->machine.psi_f_Wb;
    r.psi_5 = c->machine.psi_5_Wb;
    r.psi_7 = c->machine.psi_7_Wb;
    r.I_sat = c->machine.I_sat_A;
    r.accel = c->shaft.accel_e_rad_s2;
    if (c->shaft.mode == PLANT_SHAFT_INERTIA) {
        r.J = c->shaft.J_kgm2;
        r.friction = c->shaft.friction_Nms;
        r.T_load = c->shaft.T_load_Nm;
    }
    r.y[2] = c->shaft.theta_mech_start_rad * r.pole_pairs;
    r.y[3] = c->shaft.omega_e_start_rad_s;
    return r;
}

/* Duties that roughly hold i_q: the voltage of the steady state at the rotor's middle angle, and a little
 * extra. */
static void duties_for(const plant *p, int cycle, double i_q, double duty[3])
{
    const plant_config *c = &p->config;
    const double omega = p->state.y[STATE_OMEGA_E];
    const double theta = p->state.y[STATE_THETA_E] + 0.5 * omega * c->T_s;
    const double wobble = 1.0 + 0.05 * sin(0.37 * cycle);
    const double u_d = -omega * c->machine.L_q_H * i_q;
    const double u_q = (c->machine.R_ohm * i_q + omega * c->machine.psi_f_Wb) * wobble;
    for (int x = 0; x < 3; x++) {
        const double from = theta - 2.0 * VEC_PI / 3.0 * x;
        const double u = u_d * cos(from) - u_q * sin(from);
        duty[x] = fmin(fmax(0.5 + u / c->inverter.u_dc_V, 0.0), 1.0);
    }
}

/* The largest differences seen, relative to the rated peak current (the angle in rad, the speed relative). */
typedef struct worst {
    double current, mean, mean_dq, angle, speed;
} worst;

static void note(worst *w, const plant *p, const reference *r)
{
    const plant_means m = plant_mean(p);
    const plant_point now = plant_now(p);
    const double scale = p->config.I_scale_A;
    const double mean[4] = {r->y[4] / m.duration_s, r->y[5] / m.duration_s, r->y[6] / m.duration_s,
                            r->y[7] / m.duration_s};
    w->current = fmax(w->current, fmax(fabs(now.i_A[0] - r->y[0]), fabs(now.i_A[1] - r->y[1])) / scale);
    w->mean = fmax(w->mean, fmax(fabs(m.i_A[0] - mean[0]), fabs(m.i_A[1] - mean[1])) / scale);
    w->mean_dq = fmax(w->mean_dq, fmax(fabs(m.i_dq_A.d - mean[2]), fabs(m.i_dq_A.q - mean[3])) / scale);
    w->angle = fmax(w->angle, fabs(remainder(now.theta_e_rad - r->y[2], 2.0 * VEC_PI)));
    w->speed = fmax(w->speed, fabs(now.omega_e_rad_s - r->y[3]) / fmax(fabs(r->y[3]), 1.0));
}

static worst run(const char *name, const plant_config *c, double i_q, int cycles)
{
    plant p;
    plant_init(&p, c);
    reference r = reference_of(c);
    worst w = {0};
    double largest = 0.0;
    for (int cycle = 0; cycle < cycles; cycle++) {
        double duty[3];
        duties_for(&p, cycle, i_q, duty);
        plant_cycle(&p, duty, NULL, NULL, NULL);
        reference_cycle(&r, duty, c->T_s, c->inverter.u_dc_V);
        note(&w, &p, &r);
        largest = fmax(largest, fabs(r.y[0]) / c->I_scale_A);
    }
    printf(
        "%-22s current %.1e mean %.1e mean dq %.1e angle %.1e speed %.1e (largest current %.2f of rated)\n",
        name, w.current, w.mean, w.mean_dq, w.angle, w.speed, largest);
    reference_close(&r);
    return w;
}

static void check(const worst *w, double bound)
{
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->current);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->mean);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->mean_dq);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->angle);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->speed);
}

static plant_config at_speed(double L_q_ratio, double omega_e_rad_s)
{
    motor m = laboratory();
    m.L_q_H *= L_q_ratio;
    plant_config c = plant_config_from_motor(&m);
    c.shaft.omega_e_start_rad_s = omega_e_rad_s;
    c.shaft.theta_mech_start_rad = 0.3;
    return c;
}

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
    const worst w = run(name, &c, i_q, 300);
    check(&w, 1e-9);
}

static void test_round_rotor(void)
{
    exact("round, SFFR 33", at_speed(1.0, speed_of_sffr(33.3)), 10.0);
}

static void test_salient(void)
{
    exact("salient, SFFR 33", at_speed(2.5, speed_of_sffr(33.3)), 10.0);
}

static void test_standstill(void)
{
    exact("round, standstill", at_speed(1.0, 0.0), 10.0);
    exact("salient, standstill", at_speed(2.5, 0.0), 10.0);
}

static void test_reverse(void)
{
    exact("round, reverse", at_speed(1.0, -speed_of_sffr(20.0)), -8.0);
    exact("salient, reverse", at_speed(0.4, -speed_of_sffr(20.0)), -8.0);
}

static void test_low_sffr(void)
{
    exact("round, SFFR 3", at_speed(1.0, speed_of_sffr(3.0)), 5.0);
    exact("salient, SFFR 3", at_speed(2.5, speed_of_sffr(3.0)), 5.0);
}

static void test_no_resistance_and_rl_load(void)
{
    plant_config c = at_speed(2.5, speed_of_sffr(12.5));
    c.machine.R_ohm = 0.0;
    exact("salient, R = 0", c, 5.0);
    c = at_speed(1.0, speed_of_sffr(50.0));
    c.machine.psi_f_Wb = 0.0;
    c.machine.R_ohm = 20.0;
    exact("RL load", c, 8.0);
}

static void six_step(const char *name, plant_config c)
{
    plant p;
    plant_init(&p, &c);
    reference r = reference_of(&c);
    worst w = {0};
    for (int k = 0; k < 200; k++) {
        /* Six states in turn, following the rotor, each held for a sixth of a period or a bit more or less.
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
        note(&w, &p, &r);
    }
    printf("%-22s current %.1e mean %.1e mean dq %.1e\n", name, w.current, w.mean, w.mean_dq);
    reference_close(&r);
    check(&w, 1e-9);
}

static void test_six_step(void)
{
    plant_config c = at_speed(1.0, 2.0 * VEC_PI * 105.0);
    c.inverter.u_dc_V = 200.0;
    six_step("six-step, round", c);
    c.machine.L_q_H *= 2.0;
    six_step("six-step, salient", c);
}

/* A free shaft and a ramp go by the integrator: its stated bound is 1e-9 over these 300 cycles too. */
static void test_inertia(void)
{
    plant_config c = at_speed(2.0, 500.0);
    c.shaft.mode = PLANT_SHAFT_INERTIA;
    c.shaft.J_kgm2 = 1e-3;
    c.shaft.friction_Nms = 2e-3;
    c.shaft.T_load_Nm = 3.0;
    const worst w = run("inertia, salient", &c, 12.0, 300);
    check(&w, 1e-9);
}

static void test_ramp_through_zero(void)
{
    plant_config c = at_speed(1.0, -300.0);
    c.shaft.accel_e_rad_s2 = 10000.0;
    const worst w = run("ramp through zero", &c, 6.0, 300);
    check(&w, 1e-9);
}

/* The integrator and the exact path are two ways to the same answer: force the first where the second serves.
 */
static void test_both_paths_agree(void)
{
    plant_config c = at_speed(1.7, speed_of_sffr(15.0));
    plant exact_path, solver_path;
    plant_init(&exact_path, &c);
    plant_init(&solver_path, &c);
    solver_path.linear = false;
    double worst_A = 0.0;
    for (int cycle = 0; cycle < 500; cycle++) {
        double duty[3];
        plant_means a, b;
        duties_for(&exact_path, cycle, 9.0, duty);
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
