/*
 * The formulas of both papers in double precision: the reference for the IQ24 firmware.
 *
 * "2016": L. Jarzebowicz, Applied Mathematical Modelling 42, pp. 576-590. "2019": L. Jarzebowicz, IET Power
 * Electronics 12(12), pp. 3280-3285. Derivations and errata: docs/equations.md.
 *
 * Vectors are complex numbers in the stationary frame (amplitude-invariant Clarke), in the rotor frame where
 * the name ends in _dq. phi: electrical angle covered in one cycle; theta_m = theta + phi/2: the rotor at its
 * middle.
 */
#ifndef SIM_HOST_MODEL_PAPERS_H
#define SIM_HOST_MODEL_PAPERS_H

#include "../base/vector_complex.h"

/* ---- Rotor movement ---- */

/* sin(phi/2) / (phi/2), 1 at phi = 0. To 1e-15 for |phi| <= 2 pi. */
double papers_s1(double phi_rad);

/* (2 sin(phi/2) - phi cos(phi/2)) / phi^2, 0 at phi = 0. To 1e-15 for |phi| <= 2 pi. */
double papers_s2(double phi_rad);

/* 2016 (9) for any |phi| < pi: s1 + 2 tan(phi/2) s2, 1.0530 at phi = pi/3. */
double papers_steady_gain(double phi_rad);

/* ---- 2016: mean dq current from phase means ---- */

/* (3): the practice, which turns the mean current by one angle. */
double complex papers_mean_discrete_angle_dq(double complex i_mean, double theta_m_rad);

/* (10): exact where the current changes linearly in the stationary frame, by delta_i over the cycle. */
double complex papers_mean_corrected_dq(double complex i_mean, double complex delta_i, double theta_m_rad,
                                        double phi_rad);

/* (8): a current's movement over one cycle, normalised as there: relative to and along its own mean. */
typedef struct papers_movement {
    double k;         /* size, 1 in steady state at Theta = pi/3 */
    double gamma_rad; /* direction, 0 in steady state */
    double Theta_rad; /* angle that the rotor covers */
} papers_movement;

/* k and gamma of a current that runs straight from i_start to i_end; their mean must not vanish. */
papers_movement papers_movement_of(double complex i_start, double complex i_end, double Theta_rad);

/* (10) as printed: i_d' + j i_q' of a movement. Theta_rad != 0. */
double complex papers_mean_normalised(papers_movement m);

/* (11) and (12): errors of the discrete angle's mean, given the true mean relative to it. */
typedef struct papers_error {
    double gain;      /* |true| / |discrete| - 1 */
    double phase_rad; /* arg(true) - arg(discrete) */
} papers_error;

papers_error papers_error_of(double complex mean_normalised);

/* (13) and (14): the current's change over a cycle as seen from the rotor. */
typedef struct papers_change {
    double modulus;
    double angle_rad;
} papers_change;

papers_change papers_change_of(double complex i_start_dq, double complex i_end_dq);

/* ---- 2019: one control cycle of a non-salient machine, u constant over it ---- */

typedef struct papers_machine {
    double R_ohm, L_H, psi_f_Wb;
    double T_s; /* control cycle */
} papers_machine;

/* (3), forward Euler. theta_rad: the rotor at the start of the cycle. */
double complex papers_predict_euler(const papers_machine *m, double complex i_A, double complex u_V,
                                    double theta_rad, double omega_rad_s);

/* (12), quasi-discrete. */
double complex papers_predict_quasi_discrete(const papers_machine *m, double complex i_A, double complex u_V,
                                             double theta_rad, double omega_rad_s);

/* (10), quasi-discrete, its third term corrected. */
double complex papers_mean_quasi_discrete(const papers_machine *m, double complex i_A, double complex u_V,
                                          double theta_rad, double omega_rad_s);

#endif
