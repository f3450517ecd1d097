/*
 * The averaged model against Runge-Kutta in stationary quantities, at standstill, in reverse, without
 * resistance and at three cycles a revolution.
 */
#include "diagnose_bench.h"
#include "model/averaged_drive.h"
#include "model/flux_map.h"
#include "model/late_speed.h"
#include "model/link_ripple.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

enum { POLE_PAIRS = 2 };

void setUp(void)
{
}

void tearDown(void)
{
}

/* dx/dt of the rotor-frame equations of exact_map.h, integrated by brute force. */
static void brute(double R, double L_d, double L_q, double T, double omega, const double u[2], double forcing,
                  double x[2])
{
    const int steps = 4000;
    double h = T / steps;
    for (int n = 0; n < steps; n++) {
        double k[4][2];
        for (int stage = 0; stage < 4; stage++) {
            double share = stage == 0 ? 0.0 : (stage == 3 ? 1.0 : 0.5);
            double t = (n + share) * h;
            double at[2];
            for (int a = 0; a < 2; a++) {
                at[a] = x[a] + (stage > 0 ? share * h * k[stage - 1][a] : 0.0);
            }
            double u_d = u[0] * cos(omega * t) + u[1] * sin(omega * t);
            double u_q = u[1] * cos(omega * t) - u[0] * sin(omega * t);
            k[stage][0] = -R / L_d * at[0] + omega * at[1] + u_d;
            k[stage][1] = -omega * at[0] - R / L_q * at[1] + u_q + forcing;
        }
        for (int a = 0; a < 2; a++) {
            x[a] += h / 6.0 * (k[0][a] + 2.0 * k[1][a] + 2.0 * k[2][a] + k[3][a]);
        }
    }
}

static void the_step_is_the_exact_solution(void)
{
    static const double motors[][3] = {
        {0.9, 0.008, 0.011}, {0.0, 0.005, 0.005}, {3.0, 0.002, 0.006}, {0.05, 1e-3, 1e-3}};
    static const double turns[] = {0.0, 1e-9, 0.01, -0.3, 0.79, -2.09};
    const double T = 2.5e-4;
    for (size_t m = 0; m < 4; m++) {
        for (size_t n = 0; n < 6; n++) {
            const double *p = motors[m];
            double omega = turns[n] / T;
            averaged_step step;
            exact_maps(p[0], p[1], p[2], T, omega, &step, NULL);
            const double u[2] = {120.0, -75.0};
            const double forcing = -omega * 0.2 + 3.0;
            double x[2] = {0.03, -0.05};
            const double x0[2] = {0.03, -0.05};
            brute(p[0], p[1], p[2], T, omega, u, forcing, x);
            for (int a = 0; a < 2; a++) {
                double y = step.decay[a][0] * x0[0] + step.decay[a][1] * x0[1] + step.drive[a][0] * u[0] +
                           step.drive[a][1] * u[1] + step.push[a][1] * forcing;
                /* 4000 steps of the fourth order are exact to rounding; the flux is some 0.1 Wb. */
                TEST_ASSERT_DOUBLE_WITHIN(2e-14, x[a], y);
            }
        }
    }
}

static void a_node_serves_its_neighbourhood(void)
{
    const double T = 2.5e-4;
    const double omega = 1300.0;
    averaged_node node = averaged_node_at(0.9, 0.008, 0.011, T, omega);
    for (double h = -0.5; h <= 0.5; h += 0.125) {
        averaged_step near = averaged_node_step(&node, h);
        averaged_step exact;
        exact_maps(0.9, 0.008, 0.011, T, omega + h * AVERAGED_NODE_STEP / T, &exact, NULL);
        for (int k = 0; k < 4; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-7, (&exact.decay[0][0])[k], (&near.decay[0][0])[k]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-7 * T, (&exact.drive[0][0])[k], (&near.drive[0][0])[k]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-7 * T, (&exact.push[0][0])[k], (&near.push[0][0])[k]);
        }
    }
}

static void an_edge_loses_its_share(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(1.0, averaged_drive_edge(EDGE_CLIPPED, 7.0));
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, averaged_drive_edge(EDGE_CLIPPED, -0.5));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, averaged_drive_edge(EDGE_CHARGED, 1.0)); /* both branches meet */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -0.95, averaged_drive_edge(EDGE_CHARGED, -10.0));
}

