/*
 * An induction machine over spans of constant speed and voltage, solved exactly in double precision, and over
 * a cycle of centre-aligned PWM: both the drive's truth and the reference for include/iqfoc/induction.h.
 * Derivation: docs/induction.md.
 *
 * The machine is the inverse-gamma circuit, to which every T circuit reduces: leakage on the stator's side
 * only.
 *
 *     L_sigma di/dt = u - R_s i - dpsi/dt
 *     dpsi/dt       = R_r i - (R_r/L_m - j omega) psi
 *
 * Vectors are complex, stationary frame; psi is the rotor flux, omega the rotor's electrical speed.
 */
#ifndef SIM_HOST_INDUCTION_INDUCTION_MODEL_H
#define SIM_HOST_INDUCTION_INDUCTION_MODEL_H

#include "base/vector_complex.h"

typedef struct induction_machine {
    double R_s_ohm, R_r_ohm;
    double L_sigma_H, L_m_H;
} induction_machine;

/* The same from the T circuit, rotor values seen from the stator: both leakages, magnetising inductance. */
induction_machine induction_from_t_circuit(double R_s_ohm, double R_rotor_ohm, double L_leak_s_H,
                                           double L_leak_r_H, double L_magnetising_H);

typedef struct induction_state {
    double complex i_A, psi_Wb;
} induction_state;

/* The state after a span, and the mean current over it, stationary frame. */
typedef struct induction_span {
    induction_state end;
    double complex i_mean_A;
} induction_span;

induction_span induction_advance(const induction_machine *m, induction_state start, double complex u_V,
                                 double span_s, double omega_rad_s);

/* Such spans from edge to edge: a cycle of PWM with these duties. i_mid_A: at the carrier's peak. */
typedef struct induction_cycle {
    induction_span whole;
    double complex i_mid_A;
} induction_cycle;

induction_cycle induction_pwm(const induction_machine *m, induction_state start, const double duty[3],
                              double u_dc_V, double T_s, double omega_rad_s);

/*
 * Steady state in field orientation: i_d makes the flux, i_q the torque. What the machine then does, seen
 * from the flux (d axis).
 */
typedef struct induction_point {
    double psi_Wb;
    double omega_slip_rad_s;
    double complex u_dq_V; /* mean voltage, without PWM */
} induction_point;

/* omega_rad_s: of the rotor. i_d != 0. */
induction_point induction_steady(const induction_machine *m, double complex i_dq_A, double omega_rad_s);

#endif
