/*
 * Converts physical values of a diagnosis to the per-unit constants of extension.h, flux_predictor.h and flux_map.h. The macros
 * of floating constants fold at compile time, as in params.h, and use the same bases. A value outside its range does
 * not compile.
 */
#ifndef IQFOC_EXTENSION_PARAMS_H
#define IQFOC_EXTENSION_PARAMS_H

#include "params.h"

/* ---- The formulas in double, with their limits. ---- */
#define IQFOC_RAW_EXT_OFFSET(o_A, I_b_A)  ((o_A) / (I_b_A))
#define IQFOC_MAX_EXT_OFFSET              1.0
#define IQFOC_RAW_EXT_GAIN_INVERSE(g)     (1.0 / (g))
#define IQFOC_MIN_EXT_GAIN                0.5
#define IQFOC_MAX_EXT_GAIN                2.0
#define IQFOC_RAW_EXT_ANGLE(theta_rad)    ((theta_rad) / IQFOC_TWO_PI_)
#define IQFOC_MAX_EXT_ANGLE               0.5
#define IQFOC_RAW_EXT_DELAY(t_s, T_s)     ((t_s) / (T_s))
#define IQFOC_MAX_EXT_DELAY               8.0
#define IQFOC_RAW_EXT_VOLTAGE(v_V, U_b_V) ((v_V) / (U_b_V))
#define IQFOC_MAX_EXT_VOLTAGE             0.25
#define IQFOC_MAX_EXT_KNEE_INVERSE        127.0
/* A knee of 0, or one too small for the constant, becomes the smallest knee. */
#define IQFOC_RAW_EXT_KNEE_INVERSE(knee_A, I_b_A)                                                            \
    ((knee_A)*IQFOC_MAX_EXT_KNEE_INVERSE > (I_b_A) ? (I_b_A) / (knee_A) : IQFOC_MAX_EXT_KNEE_INVERSE)
#define IQFOC_RAW_EXT_SATURATION(I_sat_A, I_b_A) ((I_b_A) / (I_sat_A) * ((I_b_A) / (I_sat_A)))
#define IQFOC_MAX_EXT_SATURATION                 4.0
#define IQFOC_RAW_FLUX_L(L_H, T_s, I_b_A, U_b_V) ((L_H) * (I_b_A) / ((T_s) * (U_b_V)))
#define IQFOC_MIN_FLUX_L                         0.0625
#define IQFOC_MAX_FLUX_L                         8.0
#define IQFOC_RAW_FLUX_R(R_ohm, I_b_A, U_b_V)    ((R_ohm) * (I_b_A) / (U_b_V))
#define IQFOC_MAX_FLUX_R                         1.0
#define IQFOC_RAW_FLUX_PSI(psi_Wb, T_s, U_b_V)   ((psi_Wb) / ((T_s) * (U_b_V)))
#define IQFOC_MAX_FLUX_PSI                       16.0
#define IQFOC_RAW_FLUX_SKEW(L_d_H, L_q_H)        (((L_d_H) - (L_q_H)) / ((L_d_H) + (L_q_H)))
#define IQFOC_MAX_FLUX_SKEW                      0.999
#define IQFOC_MIN_MAP_L                          0.015625
/* A part of a flux map: energy, current at which it saturates, current about which it is alike. */
#define IQFOC_RAW_MAP_E(E_J, T_s, I_b_A, U_b_V) ((E_J) / ((T_s) * (U_b_V) * (I_b_A)))
#define IQFOC_MAX_MAP_E                         64.0
#define IQFOC_RAW_MAP_K(I_A, I_b_A)             ((I_b_A) / (I_A))
#define IQFOC_MIN_MAP_K                         0.0625
#define IQFOC_MAX_MAP_K                         10.0
#define IQFOC_RAW_MAP_X(I_c_A, I_d_A)           ((I_c_A) / (I_d_A))
#define IQFOC_MAX_MAP_X                         16.0

/* ---- The same as checked IQ24 constants. ---- */
#define IQFOC_EXT_OFFSET(o_A, I_b_A)                                                                         \
    IQFOC_CHECKED(IQFOC_RAW_EXT_OFFSET(o_A, I_b_A), -IQFOC_MAX_EXT_OFFSET, IQFOC_MAX_EXT_OFFSET)
