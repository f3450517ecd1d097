/* The laboratory drive of the 2019 paper (Table 2), for tests that need one typical machine. */
#ifndef TESTS_UNIT_LABORATORY_MOTOR_H
#define TESTS_UNIT_LABORATORY_MOTOR_H

#include "data/motor.h"

static inline motor laboratory_motor(void)
{
    motor m = motor_blank();
    m.pole_pairs = 3;
    m.R_ohm = 0.75;
    m.L_d_H = 5.2e-3;
    m.L_q_H = 5.2e-3;
    m.psi_f_Wb = 0.134;
    m.I_rated_A_rms = 10.5;
    m.n_max_rpm = 8000.0;
    m.f_pwm_Hz = 5000.0;
    m.u_dc_V = 750.0;
    return m;
}

#endif
