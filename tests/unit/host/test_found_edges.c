/*
 * The law of each edge's own current, against a cycle of three legs on a star of inductances that is integrated in steps
 * far below the dead time: hard diodes, a current that reaches zero between two switches stays there.
 */
#include "model/found_edges.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void)
{
}

void tearDown(void)
{
}

enum { STEPS = 40000 };

static const double T_S = 1e-4;
static const double U_DC_V = 300.0;
static const double L_H = 4e-3;

static const double PSI_WB = 0.03;
static const double PSI_5_WB = 0.0005;
static const double PSI_7_WB = -0.0003;

typedef struct cycle {
    double duty[3], first_A[3];
    double theta_rad, turn_rad; /* the magnet's angle at the start, and how far it turns */
    double L_d_H, L_q_H;
    double late_s;   /* the dead time */
    double on_V;     /* drop of a device that conducts */
    double moved[3]; /* by which each leg's duty is moved */
    bool harmonics;  /* the magnet's flux has a 5th and a 7th */
} cycle;

static double in_cycle(unsigned *seed, double low, double high)
{
    *seed = *seed * 1664525U + 1013904223U;
    return low + (high - low) * (double)(*seed >> 8) / 16777216.0;
}

/* The magnet's flux in phase x at a share of the cycle. */
static double magnet(const cycle *c, size_t x, double at)
{
    const double from = c->theta_rad + at * c->turn_rad - VEC_TWO_PI * (double)x / 3.0;
    const double more = c->harmonics ? PSI_5_WB * cos(5.0 * from) + PSI_7_WB * cos(7.0 * from) : 0.0;
    return PSI_WB * cos(from) + more;
}

/* The rotor and the magnet's flux at a share of the cycle. */
typedef struct moment {
    vec_rotor r;
    vec_ab magnet;
} moment;

static moment moment_at(const cycle *c, double at)
{
    const double m[3] = {magnet(c, 0, at), magnet(c, 1, at), magnet(c, 2, at)};
    return (moment){rotor_at(c->theta_rad + at * c->turn_rad), vec_from_phases(m)};
}

/* The flux that the first currents make with the magnet. */
static vec_ab first_flux(const cycle *c)
{
    const moment now = moment_at(c, 0.0);
    const vec_dq i = vec_to_dq(vec_from_phases(c->first_A), now.r);
    const vec_ab flux = vec_to_ab((vec_dq){c->L_d_H * i.d, c->L_q_H * i.q}, now.r);
    return (vec_ab){flux.alpha + now.magnet.alpha, flux.beta + now.magnet.beta};
}

/* Flux and currents at the end of a step under these legs' voltages: the inductances turn with the magnet. */
static vec_ab step_flux(const cycle *c, vec_ab flux, const double v[3], double dt_s, const moment *end,
                        double i[3])
{
    const vec_ab u = vec_from_phases(v);
    const vec_ab to = {flux.alpha + dt_s * u.alpha, flux.beta + dt_s * u.beta};
    const vec_dq rest = vec_to_dq((vec_ab){to.alpha - end->magnet.alpha, to.beta - end->magnet.beta}, end->r);
    vec_to_phases(vec_to_ab((vec_dq){rest.d / c->L_d_H, rest.q / c->L_q_H}, end->r), i);
    return to;
}

