#include "voltage_equation.h"

#include "base/solve.h"
#include "base/vector.h"

#include <math.h>

enum { UNKNOWNS = VOLTAGE_UNKNOWNS };

const voltage_arrangement voltage_as_recorded = {
    {0, 1, 2}, {0, 1, 2}, {1.0, 1.0, 1.0}, VOLTAGE_NONE_DERIVED, 1.0, 0.0, 0};

static vec_ab current(const recording *rec, const voltage_arrangement *a, size_t k)
{
    double column[3];
    for (int x = 0; x < 3; x++) {
        column[x] = a->i_sign[x] * rec->i_A[x][k];
    }
    if (a->i_derived >= 0) {
        column[a->i_derived] = -column[(a->i_derived + 1) % 3] - column[(a->i_derived + 2) % 3];
    }
    const double phase[3] = {column[a->i_from[0]], column[a->i_from[1]], column[a->i_from[2]]};
    return vec_from_phases(phase);
}

/* The mean over cycle k of a command that acts in halves of two cycles, or a whole one. */
static vec_ab voltage(const recording *rec, const voltage_arrangement *a, size_t k)
{
    double u[3];
    double v[3];
    const size_t far = ((size_t)a->late_halves + 1) / 2;
    const size_t near = (size_t)a->late_halves / 2;
    recording_voltage(rec, k - near, u);
    if (far != near) {
        recording_voltage(rec, k - far, v);
        for (int x = 0; x < 3; x++) {
            u[x] = 0.5 * (u[x] + v[x]);
        }
    }
    const double phase[3] = {u[a->u_from[0]], u[a->u_from[1]], u[a->u_from[2]]};
    return vec_from_phases(phase);
}

static void row_of(const recording *rec, const voltage_arrangement *a, size_t k, double design[2][UNKNOWNS],
                   double u_dq[2])
{
    vec_dq i[2];
    const double theta = a->angle_sign * rec->theta_e_rad[k] - a->angle_zero;
    const double omega = a->angle_sign * rec->omega_e_rad_s[k];
    for (size_t j = 0; j < 2; j++) {
        i[j] = vec_to_dq(current(rec, a, k + j), rotor_at(theta + (double)j * omega * rec->T_s));
    }
    const vec_dq applied = vec_to_dq(voltage(rec, a, k), rotor_at(theta + 0.5 * omega * rec->T_s));
    u_dq[0] = applied.d;
    u_dq[1] = applied.q;
    const double d = 0.5 * (i[0].d + i[1].d);
    const double q = 0.5 * (i[0].q + i[1].q);
    const double rows[2][UNKNOWNS] = {
        {d, (i[1].d - i[0].d) / rec->T_s, -omega * q, 0.0, -omega},
        {q, omega * d, (i[1].q - i[0].q) / rec->T_s, omega, 0.0},
    };
    for (size_t n = 0; n < UNKNOWNS; n++) {
        design[0][n] = rows[0][n];
        design[1][n] = rows[1][n];
    }
}

voltage_fit voltage_equation_fit(const recording *rec, const voltage_arrangement *a, size_t rows_most)
{
    double h[UNKNOWNS][UNKNOWNS] = {{0}};
    double g[UNKNOWNS] = {0};
    double power = 0.0;
    const size_t every = rec->rows / rows_most + 1;
    const size_t first = ((size_t)a->late_halves + 1) / 2;
    for (size_t s = 0; s < rec->stretches; s++) {
        for (size_t j = first; j + 1 < rec->stretch[s].count; j += every) {
            double design[2][UNKNOWNS];
            double u[2];
            row_of(rec, a, rec->stretch[s].first + j, design, u);
            for (size_t axis = 0; axis < 2; axis++) {
                power += u[axis] * u[axis];
                for (size_t m = 0; m < UNKNOWNS; m++) {
                    g[m] += design[axis][m] * u[axis];
                    for (size_t n = 0; n < UNKNOWNS; n++) {
                        h[m][n] += design[axis][m] * design[axis][n];
                    }
                }
            }
        }
    }
    for (size_t m = 0; m < UNKNOWNS; m++) {
        h[m][m] *= 1.0 + 1e-5; /* at standstill the flux has no column */
        h[m][m] += h[m][m] > 0.0 ? 0.0 : 1.0;
    }
    voltage_fit r = {.left = 1.0};
    if (power > 0.0 && solve_positive(UNKNOWNS, UNKNOWNS, &h[0][0], g, r.x)) {
        double explained = 0.0;
        for (size_t m = 0; m < UNKNOWNS; m++) {
            explained += g[m] * r.x[m];
        }
        r.left = fmax(1.0 - explained / power, 0.0);
    }
    return r;
}
