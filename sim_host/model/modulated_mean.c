/* The mean under PWM (modulated_mean.h). */
#include "modulated_mean.h"

#include "pwm_cycle.h"

exact_span modulated_exact(const exact_salient *m, const modulated_cycle *c, double complex i_start_A)
{
    double at[PWM_INSTANTS];
    pwm_instants(c->duty, at);
    exact_span total = {i_start_A * vec_turn(-c->theta_rad), 0.0};
    for (int n = 0; n + 1 < PWM_INSTANTS; n++) {
        const double share = at[n + 1] - at[n];
        const double theta = c->theta_rad + c->omega_rad_s * c->T_s * at[n];
        const double complex u = pwm_voltage(c->duty, c->u_dc_V, 0.5 * (at[n] + at[n + 1]));
        const exact_span span =
            exact_salient_span(m, total.end_dq_A, u * vec_turn(-theta), share * c->T_s, c->omega_rad_s);
        total.end_dq_A = span.end_dq_A;
        total.mean_dq_A += share * span.mean_dq_A;
    }
    return total;
}

/* Terms of the series in (phi/2)^2: at |phi/2| = pi the last is under 1e-20. */
enum { TERMS = 20 };

/* d [s1(d phi) - s1(phi)]/phi^2 = d/4 sum over n >= 1 of (-1)^n (phi/2)^(2n-2) (d^2n - 1)/(2n+1)! */
static double leg_ripple(double d, double phi_rad)
{
    const double h2 = 0.25 * phi_rad * phi_rad;
    double factor = 1.0; /* (-1)^(n-1) h^(2n-2)/(2n+1)! */
    double power = 1.0;
    double sum = 0.0;
    for (int n = 1; n <= TERMS; n++) {
        factor *= n == 1 ? 1.0 / 6.0 : -h2 / (2.0 * n * (2.0 * n + 1.0));
        power *= d * d;
        sum += factor * (1.0 - power);
    }
    return 0.25 * d * sum;
}

double complex modulated_ripple_vector(const double duty[3], double phi_rad)
{
    double complex v = 0.0;
    for (int leg = 0; leg < 3; leg++) {
        v += 2.0 / 3.0 * leg_ripple(duty[leg], phi_rad) * vec_complex_ab(vec_phase_axis[leg]);
    }
    return v;
}

static double complex seen_mid(const modulated_cycle *c, double complex v)
{
    return v * vec_turn(-c->theta_rad - 0.5 * c->omega_rad_s * c->T_s);
}

double complex modulated_ripple_dq(const exact_salient *m, const modulated_cycle *c)
{
    const double phi = c->omega_rad_s * c->T_s;
    const double volt_seconds = c->u_dc_V * c->T_s;
    const double complex v = seen_mid(c, modulated_ripple_vector(c->duty, phi));
    const double rho_d = m->R_ohm * c->T_s / m->L_d_H;
    const double rho_q = m->R_ohm * c->T_s / m->L_q_H;
    return vec_complex(volt_seconds / m->L_d_H * (rho_d * creal(v) + phi * cimag(v)),
                       volt_seconds / m->L_q_H * (rho_q * cimag(v) - phi * creal(v)));
}

/*
 * s2/phi = 1/2 sum over n >= 1 of (-1)^(n+1) (phi/2)^(2n-2) n/(2n+1)!: the mean, seen from the rotor, of the
 * bow s (1 - s)/2 that the resistance bends the current's path by.
 */
static double bow(double phi_rad)
{
    const double h2 = 0.25 * phi_rad * phi_rad;
    double factor = 1.0 / 6.0;
    double sum = factor;
    for (int n = 2; n <= TERMS; n++) {
        factor *= -h2 / (2.0 * n * (2.0 * n + 1.0));
        sum += n * factor;
    }
    return 0.5 * sum;
}

double complex modulated_from_samples(const papers_machine *m, const modulated_cycle *c,
                                      double complex i_start_A, double complex i_end_A)
{
    const double phi = c->omega_rad_s * c->T_s;
    const double rho = m->R_ohm * c->T_s / m->L_H;
    const double s1 = papers_s1(phi);
    const double complex delta = i_end_A - i_start_A;
    const double complex smooth =
        s1 * 0.5 * (i_start_A + i_end_A) + vec_complex(rho * bow(phi), -papers_s2(phi)) * delta;
    const double complex ripple =
        vec_complex(rho, -phi) * (c->u_dc_V * c->T_s / m->L_H) * modulated_ripple_vector(c->duty, phi);
    const double emf = m->psi_f_Wb / m->L_H * (1.0 - s1) * (1.0 + s1);
    return seen_mid(c, smooth + ripple) - emf;
}
