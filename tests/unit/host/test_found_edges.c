/*
 * The law of each edge's own current, against a cycle of three legs on a star of inductances that is integrated in steps
 * far below the dead time: hard diodes, a current that reaches zero between two switches stays there.
 */
#include "model/found_edges.h"

#include "unity.h"

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

typedef struct cycle {
    double duty[3], emf_V[3], first_A[3];
    double late_s;   /* the dead time */
    double moved[3]; /* by which each leg's duty is moved */
} cycle;

static double in_cycle(unsigned *seed, double low, double high)
{
    *seed = *seed * 1664525U + 1013904223U;
    return low + (high - low) * (double)(*seed >> 8) / 16777216.0;
}

/* The leg's voltage for which its current ends the step at zero; the others keep theirs. */
static double floating(const cycle *c, const double i[3], const double v[3], size_t x, double dt_s)
{
    const double others = v[(x + 1) % 3] + v[(x + 2) % 3];
    const double needed_V = -i[x] * L_H / dt_s + c->emf_V[x];
    return 1.5 * (needed_V + others / 3.0);
}

/* What each leg's mean voltage falls short of its duty's, by physics. */
static void integrate(const cycle *c, double lost_V[3])
{
    const double dt_s = T_S / STEPS;
    double i[3] = {c->first_A[0], c->first_A[1], c->first_A[2]};
    for (size_t x = 0; x < 3; x++) {
        lost_V[x] = c->duty[x] * U_DC_V;
    }
    for (int n = 0; n < STEPS; n++) {
        const double t_s = (n + 0.5) * dt_s;
        double v[3];
        bool off[3];
        for (size_t x = 0; x < 3; x++) {
            const double duty = c->duty[x] + c->moved[x];
            const double rise_s = 0.5 * T_S * (1.0 - duty);
            const double fall_s = 0.5 * T_S * (1.0 + duty);
            const bool high = t_s > rise_s && t_s < fall_s;
            off[x] = (t_s > rise_s && t_s < rise_s + c->late_s) || (t_s > fall_s && t_s < fall_s + c->late_s);
            v[x] = off[x] ? (i[x] > 0.0 ? 0.0 : U_DC_V) : (high ? U_DC_V : 0.0);
        }
        for (size_t x = 0; x < 3; x++) {
            const double hold_V = floating(c, i, v, x, dt_s);
            if (off[x] && ((i[x] > 0.0 && hold_V > 0.0) || (i[x] < 0.0 && hold_V < U_DC_V) || i[x] == 0.0)) {
                v[x] = fmin(fmax(hold_V, 0.0), U_DC_V);
            }
        }
        for (size_t x = 0; x < 3; x++) {
            lost_V[x] -= v[x] / STEPS;
        }
        const double star_V = (v[0] + v[1] + v[2]) / 3.0;
        for (size_t x = 0; x < 3; x++) {
            const double was = i[x];
            i[x] += dt_s / L_H * (v[x] - star_V - c->emf_V[x]);
            i[x] = off[x] && fabs(i[x]) < 1e-9 * (fabs(was) + 1.0) ? 0.0 : i[x];
        }
    }
}

/* The row that a recording of this cycle gives, and the currents without a loss. */
static void read_row(const cycle *c, cycle_row *row, found_currents *i)
{
    double flux[3];
    *row = (cycle_row){.u_dc_V = U_DC_V, .T_s = T_S};
    *i = (found_currents){.per_flux = {1.0 / L_H, 0.0, 1.0 / L_H}, .T_s = T_S};
    const double star_V = U_DC_V * (c->duty[0] + c->duty[1] + c->duty[2]) / 3.0;
    for (size_t x = 0; x < 3; x++) {
        row->rise[x] = 0.5 * (1.0 - c->duty[x]);
    }
    for (size_t x = 0; x < 3; x++) {
        const double u_V = c->duty[x] * U_DC_V - star_V;
        i->first[x] = c->first_A[x];
        i->last[x] = c->first_A[x] + T_S / L_H * (u_V - c->emf_V[x]);
        for (size_t y = 0; y < 3; y++) {
            flux[y] = U_DC_V * T_S * (fmax(0.0, row->rise[x] - row->rise[y]) - row->rise[x] * c->duty[y]);
        }
        i->apart[x] = vec_phase(vec_from_phases(flux), (int)x) / L_H -
                      (0.5 - row->rise[x]) * (i->last[x] - i->first[x]);
    }
}

