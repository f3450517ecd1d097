/* Motor files to the constants of the control cycle and of the predictors (params_host.h). */
#include "params_host.h"

#include "hal_host.h"

#include "iqfoc/params.h"

#include <stdio.h>
#include <string.h>

/* Four times the rated current: above what any scenario asks for, below what the converter's scaling holds. */
#define CURRENT_LIMIT_PU 4.0

bool constant_from_motor(const motor *m, const char *key, const char *name, double value, double low,
                         double high, int bits, int32_t *out, error *e)
{
    if (!(value >= low && value <= high)) {
        char remedy[120] = "";
        if (value > high && strstr(name, "L I_b)") != NULL) {
            (void)snprintf(remedy, sizeof remedy, "; I_rated_A_rms = %.3g, a larger current base, would fit",
                           1.01 * m->I_rated_A_rms * value / high);
        }
        return motor_refuse(
            m->path, key, e,
            "%s gives the per-unit constant %s = %.6g; the fixed-point library holds %.3g to %.3g%s", key,
            name, value, low, high, remedy);
    }
    *out = (int32_t)nearbyint(ldexp(value, bits));
    return true;
}

/* In IQ24. */
static bool coefficient(const motor *m, const char *key, const char *name, double value, double low,
                        double high, iq24_t *out, error *e)
{
    return constant_from_motor(m, key, name, value, low, high, 24, out, e);
}

bool predictor_from_motor(const motor *m, iqfoc_predictor_t *predictor, error *e)
{
    const per_unit base = per_unit_of(m);
    double L_d_H;
    double L_q_H;
    motor_inductances(m, &L_d_H, &L_q_H);
    const double L_H = 0.5 * (L_d_H + L_q_H);
    return coefficient(m, "L_d_H", "k_u = T U_b/(L I_b)", IQFOC_RAW_K_U(L_H, base.T_s, base.I_A, base.U_V),
                       IQFOC_MIN_K_U, IQFOC_MAX_K_U, &predictor->k_u, e) &&
           coefficient(m, "R_ohm", "k_r = R T/L", IQFOC_RAW_K_R(m->R_ohm, L_H, base.T_s), 0.0, IQFOC_MAX_K_R,
                       &predictor->k_r, e) &&
           coefficient(m, "psi_f_Wb", "k_psi = psi/(L I_b)", IQFOC_RAW_K_PSI(m->psi_f_Wb, L_H, base.I_A), 0.0,
                       IQFOC_MAX_K_PSI, &predictor->k_psi, e);
}

/* The three constants of one inductance. */
static bool axis_from_motor(const motor *m, const char *L_key, double L_H, iqfoc_exact_winding_t *axis,
                            error *e)
{
    const per_unit base = per_unit_of(m);
    return constant_from_motor(m, "R_ohm", "R T/L", IQFOC_RAW_K_R(m->R_ohm, L_H, base.T_s), 0.0,
                               IQFOC_MAX_K_R, 30, &axis->rho_q30, e) &&
           constant_from_motor(m, L_key, "T U_b/(L I_b)", IQFOC_RAW_K_U(L_H, base.T_s, base.I_A, base.U_V),
                               IQFOC_MIN_K_U, IQFOC_MAX_K_U, 26, &axis->k_u_q26, e) &&
           constant_from_motor(m, "psi_f_Wb", "psi_f/(L I_b)", IQFOC_RAW_K_PSI(m->psi_f_Wb, L_H, base.I_A),
                               0.0, IQFOC_MAX_K_PSI, 27, &axis->k_psi_q27, e);
}

bool winding_from_motor(const motor *m, iqfoc_exact_winding_t *winding, error *e)
{
    double L_d_H;
    double L_q_H;
    iqfoc_exact_winding_t made = {0};
    motor_inductances(m, &L_d_H, &L_q_H);
    if (!axis_from_motor(m, "L_d_H", 0.5 * (L_d_H + L_q_H), &made, e)) {
        return false;
    }
    *winding = made;
    return true;
}

bool salient_from_motor(const motor *m, iqfoc_salient_machine_t *machine, error *e)
{
    double L_d_H;
    double L_q_H;
    iqfoc_exact_winding_t d = {0};
    iqfoc_exact_winding_t q = {0};
    int32_t q_to_d_q27 = 0;
    int32_t d_to_q_q27 = 0;
    const double least = 1.0 / IQFOC_MAX_SALIENCY;
    motor_inductances(m, &L_d_H, &L_q_H);
    if (!axis_from_motor(m, "L_d_H", L_d_H, &d, e) || !axis_from_motor(m, "L_q_H", L_q_H, &q, e) ||
        !constant_from_motor(m, "L_q_H", "L_q/L_d", L_q_H / L_d_H, least, IQFOC_MAX_SALIENCY, 27, &q_to_d_q27,
                             e) ||
        !constant_from_motor(m, "L_d_H", "L_d/L_q", L_d_H / L_q_H, least, IQFOC_MAX_SALIENCY, 27, &d_to_q_q27,
                             e)) {
        return false;
    }
    *machine = (iqfoc_salient_machine_t){.rho_d_q30 = d.rho_q30,
                                         .rho_q_q30 = q.rho_q30,
                                         .k_d_q26 = d.k_u_q26,
                                         .k_q_q26 = q.k_u_q26,
                                         .k_psi_d_q27 = d.k_psi_q27,
                                         .k_psi_q_q27 = q.k_psi_q27,
                                         .q_to_d_q27 = q_to_d_q27,
                                         .d_to_q_q27 = d_to_q_q27};
    return true;
}

