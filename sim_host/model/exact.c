#include "exact.h"

#include <math.h>
#include <stddef.h>

/* Terms of the power series: at a norm of 8 the last one is under 1e-20. */
enum { TERMS = 50 };

/*
 * What a span does to a current: i, u and the EMF's amplitude at mid-span. As divided differences of the
 * exponential at q = -rho - j phi/2, p = j phi/2 and -p these are e^q, exp[q, p] and exp[q, p, -p]; the
 * series of the first row of the exponential of
 *
 *     | q  1  0 |
 *     |    p  1 |
 *     |      -p |
 *
 * holds them all, whatever coincides.
 */
typedef struct differences {
    double complex first, second, third;
} differences;

static differences differences_of(double complex q, double complex p, double complex r)
{
    differences row = {1.0, 0.0, 0.0};
    for (int n = TERMS; n >= 1; n--) {
        const differences next = {1.0 + row.first * q / n, (row.first + row.second * p) / n,
                                  (row.second + row.third * r) / n};
        row = next;
    }
    return row;
}

double complex exact_predict(const papers_machine *m, double complex i_A, double complex u_V, double span_s,
                             double theta_mid_rad, double omega_rad_s)
{
    const double rho = m->R_ohm * span_s / m->L_H;
    const double half_phi = 0.5 * omega_rad_s * span_s;
    const double complex G = differences_of(papers_vector(-rho, -half_phi), I * half_phi, 0.0).second;
    const double held = creal(differences_of(-rho, 0.0, 0.0).second);
    return exp(-rho) * i_A + held * span_s / m->L_H * u_V -
           I * (m->psi_f_Wb * omega_rad_s * span_s / m->L_H) * G * papers_turn(theta_mid_rad);
}

double complex exact_mean(const papers_machine *m, double complex i_A, double complex u_V, double span_s,
                          double theta_mid_rad, double omega_rad_s)
{
    const double rho = m->R_ohm * span_s / m->L_H;
    const double half_phi = 0.5 * omega_rad_s * span_s;
    const double complex H =
        differences_of(papers_vector(-rho, -half_phi), I * half_phi, -I * half_phi).third;
    const differences still = differences_of(-rho, 0.0, 0.0);
    return still.second * i_A + still.third * span_s / m->L_H * u_V -
           I * (m->psi_f_Wb * omega_rad_s * span_s / m->L_H) * H * papers_turn(theta_mid_rad);
}

/* x = [i_d, i_q, u_d, u_q, 1]; dx/ds = M x over s = 0 ... 1. */
enum { SIZE = 5 };

static void matrix_of(const exact_salient *m, double span_s, double omega_rad_s, double M[SIZE][SIZE])
{
    const double phi = omega_rad_s * span_s;
    const double rows[SIZE][SIZE] = {
        {-m->R_ohm * span_s / m->L_d_H, phi * m->L_q_H / m->L_d_H, span_s / m->L_d_H, 0.0, 0.0},
        {-phi * m->L_d_H / m->L_q_H, -m->R_ohm * span_s / m->L_q_H, 0.0, span_s / m->L_q_H,
         -phi * m->psi_f_Wb / m->L_q_H},
        {0.0, 0.0, 0.0, phi, 0.0},
        {0.0, 0.0, -phi, 0.0, 0.0},
        {0.0, 0.0, 0.0, 0.0, 0.0}};
    for (size_t r = 0; r < SIZE; r++) {
        for (size_t c = 0; c < SIZE; c++) {
            M[r][c] = rows[r][c];
        }
    }
}

static void times(double M[SIZE][SIZE], const double x[SIZE], double factor, double y[SIZE])
{
    for (size_t r = 0; r < SIZE; r++) {
        y[r] = 0.0;
        for (size_t c = 0; c < SIZE; c++) {
            y[r] += factor * M[r][c] * x[c];
        }
    }
}

/* x(1) = sum M^n/n! x(0), the mean sum M^n/(n+1)! x(0). */
exact_span exact_salient_span(const exact_salient *m, double complex i_dq_A, double complex u_dq_V,
                              double span_s, double omega_rad_s)
{
    double M[SIZE][SIZE];
    matrix_of(m, span_s, omega_rad_s, M);
    double term[SIZE] = {creal(i_dq_A), cimag(i_dq_A), creal(u_dq_V), cimag(u_dq_V), 1.0};
    double end[SIZE] = {0.0};
    double mean[SIZE] = {0.0};
    for (int n = 0; n < TERMS; n++) {
        double next[SIZE];
        times(M, term, 1.0 / (n + 1), next);
        for (size_t k = 0; k < SIZE; k++) {
            end[k] += term[k];
            mean[k] += term[k] / (n + 1);
            term[k] = next[k];
        }
    }
    const exact_span span = {papers_vector(end[0], end[1]), papers_vector(mean[0], mean[1])};
    return span;
}