static void the_extended_motor_file_says_the_same_drive(void)
{
    motor m = bench_motor();
    m.ext.has[CAUSE_ANGLE_HARMONIC] = true;
    m.ext.harmonic_order = 2.0;
    m.ext.harmonic_amplitude_rad = 0.03;
    m.ext.harmonic_phase_rad = -2.5;
    m.ext.has[CAUSE_SATURATION] = true;
    m.ext.L_0_H = 0.0095;
    m.ext.I_sat_A = 20.0;
    m.ext.has[CAUSE_VOLTAGE_DELAY] = true;
    m.ext.voltage_delay_cycles = 1.25;
    /* Each order has a place of its own, but where two are the same number. */
    const double orders[][2] = {{1.0, 1.0}, {2.0, 2.0}, {3.0, 3.0}, {6.0, 6.0}};
    for (size_t k = 0; k < 4; k++) {
        motor one = m;
        one.ext.harmonic_order = orders[k][0];
        const averaged_drive swings = averaged_drive_of(&one);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.03 * cos(-2.5), swings.harmonic_cos_rad[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.03 * sin(-2.5), swings.harmonic_sin_rad[k]);
        motor back = averaged_drive_motor(&swings, &one);
        TEST_ASSERT_EQUAL_DOUBLE(orders[k][1], *motor_harmonic_of(&back.ext, k).order);
    }
    averaged_drive d = averaged_drive_of(&m);
    motor base = bench_motor();
    motor again = averaged_drive_motor(&d, &base);
    TEST_ASSERT_FALSE(again.ext.has[CAUSE_ANGLE_HARMONIC]);
    TEST_ASSERT_TRUE(again.ext.has[CAUSE_ANGLE_HARMONIC_2]);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, again.ext.harmonic_2_order);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.03, again.ext.harmonic_2_amplitude_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -2.5, again.ext.harmonic_2_phase_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0095, again.ext.L_0_H);
    /* The axes' ratio is [motor]'s, their mean L_0. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0095, 0.5 * (again.L_d_H + again.L_q_H));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, m.L_d_H / m.L_q_H, again.L_d_H / again.L_q_H);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 20.0, again.ext.I_sat_A);
    TEST_ASSERT_EQUAL_DOUBLE(1.25, again.ext.voltage_delay_cycles);
    TEST_ASSERT_FALSE(again.ext.has[CAUSE_DEAD_TIME] || again.ext.has[CAUSE_CURRENT_GAIN]);
}

static averaged_drive with_map(void)
{
    motor m = bench_motor();
    m.ext.has[CAUSE_SATURATION_DQ] = true;
    m.ext.L_d0_H = 0.009;
    m.ext.L_q0_H = 0.013;
    m.ext.w_ddd = 2e-5;
    m.ext.w_dqq = -4e-5;
    m.ext.w_dddd = -1e-6;
    m.ext.w_ddqq = -3e-6;
    m.ext.w_qqqq = -2e-6;
    m.ext.I_sat_dq_A = 30.0;
    return averaged_drive_of(&m);
}

static void a_flux_map_goes_to_the_motor_file_and_back(void)
{
    const averaged_drive d = with_map();
    const motor base = bench_motor();
    const motor again = averaged_drive_motor(&d, &base);
    TEST_ASSERT_EQUAL_DOUBLE(0.009, d.L_d_H);
    TEST_ASSERT_TRUE(again.ext.has[CAUSE_SATURATION_DQ] && !again.ext.has[CAUSE_SATURATION]);
    TEST_ASSERT_EQUAL_DOUBLE(0.013, again.ext.L_q0_H);
    TEST_ASSERT_EQUAL_DOUBLE(-4e-5, again.ext.w_dqq);
    TEST_ASSERT_EQUAL_DOUBLE(-2e-6, again.ext.w_qqqq);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 30.0, again.ext.I_sat_dq_A);
}

/* Flux is a gradient, the incremental inductance its slope, and the current of a flux the one that makes it. */
static void a_flux_map_is_inverted(void)
{
    const averaged_drive d = with_map();
    const double h = 1e-5;
    for (int n = 0; n < 40; n++) {
        const vec_dq i = {8.0 * cos(0.4 * n) - 1.0, 7.0 * sin(0.55 * n)};
        const vec_dq flux = flux_map_flux(&d, i);
        const vec_dq on_d = flux_map_flux(&d, (vec_dq){i.d + h, i.q});
        const vec_dq on_q = flux_map_flux(&d, (vec_dq){i.d, i.q + h});
        const flux_map_slope m = flux_map_at(&d, i).slope;
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, m.dd, (on_d.d - flux.d) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, m.dq, (on_d.q - flux.q) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, m.dq, (on_q.d - flux.d) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, m.qq, (on_q.q - flux.q) / h);
        TEST_ASSERT_TRUE(flux_map_is_physical(&d, i, 0.1));
        const vec_dq back = flux_map_current(&d, flux, (vec_dq){0.8 * i.d, i.q + 1.0});
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, i.d, back.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, i.q, back.q);
    }
}

