/*
 * Converts SI values to a set of parameters while the drive runs: iqfoc/params.h for values that are not constants
 * but are read from a memory, identified, or follow a temperature or a carrier frequency.
 *
 * This optional header is the only one of the library that computes in floating point (double). Call it from a slower
 * task, never from an interrupt. A firmware that does not include it links none of it. The results equal those of the
 * macros to the last bit. A value that does not fit is named, and the set does not change:
 *
 *     const char *refused = iqfoc_si_parameters(&drive, &spare);
 *     if (refused == NULL && iqfoc_cycle_offer(&cycle, &spare) == IQFOC_OK) ...
 *
 * Values of SI units are finite and of any size; the per-unit ones must lie within the ranges of params.h.
 */
#ifndef IQFOC_IQFOC_SI_H
#define IQFOC_IQFOC_SI_H

#include "cycle.h"
#include "params.h"
#include "predictor_exact.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A machine, its inverter and its control. The resistance is that of one phase; values without another name are peak
 * values.
 */
typedef struct iqfoc_si_drive {
    double R_ohm;
    double L_d_H;
    double L_q_H;
    double psi_Wb;
    double I_rated_A_rms;
    double U_dc_V;      /* nominal DC link */
    double T_s;         /* control cycle */
    double w_rad_s;     /* bandwidth of the current control */
    double ticks_per_s; /* of the port's timer; 0: period_ticks stays as it is */
} iqfoc_si_drive_t;

/*
 * x in Q(bits), to nearest, ties up, 0 <= x and x 2^bits < 2^31 - 1: as IQ24() and IQFOC_EXACT_Q().
 *
 * The remainder of the truncation is exact, unlike x 2^bits + 0.5.
 */
static inline int32_t iqfoc_si_q(double x, uint32_t bits)
{
    const double scaled = x * IQ24_CAST_(double, INT64_C(1) << bits);
    const int32_t cut = IQ24_CAST_(int32_t, scaled);
    return scaled - cut >= 0.5 ? cut + 1 : cut;
}

/* A value, its range, and the message if it is outside; a NaN is outside every range. */
typedef struct iqfoc_si_check {
    double value;
    double low;
    double high;
    const char *refusal;
} iqfoc_si_check_t;

static inline const char *iqfoc_si_first_refused(const iqfoc_si_check_t *checks, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++) {
        if (!(checks[k].value >= checks[k].low && checks[k].value <= checks[k].high)) {
            return checks[k].refusal;
        }
    }
    return NULL;
}

/* The divisors; the coefficients show any other wrong value. */
static inline const char *iqfoc_si_refused_base(const iqfoc_si_drive_t *d)
{
    const double least = 1e-12;
    const double most = 1e12;
    const iqfoc_si_check_t checks[] = {
        {d->L_d_H, least, most, "L_d_H: must be above 0"},
        {d->L_q_H, least, most, "L_q_H: must be above 0"},
        {d->I_rated_A_rms, least, most, "I_rated_A_rms: must be above 0"},
        {d->U_dc_V, least, most, "U_dc_V: must be above 0"},
        {d->T_s, least, most, "T_s: must be above 0"},
        {d->ticks_per_s * d->T_s, 0.0, 1073741824.0, "ticks_per_s: T_s has more than 2^30 ticks"},
    };
    return iqfoc_si_first_refused(checks, (uint32_t)(sizeof checks / sizeof checks[0]));
}

/*
 * Fills in predictor (by the mean of the two inductances), gains and, if ticks_per_s is given, period_ticks; the
 * other fields do not change. Returns NULL, or the refused value's message with the set unchanged. From a task.
 */
