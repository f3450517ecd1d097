/* The iron's law in the averaged drive, against a circuit whose legs switch. */
#include "model/iron_branch.h"
#include "switched_circuit.h"

#include "unity.h"

#include <math.h>

void setUp(void)
{
}

void tearDown(void)
{
}

enum { SETTLE = 60, CYCLES = 40 };

static bool clear_of_zero(vec_ab i)
{
    return fabs(vec_phase(i, 0)) > 0.8 && fabs(vec_phase(i, 1)) > 0.8 && fabs(vec_phase(i, 2)) > 0.8;
}

/* Of all predictions: what one that carries the iron's past from row to row and one that looks it up at the row differ by, as a
 * part of u / R_fe. */
static double most_apart;

/* What the predictions of rows that start near zero are off by, in amperes. */
static double off_near_zero_A;

/* Rms of what predicted currents are off by, as a part of what the iron takes of the voltage, u / R_fe. */
static double off_by(const circuit *c, vec_dq i_dq)
{
    double near = 0.0;
    double of_near = 0.0;
    static cycle_row rows[SETTLE + CYCLES];
    const averaged_node node = averaged_node_at(c->R_ohm, c->L_d_H, c->L_q_H, T_S, c->omega_rad_s);
    const averaged_drive d = drive_of(c);
    const sensor_map sensors = sensor_map_of(&d, MISSING_NONE);
    double wrong = 0.0;
    double iron = 0.0;
    iron_memory memory = {.row = NULL};
    flow at = {.flux_Wb = {c->L_d_H * i_dq.d + c->psi_f_Wb, c->L_q_H * i_dq.q}};
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
        const vec_ab carried = averaged_drive_advance(&d, &node, &rows[n], i, &memory);
        if (n >= SETTLE && c->v_dead_V != 0.0 && !clear_of_zero(i)) {
            const vec_ab is = current(c, &at, theta + turn);
            near += size_of((vec_ab){carried.alpha - is.alpha, carried.beta - is.beta});
            of_near += 1.0;
        }
        /* Near zero an edge's own current decides, which is another law's business (test_found_edges.c). */
        if (n >= SETTLE &&
            (c->v_dead_V == 0.0 || (clear_of_zero(i) && clear_of_zero(current(c, &at, theta + turn))))) {
            const vec_ab fresh = averaged_drive_advance(&d, &node, &rows[n], i, NULL);
            const vec_ab apart = {carried.alpha - fresh.alpha, carried.beta - fresh.beta};
            most_apart = fmax(most_apart, sqrt(size_of(apart) / size_of(u)) * c->R_fe_ohm);
            const vec_ab is = current(c, &at, theta + turn);
            wrong += size_of((vec_ab){carried.alpha - is.alpha, carried.beta - is.beta});
            iron += size_of(u) / (c->R_fe_ohm * c->R_fe_ohm);
        }
    }
    off_near_zero_A = sqrt(near / fmax(of_near, 1.0));
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

/* Loops along all three axes are an iron; one conducts along its axis alone. */
static void shorted_turns_are_an_iron_of_one_phase(void)
{
    const circuit c = usual;
    averaged_drive iron = drive_of(&c);
    averaged_drive loops = iron;
    loops.fe_S = 0.0;
    loops.short_S[0] = loops.short_S[1] = loops.short_S[2] = iron.fe_S;
    const averaged_node node = averaged_node_at(c.R_ohm, c.L_d_H, c.L_q_H, T_S, c.omega_rad_s);
    const vec_ab i = {4.0, -3.0};
    const cycle_row row = row_of(&c, 0, (vec_ab){100.0, 60.0}, i);
    const vec_ab one = averaged_drive_advance(&iron, &node, &row, i, NULL);
    const vec_ab other = averaged_drive_advance(&loops, &node, &row, i, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, one.alpha, other.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, one.beta, other.beta);
    for (int x = 0; x < 3; x++) {
        averaged_drive shorted = drive_of(&c);
        shorted.fe_S = 0.0;
        TEST_ASSERT_FALSE(iron_branch_present(&shorted));
        shorted.short_S[x] = 0.3;
        TEST_ASSERT_TRUE(iron_branch_present(&shorted));
        const vec_ab V = {10.0, -20.0};
        const vec_ab A = iron_branch_conducts(&shorted, V);
        const double along_A = 2.0 / 3.0 * 0.3 * vec_phase(V, x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, along_A * vec_phase_axis[x].alpha, A.alpha);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, along_A * vec_phase_axis[x].beta, A.beta);
    }
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

/* By running, over all: 0.016 A, and 0.034 A if the edges find only the current that turns with the rotor. */
static void an_edge_finds_the_irons_current(void)
{
    static const double taus_s[] = {2e-5, 5e-5, 1.25e-4};
    double square = 0.0;
    for (size_t n = 0; n < 6; n++) {
        circuit c = usual;
        c.tau_fe_s = taus_s[n / 2];
        c.omega_rad_s = n % 2 == 0 ? 350.0 : 600.0;
        c.R_fe_ohm = 300.0;
        c.v_dead_V = 4.0;
        off_by(&c, (vec_dq){-0.5, 2.0});
        square += off_near_zero_A * off_near_zero_A / 6.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, sqrt(square));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_is_carried_is_what_the_rows_before_left);
    RUN_TEST(the_law_is_the_circuits);
    RUN_TEST(the_iron_sees_all_that_the_phases_drop);
    RUN_TEST(the_iron_sees_a_compensation);
    RUN_TEST(an_edge_finds_the_irons_current);
    RUN_TEST(shorted_turns_are_an_iron_of_one_phase);
    RUN_TEST(what_the_sensors_do_is_not_remembered);
    return UNITY_END();
}