static averaged_drive with_parts(void)
{
    motor m = bench_motor();
    m.ext.has[CAUSE_SATURATION_DQ] = true;
    m.ext.L_d0_H = 0.03;
    m.ext.L_q0_H = 0.13;
    m.ext.E_1_J = 10.0;
    m.ext.I_d1_A = 30.0;
    m.ext.I_q1_A = 10.0;
    m.ext.I_c1_A = -4.0;
    m.ext.E_2_J = 0.2;
    m.ext.I_d2_A = 4.0;
    m.ext.I_q2_A = 8.0;
    m.ext.I_c2_A = 3.0;
    return averaged_drive_of(&m);
}

/* Each at no current has the inductances of the file and no flux; there is a gradient everywhere, and the current of a flux is found. */
static void parts_that_saturate_make_a_flux_map(void)
{
    const averaged_drive d = with_parts();
    const flux_map_point none = flux_map_at(&d, (vec_dq){0.0, 0.0});
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0, none.flux.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.03, none.slope.dd);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.13, none.slope.qq);
    const double h = 1e-5;
    for (int n = 0; n < 60; n++) {
        const vec_dq i = {(4.0 + 0.4 * n) * cos(0.4 * n), (3.0 + 0.3 * n) * sin(0.55 * n)};
        /* The energy itself, at no current without its slope. */
        double flux[2];
        for (int axis = 0; axis < 2; axis++) {
            double energy[2];
            for (int side = 0; side < 2; side++) {
                const double by = side == 0 ? -h : h;
                const double at_d = i.d + (axis == 0 ? by : 0.0);
                const double at_q = i.q + (axis == 1 ? by : 0.0);
                double W = 0.5 * (0.03 * at_d * at_d + 0.13 * at_q * at_q);
                for (size_t k = 0; k < IRON_PARTS; k++) {
                    const iron_part *p = &d.iron[k];
                    const double c = p->I_c_A / p->I_d_A;
                    const double x = at_d / p->I_d_A;
                    const double y = at_q / p->I_q_A;
                    const double root = sqrt(1.0 + c * c);
                    W += p->E_J * (sqrt(1.0 + (x - c) * (x - c) + y * y) + c * x / root -
                                   0.5 * x * x / (root * root * root) - 0.5 * y * y / root);
                }
                energy[side] = W;
            }
            flux[axis] = (energy[1] - energy[0]) / (2.0 * h);
        }
        const flux_map_point at = flux_map_at(&d, i);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, flux[0], at.flux.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, flux[1], at.flux.q);
        const vec_dq on_d = flux_map_flux(&d, (vec_dq){i.d + h, i.q});
        const vec_dq on_q = flux_map_flux(&d, (vec_dq){i.d, i.q + h});
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, at.slope.dd, (on_d.d - at.flux.d) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, at.slope.dq, (on_d.q - at.flux.q) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, at.slope.dq, (on_q.d - at.flux.d) / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, at.slope.qq, (on_q.q - at.flux.q) / h);
        const vec_dq back = flux_map_current(&d, at.flux, (vec_dq){0.95 * i.d, i.q + 0.5});
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, i.d, back.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, i.q, back.q);
    }
}

/* Convex at every current, a hundred times the rated one too, where the flux goes on in a straight line; else no machine has it. */
static void parts_that_saturate_are_convex_everywhere(void)
{
    averaged_drive d = with_parts();
    TEST_ASSERT_TRUE(flux_map_is_convex(&d, 0.01));
    for (double A = 0.3; A < 1500.0; A *= 1.7) {
        for (int n = 0; n < 48; n++) {
            const vec_dq i = {A * cos(0.131 * n), A * sin(0.131 * n)};
            TEST_ASSERT_TRUE(flux_map_is_physical(&d, i, 0.01));
        }
    }
    const flux_map_slope far = flux_map_at(&d, (vec_dq){0.0, 1e6}).slope;
    const double root = sqrt(1.0 + 16.0 / 900.0);
    const double second = sqrt(1.0 + 9.0 / 16.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.13 - 10.0 / (100.0 * root) - 0.2 / (64.0 * second), far.qq);
    d.iron[0].E_J = 14.0; /* more than L_q has */
    TEST_ASSERT_FALSE(flux_map_is_convex(&d, 0.0));
    TEST_ASSERT_FALSE(flux_map_is_physical(&d, (vec_dq){0.0, 1000.0}, 0.0));
}

static void parts_that_saturate_go_to_the_motor_file_and_back(void)
{
    averaged_drive d = with_parts();
    const motor base = bench_motor();
    motor again = averaged_drive_motor(&d, &base);
    TEST_ASSERT_TRUE(again.ext.has[CAUSE_SATURATION_DQ] && !again.ext.has[CAUSE_SATURATION]);
    const averaged_drive back = averaged_drive_of(&again);
    TEST_ASSERT_EQUAL_MEMORY(d.iron, back.iron, sizeof d.iron);
    TEST_ASSERT_EQUAL_DOUBLE(0.03, back.L_d_H);
    /* Without energy nothing is written of a part. */
    d.iron[0].E_J = d.iron[1].E_J = 0.0;
    again = averaged_drive_motor(&d, &base);
    TEST_ASSERT_FALSE(again.ext.has[CAUSE_SATURATION_DQ]);
    TEST_ASSERT_TRUE(again.ext.I_d1_A == 0.0 && again.ext.I_q2_A == 0.0 && again.ext.I_c1_A == 0.0);
}

