/* The voltage equation with columns exchanged (wiring.h). */
#include "wiring.h"

#include "base/solve.h"
#include "base/vector.h"

#include <math.h>
#include <stdio.h>

enum { UNKNOWNS = 5, ROWS_MOST = 20000 };

/* A rearrangement must leave this share of the voltage's power or more as it is, and this factor less when
 * undone. */
static const double BAD = 5e-4;
static const double BETTER = 8.0;

typedef struct arrangement {
    int i_from[3], u_from[3]; /* phase x is read from column ... */
    double i_sign, angle_sign;
    const char *words;
} arrangement;

typedef struct regression {
    double left; /* share of the voltage's power that is not explained */
    double x[UNKNOWNS];
} regression;

static vec_ab read_phases(const double x[3], const int from[3], double sign)
{
    const double phase[3] = {sign * x[from[0]], sign * x[from[1]], sign * x[from[2]]};
    return vec_from_phases(phase);
}

static void row_of(const recording *rec, const arrangement *a, size_t k, double design[2][UNKNOWNS],
                   double u_dq[2])
{
    vec_dq i[2];
    double u[3];
    const double theta = a->angle_sign * rec->theta_e_rad[k];
    const double omega = a->angle_sign * rec->omega_e_rad_s[k];
    for (size_t j = 0; j < 2; j++) {
        const double phase[3] = {rec->i_A[0][k + j], rec->i_A[1][k + j], rec->i_A[2][k + j]};
        i[j] = vec_to_dq(read_phases(phase, a->i_from, a->i_sign),
                         rotor_at(theta + (double)j * omega * rec->T_s));
    }
    recording_voltage(rec, k, u);
    const vec_dq applied =
        vec_to_dq(read_phases(u, a->u_from, 1.0), rotor_at(theta + 0.5 * omega * rec->T_s));
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

static regression regress(const recording *rec, const arrangement *a)
{
    double h[UNKNOWNS][UNKNOWNS] = {{0}};
    double g[UNKNOWNS] = {0};
    double power = 0.0;
    size_t every = rec->rows / ROWS_MOST + 1;
    for (size_t s = 0; s < rec->stretches; s++) {
        for (size_t j = 0; j + 1 < rec->stretch[s].count; j += every) {
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
    regression r = {.left = 1.0};
    if (power > 0.0 && solve_positive(UNKNOWNS, UNKNOWNS, &h[0][0], g, r.x)) {
        double explained = 0.0;
        for (size_t m = 0; m < UNKNOWNS; m++) {
            explained += g[m] * r.x[m];
        }
        r.left = fmax(1.0 - explained / power, 0.0);
    }
    return r;
}

static const arrangement as_recorded = {{0, 1, 2}, {0, 1, 2}, 1.0, 1.0, NULL};

static const arrangement exchanged[] = {
    {{0, 2, 1}, {0, 1, 2}, 1.0, 1.0, "the current columns of phases B and C look swapped"},
    {{1, 0, 2}, {0, 1, 2}, 1.0, 1.0, "the current columns of phases A and B look swapped"},
    {{2, 1, 0}, {0, 1, 2}, 1.0, 1.0, "the current columns of phases A and C look swapped"},
    {{1, 2, 0}, {0, 1, 2}, 1.0, 1.0, "the current columns look shifted by one phase against the voltages"},
    {{2, 0, 1}, {0, 1, 2}, 1.0, 1.0, "the current columns look shifted by two phases against the voltages"},
    {{0, 1, 2}, {0, 2, 1}, 1.0, 1.0, "the voltages or duties of phases B and C look swapped"},
    {{0, 1, 2}, {1, 0, 2}, 1.0, 1.0, "the voltages or duties of phases A and B look swapped"},
    {{0, 1, 2}, {2, 1, 0}, 1.0, 1.0, "the voltages or duties of phases A and C look swapped"},
    {{0, 1, 2},
     {0, 1, 2},
     1.0,
     -1.0,
     "the angle counts against the phases A-B-C: its direction is wrong, or two motor phases are swapped"},
};

static double ratio(double fitted, double file)
{
    double r = file > 0.0 && fitted > 0.0 ? fitted / file : 1.0;
    return r > 1.0 ? r : 1.0 / r;
}

bool check_wiring(const recording *rec, const motor *m, bool far_off, error *e)
{
    regression own = regress(rec, &as_recorded);
    regression best = own;
    const char *words = NULL;
    for (size_t k = 0; k < sizeof exchanged / sizeof *exchanged; k++) {
        regression other = regress(rec, &exchanged[k]);
        if (other.left < best.left && other.x[1] > 0.0 && other.x[2] > 0.0) {
            best = other;
            words = exchanged[k].words;
        }
    }
    if (words && own.left > BAD && own.left > BETTER * best.left) {
        return error_input(
            e, rec->path, 0, 0,
            "%s: with that undone the voltage equation misses %.2g %% of the voltage, as recorded %.2g %%",
            words, 100.0 * sqrt(best.left), 100.0 * sqrt(own.left));
    }
    bool holds = own.left < 0.1;
    if (holds && own.x[1] < 0.0 && own.x[2] < 0.0) {
        return error_input(e, rec->path, 0, 0,
                           "the currents have the wrong sign: a positive phase current must flow into the "
                           "motor (the voltage equation "
                           "holds with L_d = %.3g H, L_q = %.3g H)",
                           own.x[1], own.x[2]);
    }
    double flux = hypot(own.x[3], own.x[4]);
    double angle = atan2(own.x[4], own.x[3]);
    if (holds && own.x[1] > 0.0 && own.x[2] > 0.0 && flux > 0.0 && fabs(angle) > 1.2) {
        return error_input(e, rec->path, 0, 0,
                           "the magnet shows %.0f degrees from the recorded d axis: theta_e = 0 must be "
                           "where its flux lies on phase A's "
                           "axis (check zero, direction and the phases' order)",
                           angle * 57.29577951308232);
    }
    if (far_off && holds && own.x[1] > 0.0 && own.x[2] > 0.0 &&
        (ratio(own.x[0], m->R_ohm) > 20.0 ||
         ratio(sqrt(own.x[1] * own.x[2]), sqrt(m->L_d_H * m->L_q_H)) > 5.0 ||
         ratio(flux, m->psi_f_Wb) > 3.0)) {
        return error_input(e, rec->path, 0, 0,
                           "the motor file is another motor's, or its units are wrong: the voltage equation "
                           "holds with about R = %.2g ohm, "
                           "L_d = %.2g H, L_q = %.2g H, psi_f = %.2g Wb",
                           own.x[0], own.x[1], own.x[2], flux);
    }
    return true;
}