#define IQFOC_EXT_GAIN_INVERSE(g)                                                                            \
    IQFOC_CHECKED(IQFOC_RAW_EXT_GAIN_INVERSE(g), IQFOC_MIN_EXT_GAIN, IQFOC_MAX_EXT_GAIN)
#define IQFOC_EXT_ANGLE(theta_rad)                                                                           \
    IQFOC_CHECKED(IQFOC_RAW_EXT_ANGLE(theta_rad), -IQFOC_MAX_EXT_ANGLE, IQFOC_MAX_EXT_ANGLE)
#define IQFOC_EXT_DELAY(t_s, T_s)                                                                            \
    IQFOC_CHECKED(IQFOC_RAW_EXT_DELAY(t_s, T_s), -IQFOC_MAX_EXT_DELAY, IQFOC_MAX_EXT_DELAY)
#define IQFOC_EXT_K_U(k_u) IQFOC_CHECKED(k_u, IQFOC_MIN_EXT_GAIN, IQFOC_MAX_EXT_GAIN)
#define IQFOC_EXT_VOLTAGE(v_V, U_b_V)                                                                        \
    IQFOC_CHECKED(IQFOC_RAW_EXT_VOLTAGE(v_V, U_b_V), -IQFOC_MAX_EXT_VOLTAGE, IQFOC_MAX_EXT_VOLTAGE)
#define IQFOC_EXT_KNEE_INVERSE(knee_A, I_b_A)                                                                \
    IQFOC_CHECKED(IQFOC_RAW_EXT_KNEE_INVERSE(knee_A, I_b_A), 0.0, IQFOC_MAX_EXT_KNEE_INVERSE)
#define IQFOC_EXT_SATURATION(I_sat_A, I_b_A)                                                                 \
    IQFOC_CHECKED(IQFOC_RAW_EXT_SATURATION(I_sat_A, I_b_A), 0.0, IQFOC_MAX_EXT_SATURATION)
#define IQFOC_FLUX_L(L_H, T_s, I_b_A, U_b_V)                                                                 \
    IQFOC_CHECKED(IQFOC_RAW_FLUX_L(L_H, T_s, I_b_A, U_b_V), IQFOC_MIN_FLUX_L, IQFOC_MAX_FLUX_L)
#define IQFOC_FLUX_K(L_H, T_s, I_b_A, U_b_V)                                                                 \
    IQFOC_CHECKED(1.0 / IQFOC_RAW_FLUX_L(L_H, T_s, I_b_A, U_b_V), 1.0 / IQFOC_MAX_FLUX_L,                    \
                  1.0 / IQFOC_MIN_FLUX_L)
#define IQFOC_FLUX_R(R_ohm, I_b_A, U_b_V)                                                                    \
    IQFOC_CHECKED(IQFOC_RAW_FLUX_R(R_ohm, I_b_A, U_b_V), 0.0, IQFOC_MAX_FLUX_R)
#define IQFOC_FLUX_PSI(psi_Wb, T_s, U_b_V)                                                                   \
    IQFOC_CHECKED(IQFOC_RAW_FLUX_PSI(psi_Wb, T_s, U_b_V), 0.0, IQFOC_MAX_FLUX_PSI)

#define IQFOC_FLUX_SKEW(L_d_H, L_q_H)                                                                        \
    IQFOC_CHECKED(IQFOC_RAW_FLUX_SKEW(L_d_H, L_q_H), -IQFOC_MAX_FLUX_SKEW, IQFOC_MAX_FLUX_SKEW)

/* iqfoc_flux_predictor_t: l_d, l_q, k_d, k_q, r, psi, skew (in the order of its members, as in params.h). */
#define IQFOC_FLUX_PREDICTOR(R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V)                                 \
    {                                                                                                        \
        IQFOC_FLUX_L(L_d_H, T_s, I_b_A, U_b_V), IQFOC_FLUX_L(L_q_H, T_s, I_b_A, U_b_V),                      \
            IQFOC_FLUX_K(L_d_H, T_s, I_b_A, U_b_V), IQFOC_FLUX_K(L_q_H, T_s, I_b_A, U_b_V),                  \
            IQFOC_FLUX_R(R_ohm, I_b_A, U_b_V), IQFOC_FLUX_PSI(psi_Wb, T_s, U_b_V),                           \
            IQFOC_FLUX_SKEW(L_d_H, L_q_H)                                                                    \
    }