bool gains_from_motor(const motor *m, double bandwidth_Hz, iqfoc_current_control_gains_t *gains, error *e)
{
    const per_unit base = per_unit_of(m);
    const double w_rad_s = VEC_TWO_PI * bandwidth_Hz;
    const double ki = IQFOC_RAW_KI(w_rad_s, m->R_ohm, base.T_s, base.I_A, base.U_V);
    double L_d_H;
    double L_q_H;
    motor_inductances(m, &L_d_H, &L_q_H);
    return coefficient(m, "L_d_H", "kp_d = w L_d I_b/U_b", IQFOC_RAW_KP(w_rad_s, L_d_H, base.I_A, base.U_V),
                       0.0, IQFOC_MAX_GAIN, &gains->kp_d, e) &&
           coefficient(m, "L_q_H", "kp_q = w L_q I_b/U_b", IQFOC_RAW_KP(w_rad_s, L_q_H, base.I_A, base.U_V),
                       0.0, IQFOC_MAX_GAIN, &gains->kp_q, e) &&
           coefficient(m, "R_ohm", "ki_d = w R T I_b/U_b", ki, 0.0, IQFOC_MAX_GAIN, &gains->ki_d, e) &&
           coefficient(m, "R_ohm", "ki_q = w R T I_b/U_b", ki, 0.0, IQFOC_MAX_GAIN, &gains->ki_q, e) &&
           coefficient(m, "f_pwm_Hz", "anti_windup = w T", IQFOC_RAW_ANTI_WINDUP(w_rad_s, base.T_s), 0.0,
                       IQFOC_MAX_ANTI_WINDUP, &gains->anti_windup, e) &&
           coefficient(m, "L_d_H", "x_d = 2 pi L_d I_b/(T U_b)",
                       IQFOC_RAW_X(L_d_H, base.T_s, base.I_A, base.U_V), 0.0, IQFOC_MAX_X, &gains->x_d, e) &&
           coefficient(m, "L_q_H", "x_q = 2 pi L_q I_b/(T U_b)",
                       IQFOC_RAW_X(L_q_H, base.T_s, base.I_A, base.U_V), 0.0, IQFOC_MAX_X, &gains->x_q, e) &&
           coefficient(m, "psi_f_Wb", "emf = 2 pi psi/(T U_b)",
                       IQFOC_RAW_EMF(m->psi_f_Wb, base.T_s, base.U_V), 0.0, IQFOC_MAX_X, &gains->emf, e);
}

static bool speed_fits(const motor *m, error *e)
{
    const double turns = IQFOC_RAW_SPEED(m->n_max_rpm, m->pole_pairs, 1.0 / m->f_pwm_Hz);
    return turns <= IQFOC_MAX_SPEED ||
           motor_refuse(
               m->path, "n_max_rpm", e,
               "n_max_rpm with pole_pairs and f_pwm_Hz gives %.3g turns per control cycle; the library "
               "holds 1/3 (a switching-to-fundamental ratio of 3)",
               turns);
}

double control_bandwidth_Hz(const motor *m, const scenario_control *control)
{
    /* A corrected mean is a cycle old when it is used: a third of the bandwidth keeps the phase margin. */
    const double usual_Hz = m->f_pwm_Hz / (control->feedback == FEEDBACK_CORRECTED_MEAN ? 60.0 : 20.0);
    return control->bandwidth_Hz > 0.0 ? control->bandwidth_Hz : usual_Hz;
}

bool config_from_motor(const motor *m, const scenario_control *control, iqfoc_cycle_config_t *config,
                       error *e)
{
    static const iqfoc_feedback_t feedback[] = {
        [FEEDBACK_MIDPOINT] = IQFOC_FEEDBACK_MIDPOINT,
        [FEEDBACK_CORRECTED_MEAN] = IQFOC_FEEDBACK_CORRECTED_MEAN,
        [FEEDBACK_QUASI_DISCRETE_MEAN] = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    };
    const double bandwidth_Hz = control_bandwidth_Hz(m, control);
    iqfoc_cycle_config_t made;
    memset(&made, 0, sizeof made);
    if (!speed_fits(m, e) || !predictor_from_motor(m, &made.predictor, e) ||
        !gains_from_motor(m, bandwidth_Hz, &made.gains, e)) {
        return false;
    }
    made.feedback = feedback[control->feedback];
    made.modulation =
        control->modulation == MODULATION_SIX_STEP ? IQFOC_MODULATION_SIX_STEP : IQFOC_MODULATION_PWM;
    made.safe_state = IQFOC_SAFE_GATES_OFF;
    made.span_max = IQ24_ONE;
    made.current_limit = iq24_from_double(CURRENT_LIMIT_PU);
    const double period = HAL_HOST_TICKS_PER_S / m->f_pwm_Hz;
    if (!(period < 4294967295.0)) {
        return motor_refuse(m->path, "f_pwm_Hz", e,
                            "f_pwm_Hz = %g is too low: a control cycle must fit a 32-bit timer", m->f_pwm_Hz);
    }
    made.period_ticks = (uint32_t)period;
    made.tolerance_ticks = made.period_ticks / 50;
    made.stale_ticks = made.period_ticks / 4;
    made.deadline_ticks = made.period_ticks / 2;
    made.trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE | IQFOC_STATUS_OVERCURRENT;
    *config = made;
    return true;
}
