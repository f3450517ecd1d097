#include "test_plant_compare.h"

#include "../laboratory_motor.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

reference compare_reference(const plant_config *c)
{
    reference r;
    memset(&r, 0, sizeof r);
    r.pole_pairs = c->machine.pole_pairs;
    for (int x = 0; x < 3; x++) {
        r.R[x] = c->machine.R_ohm + c->machine.dR_ohm[x] + c->inverter.r_on_ohm;
        r.dL[x] = c->machine.dL_H[x];
    }
    r.L_d = c->machine.L_d_H;
    r.L_q = c->machine.L_q_H;
    r.psi = c->machine.psi_f_Wb;
    r.psi_5 = c->machine.psi_5_Wb;
    r.psi_7 = c->machine.psi_7_Wb;
    r.psi_11 = c->machine.psi_11_Wb;
    r.psi_13 = c->machine.psi_13_Wb;
    r.R_first = c->machine.R_ohm;
    r.alpha_R = c->machine.alpha_R;
    r.alpha_psi = c->machine.alpha_psi;
    r.heating = c->machine.heating_K;
    r.heating_s = c->machine.heating_s;
    r.reference = c->machine.reference_K;
    r.R_rate = c->machine.R_rate_ohm_s;
    r.psi_rate = c->machine.psi_rate_Wb_s;
    r.t = c->clock_s;
    r.I_sat = c->machine.I_sat_A;
    r.w[3][0] = c->machine.w_ddd;
    r.w[1][2] = c->machine.w_dqq;
    r.w[4][0] = c->machine.w_dddd;
    r.w[2][2] = c->machine.w_ddqq;
    r.w[0][4] = c->machine.w_qqqq;
    r.R_fe = c->machine.R_fe_ohm;
    r.tau_fe = c->machine.tau_fe_s;
    r.bandwidth = c->sensors.current_bandwidth_Hz;
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
void compare_duties(const plant *p, int cycle, double i_q, double duty[3])
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

void compare_note(comparison *w, const plant *p, const reference *r)
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
    const vec_ab seen = p->state.seen_A;
    w->seen =
        fmax(w->seen, fmax(fabs(vec_phase(seen, 0) - r->y[10]), fabs(vec_phase(seen, 1) - r->y[11])) / scale);
    w->speed = fmax(w->speed, fabs(now.omega_e_rad_s - r->y[3]) / fmax(fabs(r->y[3]), 1.0));
}

comparison compare_run(const char *name, const plant_config *c, double i_q, int cycles)
{
    plant p;
    plant_init(&p, c);
    reference r = compare_reference(c);
    comparison w = {0};
    double largest = 0.0;
    for (int cycle = 0; cycle < cycles; cycle++) {
        double duty[3];
        compare_duties(&p, cycle, i_q, duty);
        plant_cycle(&p, duty, NULL, NULL, NULL);
        reference_cycle(&r, duty, c->T_s, c->inverter.u_dc_V);
        compare_note(&w, &p, &r);
        largest = fmax(largest, fabs(r.y[0]) / c->I_scale_A);
    }
    printf(
        "%-22s current %.1e mean %.1e mean dq %.1e angle %.1e speed %.1e (largest current %.2f of rated)\n",
        name, w.current, w.mean, w.mean_dq, w.angle, w.speed, largest);
    reference_close(&r);
    return w;
}

void compare_check(const comparison *w, double bound)
{
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->current);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->mean);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->mean_dq);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->angle);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->speed);
    TEST_ASSERT_DOUBLE_WITHIN(bound, 0.0, w->seen);
}

plant_config compare_drive(double L_q_ratio, double omega_e_rad_s)
{
    motor m = laboratory_motor();
    m.L_q_H *= L_q_ratio;
    plant_config c = plant_config_from_motor(&m);
    c.shaft.omega_e_start_rad_s = omega_e_rad_s;
    c.shaft.theta_mech_start_rad = 0.3;
    return c;
}
