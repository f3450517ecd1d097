/* Motor files to the constants of the exact predictors (params_exact.h). */
#include "params_exact.h"

/* The three constants of one inductance. */
static bool axis_from_motor(const motor *m, const char *L_key, double L_H, iqfoc_exact_winding_t *axis,
                            error *e)
{
    const per_unit base = per_unit_of(m);
    return constant_from_motor(m, "R_ohm", "R T/L", IQFOC_RAW_K_R(m->R_ohm, L_H, base.T_s), 0.0,
                               IQFOC_MAX_K_R, 30, &axis->rho_q30, e) &&
           constant_from_motor(m, L_key, "T U_b/(L I_b)", IQFOC_RAW_K_U(L_H, base.T_s, base.I_A, base.U_V),
                               LEAST_K_U, IQFOC_MAX_K_U, 26, &axis->k_u_q26, e) &&
           constant_from_motor(m, "psi_f_Wb", "psi_f/(L I_b)", IQFOC_RAW_K_PSI(m->psi_f_Wb, L_H, base.I_A),
                               0.0, IQFOC_MAX_K_PSI, 27, &axis->k_psi_q27, e);
}

bool winding_from_motor(const motor *m, iqfoc_exact_winding_t *winding, error *e)
{
    double L_d_H;
    double L_q_H;
    iqfoc_exact_winding_t made = {0};
    motor_inductances(m, &L_d_H, &L_q_H);
    if (!axis_from_motor(m, "L_d_H", 0.5 * (L_d_H + L_q_H), &made, e)) {
        return false;
    }
    *winding = made;
    return true;
}

bool salient_from_motor(const motor *m, iqfoc_salient_machine_t *machine, error *e)
{
    double L_d_H;
    double L_q_H;
    iqfoc_exact_winding_t d = {0};
    iqfoc_exact_winding_t q = {0};
    int32_t q_to_d_q27;
    int32_t d_to_q_q27;
    const double least = 1.0 / IQFOC_MAX_SALIENCY;
    motor_inductances(m, &L_d_H, &L_q_H);
    if (!axis_from_motor(m, "L_d_H", L_d_H, &d, e) || !axis_from_motor(m, "L_q_H", L_q_H, &q, e) ||
        !constant_from_motor(m, "L_q_H", "L_q/L_d", L_q_H / L_d_H, least, IQFOC_MAX_SALIENCY, 27, &q_to_d_q27,
                             e) ||
        !constant_from_motor(m, "L_d_H", "L_d/L_q", L_d_H / L_q_H, least, IQFOC_MAX_SALIENCY, 27, &d_to_q_q27,
                             e)) {
        return false;
    }
    *machine = (iqfoc_salient_machine_t){.rho_d_q30 = d.rho_q30,
                                         .rho_q_q30 = q.rho_q30,
                                         .k_d_q26 = d.k_u_q26,
                                         .k_q_q26 = q.k_u_q26,
                                         .k_psi_d_q27 = d.k_psi_q27,
                                         .k_psi_q_q27 = q.k_psi_q27,
                                         .q_to_d_q27 = q_to_d_q27,
                                         .d_to_q_q27 = d_to_q_q27};
    return true;
}
