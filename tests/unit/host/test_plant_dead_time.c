/*
 * Dead time, device drops and the clamp at zero current.
 *
 * The reference has diodes that are not ideal: a leg goes from its one voltage to the other
 * by tanh(i / knee), so that the current chooses the device by itself and no event is looked for. The plant's
 * ideal diodes are its limit for a small knee.
 */
#include "test_plant_compare.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The legs over a cycle as the table of plant_inverter.h says, worked out again here: 0 both off, +1 high on, -1
 * low on. */
static int leg_at(double t, double duty, double T, double t_dead)
{
    const double rise = 0.5 * T * (1.0 - duty), fall = 0.5 * T * (1.0 + duty);
    if ((t >= rise && t < rise + t_dead) || (t >= fall && t < fall + t_dead)) {
        return 0;
    }
    return t >= rise && t < fall ? 1 : -1;
}

static void smooth_diode_cycle(reference *r, const plant_config *c, const double duty[3])
{
    const plant_inverter *v = &c->inverter;
    double edge[14] = {0.0};
    int edges = 1;
    for (int x = 0; x < 3; x++) {
        for (int side = -1; side <= 1; side += 2) {
            edge[edges++] = 0.5 * c->T_s * (1.0 + side * duty[x]);
            edge[edges++] = 0.5 * c->T_s * (1.0 + side * duty[x]) + v->t_dead_s;
        }
    }
    edge[edges++] = c->T_s;
    for (int a = 1; a < edges; a++) {
        for (int b = a; b > 0 && edge[b] < edge[b - 1]; b--) {
            const double swap = edge[b];
            edge[b] = edge[b - 1];
            edge[b - 1] = swap;
        }
    }
    reference_clear(r);
    for (int n = 0; n + 1 < edges; n++) {
        for (int x = 0; x < 3; x++) {
            const int on = leg_at(0.5 * (edge[n] + edge[n + 1]), duty[x], c->T_s, v->t_dead_s);
            r->least[x] = on > 0 ? v->u_dc_V - v->v_switch_V : -v->v_diode_V;
            r->most[x] = on < 0 ? v->v_switch_V : v->u_dc_V + v->v_diode_V;
        }
        reference_advance(r, edge[n + 1] - edge[n]);
    }
}

/*
 * Relative to the rated peak of 14.8 A. Measured: at most 3.4e-7 with this knee, 1.1e-6 with one ten times as
 * wide, so that the rest is the reference's knee.
 */
static void follow(const char *name, plant_config c, double i_q, int cycles)
{
    plant p;
    plant_init(&p, &c);
    reference r = compare_reference(&c);
    r.knee = 1e-6;
    comparison w = {0};
    double least = INFINITY;
    for (int cycle = 0; cycle < cycles; cycle++) {
        double duty[3];
        compare_duties(&p, cycle, i_q, duty);
        plant_cycle(&p, duty, NULL, NULL, NULL);
        smooth_diode_cycle(&r, &c, duty);
        compare_note(&w, &p, &r);
        for (int x = 0; x < 3; x++) {
            least = fmin(least, fabs(plant_now(&p).i_A[x]));
        }
    }
    printf("%-26s current %.1e mean %.1e mean dq %.1e (smallest phase current %.1e A)\n", name, w.current,
           w.mean, w.mean_dq, least);
    reference_close(&r);
    TEST_ASSERT_DOUBLE_WITHIN(5e-7, 0.0, w.current);
    TEST_ASSERT_DOUBLE_WITHIN(5e-7, 0.0, w.mean);
    TEST_ASSERT_DOUBLE_WITHIN(5e-7, 0.0, w.mean_dq);
}

static void test_dead_time(void)
{
    plant_config c = compare_drive(1.0, 500.0);
    c.inverter.t_dead_s = 2e-6;
    follow("dead time, 10 A", c, 10.0, 60);
    follow("dead time, 0.3 A", c, 0.3, 60); /* ripple crosses zero in every cycle */
    follow("dead time, no current", c, 0.0, 60);
}

static void test_drops(void)
{
    plant_config c = compare_drive(1.8, -400.0);
    c.inverter.v_switch_V = 1.6;
    c.inverter.v_diode_V = 1.1;
    c.inverter.r_on_ohm = 0.02;
    follow("drops, 10 A", c, 10.0, 60);
    follow("drops, 0.5 A", c, 0.5, 60);
}

static void test_dead_time_and_drops(void)
{
    plant_config c = compare_drive(1.3, 300.0);
    c.inverter.t_dead_s = 3e-6;
    c.inverter.v_switch_V = 2.0;
    c.inverter.v_diode_V = 1.5;
    follow("both, 5 A", c, 5.0, 60);
    follow("both, 0.2 A", c, 0.2, 60);
    c.shaft.omega_e_start_rad_s = 0.0;
    follow("both, standstill", c, 0.5, 60);
    c.machine.I_sat_A = 20.0;
    c.machine.psi_5_Wb = 0.003;
    c.machine.R_fe_ohm = 300.0;
    c.machine.tau_fe_s = 50e-6;
    c.shaft.omega_e_start_rad_s = 600.0;
    follow("both, other effects", c, 4.0, 60);
}

