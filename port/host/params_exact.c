#include "params_exact.h"

#include <math.h>

/* A constant of Q(bits) if it lies in low ... high; else refused at the key that makes it. */
static bool constant(const char *path, const char *key, const char *name, double value, double low,
                     double high, int bits, int32_t *out, error *e)
{
    if (!(value >= low && value <= high)) {
        return motor_refuse(
            path, key, e, "%s gives the per-unit constant %s = %.6g; the exact predictor holds %.3g to %.3g",
            key, name, value, low, high);
    }
    *out = (int32_t)nearbyint(ldexp(value, bits));
    return true;
}

/* Half an LSB of IQ24: below it a machine would not answer to its voltage. */
#define LEAST_K_U 6e-8

/* The three constants of one inductance. */
typedef struct axis_constants {
    int32_t rho_q30, k_u_q26, k_psi_q27;
} axis_constants;

static bool axis_from_motor(const motor *m, const char *path, const char *L_key, double L_H,
                            axis_constants *a, error *e)
{
    const per_unit base = per_unit_of(m);
    return constant(path, "R_ohm", "R T/L", IQFOC_RAW_K_R(m->R_ohm, L_H, base.T_s), 0.0, IQFOC_MAX_K_R, 30,
                    &a->rho_q30, e) &&
           constant(path, L_key, "T U_b/(L I_b)", IQFOC_RAW_K_U(L_H, base.T_s, base.I_A, base.U_V), LEAST_K_U,
                    IQFOC_MAX_K_U, 26, &a->k_u_q26, e) &&
           constant(path, "psi_f_Wb", "psi_f/(L I_b)", IQFOC_RAW_K_PSI(m->psi_f_Wb, L_H, base.I_A), 0.0,
                    IQFOC_MAX_K_PSI, 27, &a->k_psi_q27, e);
}

bool winding_from_motor(const motor *m, const char *path, iqfoc_exact_winding_t *winding, error *e)
{
    axis_constants a = {0};
    if (!axis_from_motor(m, path, "L_d_H", 0.5 * (m->L_d_H + m->L_q_H), &a, e)) {
        return false;
    }
    *winding = (iqfoc_exact_winding_t){a.rho_q30, a.k_u_q26, a.k_psi_q27};
    return true;
}

bool salient_from_motor(const motor *m, const char *path, iqfoc_salient_machine_t *machine, error *e)
{
    axis_constants d = {0};
    axis_constants q = {0};
    iqfoc_salient_machine_t made = {0};
    const double least = 1.0 / IQFOC_MAX_SALIENCY;
    if (!axis_from_motor(m, path, "L_d_H", m->L_d_H, &d, e) ||
        !axis_from_motor(m, path, "L_q_H", m->L_q_H, &q, e) ||
        !constant(path, "L_q_H", "L_q/L_d", m->L_q_H / m->L_d_H, least, IQFOC_MAX_SALIENCY, 27,
                  &made.q_to_d_q27, e) ||
        !constant(path, "L_d_H", "L_d/L_q", m->L_d_H / m->L_q_H, least, IQFOC_MAX_SALIENCY, 27,
                  &made.d_to_q_q27, e)) {
        return false;
    }
    made.rho_d_q30 = d.rho_q30;
    made.rho_q_q30 = q.rho_q30;
    made.k_d_q26 = d.k_u_q26;
    made.k_q_q26 = q.k_u_q26;
    made.k_psi_d_q27 = d.k_psi_q27;
    made.k_psi_q_q27 = q.k_psi_q27;
    *machine = made;
    return true;
}