#define IQFOC_MAP_L(L_H, T_s, I_b_A, U_b_V)                                                                  \
    IQFOC_CHECKED(IQFOC_RAW_FLUX_L(L_H, T_s, I_b_A, U_b_V), IQFOC_MIN_MAP_L, IQFOC_MAX_FLUX_L)
#define IQFOC_MAP_PSI(psi_Wb, T_s, U_b_V)                                                                    \
    IQFOC_CHECKED(IQFOC_RAW_FLUX_PSI(psi_Wb, T_s, U_b_V), -IQFOC_MAX_FLUX_PSI, IQFOC_MAX_FLUX_PSI)
#define IQFOC_MAP_E(E_J, T_s, I_b_A, U_b_V)                                                                  \
    IQFOC_CHECKED(IQFOC_RAW_MAP_E(E_J, T_s, I_b_A, U_b_V), 0.0, IQFOC_MAX_MAP_E)
#define IQFOC_MAP_K(I_A, I_b_A) IQFOC_CHECKED(IQFOC_RAW_MAP_K(I_A, I_b_A), IQFOC_MIN_MAP_K, IQFOC_MAX_MAP_K)
#define IQFOC_MAP_X(I_c_A, I_d_A)                                                                            \
    IQFOC_CHECKED(IQFOC_RAW_MAP_X(I_c_A, I_d_A), -IQFOC_MAX_MAP_X, IQFOC_MAX_MAP_X)

/* iqfoc_flux_map_part_t: e, k_d, k_q, x_0. */
#define IQFOC_FLUX_MAP_PART(E_J, I_d_A, I_q_A, I_c_A, T_s, I_b_A, U_b_V)                                     \
    {                                                                                                        \
        IQFOC_MAP_E(E_J, T_s, I_b_A, U_b_V), IQFOC_MAP_K(I_d_A, I_b_A), IQFOC_MAP_K(I_q_A, I_b_A),           \
            IQFOC_MAP_X(I_c_A, I_d_A)                                                                        \
    }
#define IQFOC_FLUX_MAP_NO_PART                                                                               \
    {                                                                                                        \
        0, 0, 0, 0                                                                                           \
    }

/*
 * iqfoc_flux_map_t: l_d, l_q, r, psi, part. L_d, L_q: of straight iron, those at no current less what the parts have
 * there, E/I_d^2 (1 + x_0^2)^(-3/2) and E/I_q^2 (1 + x_0^2)^(-1/2). psi: psi_f and the parts' E/I_d x_0 (1 + x_0^2)^(-1/2).
 */
#define IQFOC_FLUX_MAP(R_ohm, L_d_H, L_q_H, psi_Wb, part_1, part_2, T_s, I_b_A, U_b_V)                       \
    {                                                                                                        \
        IQFOC_MAP_L(L_d_H, T_s, I_b_A, U_b_V), IQFOC_MAP_L(L_q_H, T_s, I_b_A, U_b_V),                        \
            IQFOC_FLUX_R(R_ohm, I_b_A, U_b_V), IQFOC_MAP_PSI(psi_Wb, T_s, U_b_V),                            \
        {                                                                                                    \
            part_1, part_2                                                                                   \
        }                                                                                                    \
    }

/*
 * iqfoc_extension_t without any correction: i_offset, i_gain_inverse, theta_0, theta_delay, k_u, v_dead,
 * knee_inverse, saturation.
 */
#define IQFOC_EXTENSION_NONE                                                                                 \
    {                                                                                                        \
        {0, 0, 0}, {IQ24(1.0), IQ24(1.0), IQ24(1.0)}, 0, 0, IQ24(1.0), 0, IQ24(127.0), 0                     \
    }

#endif
