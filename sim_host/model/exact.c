/* The exact solution of a span (exact.h). */
#include "exact.h"

#include "exact_map.h"

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
    const double complex G = differences_of(vec_complex(-rho, -half_phi), I * half_phi, 0.0).second;
    const double held = creal(differences_of(-rho, 0.0, 0.0).second);
    return exp(-rho) * i_A + held * span_s / m->L_H * u_V -
           I * (m->psi_f_Wb * omega_rad_s * span_s / m->L_H) * G * vec_turn(theta_mid_rad);
}

double complex exact_mean(const papers_machine *m, double complex i_A, double complex u_V, double span_s,
                          double theta_mid_rad, double omega_rad_s)
{
    const double rho = m->R_ohm * span_s / m->L_H;
    const double half_phi = 0.5 * omega_rad_s * span_s;
    const double complex H = differences_of(vec_complex(-rho, -half_phi), I * half_phi, -I * half_phi).third;
    const differences still = differences_of(-rho, 0.0, 0.0);
    return still.second * i_A + still.third * span_s / m->L_H * u_V -
           I * (m->psi_f_Wb * omega_rad_s * span_s / m->L_H) * H * vec_turn(theta_mid_rad);
}

/* The current that the mapped flux is: x, u and the EMF's -omega psi_f on the q axis. */
static double complex mapped(const exact_salient *m, const exact_map *map, double complex flux,
                             double complex u_V, double emf_V)
{
    double x[2];
    for (size_t row = 0; row < 2; row++) {
        x[row] = map->decay[row][0] * creal(flux) + map->decay[row][1] * cimag(flux) +
                 map->drive[row][0] * creal(u_V) + map->drive[row][1] * cimag(u_V) -
                 map->push[row][1] * emf_V;
    }
    return vec_complex(x[0] / m->L_d_H, x[1] / m->L_q_H);
}

exact_span exact_salient_span(const exact_salient *m, double complex i_dq_A, double complex u_dq_V,
                              double span_s, double omega_rad_s)
{
    exact_map end;
    exact_map mean;
    exact_maps(m->R_ohm, m->L_d_H, m->L_q_H, span_s, omega_rad_s, &end, &mean);
    const double complex flux = vec_complex(m->L_d_H * creal(i_dq_A), m->L_q_H * cimag(i_dq_A));
    const double emf_V = omega_rad_s * m->psi_f_Wb;
    const exact_span span = {mapped(m, &end, flux, u_dq_V, emf_V), mapped(m, &mean, flux, u_dq_V, emf_V)};
    return span;
}