/* What each leg's mean voltage falls short of its duty's, by physics. */
static void integrate(const cycle *c, double lost_V[3])
{
    const double dt_s = T_S / STEPS;
    double i[3] = {c->first_A[0], c->first_A[1], c->first_A[2]};
    vec_ab flux = first_flux(c);
    for (size_t x = 0; x < 3; x++) {
        lost_V[x] = c->duty[x] * U_DC_V;
    }
    for (int n = 0; n < STEPS; n++) {
        const double t_s = (n + 0.5) * dt_s;
        const moment end = moment_at(c, (n + 1.0) / STEPS);
        double v[3];
        double to[3];
        double out_V[3]; /* of a current that flows out of the leg, and of one that flows in */
        double in_V[3];
        for (size_t x = 0; x < 3; x++) {
            const double duty = c->duty[x] + c->moved[x];
            const double rise_s = 0.5 * T_S * (1.0 - duty);
            const double fall_s = 0.5 * T_S * (1.0 + duty);
            const bool high = t_s > rise_s && t_s < fall_s;
            const bool off =
                (t_s > rise_s && t_s < rise_s + c->late_s) || (t_s > fall_s && t_s < fall_s + c->late_s);
            out_V[x] = (high && !off ? U_DC_V : 0.0) - c->on_V;
            in_V[x] = (high || off ? U_DC_V : 0.0) + c->on_V;
            v[x] = i[x] > 0.0 ? out_V[x] : in_V[x];
        }
        for (size_t x = 0; x < 3; x++) {
            /* A current that would pass zero ends the step there: the leg floats between the two. */
            const double by_device_V = v[x];
            if (!(out_V[x] < in_V[x])) {
                continue;
            }
            step_flux(c, flux, v, dt_s, &end, to);
            if (to[x] * i[x] <= 0.0) {
                const double end_A = to[x];
                v[x] = by_device_V + 1.0;
                step_flux(c, flux, v, dt_s, &end, to);
                v[x] = fmin(fmax(by_device_V - end_A / (to[x] - end_A), out_V[x]), in_V[x]);
            }
        }
        flux = step_flux(c, flux, v, dt_s, &end, to);
        for (size_t x = 0; x < 3; x++) {
            lost_V[x] -= v[x] / STEPS;
            i[x] = out_V[x] < in_V[x] && fabs(to[x]) < 1e-9 * (fabs(i[x]) + 1.0) ? 0.0 : to[x];
        }
    }
}

/* The row that a recording of a cycle gives, and the currents without a loss. */
typedef struct reading {
    cycle_row row;
    cycle_turn turn;
    found_way way;
} reading;

static void read_row(const averaged_drive *d, const cycle *c, reading *to)
{
    cycle_row *row = &to->row;
    const double link_V = U_DC_V / d->k_u; /* as measured */
    *row =
        (cycle_row){.u_dc_V = link_V, .T_s = T_S, .cos_turn = cos(c->turn_rad), .sin_turn = sin(c->turn_rad)};
    const vec_ab first = vec_from_phases(c->first_A);
    double last[3];
    double mean_V[3];
    for (size_t x = 0; x < 3; x++) {
        row->rise[x] = 0.5 * (1.0 - c->duty[x]);
        mean_V[x] = c->duty[x] * U_DC_V;
    }
    const moment end = moment_at(c, 1.0);
    step_flux(c, first_flux(c), mean_V, T_S, &end, last);
    for (size_t x = 0; x < 3; x++) {
        double high[3];
        for (size_t y = 0; y < 3; y++) {
            high[y] = link_V * T_S * (fmax(0.0, row->rise[x] - row->rise[y]) - row->rise[x] * c->duty[y]);
        }
        row->edge_ripple_Wb[x] = vec_from_phases(high);
    }
    to->turn = found_turn_of(d, row, rotor_at(c->theta_rad));
    to->way = found_way_of(d, row, &to->turn, NULL, first, vec_from_phases(last), first);
}

/*
 * The root mean square of what the law errs by in many cycles of a magnet that turns so far in each, of what each leg loses at most. The
 * link is k_u times what is measured. With harmonics the magnet has them, and the law knows of them or not. L_q is so many times L_d.
 */
static double error_with(double k_u, double late_V, double compensation_V, double turn_rad, bool harmonics,
                         bool known, double salient, double on_V)
{
    const double v_dead_V = late_V + on_V - compensation_V;
    const double whole_V = fmax(late_V + on_V, compensation_V);
    const averaged_drive d = {.v_dead_V = v_dead_V,
                              .conduction = on_V / (late_V + on_V),
                              .compensation_V = compensation_V,
                              .compensation_knee_A = 1e-6,
                              .edge = EDGE_CLIPPED,
                              .edge_ripple = 1.0,
                              .psi_f_Wb = PSI_WB,
                              .psi_5_Wb = known ? PSI_5_WB : 0.0,
                              .psi_7_Wb = known ? PSI_7_WB : 0.0,
                              .k_u = k_u,
                              .L_d_H = L_H,
                              .L_q_H = salient * L_H,
                              .i_knee_A = 1e-6};
    unsigned seed = 7;
    double square = 0.0;
    enum { CYCLES = 60 };
    for (int n = 0; n < CYCLES; n++) {
        cycle c = {.harmonics = harmonics,
                   .L_d_H = d.L_d_H,
                   .L_q_H = d.L_q_H,
                   .late_s = late_V / U_DC_V * T_S,
                   .on_V = on_V,
                   .theta_rad = in_cycle(&seed, 0.0, VEC_TWO_PI),
                   .turn_rad = turn_rad};
        const double along = in_cycle(&seed, 0.0, VEC_TWO_PI);
        const double size_A = in_cycle(&seed, 0.3, 4.0);
        for (int x = 0; x < 3; x++) {
            const double emf_V = (magnet(&c, (size_t)x, 1.0) - magnet(&c, (size_t)x, 0.0)) / T_S;
            c.first_A[x] = size_A * vec_phase((vec_ab){cos(along), sin(along)}, x);
            c.duty[x] = 0.5 + (emf_V + in_cycle(&seed, -10.0, 10.0)) / U_DC_V;
            c.moved[x] = copysign(compensation_V / U_DC_V, c.first_A[x]);
        }
        reading read;
        double by_law[3];
        double by_physics[3];
        edge_losses each;
        read_row(&d, &c, &read);
        found_edges_lost(&d, &read.row, &read.way, T_S, by_law, &each);
        integrate(&c, by_physics);
        for (size_t x = 0; x < 3; x++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, by_law[x], each.rise_V[x] + each.fall_V[x]); /* R is zero */
            const double wrong = (by_law[x] - by_physics[x]) / whole_V;
            square += wrong * wrong / (3.0 * CYCLES);
        }
    }
    return sqrt(square);
}