/* A guess is as far off as the square of the way to it, and exact where the inductances are constant. */
static void a_flux_is_guessed_from_a_current_nearby(void)
{
    averaged_drive d = with_map();
    const vec_dq i = {-3.0, 5.0};
    const flux_map_point at = flux_map_at(&d, i);
    double off[2];
    for (int n = 0; n < 2; n++) {
        const double by = n == 0 ? 0.2 : 0.1;
        const vec_dq to = {i.d + by, i.q - by};
        const vec_dq guess = flux_map_guess(&d, flux_map_flux(&d, to), i, &at);
        off[n] = hypot(guess.d - to.d, guess.q - to.q);
    }
    TEST_ASSERT_TRUE(off[1] > 0.0 && off[0] < 0.02);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 4.0, off[0] / off[1]);
    d = (averaged_drive){.L_d_H = 0.009, .L_q_H = 0.013};
    const flux_map_point plain = flux_map_at(&d, i);
    const vec_dq guess = flux_map_guess(&d, (vec_dq){0.09, 0.13}, i, &plain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, guess.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, guess.q);
}

/* A flux beyond what the map carries: no current makes it, and what comes out is no runaway. */
static void a_flux_beyond_the_map_has_a_current_of_its_size(void)
{
    averaged_drive d = with_map();
    d.saturation = 0.0;
    d.w_qqqq = -2e-5;
    TEST_ASSERT_FALSE(flux_map_is_physical(&d, (vec_dq){0.0, 10.0}, 0.0));
    const vec_dq i = flux_map_current(&d, (vec_dq){0.0, 0.2}, (vec_dq){0.0, 3.0});
    TEST_ASSERT_TRUE(i.q > 3.0 && i.q < 40.0 && fabs(i.d) < 40.0);
}

/* The plain law's flux has its largest value at I_sat. Up to there the current comes back; beyond, it is twice the unsaturated one. */
static void the_plain_law_gives_its_current_back(void)
{
    const averaged_drive d = {.L_d_H = 0.01, .L_q_H = 0.01, .saturation = 1.0 / (12.0 * 12.0)};
    for (int n = 0; n < 40; n++) {
        const vec_dq i = {0.29 * n * cos(0.7 * n), 0.29 * n * sin(0.7 * n)};
        const vec_dq back = flux_map_current(&d, flux_map_flux(&d, i), (vec_dq){0.0, 0.0});
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.d, back.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, i.q, back.q);
    }
    const vec_dq beyond = flux_map_current(&d, (vec_dq){-0.08, 0.0}, (vec_dq){0.0, 0.0});
    TEST_ASSERT_DOUBLE_WITHIN(0.0, -16.0, beyond.d);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, beyond.q);
}

/* The current at the end of a cycle of 0.2 rad that is recorded as beginning at `recorded`, mechanically at `mech`. */
static vec_ab after_cycle_at(const averaged_drive *d, double recorded, double mech, double mech_moves)
{
    const double T = 1.25e-4;
    const averaged_node node = averaged_node_at(d->R_ohm, d->L_d_H, d->L_q_H, T, 0.2 / T);
    const cycle_row row = {.u_V[0] = {40.0, -25.0},
                           .cos_theta = cos(recorded),
                           .sin_theta = sin(recorded),
                           .cos_mech = cos(mech),
                           .sin_mech = sin(mech),
                           .mech_moves = mech_moves,
                           .cos_turn = cos(0.2),
                           .sin_turn = sin(0.2),
                           .omega_rad_s = 0.2 / T,
                           .u_dc_V = 565.0,
                           .T_s = T};
    return averaged_drive_advance(d, &node, &row, (vec_ab){3.0, -2.0}, NULL);
}

static vec_ab after_cycle(const averaged_drive *d, double recorded)
{
    return after_cycle_at(d, recorded, 0.0, 0.0);
}

/* An error once and twice an electrical turn depends on the true angle, and the recorded one is all that a row has. */
static void an_error_of_the_electrical_turn_is_taken_at_the_true_angle(void)
{
    const motor m = bench_motor();
    const averaged_drive right = averaged_drive_of(&m);
    averaged_drive off = right;
    off.harmonic_cos_rad[2] = 0.02;
    off.harmonic_sin_rad[2] = -0.03;
    off.harmonic_cos_rad[3] = 0.07;
    off.harmonic_sin_rad[3] = 0.06;
    double most = 0.0;
    for (int k = 0; k < 100; k++) {
        const double theta = 0.0628 * k;
        const double ahead =
            0.02 * cos(theta) - 0.03 * sin(theta) + 0.07 * cos(2.0 * theta) + 0.06 * sin(2.0 * theta);
        const vec_ab want = after_cycle(&right, theta);
        const vec_ab got = after_cycle(&off, theta + ahead);
        most = fmax(most, hypot(got.alpha - want.alpha, got.beta - want.beta));
    }
    printf("  off by %.2g A at most\n", most);
    TEST_ASSERT_TRUE(most < 1e-5);
}

