/* The formulas of both papers (papers.h). */
#include "papers.h"

/* Terms of the power series below: at |phi/2| = pi the last one is under 1e-20. */
enum { SERIES_TERMS = 20 };

/*
 * With h = phi/2:  s1 = sin(h)/h              = sum over n >= 0 of (-1)^n     h^2n     / (2n+1)!
 *                  s2 = (sin h - h cos h)/2h^2 = sum over n >= 1 of (-1)^(n+1) h^(2n-1) n/(2n+1)!
 * A series has neither the division by zero nor the cancellation of the closed form near standstill.
 */
double papers_s1(double phi_rad)
{
    const double h = 0.5 * phi_rad;
    double term = 1.0;
    double sum = 1.0;
    for (int n = 1; n <= SERIES_TERMS; n++) {
        term *= -h * h / (2.0 * n * (2.0 * n + 1.0));
        sum += term;
    }
    return sum;
}

double papers_s2(double phi_rad)
{
    const double h = 0.5 * phi_rad;
    double term = h / 6.0; /* h^(2n-1)/(2n+1)! with its sign */
    double sum = term;
    for (int n = 2; n <= SERIES_TERMS; n++) {
        term *= -h * h / (2.0 * n * (2.0 * n + 1.0));
        sum += n * term;
    }
    return sum;
}

double papers_steady_gain(double phi_rad)
{
    return papers_s1(phi_rad) + 2.0 * tan(0.5 * phi_rad) * papers_s2(phi_rad);
}

double complex papers_mean_discrete_angle_dq(double complex i_mean, double theta_m_rad)
{
    return i_mean * vec_turn(-theta_m_rad);
}

double complex papers_mean_corrected_dq(double complex i_mean, double complex delta_i, double theta_m_rad,
                                        double phi_rad)
{
    return vec_turn(-theta_m_rad) * (papers_s1(phi_rad) * i_mean - I * papers_s2(phi_rad) * delta_i);
}

/* tan(pi/6), the base of k in (8). */
static const double k_base = VEC_1_SQRT3;

papers_movement papers_movement_of(double complex i_start, double complex i_end, double Theta_rad)
{
    const double complex mean = 0.5 * (i_start + i_end);
    const double complex half_change = 0.5 * (i_end - i_start) / mean;
    /* (8): x' grows by k sin(gamma) tan(pi/6) from the middle on, y' by k cos(gamma) tan(pi/6). */
    const papers_movement m = {.k = cabs(half_change) / k_base,
                               .gamma_rad = atan2(creal(half_change), cimag(half_change)),
                               .Theta_rad = Theta_rad};
    return m;
}

double complex papers_mean_normalised(papers_movement m)
{
    const double half = 0.5 * m.Theta_rad;
    const double leak =
        2.0 / (m.Theta_rad * m.Theta_rad) * (2.0 * sin(half) - m.Theta_rad * cos(half)) * m.k * k_base;
    return vec_complex(2.0 / m.Theta_rad * sin(half) + leak * cos(m.gamma_rad), -leak * sin(m.gamma_rad));
}

papers_error papers_error_of(double complex mean_normalised)
{
    const papers_error e = {cabs(mean_normalised) - 1.0, carg(mean_normalised)};
    return e;
}

papers_change papers_change_of(double complex i_start_dq, double complex i_end_dq)
{
    const papers_change c = {cabs(i_end_dq) - cabs(i_start_dq), carg(i_end_dq / i_start_dq)};
    return c;
}

/* (T/L)(u - R i): what voltage and resistance do over one cycle. */
static double complex drive(const papers_machine *m, double complex i_A, double complex u_V)
{
    return m->T_s / m->L_H * (u_V - m->R_ohm * i_A);
}

double complex papers_predict_euler(const papers_machine *m, double complex i_A, double complex u_V,
                                    double theta_rad, double omega_rad_s)
{
    const double phi = omega_rad_s * m->T_s;
    return i_A + drive(m, i_A, u_V) - I * (m->psi_f_Wb * phi / m->L_H) * vec_turn(theta_rad);
}

double complex papers_predict_quasi_discrete(const papers_machine *m, double complex i_A, double complex u_V,
                                             double theta_rad, double omega_rad_s)
{
    const double phi = omega_rad_s * m->T_s;
    return i_A + drive(m, i_A, u_V) -
           I * (m->psi_f_Wb * phi / m->L_H) * papers_s1(phi) * vec_turn(theta_rad + 0.5 * phi);
}

double complex papers_mean_quasi_discrete(const papers_machine *m, double complex i_A, double complex u_V,
                                          double theta_rad, double omega_rad_s)
{
    const double phi = omega_rad_s * m->T_s;
    return i_A + 0.5 * drive(m, i_A, u_V) -
           (m->psi_f_Wb * phi / m->L_H) * vec_turn(theta_rad + 0.5 * phi) *
               vec_complex(papers_s2(phi), 0.5 * papers_s1(phi));
}