/*
 * All switches off: the current returns to the link through the diodes and stops. Phase A carries i, B and C
 * half each back; A's leg is at -V_d, the others at u_dc + V_d: L di/dt = -R i - 2/3 (u_dc + 2 V_d).
 */
static void test_all_off_current_ends_at_zero(void)
{
    plant_config c = compare_drive(1.0, 0.0);
    c.machine.psi_f_Wb = 0.0;
    c.inverter.t_dead_s = 0.5 * c.T_s;
    c.inverter.v_diode_V = 1.0;
    c.shaft.theta_mech_start_rad = 0.0;
    plant p;
    plant_init(&p, &c);
    const double i_start = 4.0;
    plant_set_current(&p, (vec_dq){i_start, 0.0});
    const bool high[3] = {true, true, true};
    plant_begin_interval(&p, high, 0.5 * c.T_s); /* low side off, high side not yet on: all off for 100 us */
    const double push_V = 2.0 / 3.0 * (c.inverter.u_dc_V + 2.0), R = c.machine.R_ohm,
                 tau = c.machine.L_d_H / R;
    const double end_s = tau * log(1.0 + R * i_start / push_V);
    TEST_ASSERT_TRUE(end_s < 0.5 * c.T_s);
    for (int k = 1; k <= 20; k++) {
        const double t = 0.5 * c.T_s * k / 20.0;
        plant_advance_to(&p, t);
        const double expected = t < end_s ? (i_start + push_V / R) * exp(-t / tau) - push_V / R : 0.0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, expected, plant_now(&p).i_A[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.5 * expected, plant_now(&p).i_A[1]);
    }
    TEST_ASSERT_TRUE(p.leg[0].flow == LEG_FLOW_NONE && p.leg[1].flow == LEG_FLOW_NONE);
}

/* To first order a leg loses u_dc t_dead f_pwm + (V_switch + V_diode)/2 against its current: interfaces,
 * "dead_time". */
static void test_lost_voltage(void)
{
    plant_config c = compare_drive(1.0, 0.0);
    c.machine.psi_f_Wb = 0.0;
    c.machine.L_d_H = c.machine.L_q_H = 1.0; /* hardly any ripple: every edge finds the same current */
    c.shaft.theta_mech_start_rad = 0.0;
    c.inverter.t_dead_s = 1.5e-6;
    c.inverter.v_switch_V = 1.2;
    c.inverter.v_diode_V = 0.8;
    plant p;
    plant_init(&p, &c);
    plant_set_current(&p, (vec_dq){8.0, 0.0});
    const double duty[3] = {0.5, 0.5, 0.5};
    plant_means m;
    plant_cycle(&p, duty, NULL, NULL, &m);
    const double v_dead = c.inverter.u_dc_V * 1.5e-6 * 5000.0 + 0.5 * (1.2 + 0.8);
    /* A positive, B and C negative: legs lose (v, -v, -v), the star point takes -v/3 of it. */
    TEST_ASSERT_DOUBLE_WITHIN(0.02, -4.0 / 3.0 * v_dead, m.u_V[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 2.0 / 3.0 * v_dead, m.u_V[1]);
}

/* A pulse shorter than the dead time never turns its switch on; the leg waits from the last command. */
static void test_pulse_shorter_than_dead_time(void)
{
    inverter_leg leg = {.high = false, .on_at_s = 0.0};
    leg_begin_cycle(&leg, 0.01, 0.01, 100e-6, 2e-6); /* 1 us high around 50 us */
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 49.5e-6, leg_next_change(&leg, 0.0));
    leg_pass(&leg, leg.rise_s, 2e-6);
    TEST_ASSERT_TRUE(leg.high && leg_off(&leg, 49.6e-6));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 50.5e-6, leg_next_change(&leg, 49.6e-6));
    leg_pass(&leg, leg.fall_s, 2e-6);
    TEST_ASSERT_TRUE(!leg.high && leg_off(&leg, 52.4e-6));
    TEST_ASSERT_FALSE(leg_off(&leg, 52.6e-6));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 52.5e-6, leg_next_change(&leg, 51e-6));
    TEST_ASSERT_TRUE(isinf(leg_next_change(&leg, 53e-6)));
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
    RUN_TEST(test_dead_time);
    RUN_TEST(test_drops);
    RUN_TEST(test_dead_time_and_drops);
    RUN_TEST(test_all_off_current_ends_at_zero);
    RUN_TEST(test_lost_voltage);
    RUN_TEST(test_pulse_shorter_than_dead_time);
    return UNITY_END();
}