/* So does one of the mechanical turn, where the mechanical angle is the same sensor's; another sensor's angle stays. */
static void an_error_of_the_turn_moves_the_angle_that_it_depends_on(void)
{
    const motor m = bench_motor();
    const averaged_drive right = averaged_drive_of(&m);
    averaged_drive off = right;
    off.theta_0_rad = 0.03;
    off.harmonic_cos_rad[0] = 0.04;
    off.harmonic_sin_rad[1] = -0.08;
    double most = 0.0;
    double apart = 0.0;
    for (int k = 0; k < 100; k++) {
        const double mech = 0.0628 * k;
        const double ahead = 0.03 + 0.04 * cos(mech) - 0.08 * sin(2.0 * mech);
        const vec_ab want = after_cycle(&right, POLE_PAIRS * mech);
        const vec_ab one =
            after_cycle_at(&off, POLE_PAIRS * mech + ahead, mech + ahead / POLE_PAIRS, 1.0 / POLE_PAIRS);
        const vec_ab two = after_cycle_at(&off, POLE_PAIRS * mech + ahead, mech, 0.0);
        most = fmax(most, hypot(one.alpha - want.alpha, one.beta - want.beta));
        most = fmax(most, hypot(two.alpha - want.alpha, two.beta - want.beta));
        const vec_ab plain = after_cycle_at(&off, POLE_PAIRS * mech + ahead, mech + ahead / POLE_PAIRS, 0.0);
        apart = fmax(apart, hypot(plain.alpha - want.alpha, plain.beta - want.beta));
    }
    printf("  off by %.2g A at most, %.2g as it is recorded\n", most, apart);
    TEST_ASSERT_TRUE(most < 1e-5 && apart > 1e-2);
}

/* A rotor with POLE_PAIRS pole pairs that turns evenly. */
typedef struct turning_magnet {
    averaged_drive d;
    double theta_rad, omega_rad_s;
} turning_magnet;

/* Its machine has R, L_d and L_q, and it turns by so many rad in a cycle of T. */
static turning_magnet magnet_of(const double machine[3], double turn, double T)
{
    const motor file = bench_motor();
    turning_magnet m = {averaged_drive_of(&file), 0.4, turn / T};
    m.d.R_ohm = machine[0];
    m.d.L_d_H = machine[1];
    m.d.L_q_H = machine[2];
    return m;
}

static averaged_node node_of(const turning_magnet *m, double T)
{
    return averaged_node_at(m->d.R_ohm, m->d.L_d_H, m->d.L_q_H, T, m->omega_rad_s);
}

static cycle_row cycle_of(const turning_magnet *m, double T)
{
    return (cycle_row){.cos_theta = cos(m->theta_rad),
                       .sin_theta = sin(m->theta_rad),
                       .cos_mech = cos(m->theta_rad / POLE_PAIRS),
                       .sin_mech = sin(m->theta_rad / POLE_PAIRS),
                       .per_pole = 1.0 / POLE_PAIRS,
                       .cos_turn = cos(m->omega_rad_s * T),
                       .sin_turn = sin(m->omega_rad_s * T),
                       .omega_rad_s = m->omega_rad_s,
                       .T_s = T};
}

/* Its flux at a time, stationary frame. */
static vec_ab flux_of(const turning_magnet *m, double t)
{
    const averaged_drive *d = &m->d;
    const double theta = m->theta_rad + m->omega_rad_s * t;
    const double mech = theta / POLE_PAIRS;
    const double more = d->pole_cos[0] * cos(mech) + d->pole_sin[0] * sin(mech) +
                        d->pole_cos[1] * cos(2.0 * mech) + d->pole_sin[1] * sin(2.0 * mech);
    const double psi = d->psi_f_Wb * (1.0 + more);
    return (vec_ab){psi * cos(theta) + d->psi_5_Wb * cos(5.0 * theta) + d->psi_7_Wb * cos(7.0 * theta) +
                        d->psi_11_Wb * cos(11.0 * theta) + d->psi_13_Wb * cos(13.0 * theta),
                    psi * sin(theta) - d->psi_5_Wb * sin(5.0 * theta) + d->psi_7_Wb * sin(7.0 * theta) -
                        d->psi_11_Wb * sin(11.0 * theta) + d->psi_13_Wb * sin(13.0 * theta)};
}