static double error_at_link(double k_u, double late_V, double compensation_V, double turn_rad)
{
    return error_with(k_u, late_V, compensation_V, turn_rad, false, false, 1.0, 0.0);
}

static double error_of(double late_V, double compensation_V, double turn_rad)
{
    return error_at_link(1.0, late_V, compensation_V, turn_rad);
}

/* By running: 0.0009, 0.0020, 0.0062; 0.014, 0.055, 0.143 by the chord from the first current to the last. */
static void a_plain_dead_time_is_met(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.0012, 0.0, error_of(4.0, 0.0, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, error_of(4.0, 0.0, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(0.008, 0.0, error_of(4.0, 0.0, 0.4));
}

/* By less than it takes, by all of it, and by more. */
static void a_compensated_one_is_met(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, error_of(4.0, 2.0, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, error_of(4.0, 4.0, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, error_of(4.0, 8.0, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, error_of(8.0, 12.0, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(0.004, 0.0, error_of(4.0, 8.0, 0.4));
}

/* What the edges find follows the true link: by running with k_u = 1, as the row has it, 0.0020 becomes 0.116 and 0.048. */
static void a_link_that_is_measured_wrong_is_met(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, error_at_link(0.8, 4.0, 0.0, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, error_at_link(1.2, 4.0, 8.0, 0.2));
}

/* Half-way through a cycle they bend the current, too. */
static void harmonics_of_the_magnet_are_met(void)
{
    const double known = error_with(1.0, 4.0, 8.0, 0.2, true, true, 1.0, 0.0);
    const double unknown = error_with(1.0, 4.0, 8.0, 0.2, true, false, 1.0, 0.0);
    printf("  off by %.2g, %.2g without the harmonics\n", known, unknown);
    TEST_ASSERT_TRUE(known < 0.0025 && unknown > 5.0 * known);
}

/* The ripple that an edge finds is that of the inductances there: by those half-way 0.0024 and 0.0054. */
static void a_salient_machine_is_met(void)
{
    const double slow = error_with(1.0, 4.0, 8.0, 0.1, false, false, 2.0, 0.0);
    const double fast = error_with(1.0, 4.0, 8.0, 0.2, false, false, 2.0, 0.0);
    printf("  off by %.2g and %.2g\n", slow, fast);
    TEST_ASSERT_TRUE(slow < 0.002 && fast < 0.005);
}

/* Devices drop with no edge, alone, with a dead time and with its compensation: as if edges took it, by running, 0.19, 0.058 and 0.052. */
static void devices_that_conduct_are_met(void)
{
    const double alone = error_with(1.0, 0.0, 0.0, 0.2, false, false, 1.0, 4.0);
    const double more = error_with(1.0, 4.0, 0.0, 0.2, false, false, 1.0, 2.0);
    const double compensated = error_with(1.0, 4.0, 6.0, 0.2, false, false, 1.0, 2.0);
    const double salient = error_with(1.0, 4.0, 0.0, 0.2, false, false, 1.6, 2.0);
    printf("  off by %.2g, %.2g, %.2g and %.2g\n", alone, more, compensated, salient);
    TEST_ASSERT_TRUE(alone < 0.006 && more < 0.012 && compensated < 0.012 && salient < 0.012);
}

/* An early loss has decayed more by the cycle's end than a late one, by half of the flux that decays in a cycle between its ends. */
static void what_is_lost_early_decays(void)
{
    averaged_drive d = {
        .v_dead_V = 4.0, .edge = EDGE_CLIPPED, .k_u = 1.0, .L_d_H = L_H, .L_q_H = L_H, .i_knee_A = 1e-3};
    const cycle c = {.duty = {0.5, 0.5, 0.5}, .first_A = {3.0, -2.0, -1.0}, .L_d_H = L_H, .L_q_H = L_H};
    for (double ohm = 0.0; ohm < 3.0; ohm += 2.0) {
        reading read;
        double lost[3];
        edge_losses each;
        const double share = ohm * T_S / L_H;
        d.R_ohm = ohm;
        read_row(&d, &c, &read);
        found_edges_lost(&d, &read.row, &read.way, T_S, lost, &each);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0 * (1.0 - 0.25 * share), lost[0]); /* at the rise */
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -4.0 * (1.0 + 0.25 * share), lost[1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0, each.rise_V[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, each.fall_V[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, each.rise_V[1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -4.0, each.fall_V[1]);
    }
}

/* Of legs whose currents are all far from zero, and next to one that is near: by two ways through the law. */
static void a_leg_far_from_zero_loses_the_same_next_to_one_near(void)
{
    const averaged_drive d = {.v_dead_V = 3.0,
                              .compensation_V = 3.0,
                              .compensation_knee_A = 1e-3,
                              .conduction = 0.3,
                              .R_ohm = 2.0,
                              .edge = EDGE_CLIPPED,
                              .edge_ripple = 1.0,
                              .k_u = 1.0,
                              .L_d_H = L_H,
                              .L_q_H = 1.5 * L_H,
                              .i_knee_A = 1e-3};
    for (size_t periods = 1; periods < 4; periods += 2) {
        double lost[2][3];
        edge_losses each[2];
        for (size_t near = 0; near < 2; near++) {
            const double third_A = near ? -0.005 : -3.0;
            const cycle c = {.duty = {0.52, 0.5, 0.48},
                             .first_A = {8.0, -8.0 - third_A, third_A},
                             .L_d_H = d.L_d_H,
                             .L_q_H = d.L_q_H};
            reading read;
            read_row(&d, &c, &read);
            read.row.periods = periods;
            found_edges_lost(&d, &read.row, &read.way, T_S, lost[near], &each[near]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, lost[0][0], lost[1][0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, lost[0][1], lost[1][1]);
        for (size_t x = 0; x < 2; x++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, each[0].rise_V[x], each[1].rise_V[x]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, each[0].fall_V[x], each[1].fall_V[x]);
        }
        TEST_ASSERT_TRUE(fabs(lost[0][2] - lost[1][2]) > 0.1);
    }
}

/* A leg that is held at a rail has no edge to lose by, and a compensation moves none beyond the valley. */
static void a_held_leg_loses_nothing(void)
{
    const averaged_drive d = {.v_dead_V = -4.0,
                              .compensation_V = 8.0,
                              .compensation_knee_A = 1e-3,
                              .edge = EDGE_CLIPPED,
                              .k_u = 1.0,
                              .L_d_H = L_H,
                              .L_q_H = L_H,
                              .i_knee_A = 1e-3};
    const cycle c = {.duty = {1.0, 0.4, 0.3}, .first_A = {3.0, -2.0, -1.0}, .L_d_H = L_H, .L_q_H = L_H};
    reading read;
    double lost[3];
    edge_losses each;
    read_row(&d, &c, &read);
    read.row.no_rise[0] = read.row.no_fall[0] = 1.0;
    found_edges_lost(&d, &read.row, &read.way, T_S, lost, &each);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, lost[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0, lost[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0, lost[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_plain_dead_time_is_met);
    RUN_TEST(a_compensated_one_is_met);
    RUN_TEST(a_link_that_is_measured_wrong_is_met);
    RUN_TEST(harmonics_of_the_magnet_are_met);
    RUN_TEST(a_salient_machine_is_met);
    RUN_TEST(devices_that_conduct_are_met);
    RUN_TEST(what_is_lost_early_decays);
    RUN_TEST(a_leg_far_from_zero_loses_the_same_next_to_one_near);
    RUN_TEST(a_held_leg_loses_nothing);
    return UNITY_END();
}
