/*
 * Converts physical values to per unit: macros of floating constants that fold at compile time, so that no
 * floating-point instruction reaches the target. The host evaluates them with the values of its motor file.
 *
 * Bases (docs/units.md): current I_b = sqrt(2) I_rated_rms, voltage U_b = nominal DC link, angle one turn, time one
 * control cycle T. In a firmware:
 *
 *     static const iqfoc_predictor_t predictor =
 *         IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, IQFOC_I_BASE(I_RATED_A), U_DC_V);
 *
 * A value out of its range does not compile: the compiler lists the macros that it expanded, and one of them has the
 * coefficient, its range and the remedy as its name (IQFOC_K_PSI_IS_0_TO_8_ELSE_A_LARGER_I_BASE). The host refuses the
 * same values by the same names.
 */
#ifndef IQFOC_PARAMS_H
#define IQFOC_PARAMS_H

#include "iq24.h"

/*
 * 1 if x lies within low ... high. Otherwise it does not compile: in C a division by 0 is no constant, and in C++ the
 * template has no such member.
 */
#ifdef __cplusplus
extern "C++" {
template <bool value_is_within_its_range> struct iqfoc_range_check_ {
};
template <> struct iqfoc_range_check_<true> {
    static constexpr int32_t passed = 1;
};
}
#define IQFOC_WITHIN_(x, low, high) (iqfoc_range_check_<((x) >= (low) && (x) <= (high))>::passed)
#else
#define IQFOC_WITHIN_(x, low, high) (((x) >= (low) && (x) <= (high)) ? 1 : 0)
#endif

/* The IQ24 constant of x, or no constant at all if x is outside low ... high. */
#define IQFOC_CHECKED(x, low, high) (IQ24_NEAREST_(x) / IQFOC_WITHIN_(x, low, high))

/* Current base in A from the rated phase current in A rms. */
#define IQFOC_I_BASE(I_rated_A_rms) (1.4142135623730951 * (I_rated_A_rms))

#define IQFOC_TWO_PI_ 6.283185307179586

/* ---- The formulas in double, one per coefficient of predictor.h and current_control.h, with limits. ---- */
#define IQFOC_RAW_K_U(L_H, T_s, I_b_A, U_b_V) ((T_s) * (U_b_V) / ((L_H) * (I_b_A)))
#define IQFOC_MAX_K_U                         16.0
/* Half an LSB of IQ24: below it the current would not depend on the voltage. */
#define IQFOC_MIN_K_U                       6e-8
#define IQFOC_RAW_K_R(R_ohm, L_H, T_s)      ((R_ohm) * (T_s) / (L_H))
#define IQFOC_MAX_K_R                       1.0
#define IQFOC_RAW_K_PSI(psi_Wb, L_H, I_b_A) ((psi_Wb) / ((L_H) * (I_b_A)))
#define IQFOC_MAX_K_PSI                     8.0
/* Reactance and EMF at one turn per cycle. */
#define IQFOC_RAW_X(L_H, T_s, I_b_A, U_b_V) (IQFOC_TWO_PI_ * (L_H) * (I_b_A) / ((T_s) * (U_b_V)))
#define IQFOC_RAW_EMF(psi_Wb, T_s, U_b_V)   (IQFOC_TWO_PI_ * (psi_Wb) / ((T_s) * (U_b_V)))
#define IQFOC_MAX_X                         96.0
/* PI gains for a closed loop of the given bandwidth: the zero on the winding's pole, kp = w L, ki = w R T. */
#define IQFOC_RAW_KP(w_rad_s, L_H, I_b_A, U_b_V)        ((w_rad_s) * (L_H) * (I_b_A) / (U_b_V))
#define IQFOC_RAW_KI(w_rad_s, R_ohm, T_s, I_b_A, U_b_V) ((w_rad_s) * (R_ohm) * (T_s) * (I_b_A) / (U_b_V))
#define IQFOC_MAX_GAIN                                  32.0
/* Back-calculation as fast as the loop itself. */
#define IQFOC_RAW_ANTI_WINDUP(w_rad_s, T_s) ((w_rad_s) * (T_s))
#define IQFOC_MAX_ANTI_WINDUP               1.0
/* Electrical speed in turns per control cycle. */
#define IQFOC_RAW_SPEED(n_rpm, pole_pairs, T_s) ((n_rpm) / 60.0 * (pole_pairs) * (T_s))
#define IQFOC_MAX_SPEED                         (1.0 / 3.0)

/* ---- The same as checked IQ24 constants. A compiler's error message shows the names of the ranges. ---- */
#define IQFOC_K_U_IS_6E_8_TO_16_ELSE_ANOTHER_I_BASE_OR_T(x) IQFOC_CHECKED(x, IQFOC_MIN_K_U, IQFOC_MAX_K_U)
#define IQFOC_K_R_IS_0_TO_1_ELSE_A_SHORTER_T(x)             IQFOC_CHECKED(x, 0.0, IQFOC_MAX_K_R)
#define IQFOC_K_PSI_IS_0_TO_8_ELSE_A_LARGER_I_BASE(x)       IQFOC_CHECKED(x, 0.0, IQFOC_MAX_K_PSI)
#define IQFOC_X_AND_EMF_ARE_0_TO_96_ELSE_A_LARGER_U_DC(x)   IQFOC_CHECKED(x, 0.0, IQFOC_MAX_X)
#define IQFOC_GAIN_IS_0_TO_32_ELSE_A_LOWER_BANDWIDTH(x)     IQFOC_CHECKED(x, 0.0, IQFOC_MAX_GAIN)
#define IQFOC_W_T_IS_0_TO_1_ELSE_A_LOWER_BANDWIDTH(x)       IQFOC_CHECKED(x, 0.0, IQFOC_MAX_ANTI_WINDUP)
#define IQFOC_SPEED_IS_AT_MOST_A_THIRD_ELSE_A_SHORTER_T(x)  IQFOC_CHECKED(x, -IQFOC_MAX_SPEED, IQFOC_MAX_SPEED)