/* The current of a flux linkage at a time, stationary frame. */
static vec_ab current_of(const turning_magnet *m, double t, vec_ab linkage)
{
    const double theta = m->theta_rad + m->omega_rad_s * t;
    const vec_ab psi = flux_of(m, t);
    const vec_ab own = {linkage.alpha - psi.alpha, linkage.beta - psi.beta};
    const double d = (own.alpha * cos(theta) + own.beta * sin(theta)) / m->d.L_d_H;
    const double q = (own.beta * cos(theta) - own.alpha * sin(theta)) / m->d.L_q_H;
    return (vec_ab){d * cos(theta) - q * sin(theta), d * sin(theta) + q * cos(theta)};
}

/* The flux linkage of a current at the start. */
static vec_ab linkage_of(const turning_magnet *m, vec_ab i)
{
    const vec_rotor start = rotor_at(m->theta_rad);
    const vec_dq i_dq = vec_to_dq(i, start);
    const vec_ab own = vec_to_ab((vec_dq){m->d.L_d_H * i_dq.d, m->d.L_q_H * i_dq.q}, start);
    const vec_ab magnet = flux_of(m, 0.0);
    return (vec_ab){own.alpha + magnet.alpha, own.beta + magnet.beta};
}

/* The current after T of a voltage, from a flux linkage at the start: Runge-Kutta on that. */
static vec_ab after_turn(const turning_magnet *m, double T, vec_ab linkage, vec_ab u)
{
    const int steps = 2000;
    const double h = T / steps;
    for (int n = 0; n < steps; n++) {
        vec_ab sum = {0.0, 0.0};
        vec_ab slope = {0.0, 0.0};
        for (int stage = 0; stage < 4; stage++) {
            const double share = stage == 0 ? 0.0 : (stage == 3 ? 1.0 : 0.5);
            const vec_ab at = {linkage.alpha + share * h * slope.alpha,
                               linkage.beta + share * h * slope.beta};
            const vec_ab i = current_of(m, (n + share) * h, at);
            const double weight = stage == 0 || stage == 3 ? 1.0 : 2.0;
            const vec_ab more = vec_times_phases(i, m->d.dR_ohm);
            slope = (vec_ab){u.alpha - m->d.R_ohm * i.alpha - more.alpha,
                             u.beta - m->d.R_ohm * i.beta - more.beta};
            sum.alpha += weight / 6.0 * slope.alpha;
            sum.beta += weight / 6.0 * slope.beta;
        }
        linkage.alpha += h * sum.alpha;
        linkage.beta += h * sum.beta;
    }
    return current_of(m, T, linkage);
}

/* The magnet's harmonics and its unequal poles, turned by up to two thirds of a turn in a cycle that lasts up to half of L/R. */
static void a_magnet_that_is_no_sine_induces_what_it_should(void)
{
    static const double machines[][3] = {
        {0.9, 0.008, 0.011}, {0.0, 0.005, 0.005}, {0.223, 813e-6, 813e-6}, {10.0, 0.005, 0.009}};
    static const double turns[] = {0.0, 1e-9, 0.05, -0.3, 0.82, -2.09, 4.0};
    const double T = 2.5e-4;
    double most = 0.0;
    for (size_t k = 0; k < sizeof machines / sizeof *machines; k++) {
        for (size_t n = 0; n < sizeof turns / sizeof *turns; n++) {
            turning_magnet m = magnet_of(machines[k], turns[n], T);
            averaged_drive *d = &m.d;
            d->psi_f_Wb = 0.1;
            d->psi_5_Wb = 0.003;
            d->psi_7_Wb = -0.002;
            d->psi_11_Wb = 0.001;
            d->psi_13_Wb = 0.0015;
            d->pole_cos[0] = 0.02;
            d->pole_sin[0] = -0.01;
            d->pole_cos[1] = 0.03;
            d->pole_sin[1] = 0.04;
            const averaged_node node = node_of(&m, T);
            const cycle_row row = cycle_of(&m, T);
            const vec_ab got = averaged_drive_advance(d, &node, &row, (vec_ab){0}, NULL);
            const vec_ab want = after_turn(&m, T, flux_of(&m, 0.0), (vec_ab){0});
            most = fmax(most, hypot(got.alpha - want.alpha, got.beta - want.beta) /
                                  fmax(1e-3, hypot(want.alpha, want.beta)));
        }
    }
    printf("  off by %.2g of the current at most\n", most);
    TEST_ASSERT_TRUE(most < 1e-9);
}

/*
 * What a phase's own resistance takes in a cycle, by its mean current on a bent way. By running: 0.0065 at the most; by the mean of both
 * ends' currents and of the inductances 0.11.
 */