/* The root mean square of what the law errs by in many cycles, of what each leg loses at most. */
static double error_of(double late_V, double compensation_V)
{
    const double v_dead_V = late_V - compensation_V;
    const double whole_V = fmax(late_V, compensation_V);
    const averaged_drive d = {.v_dead_V = v_dead_V,
                              .compensation_V = compensation_V,
                              .compensation_knee_A = 1e-6,
                              .edge = EDGE_FOUND,
                              .L_d_H = L_H,
                              .L_q_H = L_H,
                              .i_knee_A = 1e-6};
    unsigned seed = 7;
    double square = 0.0;
    enum { CYCLES = 60 };
    for (int n = 0; n < CYCLES; n++) {
        cycle c = {.late_s = late_V / U_DC_V * T_S};
        const double turn = in_cycle(&seed, 0.0, VEC_TWO_PI);
        const double size_A = in_cycle(&seed, 0.3, 4.0);
        const vec_ab emf = {in_cycle(&seed, -60.0, 60.0), in_cycle(&seed, -60.0, 60.0)};
        for (int x = 0; x < 3; x++) {
            c.first_A[x] = size_A * vec_phase((vec_ab){cos(turn), sin(turn)}, x);
            c.emf_V[x] = vec_phase(emf, x);
            c.duty[x] = 0.5 + (c.emf_V[x] + in_cycle(&seed, -10.0, 10.0)) / U_DC_V;
            c.moved[x] = copysign(compensation_V / U_DC_V, c.first_A[x]);
        }
        cycle_row row;
        found_currents i;
        double by_law[3];
        double by_physics[3];
        read_row(&c, &row, &i);
        found_edges_lost(&d, &row, &i, by_law);
        integrate(&c, by_physics);
        for (size_t x = 0; x < 3; x++) {
            const double wrong = (by_law[x] - by_physics[x]) / whole_V;
            square += wrong * wrong / (3.0 * CYCLES);
        }
    }
    return sqrt(square);
}

static void a_plain_dead_time_is_met(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 6e-4, error_of(4.0, 0.0));
}

/* By less than it takes, by all of it, and by more. */
static void a_compensated_one_is_met(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 6e-4, error_of(4.0, 2.0));
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 6e-4, error_of(4.0, 4.0));
    TEST_ASSERT_DOUBLE_WITHIN(3e-4, 4e-4, error_of(4.0, 8.0));
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 7e-4, error_of(8.0, 12.0));
}

/* A leg that is held at a rail has no edge to lose by, and a compensation moves none beyond the valley. */
static void a_held_leg_loses_nothing(void)
{
    const averaged_drive d = {.v_dead_V = -4.0,
                              .compensation_V = 8.0,
                              .compensation_knee_A = 1e-3,
                              .edge = EDGE_FOUND,
                              .L_d_H = L_H,
                              .L_q_H = L_H,
                              .i_knee_A = 1e-3};
    const cycle c = {.duty = {1.0, 0.4, 0.3}, .first_A = {3.0, -2.0, -1.0}};
    cycle_row row;
    found_currents i;
    double lost[3];
    read_row(&c, &row, &i);
    row.no_rise[0] = row.no_fall[0] = 1.0;
    found_edges_lost(&d, &row, &i, lost);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, lost[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0, lost[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0, lost[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_plain_dead_time_is_met);
    RUN_TEST(a_compensated_one_is_met);
    RUN_TEST(a_held_leg_loses_nothing);
    return UNITY_END();
}