#define IQFOC_K_U(L_H, T_s, I_b_A, U_b_V)                                                                    \
    IQFOC_K_U_IS_6E_8_TO_16_ELSE_ANOTHER_I_BASE_OR_T(IQFOC_RAW_K_U(L_H, T_s, I_b_A, U_b_V))
#define IQFOC_K_R(R_ohm, L_H, T_s) IQFOC_K_R_IS_0_TO_1_ELSE_A_SHORTER_T(IQFOC_RAW_K_R(R_ohm, L_H, T_s))
#define IQFOC_K_PSI(psi_Wb, L_H, I_b_A)                                                                      \
    IQFOC_K_PSI_IS_0_TO_8_ELSE_A_LARGER_I_BASE(IQFOC_RAW_K_PSI(psi_Wb, L_H, I_b_A))
#define IQFOC_X(L_H, T_s, I_b_A, U_b_V)                                                                      \
    IQFOC_X_AND_EMF_ARE_0_TO_96_ELSE_A_LARGER_U_DC(IQFOC_RAW_X(L_H, T_s, I_b_A, U_b_V))
#define IQFOC_EMF(psi_Wb, T_s, U_b_V)                                                                        \
    IQFOC_X_AND_EMF_ARE_0_TO_96_ELSE_A_LARGER_U_DC(IQFOC_RAW_EMF(psi_Wb, T_s, U_b_V))
#define IQFOC_KP(w_rad_s, L_H, I_b_A, U_b_V)                                                                 \
    IQFOC_GAIN_IS_0_TO_32_ELSE_A_LOWER_BANDWIDTH(IQFOC_RAW_KP(w_rad_s, L_H, I_b_A, U_b_V))
#define IQFOC_KI(w_rad_s, R_ohm, T_s, I_b_A, U_b_V)                                                          \
    IQFOC_GAIN_IS_0_TO_32_ELSE_A_LOWER_BANDWIDTH(IQFOC_RAW_KI(w_rad_s, R_ohm, T_s, I_b_A, U_b_V))
#define IQFOC_ANTI_WINDUP(w_rad_s, T_s)                                                                      \
    IQFOC_W_T_IS_0_TO_1_ELSE_A_LOWER_BANDWIDTH(IQFOC_RAW_ANTI_WINDUP(w_rad_s, T_s))
#define IQFOC_SPEED(n_rpm, pole_pairs, T_s)                                                                  \
    IQFOC_SPEED_IS_AT_MOST_A_THIRD_ELSE_A_SHORTER_T(IQFOC_RAW_SPEED(n_rpm, pole_pairs, T_s))
/* Deprecated name of version 0.1. The next version has only the name above. */
#define IQFOC_TURNS(n_rpm, pole_pairs, T_s) IQFOC_SPEED(n_rpm, pole_pairs, T_s)

/*
 * ---- Initialisers of whole structs ----
 * Values in the order of the struct's members, because C++17 knows no other; tests/unit/library/test_initialisers.c
 * holds them to it.
 */

/* iqfoc_predictor_t: k_u, k_r, k_psi. */
#define IQFOC_PREDICTOR(R_ohm, L_H, psi_Wb, T_s, I_b_A, U_b_V)                                               \
    {                                                                                                        \
        IQFOC_K_U(L_H, T_s, I_b_A, U_b_V), IQFOC_K_R(R_ohm, L_H, T_s), IQFOC_K_PSI(psi_Wb, L_H, I_b_A)       \
    }

/*
 * iqfoc_current_control_gains_t for a closed-loop bandwidth in rad/s, well below 1/T (a twentieth of
 * 2 pi/T is usual): kp_d, kp_q, ki_d, ki_q, anti_windup, x_d, x_q, emf.
 */
#define IQFOC_GAINS(w_rad_s, R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V)                                 \
    {                                                                                                        \
        IQFOC_KP(w_rad_s, L_d_H, I_b_A, U_b_V), IQFOC_KP(w_rad_s, L_q_H, I_b_A, U_b_V),                      \
            IQFOC_KI(w_rad_s, R_ohm, T_s, I_b_A, U_b_V), IQFOC_KI(w_rad_s, R_ohm, T_s, I_b_A, U_b_V),        \
            IQFOC_ANTI_WINDUP(w_rad_s, T_s), IQFOC_X(L_d_H, T_s, I_b_A, U_b_V),                              \
            IQFOC_X(L_q_H, T_s, I_b_A, U_b_V), IQFOC_EMF(psi_Wb, T_s, U_b_V)                                 \
    }

#endif