static void a_phase_drops_by_its_mean_current(void)
{
    static const double machines[][3] = {{1.1, 0.0049, 0.0049}, {0.17, 0.0011, 0.0022}};
    static const double turns[] = {0.16, -0.5, 0.93};
    const double T = 2e-4;
    double most = 0.0;
    for (size_t k = 0; k < sizeof machines / sizeof *machines; k++) {
        for (size_t n = 0; n < sizeof turns / sizeof *turns; n++) {
            turning_magnet m = magnet_of(machines[k], turns[n], T);
            averaged_drive *d = &m.d;
            d->psi_f_Wb = 0.05;
            const averaged_node node = node_of(&m, T);
            cycle_row row = cycle_of(&m, T);
            const vec_ab first = {3.0, 8.0};
            const vec_ab linkage = linkage_of(&m, first);
            /* By this the flux linkage turns with the rotor, but for the drop. */
            row.u_V[0] =
                (vec_ab){(row.cos_turn * linkage.alpha - row.sin_turn * linkage.beta - linkage.alpha) / T,
                         (row.sin_turn * linkage.alpha + row.cos_turn * linkage.beta - linkage.beta) / T};
            /* What a phase with all of the current would drop. */
            const double most_A = 2.0 / 3.0 * 0.5 * d->R_ohm * hypot(first.alpha, first.beta) * T / d->L_d_H;
            d->dR_ohm[0] = 0.5 * d->R_ohm;
            d->dR_ohm[2] = -0.1 * d->R_ohm;
            const vec_ab got = averaged_drive_advance(d, &node, &row, first, NULL);
            const vec_ab want = after_turn(&m, T, linkage, row.u_V[0]);
            most = fmax(most, hypot(got.alpha - want.alpha, got.beta - want.beta) / most_A);
        }
    }
    printf("  off by %.2g of the effect at most\n", most);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, most);
}

/*
 * The edges find the current that the harmonics of the magnet leave, as they find that of a voltage. A law as wide as the currents
 * shows it: with the harmonics, and with a voltage that does the same.
 */
static void edges_find_what_harmonics_do_to_the_current(void)
{
    const motor m = bench_motor();
    const double T = 1.25e-4;
    const double turn = 0.02;
    averaged_drive d = averaged_drive_of(&m);
    d.R_ohm = 1e-9;
    d.edge = EDGE_CLIPPED;
    d.i_knee_A = 1e3;
    const averaged_node node = averaged_node_at(d.R_ohm, d.L_d_H, d.L_q_H, T, turn / T);
    cycle_row row = {.cos_theta = 1.0,
                     .cos_turn = cos(turn),
                     .sin_turn = sin(turn),
                     .omega_rad_s = turn / T,
                     .rise = {0.25, 0.25, 0.25},
                     .u_dc_V = 565.0,
                     .T_s = T};
    averaged_drive bent = d;
    bent.psi_5_Wb = 0.02;
    cycle_row pushed = row;
    const vec_ab plain = averaged_drive_advance(&d, &node, &row, (vec_ab){0}, NULL);
    const vec_ab end = averaged_drive_advance(&bent, &node, &row, (vec_ab){0}, NULL);
    /* The current is affine in the voltage. */
    vec_ab by[2];
    for (int k = 0; k < 2; k++) {
        pushed.u_V[0] = (vec_ab){k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0};
        const vec_ab to = averaged_drive_advance(&d, &node, &pushed, (vec_ab){0}, NULL);
        by[k] = (vec_ab){to.alpha - plain.alpha, to.beta - plain.beta};
    }
    const vec_ab more = {end.alpha - plain.alpha, end.beta - plain.beta};
    const double det = by[0].alpha * by[1].beta - by[1].alpha * by[0].beta;
    pushed.u_V[0] = (vec_ab){(more.alpha * by[1].beta - more.beta * by[1].alpha) / det,
                             (more.beta * by[0].alpha - more.alpha * by[0].beta) / det};
    d.v_dead_V = bent.v_dead_V = 500.0;
    const vec_ab lost_bent = averaged_drive_advance(&bent, &node, &row, (vec_ab){0}, NULL);
    const vec_ab lost_pushed = averaged_drive_advance(&d, &node, &pushed, (vec_ab){0}, NULL);
    const double lost_A = hypot(lost_pushed.alpha - end.alpha, lost_pushed.beta - end.beta);
    const double apart_A = hypot(lost_bent.alpha - lost_pushed.alpha, lost_bent.beta - lost_pushed.beta);
    printf("  the edges take %.3g A, %.2g A apart\n", lost_A, apart_A);
    TEST_ASSERT_TRUE(lost_A > 1e-4);
    TEST_ASSERT_TRUE(apart_A < 0.05 * lost_A);
}

