/*
 * Written by iqfoc diagnose from data/recordings/dead_time.csv.gz with data/recordings/dead_time.toml.
 * dead_time (v_dead = 3.391 V) explains the model error: 1.92 % before, 0.45 % after, noise floor 0.438 %.
 *
 *     static const iqfoc_extension_t extension = IQFOC_DIAGNOSED_EXTENSION;
 *     static const iqfoc_flux_predictor_t predictor = IQFOC_DIAGNOSED_FLUX_PREDICTOR;
 *
 * How they are used: iqfoc/extension.h, iqfoc/flux_predictor.h. A value that the library cannot hold does not compile.
 */
#ifndef IQFOC_DIAGNOSED_EXTENSION_H
#define IQFOC_DIAGNOSED_EXTENSION_H

#include "iqfoc/extension_params.h"
#include "iqfoc/flux_predictor.h"

/* ---- Bases and machine: what iqfoc/params.h takes ---- */
#define IQFOC_DIAGNOSED_T_S       0.00025 /* s, control cycle; as in the motor file */
#define IQFOC_DIAGNOSED_I_RATED_A 6.0     /* A rms; as in the motor file */
#define IQFOC_DIAGNOSED_U_DC_V    565.0   /* V; as in the motor file */
#define IQFOC_DIAGNOSED_R_OHM     0.9     /* ohm; as in the motor file */
#define IQFOC_DIAGNOSED_L_D_H     0.008   /* H; as in the motor file */
#define IQFOC_DIAGNOSED_L_Q_H     0.011   /* H; as in the motor file */
#define IQFOC_DIAGNOSED_PSI_WB    0.2     /* Wb; as in the motor file */
#define IQFOC_DIAGNOSED_I_BASE_A  IQFOC_I_BASE(IQFOC_DIAGNOSED_I_RATED_A)

/* ---- Sensors: measured = g * true + o, recorded angle = true + theta_0, and true at t + t_delay ---- */
#define IQFOC_DIAGNOSED_O_A_A       0.0 /* A; none seen */
#define IQFOC_DIAGNOSED_O_B_A       0.0 /* A; none seen */
#define IQFOC_DIAGNOSED_O_C_A       0.0 /* A; none seen */
#define IQFOC_DIAGNOSED_G_A         1.0 /* 1; none seen */
#define IQFOC_DIAGNOSED_G_B         1.0 /* 1; none seen */
#define IQFOC_DIAGNOSED_G_C         1.0 /* 1; none seen */
#define IQFOC_DIAGNOSED_THETA_0_RAD 0.0 /* rad, electrical; none seen */
#define IQFOC_DIAGNOSED_T_DELAY_S   0.0 /* s; none seen */

/* ---- Voltage: applied = k_u * recorded, less v_dead * sat(i / i_knee) of each leg; L = L_0 / (1 + (i/I_sat)^2) ---- */
#define IQFOC_DIAGNOSED_K_U 1.0 /* 1; none seen */
#define IQFOC_DIAGNOSED_V_DEAD_V                                                                             \
    3.3911527204961835 /* V; diagnosed, 95 %: 3.35555 to 3.42675; motor file 0 */
#define IQFOC_DIAGNOSED_I_KNEE_A                                                                             \
    0.5977437942503404 /* A; diagnosed, 95 %: 0.40708 to 0.877709; motor file 0 */

/* iqfoc_extension_t: the corrections of samples, duties and acting voltage, in the order of its members. */
#define IQFOC_DIAGNOSED_EXTENSION                                                                            \
    {                                                                                                        \
        {IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_A_A, IQFOC_DIAGNOSED_I_BASE_A),                                  \
         IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_B_A, IQFOC_DIAGNOSED_I_BASE_A),                                  \
         IQFOC_EXT_OFFSET(IQFOC_DIAGNOSED_O_C_A, IQFOC_DIAGNOSED_I_BASE_A)},                                 \
            {IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_A), IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_B),       \
             IQFOC_EXT_GAIN_INVERSE(IQFOC_DIAGNOSED_G_C)},                                                   \
            IQFOC_EXT_ANGLE(IQFOC_DIAGNOSED_THETA_0_RAD),                                                    \
            IQFOC_EXT_DELAY(IQFOC_DIAGNOSED_T_DELAY_S, IQFOC_DIAGNOSED_T_S),                                 \
            IQFOC_EXT_K_U(IQFOC_DIAGNOSED_K_U),                                                              \
            IQFOC_EXT_VOLTAGE(IQFOC_DIAGNOSED_V_DEAD_V, IQFOC_DIAGNOSED_U_DC_V),                             \
            IQFOC_EXT_KNEE_INVERSE(IQFOC_DIAGNOSED_I_KNEE_A, IQFOC_DIAGNOSED_I_BASE_A), 0                    \
    }

/* iqfoc_predictor_t, for a machine with L_d = L_q: their mean stands for both. */
#define IQFOC_DIAGNOSED_PREDICTOR                                                                            \
    IQFOC_PREDICTOR(IQFOC_DIAGNOSED_R_OHM, 0.5 * (IQFOC_DIAGNOSED_L_D_H + IQFOC_DIAGNOSED_L_Q_H),            \
                    IQFOC_DIAGNOSED_PSI_WB, IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A,                   \
                    IQFOC_DIAGNOSED_U_DC_V)

/* iqfoc_flux_predictor_t, for any machine. */
#define IQFOC_DIAGNOSED_FLUX_PREDICTOR                                                                       \
    IQFOC_FLUX_PREDICTOR(IQFOC_DIAGNOSED_R_OHM, IQFOC_DIAGNOSED_L_D_H, IQFOC_DIAGNOSED_L_Q_H,                \
                         IQFOC_DIAGNOSED_PSI_WB, IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A,              \
                         IQFOC_DIAGNOSED_U_DC_V)

/* iqfoc_current_control_gains_t for a closed loop of w_rad_s. */
#define IQFOC_DIAGNOSED_GAINS(w_rad_s)                                                                       \
    IQFOC_GAINS(w_rad_s, IQFOC_DIAGNOSED_R_OHM, IQFOC_DIAGNOSED_L_D_H, IQFOC_DIAGNOSED_L_Q_H,                \
                IQFOC_DIAGNOSED_PSI_WB, IQFOC_DIAGNOSED_T_S, IQFOC_DIAGNOSED_I_BASE_A,                       \
                IQFOC_DIAGNOSED_U_DC_V)

#endif
