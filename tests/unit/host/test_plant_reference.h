/*
 * The drive once more, for the plant's tests: in phase variables, integrated by SUNDIALS CVODE at a tolerance
 * of 1e-12.
 *
 * Nothing is shared with the plant. The machine is written as three coupled coils on the axes a = 0, 2 pi/3,
 * 4 pi/3 with the inductances
 *     L_xy(theta) = 2/3 [ (L_d + L_q)/2 cos(a_x - a_y) + (L_d - L_q)/2 cos(2 theta - a_x - a_y) ]
 * (L_d, L_q constant, or both falling as 1/(1 + (i/I_sat)^2), i by the energy; further co-energy as a polynomial) and the magnet's flux linkages
 *     psi cos(theta - a_x) + psi_5 cos 5(theta - a_x) + psi_7 cos 7(theta - a_x) + and so for 11 and 13.
 * The two line-to-line equations and i_a + i_b + i_c = 0 are solved for the currents.
 */
#ifndef TESTS_UNIT_TEST_PLANT_REFERENCE_H
#define TESTS_UNIT_TEST_PLANT_REFERENCE_H

#include <stdbool.h>

typedef struct reference {
    double pole_pairs, R[3], dL[3], L_d, L_q, psi, psi_5, psi_7, psi_11, psi_13, I_sat; /* I_sat 0: none */
    double R_first; /* of the winding alone, which alpha_R is of */
    double alpha_R, alpha_psi, heating, heating_s,
        reference;           /* by which R, psi grow with the drive's warming */
    double R_rate, psi_rate; /* by which each R and psi grow per second of t */
    /* Co-energy of the machine beyond that, 3/2 sum of w_nk d^n q^k, d and q the current's parts: w[n][k]. */
    double w[5][5];
    /* Iron loss, none with R_fe = 0: R_fe i_fe + tau_fe R_fe di_fe/dt = dflux_x/dt in each phase. */
    double R_fe, tau_fe;
    double bandwidth;           /* of the current sensors, Hz; 0: none */
    double accel;               /* of a given speed */
    double J, friction, T_load; /* J > 0: the shaft is free */
    double u_leg[3];            /* the legs' voltages, constant over a call of reference_advance */
    /*
     * With knee > 0 a leg is at least[x] while its current flows out, at most[x] while it flows in, and
     * goes from one to the other by tanh(i/knee): diodes that are not ideal, integrated by the stiff method.
     * u_leg is not used then.
     */
    double least[3], most[3], knee;
    double t;
    /*
     * i_a, i_b, theta_e, omega_e; integrals of i_a, i_b, i_d, i_q, cleared by reference_clear; i_fe of a, b;
     * what the sensors of a, b see.
     */
    double y[12];
    void *solver; /* opened at the first advance */
} reference;

void reference_advance(reference *r, double dt);
void reference_clear(reference *r);
void reference_close(reference *r);

/* From one valley to the next with ideal legs, edges worked out here. */
void reference_cycle(reference *r, const double duty[3], double T, double u_dc);

#endif