/* A resistance that all phases have more of is one of the winding, for the iron's current too. */
static void what_the_phases_drop_they_drop_of_the_irons_current_too(void)
{
    const motor m = bench_motor();
    averaged_drive whole = averaged_drive_of(&m);
    whole.iron_S = 0.5 / ((0.2 / 1.25e-4) * m.psi_f_Wb); /* half an ampere */
    averaged_drive parts = whole;
    whole.R_ohm *= 1.3;
    for (size_t x = 0; x < 3; x++) {
        parts.dR_ohm[x] = 0.3 * parts.R_ohm;
    }
    double most = 0.0;
    for (int k = 0; k < 100; k++) {
        const vec_ab want = after_cycle(&whole, 0.0628 * k);
        const vec_ab got = after_cycle(&parts, 0.0628 * k);
        most = fmax(most, hypot(got.alpha - want.alpha, got.beta - want.beta));
    }
    /* What the iron's current drops over that resistance in a cycle, on the smaller inductance. */
    const double drop_A = 0.3 * m.R_ohm * 0.5 * 1.25e-4 / fmin(m.L_d_H, m.L_q_H);
    printf("  off by %.2g of %.2g A\n", most, drop_A);
    TEST_ASSERT_TRUE(most < 0.2 * drop_A);
}

/* Of a speed that climbs evenly and settled behind its filter, and of one that turns round within many tau. */
static void a_filtered_speed_is_put_right(void)
{
    enum { ROWS = 400 };
    const double T_s = 250e-6;
    const double tau_s = 12.0 * T_s;
    double recorded[ROWS];
    double found[ROWS];
    for (size_t k = 0; k < ROWS; k++) {
        recorded[k] = 300.0 + 40.0 * ((double)k * T_s - tau_s);
    }
    late_speed_undo(recorded, ROWS, T_s, tau_s, found);
    for (size_t k = 0; k < ROWS; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 300.0 + 40.0 * (double)k * T_s, found[k]);
    }
    late_speed_undo(recorded, 1, T_s, tau_s, found);
    TEST_ASSERT_EQUAL_DOUBLE(recorded[0], found[0]);
    const double w = 25.0; /* w tau = 0.075 */
    const double size = 1.0 / sqrt(1.0 + w * w * tau_s * tau_s);
    for (size_t k = 0; k < ROWS; k++) {
        recorded[k] = size * sin(w * (double)k * T_s - atan(w * tau_s));
    }
    late_speed_undo(recorded, ROWS, T_s, tau_s, found);
    for (size_t k = 12; k + 12 < ROWS; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, sin(w * (double)k * T_s), found[k]);
    }
}

/* All that a row knows of the voltage is under the other link, and nothing else changes. */
static void a_row_under_another_link(void)
{
    cycle_row row[3];
    memset(row, 0, sizeof row);
    for (size_t k = 0; k < 3; k++) {
        row[k].u_V[0] = (vec_ab){10.0 + (double)k, -4.0};
        row[k].u_dc_V = 500.0;
        row[k].i_A = (vec_ab){1.0, 2.0};
        row[k].rise[1] = 0.3;
        row[k].edge_ripple_Wb[2] = (vec_ab){1e-3, 2e-3};
        link_ripple_scale(&row[k], 1.0 + 0.1 * (double)k);
        link_ripple_tell(&row[k], k);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.2 * 12.0, row[2].u_V[0].alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.1 * 11.0, row[2].u_V[1].alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, row[2].u_V[2].alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10.0, row[0].u_V[2].alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 600.0, row[2].u_dc_V);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 2.4e-3, row[2].edge_ripple_Wb[2].beta);
    TEST_ASSERT_TRUE(row[2].rise[1] == 0.3 && row[2].i_A.beta == 2.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_step_is_the_exact_solution);
    RUN_TEST(a_node_serves_its_neighbourhood);
    RUN_TEST(an_edge_loses_its_share);
    RUN_TEST(the_extended_motor_file_says_the_same_drive);
    RUN_TEST(a_flux_map_goes_to_the_motor_file_and_back);
    RUN_TEST(a_flux_map_is_inverted);
    RUN_TEST(parts_that_saturate_make_a_flux_map);
    RUN_TEST(parts_that_saturate_are_convex_everywhere);
    RUN_TEST(parts_that_saturate_go_to_the_motor_file_and_back);
    RUN_TEST(a_flux_is_guessed_from_a_current_nearby);
    RUN_TEST(a_flux_beyond_the_map_has_a_current_of_its_size);
    RUN_TEST(the_plain_law_gives_its_current_back);
    RUN_TEST(an_error_of_the_electrical_turn_is_taken_at_the_true_angle);
    RUN_TEST(an_error_of_the_turn_moves_the_angle_that_it_depends_on);
    RUN_TEST(a_magnet_that_is_no_sine_induces_what_it_should);
    RUN_TEST(a_phase_drops_by_its_mean_current);
    RUN_TEST(edges_find_what_harmonics_do_to_the_current);
    RUN_TEST(what_the_phases_drop_they_drop_of_the_irons_current_too);
    RUN_TEST(a_filtered_speed_is_put_right);
    RUN_TEST(a_row_under_another_link);
    return UNITY_END();
}
