/* Length, cycle, sizes and units of a recording (columns.h). */
#include "columns.h"

#include "angle.h"

#include <math.h>

/* Fewest rows of consecutive cycles for a diagnosis: fitted and held-out blocks, each several L/R long. */
static const size_t ROWS_LEAST = 200;

static bool length(const recording *rec, error *e)
{
    size_t usable = 0;
    for (size_t s = 0; s < rec->stretches; s++) {
        usable += rec->stretch[s].count >= 50 ? rec->stretch[s].count : 0;
    }
    return usable >= ROWS_LEAST || error_input(e, rec->path, 0, 0,
                                               "%zu of %zu rows are in stretches of 50 consecutive cycles or "
                                               "more (%zu stretches); a diagnosis needs %zu",
                                               usable, rec->rows, rec->stretches, ROWS_LEAST);
}

static bool cycle(const recording *rec, const motor *m, error *e)
{
    if (rec->pwm.pulses > 0) {
        return error_input(
            e, rec->path, 0, 0,
            "rows of a pulse pattern (%d pulses) cannot be diagnosed: a cycle has no centred pulses; record "
            "modulation = \"pwm\"",
            rec->pwm.pulses);
    }
    double ratio = rec->T_s * m->f_pwm_Hz;
    if (ratio > 0.8 && ratio < 1.25) {
        return true;
    }
    if (ratio > 800.0 && ratio < 1250.0) {
        return error_input(e, rec->path, 0, 0,
                           "t_s steps by %g: it looks like milliseconds; expected seconds", rec->T_s);
    }
    if (ratio > 8e5 && ratio < 1.25e6) {
        return error_input(e, rec->path, 0, 0,
                           "t_s steps by %g: it looks like microseconds; expected seconds", rec->T_s);
    }
    if (ratio > 8e-4 && ratio < 1.25e-3) {
        return error_input(e, rec->path, 0, 0,
                           "t_s steps by %g s, a thousandth of the cycle 1/f_pwm_Hz = %g s; expected seconds",
                           rec->T_s, 1.0 / m->f_pwm_Hz);
    }
    if (ratio > 0.4 && ratio < 0.625) {
        return error_input(
            e, rec->path, 0, 0,
            "t_s steps by %g s, half the cycle of the motor file's f_pwm_Hz = %g: rows of half a carrier "
            "period (two updates) cannot be diagnosed; record one row per carrier period",
            rec->T_s, m->f_pwm_Hz);
    }
    return error_input(e, rec->path, 0, 0,
                       "t_s steps by %g s, but f_pwm_Hz = %g of the motor file gives a cycle of %g s; record "
                       "consecutive control cycles, or correct f_pwm_Hz",
                       rec->T_s, m->f_pwm_Hz, 1.0 / m->f_pwm_Hz);
}

static double rms3(const recording *rec, bool voltage, double *peak)
{
    double sum = 0.0;
    *peak = 0.0;
    for (size_t k = 0; k < rec->rows; k++) {
        double x[3] = {rec->i_A[0][k], rec->i_A[1][k], rec->i_A[2][k]};
        if (voltage) {
            recording_voltage(rec, k, x);
        }
        for (size_t phase = 0; phase < 3; phase++) {
            sum += x[phase] * x[phase] / 3.0;
            *peak = fmax(*peak, fabs(x[phase]));
        }
    }
    return sqrt(sum / (double)rec->rows);
}

static bool size(const recording *rec, const motor *m, error *e)
{
    double i_peak;
    double u_peak;
    double i_rms = rms3(rec, false, &i_peak);
    double u_rms = rms3(rec, true, &u_peak);
    if (i_peak == 0.0 && u_peak == 0.0) {
        return error_input(e, rec->path, 0, 0, "all currents and voltages are zero; record with current");
    }
    if (i_rms > 50.0 * m->I_rated_A_rms) {
        return error_input(e, rec->path, 0, 0,
                           "phase currents of %.4g rms, but the motor is rated %.4g A: they look like "
                           "milliamperes, or the motor file is for another motor",
                           i_rms, m->I_rated_A_rms);
    }
    if (i_rms < 0.004 * m->I_rated_A_rms) {
        return error_input(e, rec->path, 0, 0,
                           "no excitation: phase currents of %.3g A rms are too small for a rated current of "
                           "%.4g A (or they are in kiloamperes)",
                           i_rms, m->I_rated_A_rms);
    }
    if (u_peak > 20.0 * m->u_dc_V) {
        return error_input(e, rec->path, 0, 0,
                           "phase voltages up to %.4g, but the DC link has %.4g V: they look like "
                           "millivolts, or the motor file is for another drive",
                           u_peak, m->u_dc_V);
    }
    double omega2 = 0.0;
    for (size_t k = 0; k < rec->rows; k++) {
        omega2 += rec->omega_e_rad_s[k] * rec->omega_e_rad_s[k] / (double)rec->rows;
    }
    double expected = m->R_ohm * i_rms + sqrt(0.5 * omega2) * m->psi_f_Wb;
    if (u_peak == 0.0 || u_rms < 0.005 * expected) {
        return error_input(e, rec->path, 0, 0,
                           "no excitation: phase voltages of %.3g V rms, but R i and the back-EMF need about "
                           "%.3g V (or they are in kilovolts)",
                           u_rms, expected);
    }
    return true;
}

/* The rated current at top speed must not need this many times the link: no machine does. */
static const double LINKS_MOST = 30.0;

static bool inductance(const motor *m, double L_H, const char *key, error *e)
{
    const double needed_V = motor_speed_rad_s(m, m->n_max_rpm) * L_H * motor_rated_peak_A(m);
    if (needed_V <= LINKS_MOST * m->u_dc_V) {
        return true;
    }
    return motor_refuse(
        m->path, key, e,
        "%s = %.4g needs %.3g V at the rated current and n_max_rpm, the DC link has %.4g V: it looks like "
        "millihenries; expected henries",
        key, L_H, needed_V, m->u_dc_V);
}

bool check_columns(const recording *rec, const motor *m, error *e)
{
    return length(rec, e) && cycle(rec, m, e) && inductance(m, m->L_d_H, "L_d_H", e) &&
           inductance(m, m->L_q_H, "L_q_H", e) && size(rec, m, e) && check_angle(rec, m, e);
}
