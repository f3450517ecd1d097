/* The induction machine over spans and cycles (induction_model.h). */
#include "induction_model.h"

#include "model/pwm_cycle.h"

/*
 * Circuits with the same terminals: the rotor's winding scaled by L_magnetising over the rotor's inductance,
 * so that its leakage moves to the stator's side.
 */
induction_machine induction_from_t_circuit(double R_s_ohm, double R_rotor_ohm, double L_leak_s_H,
                                           double L_leak_r_H, double L_magnetising_H)
{
    const double k = L_magnetising_H / (L_magnetising_H + L_leak_r_H);
    const induction_machine m = {.R_s_ohm = R_s_ohm,
                                 .R_r_ohm = k * k * R_rotor_ohm,
                                 .L_sigma_H = L_leak_s_H + k * L_leak_r_H,
                                 .L_m_H = k * L_magnetising_H};
    return m;
}

/* Terms of the power series: at |rates| t = 8 the last is under 1e-20. */
enum { TERMS = 50 };

/* end = sum M^n/n! x, mean = sum M^n/(n+1)! x, M x by the machine's equations. */
induction_span induction_advance(const induction_machine *m, induction_state start, double complex u_V,
                                 double span_s, double omega_rad_s)
{
    const double complex decay = vec_complex(m->R_r_ohm / m->L_m_H, -omega_rad_s);
    double complex i = start.i_A;
    double complex psi = start.psi_Wb;
    double complex u = u_V;
    induction_span total = {{0.0, 0.0}, 0.0};
    for (int n = 0; n < TERMS; n++) {
        total.end.i_A += i;
        total.end.psi_Wb += psi;
        total.i_mean_A += i / (n + 1);
        const double complex dpsi = m->R_r_ohm * i - decay * psi;
        const double complex di = (u - m->R_s_ohm * i - dpsi) / m->L_sigma_H;
        i = span_s / (n + 1) * di;
        psi = span_s / (n + 1) * dpsi;
        u = 0.0;
    }
    return total;
}

induction_cycle induction_pwm(const induction_machine *m, induction_state start, const double duty[3],
                              double u_dc_V, double T_s, double omega_rad_s)
{
    double at[PWM_INSTANTS];
    pwm_instants(duty, at);
    induction_cycle cycle = {{start, 0.0}, start.i_A};
    for (int n = 0; n + 1 < PWM_INSTANTS; n++) {
        const double share = at[n + 1] - at[n];
        const double complex u = pwm_voltage(duty, u_dc_V, 0.5 * (at[n] + at[n + 1]));
        const induction_span span = induction_advance(m, cycle.whole.end, u, share * T_s, omega_rad_s);
        cycle.whole.end = span.end;
        cycle.whole.i_mean_A += share * span.i_mean_A;
        if (at[n + 1] <= 0.5) {
            cycle.i_mid_A = span.end.i_A;
        }
    }
    return cycle;
}

induction_point induction_steady(const induction_machine *m, double complex i_dq_A, double omega_rad_s)
{
    const double psi = m->L_m_H * creal(i_dq_A);
    const double slip = m->R_r_ohm * cimag(i_dq_A) / psi;
    const double omega_s = omega_rad_s + slip;
    const induction_point p = {.psi_Wb = psi,
                               .omega_slip_rad_s = slip,
                               .u_dq_V = m->R_s_ohm * i_dq_A + I * omega_s * (m->L_sigma_H * i_dq_A + psi)};
    return p;
}
