/*
 * The iron's law in the averaged drive, against a circuit whose legs switch: a winding's resistance, a salient rotor's flux and,
 * beside what makes flux, a branch of R_fe with tau_fe R_fe, integrated in steps far below an edge's time.
 */
#include "model/iron_branch.h"

#include "unity.h"

#include <math.h>

void setUp(void)
{
}

void tearDown(void)
{
}

enum { STEPS = 2000, SETTLE = 60, CYCLES = 40 };

static const double T_S = 2.5e-4;
static const double U_DC_V = 300.0;

typedef struct circuit {
    double R_ohm, L_d_H, L_q_H, psi_f_Wb, R_fe_ohm, tau_fe_s, omega_rad_s;
    double dR_ohm[3];
    double v_dead_V;
    double
        v_moved_V; /* by which a compensation moves each edge, by the current's sign at the cycle's start */
    double g[3], offset_A[2]; /* of the current sensors, by which the rows are recorded */
} circuit;

static const circuit usual = {.R_ohm = 0.9,
                              .L_d_H = 0.008,
                              .L_q_H = 0.011,
                              .psi_f_Wb = 0.2,
                              .R_fe_ohm = 150.0,
                              .tau_fe_s = 1e-4,
                              .omega_rad_s = 300.0,
                              .g = {1.0, 1.0, 1.0}};

typedef struct flow {
    vec_ab flux_Wb, iron_A;
} flow;

static vec_ab magnetising(const circuit *c, vec_ab flux, double theta)
{
    const vec_rotor r = rotor_at(theta);
    const vec_dq f = vec_to_dq(flux, r);
    return vec_to_ab((vec_dq){(f.d - c->psi_f_Wb) / c->L_d_H, f.q / c->L_q_H}, r);
}

static vec_ab current(const circuit *c, const flow *at, double theta)
{
    const vec_ab i = magnetising(c, at->flux_Wb, theta);
    return (vec_ab){i.alpha + at->iron_A.alpha, i.beta + at->iron_A.beta};
}

static flow rate(const circuit *c, const flow *at, double theta, vec_ab u)
{
    const vec_ab i = current(c, at, theta);
    double drop[3];
    vec_to_phases(i, drop);
    for (int x = 0; x < 3; x++) {
        drop[x] *= c->R_ohm + c->dR_ohm[x];
    }
    const vec_ab v = vec_from_phases(drop);
    const vec_ab e = {u.alpha - v.alpha, u.beta - v.beta};
    return (flow){e,
                  {(e.alpha / c->R_fe_ohm - at->iron_A.alpha) / c->tau_fe_s,
                   (e.beta / c->R_fe_ohm - at->iron_A.beta) / c->tau_fe_s}};
}

static flow moved(const flow *at, const flow *by, double h)
{
    return (flow){{at->flux_Wb.alpha + h * by->flux_Wb.alpha, at->flux_Wb.beta + h * by->flux_Wb.beta},
                  {at->iron_A.alpha + h * by->iron_A.alpha, at->iron_A.beta + h * by->iron_A.beta}};
}

/* One cycle of three legs; a dead time delays the rise where the current flows out and the fall where it flows in. */
static void switched_cycle(const circuit *c, const cycle_row *row, double theta, flow *at)
{
    const double h = T_S / STEPS;
    const double late = c->v_dead_V / U_DC_V;
    double rise[3];
    double fall[3];
    double i[3];
    double told[3]; /* to rise */
    vec_to_phases(current(c, at, theta), i);
    for (size_t x = 0; x < 3; x++) {
        told[x] = row->rise[x] - (i[x] > 0.0 ? 1.0 : -1.0) * c->v_moved_V / U_DC_V;
        rise[x] = told[x];
        fall[x] = 1.0 - told[x];
    }
    for (int n = 0; n < STEPS; n++) {
        const double share = (double)n / STEPS;
        double leg[3];
        vec_to_phases(current(c, at, theta + c->omega_rad_s * h * n), i);
        for (size_t x = 0; x < 3; x++) {
            if (share <= told[x]) {
                rise[x] = told[x] + (i[x] > 0.0 ? late : 0.0);
            }
            if (share <= 1.0 - told[x]) {
                fall[x] = 1.0 - told[x] + (i[x] < 0.0 ? late : 0.0);
            }
            const double on = fmin(share + 1.0 / STEPS, fall[x]) - fmax(share, rise[x]);
            leg[x] = U_DC_V * STEPS * fmax(on, 0.0);
        }
        const vec_ab u = vec_from_phases(leg);
        const double mid = theta + c->omega_rad_s * h * (n + 0.5);
        const flow k1 = rate(c, at, mid - 0.5 * c->omega_rad_s * h, u);
        const flow half = moved(at, &k1, 0.5 * h);
        const flow k2 = rate(c, &half, mid, u);
        *at = moved(at, &k2, h);
    }
}