static inline const char *iqfoc_si_parameters(const iqfoc_si_drive_t *d, iqfoc_cycle_config_t *set)
{
    const char *refused = iqfoc_si_refused_base(d);
    if (refused != NULL) {
        return refused;
    }
    const double I_b = IQFOC_I_BASE(d->I_rated_A_rms);
    const double L = 0.5 * (d->L_d_H + d->L_q_H);
    const double k_u = IQFOC_RAW_K_U(L, d->T_s, I_b, d->U_dc_V);
    const double k_r = IQFOC_RAW_K_R(d->R_ohm, L, d->T_s);
    const double k_psi = IQFOC_RAW_K_PSI(d->psi_Wb, L, I_b);
    const double kp_d = IQFOC_RAW_KP(d->w_rad_s, d->L_d_H, I_b, d->U_dc_V);
    const double kp_q = IQFOC_RAW_KP(d->w_rad_s, d->L_q_H, I_b, d->U_dc_V);
    const double ki = IQFOC_RAW_KI(d->w_rad_s, d->R_ohm, d->T_s, I_b, d->U_dc_V);
    const double back = IQFOC_RAW_ANTI_WINDUP(d->w_rad_s, d->T_s);
    const double x_d = IQFOC_RAW_X(d->L_d_H, d->T_s, I_b, d->U_dc_V);
    const double x_q = IQFOC_RAW_X(d->L_q_H, d->T_s, I_b, d->U_dc_V);
    const double emf = IQFOC_RAW_EMF(d->psi_Wb, d->T_s, d->U_dc_V);
    const iqfoc_si_check_t checks[] = {
        {k_u, IQFOC_MIN_K_U, IQFOC_MAX_K_U, "L_d_H, L_q_H: k_u = T U/(L I) is not within 6e-8 ... 16"},
        {k_r, 0.0, IQFOC_MAX_K_R, "R_ohm: k_r = R T/L is not within 0 ... 1"},
        {k_psi, 0.0, IQFOC_MAX_K_PSI, "psi_Wb: k_psi = psi/(L I) is not within 0 ... 8"},
        {back, 0.0, IQFOC_MAX_ANTI_WINDUP, "w_rad_s: w T is not within 0 ... 1"},
        {kp_d, 0.0, IQFOC_MAX_GAIN, "L_d_H: kp_d = w L_d I/U is not within 0 ... 32"},
        {kp_q, 0.0, IQFOC_MAX_GAIN, "L_q_H: kp_q = w L_q I/U is not within 0 ... 32"},
        {ki, 0.0, IQFOC_MAX_GAIN, "R_ohm: ki = w R T I/U is not within 0 ... 32"},
        {x_d, 0.0, IQFOC_MAX_X, "L_d_H: x_d = 2 pi L_d I/(T U) is not within 0 ... 96"},
        {x_q, 0.0, IQFOC_MAX_X, "L_q_H: x_q = 2 pi L_q I/(T U) is not within 0 ... 96"},
        {emf, 0.0, IQFOC_MAX_X, "psi_Wb: emf = 2 pi psi/(T U) is not within 0 ... 96"},
    };
    refused = iqfoc_si_first_refused(checks, (uint32_t)(sizeof checks / sizeof checks[0]));
    if (refused == NULL) {
        const iqfoc_predictor_t predictor = {iqfoc_si_q(k_u, 24), iqfoc_si_q(k_r, 24), iqfoc_si_q(k_psi, 24)};
        const iqfoc_current_control_gains_t gains = {
            iqfoc_si_q(kp_d, 24), iqfoc_si_q(kp_q, 24), iqfoc_si_q(ki, 24),  iqfoc_si_q(ki, 24),
            iqfoc_si_q(back, 24), iqfoc_si_q(x_d, 24),  iqfoc_si_q(x_q, 24), iqfoc_si_q(emf, 24)};
        set->predictor = predictor;
        set->gains = gains;
        if (d->ticks_per_s > 0.0) {
            set->period_ticks = (uint32_t)iqfoc_si_q(d->ticks_per_s * d->T_s, 0);
        }
    }
    return refused;
}

/*
 * The same for the exact predictor's winding (predictor_exact.h), by the mean of the two inductances. A firmware with
 * IQFOC_MODEL_EXACT or deadbeat control calls it in the task that changes its parameters.
 */
static inline const char *iqfoc_si_winding(const iqfoc_si_drive_t *d, iqfoc_exact_winding_t *winding)
{
    iqfoc_cycle_config_t set;
    const char *refused = iqfoc_si_parameters(d, &set);
    if (refused == NULL) {
        const double I_b = IQFOC_I_BASE(d->I_rated_A_rms);
        const double L = 0.5 * (d->L_d_H + d->L_q_H);
        winding->rho_q30 = iqfoc_si_q(IQFOC_RAW_K_R(d->R_ohm, L, d->T_s), 30);
        winding->k_u_q26 = iqfoc_si_q(IQFOC_RAW_K_U(L, d->T_s, I_b, d->U_dc_V), 26);
        winding->k_psi_q27 = iqfoc_si_q(IQFOC_RAW_K_PSI(d->psi_Wb, L, I_b), 27);
    }
    return refused;
}

#ifdef __cplusplus
}
#endif

#endif
