/* The voltage equation with columns exchanged (wiring.h). */
#include "wiring.h"

#include "voltage_equation.h"

#include "base/vector.h"

#include <math.h>
#include <stdio.h>

enum { ROWS_MOST = 20000 };

/* As recorded, the residual must be at least this share of the voltage's power, and smaller by this factor with the exchange undone. */
static const double BAD = 5e-4;
static const double BETTER = 8.0;
/* Variances of a sample's noise by which a current moves at the least. */
static const double MOVES = 10.0;

typedef struct exchange {
    voltage_arrangement a;
    const char *words;
} exchange;

#define CURRENTS(a, b, c)                                                                                    \
    {                                                                                                        \
        {a, b, c}, {0, 1, 2}, {1.0, 1.0, 1.0}, VOLTAGE_NONE_DERIVED, 1.0, 0.0, 0                             \
    }
#define VOLTAGES(a, b, c)                                                                                    \
    {                                                                                                        \
        {0, 1, 2}, {a, b, c}, {1.0, 1.0, 1.0}, VOLTAGE_NONE_DERIVED, 1.0, 0.0, 0                             \
    }
#define BACKWARDS                                                                                            \
    {                                                                                                        \
        {0, 1, 2}, {0, 1, 2}, {1.0, 1.0, 1.0}, VOLTAGE_NONE_DERIVED, -1.0, 0.0, 0                            \
    }

static const exchange exchanged[] = {
    {CURRENTS(0, 2, 1), "the current columns of phases B and C look swapped"},
    {CURRENTS(1, 0, 2), "the current columns of phases A and B look swapped"},
    {CURRENTS(2, 1, 0), "the current columns of phases A and C look swapped"},
    {CURRENTS(1, 2, 0), "the current columns look shifted by one phase against the voltages"},
    {CURRENTS(2, 0, 1), "the current columns look shifted by two phases against the voltages"},
    {VOLTAGES(0, 2, 1), "the voltages or duties of phases B and C look swapped"},
    {VOLTAGES(1, 0, 2), "the voltages or duties of phases A and B look swapped"},
    {VOLTAGES(2, 1, 0), "the voltages or duties of phases A and C look swapped"},
    {BACKWARDS,
     "the angle counts against the phases A-B-C: its direction is wrong, or two motor phases are swapped"},
};

static double ratio(double fitted, double file)
{
    double r = file > 0.0 && fitted > 0.0 ? fitted / file : 1.0;
    return r > 1.0 ? r : 1.0 / r;
}

static bool is_other(const voltage_fit *own, const motor *m)
{
    return ratio(own->x[0], m->R_ohm) > 20.0 ||
           ratio(sqrt(own->x[1] * own->x[2]), sqrt(m->L_d_H * m->L_q_H)) > 5.0;
}

/* In the rotor frame, over the noise of a sample. What does not move tells neither R nor L: at one point psi_f does as well. */
static bool currents_move(const recording *rec)
{
    vec_dq mean = {0.0, 0.0};
    double square = 0.0;
    double noise = 0.0;
    for (size_t s = 0; s < rec->stretches; s++) {
        vec_dq last[2] = {{0.0, 0.0}, {0.0, 0.0}};
        for (size_t j = 0; j < rec->stretch[s].count; j++) {
            const size_t k = rec->stretch[s].first + j;
            const double phase[3] = {rec->i_A[0][k], rec->i_A[1][k], rec->i_A[2][k]};
            const vec_dq i = vec_to_dq(vec_from_phases(phase), rotor_at(rec->theta_e_rad[k]));
            const vec_dq bend = {i.d - 2.0 * last[0].d + last[1].d, i.q - 2.0 * last[0].q + last[1].q};
            noise += j >= 2 ? (bend.d * bend.d + bend.q * bend.q) / 6.0 : 0.0;
            square += i.d * i.d + i.q * i.q;
            mean.d += i.d;
            mean.q += i.q;
            last[1] = last[0];
            last[0] = i;
        }
    }
    const double rows = (double)rec->rows;
    return square - (mean.d * mean.d + mean.q * mean.q) / rows > MOVES * noise;
}

bool check_wiring(const recording *rec, const motor *m, bool far_off, error *e)
{
    voltage_fit own = voltage_equation_fit(rec, &voltage_as_recorded, ROWS_MOST);
    voltage_fit best = own;
    const char *words = NULL;
    for (size_t k = 0; k < sizeof exchanged / sizeof *exchanged; k++) {
        voltage_fit other = voltage_equation_fit(rec, &exchanged[k].a, ROWS_MOST);
        if (other.left < best.left && other.x[1] > 0.0 && other.x[2] > 0.0) {
            best = other;
            words = exchanged[k].words;
        }
    }
    voltage_arrangement mechanical = voltage_as_recorded;
    mechanical.angle_sign = (double)m->pole_pairs;
    const voltage_fit turned = voltage_equation_fit(rec, &mechanical, ROWS_MOST);
    if (m->pole_pairs > 1 && turned.left < best.left && turned.x[1] > 0.0 && turned.x[2] > 0.0) {
        best = turned;
        words = "theta_e_rad and omega_e_rad_s look mechanical: the electrical ones are expected, pole_pairs "
                "times as large";
    }
    if (words && own.left > BAD && own.left > BETTER * best.left) {
        return error_input(e, rec->path, 0, 0,
                           "%s: with this corrected, the residual of the voltage equation is %.2g %% of the "
                           "voltage, as recorded %.2g %%",
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
                           "the magnet is %.0f degrees from the recorded d axis: theta_e = 0 must be where "
                           "its flux is on the axis of phase A (check zero, direction and phase order)",
                           angle * 57.29577951308232);
    }
    if (far_off && holds && own.x[1] > 0.0 && own.x[2] > 0.0 &&
        ((is_other(&own, m) && currents_move(rec)) || ratio(flux, m->psi_f_Wb) > 3.0)) {
        return error_input(
            e, rec->path, 0, 0,
            "the motor file is for another motor, or its units are wrong: the voltage equation "
            "holds with about R = %.2g ohm, "
            "L_d = %.2g H, L_q = %.2g H, psi_f = %.2g Wb",
            own.x[0], own.x[1], own.x[2], flux);
    }
    return true;
}