/* A row as a recording of this cycle gives it. */
static cycle_row row_of(const circuit *c, size_t n, vec_ab u, vec_ab i)
{
    const double theta = c->omega_rad_s * T_S * (double)n;
    const vec_rotor r = rotor_at(theta);
    const vec_rotor turn = rotor_at(c->omega_rad_s * T_S);
    cycle_row row = {.u_V = {u},
                     .cos_theta = r.cos,
                     .sin_theta = r.sin,
                     .cos_turn = turn.cos,
                     .sin_turn = turn.sin,
                     .omega_rad_s = c->omega_rad_s,
                     .u_dc_V = U_DC_V,
                     .T_s = T_S,
                     .history = n,
                     .i_A = i};
    double v[3];
    vec_to_phases(u, v);
    for (size_t x = 0; x < 3; x++) {
        row.rise[x] = 0.25 - 0.5 * v[x] / U_DC_V;
    }
    for (size_t x = 0; x < 3; x++) {
        double ahead[3]; /* each leg's volt-seconds up to this one's rise, beside those of its mean voltage */
        for (size_t y = 0; y < 3; y++) {
            const double on = fmax(row.rise[x] - row.rise[y], 0.0);
            ahead[y] = U_DC_V * T_S * (on - row.rise[x] * (1.0 - 2.0 * row.rise[y]));
        }
        row.edge_ripple_Wb[x] = vec_from_phases(ahead);
    }
    return row;
}

static double size_of(vec_ab v)
{
    return v.alpha * v.alpha + v.beta * v.beta;
}

static bool clear_of_nought(vec_ab i)
{
    return fabs(vec_phase(i, 0)) > 0.8 && fabs(vec_phase(i, 1)) > 0.8 && fabs(vec_phase(i, 2)) > 0.8;
}

/* Of all predictions: what one that carries the iron's past from row to row and one that looks it up at the row differ by, as a
 * part of u / R_fe. */
static double most_apart;

/* Rms of what predicted currents are off by, as a part of what the iron takes of the voltage, u / R_fe. */
static double off_by(const circuit *c, vec_dq i_dq)
{
    static cycle_row rows[SETTLE + CYCLES];
    const averaged_node node = averaged_node_at(c->R_ohm, c->L_d_H, c->L_q_H, T_S, c->omega_rad_s);
    averaged_drive d = {.R_ohm = c->R_ohm,
                        .L_d_H = c->L_d_H,
                        .L_q_H = c->L_q_H,
                        .psi_f_Wb = c->psi_f_Wb,
                        .fe_S = 1.0 / c->R_fe_ohm,
                        .fe_tau_s = c->tau_fe_s,
                        .v_dead_V = c->v_dead_V - 2.0 * c->v_moved_V,
                        .i_knee_A = 1e-3,
                        .edge = c->v_moved_V > 0.0 ? EDGE_OVER : EDGE_CLIPPED,
                        .edge_ripple = 1.0,
                        .dead_share =
                            c->v_moved_V > 0.0 ? c->v_dead_V / (2.0 * c->v_moved_V - c->v_dead_V) : 0.0,
                        .k_u = 1.0,
                        .g = {c->g[0], c->g[1], c->g[2]},
                        .offset_ab_A = {c->offset_A[0], c->offset_A[1]}};
    const sensor_map sensors = sensor_map_of(&d, false, 0.0);
    double wrong = 0.0;
    double iron = 0.0;
    iron_memory memory = {.row = NULL};
    flow at = {.flux_Wb = {c->L_d_H * i_dq.d + c->psi_f_Wb, c->L_q_H * i_dq.q}};
    for (size_t x = 0; x < 3; x++) {
        d.dR_ohm[x] = c->dR_ohm[x];
    }
    for (size_t n = 0; n < SETTLE + CYCLES; n++) {
        const double turn = c->omega_rad_s * T_S;
        const double theta = turn * (double)n;
        const double stir = 20.0 * sin(2.1 * (double)n);
        const double w = c->omega_rad_s;
        const vec_dq u_dq = {c->R_ohm * i_dq.d - w * c->L_q_H * i_dq.q + stir,
                             c->R_ohm * i_dq.q + w * (c->L_d_H * i_dq.d + c->psi_f_Wb) - stir};
        const vec_ab u = vec_to_ab(u_dq, rotor_at(theta + 0.5 * turn));
        const vec_ab i = current(c, &at, theta);
        rows[n] = row_of(c, n, u, sensor_map_measure(&sensors, i));
        switched_cycle(c, &rows[n], theta, &at);
        /* Near nought an edge's own current decides, which is another law's business (test_found_edges.c). */
        if (n >= SETTLE &&
            (c->v_dead_V == 0.0 || (clear_of_nought(i) && clear_of_nought(current(c, &at, theta + turn))))) {
            const vec_ab told = averaged_drive_advance(&d, &node, &rows[n], i, &memory);
            const vec_ab anew = averaged_drive_advance(&d, &node, &rows[n], i, NULL);
            const vec_ab apart = {told.alpha - anew.alpha, told.beta - anew.beta};
            most_apart = fmax(most_apart, sqrt(size_of(apart) / size_of(u)) * c->R_fe_ohm);
            const vec_ab is = current(c, &at, theta + turn);
            wrong += size_of((vec_ab){told.alpha - is.alpha, told.beta - is.beta});
            iron += size_of(u) / (c->R_fe_ohm * c->R_fe_ohm);
        }
    }
    return sqrt(wrong / iron);
}

static const vec_dq flowing = {-3.0, 6.0};

/*
 * From a branch that fades a hundred times in a cycle to one that lasts for four. Found by running: 0.0001 to 0.0015, and up to
 * 0.008 of one that lasts for a tenth, which sees the ripple of the drop about the instant where it is sampled. A law with the
 * drop of the sampled current alone is off by 0.007 to 0.03.
 */
static void the_law_is_the_circuits(void)
{
    static const double taus[][2] = {
        {2.5e-6, 0.002}, {2.5e-5, 0.01}, {1e-4, 0.005}, {2.5e-4, 0.001}, {1e-3, 0.001}};
    static const double omegas[] = {-100.0, 300.0, 600.0};
    for (size_t k = 0; k < 5; k++) {
        for (size_t n = 0; n < 3; n++) {
            circuit c = usual;
            c.tau_fe_s = taus[k][0];
            c.omega_rad_s = omegas[n];
            TEST_ASSERT_DOUBLE_WITHIN(taus[k][1], 0.0, off_by(&c, flowing));
        }
    }
}

/* By running: 0.0059 (0.031 without the iron's own current in the drop), 0.0023, and 0.0014 and 0.0009 (0.006 if the iron does not
 * see what an edge loses). */
static void the_iron_sees_all_that_the_phases_drop(void)
{
    circuit c = usual;
    c.R_ohm = 5.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.008, 0.0, off_by(&c, flowing));
    c = usual;
    c.dR_ohm[0] = 0.3;
    c.dR_ohm[2] = -0.2;
    TEST_ASSERT_DOUBLE_WITHIN(0.003, 0.0, off_by(&c, flowing));
    c = usual;
    c.v_dead_V = 4.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, off_by(&c, flowing));
    c.tau_fe_s = 1e-3;
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, off_by(&c, flowing));
}

/* By running: 0.0017 and 0.0007; 0.015 and 0.005 by the mean current's sign in place of each edge's, and 0.05 and 0.026 if the
 * iron does not see what the compensation adds. */
static void the_iron_sees_a_compensation(void)
{
    circuit c = usual;
    c.v_dead_V = 4.0;
    c.v_moved_V = 6.0;
    TEST_ASSERT_DOUBLE_WITHIN(0.0025, 0.0, off_by(&c, flowing));
    c.tau_fe_s = 1e-3;
    TEST_ASSERT_DOUBLE_WITHIN(0.0012, 0.0, off_by(&c, flowing));
}

/* The branch remembers true currents: by the recorded ones the law is off by 0.0038, ten times as much. */
static void what_the_sensors_do_is_not_remembered(void)
{
    circuit c = usual;
    c.tau_fe_s = 2.5e-4;
    const double sound = off_by(&c, flowing);
    c.offset_A[0] = 0.5;
    c.offset_A[1] = -0.3;
    c.g[0] = 1.05;
    c.g[1] = 0.96;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, sound, off_by(&c, flowing));
}

/* A look at the rows before leaves out what has faded to 1e-4. */
static void what_is_carried_is_what_the_rows_before_left(void)
{
    most_apart = 0.0;
    for (double tau_s = 2.5e-6; tau_s < 2e-3; tau_s *= 2.0) {
        circuit c = usual;
        c.tau_fe_s = tau_s;
        c.v_dead_V = 2.0;
        off_by(&c, flowing);
    }
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.0, most_apart);
    TEST_ASSERT_TRUE(most_apart > 0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_is_carried_is_what_the_rows_before_left);
    RUN_TEST(the_law_is_the_circuits);
    RUN_TEST(the_iron_sees_all_that_the_phases_drop);
    RUN_TEST(the_iron_sees_a_compensation);
    RUN_TEST(what_the_sensors_do_is_not_remembered);
    return UNITY_END();
}
