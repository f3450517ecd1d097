/* A motor file's extensions to fixed point (extension_host.h). */
#include "extension_host.h"

#include "iqfoc/extension_params.h"

/* In IQ24. */
static bool constant(const motor *m, const char *key, const char *name, double value, double low, double high,
                     iq24_t *out, error *e)
{
    return constant_from_motor(m, key, name, value, low, high, 24, out, e);
}

static bool currents(const motor *m, const per_unit *base, iqfoc_extension_t *made, error *e)
{
    static const char *const offset_key[3] = {"o_a_A", "o_b_A", "o_c_A"};
    static const char *const gain_key[3] = {"g_a", "g_b", "g_c"};
    iq24_t *const offset[3] = {&made->i_offset.a, &made->i_offset.b, &made->i_offset.c};
    iq24_t *const gain[3] = {&made->i_gain_inverse.a, &made->i_gain_inverse.b, &made->i_gain_inverse.c};
    const motor_extension *x = &m->ext;
    bool good = true;
    for (int phase = 0; phase < 3 && good; phase++) {
        const double o_A = x->has[CAUSE_CURRENT_OFFSET] ? x->o_A[phase] : 0.0;
        const double g = x->has[CAUSE_CURRENT_GAIN] ? x->g[phase] : 1.0;
        good = constant(m, offset_key[phase], "current offset/I_b", IQFOC_RAW_EXT_OFFSET(o_A, base->I_A),
                        -IQFOC_MAX_EXT_OFFSET, IQFOC_MAX_EXT_OFFSET, offset[phase], e) &&
               constant(m, gain_key[phase], "1/current gain", IQFOC_RAW_EXT_GAIN_INVERSE(g),
                        IQFOC_MIN_EXT_GAIN, IQFOC_MAX_EXT_GAIN, gain[phase], e);
    }
    return good;
}

bool extension_from_motor(const motor *m, iqfoc_extension_t *extension, error *e)
{
    const per_unit base = per_unit_of(m);
    const motor_extension *x = &m->ext;
    const double theta_0 = x->has[CAUSE_ANGLE_OFFSET] ? x->theta_0_rad : 0.0;
    const double t_delay_s = x->has[CAUSE_ANGLE_DELAY] ? x->t_delay_s : 0.0;
    const double k_u = x->has[CAUSE_VOLTAGE_GAIN] ? x->k_u : 1.0;
    const double v_dead_V = x->has[CAUSE_DEAD_TIME] ? x->v_dead_V : 0.0;
    const double knee_A = x->has[CAUSE_DEAD_TIME] ? x->i_knee_A : 0.0;
    const double saturation = x->has[CAUSE_SATURATION] ? IQFOC_RAW_EXT_SATURATION(x->I_sat_A, base.I_A) : 0.0;
    iqfoc_extension_t made = IQFOC_EXTENSION_NONE;
    if (!currents(m, &base, &made, e) ||
        !constant(m, "theta_0_rad", "theta_0 in turns", IQFOC_RAW_EXT_ANGLE(theta_0), -IQFOC_MAX_EXT_ANGLE,
                  IQFOC_MAX_EXT_ANGLE, &made.theta_0, e) ||
        !constant(m, "t_delay_s", "t_delay/T", IQFOC_RAW_EXT_DELAY(t_delay_s, base.T_s), -IQFOC_MAX_EXT_DELAY,
                  IQFOC_MAX_EXT_DELAY, &made.theta_delay, e) ||
        !constant(m, "k_u", "k_u", k_u, IQFOC_MIN_EXT_GAIN, IQFOC_MAX_EXT_GAIN, &made.k_u, e) ||
        !constant(m, "v_dead_V", "v_dead/U_b", IQFOC_RAW_EXT_VOLTAGE(v_dead_V, base.U_V),
                  -IQFOC_MAX_EXT_VOLTAGE, IQFOC_MAX_EXT_VOLTAGE, &made.v_dead, e) ||
        !constant(m, "i_knee_A", "I_b/i_knee", IQFOC_RAW_EXT_KNEE_INVERSE(knee_A, base.I_A), 0.0,
                  IQFOC_MAX_EXT_KNEE_INVERSE, &made.knee_inverse, e) ||
        !constant(m, "I_sat_A", "(I_b/I_sat)^2", saturation, 0.0, IQFOC_MAX_EXT_SATURATION, &made.saturation,
                  e)) {
        return false;
    }
    *extension = made;
    return true;
}

static bool inductance(const motor *m, const char *key, const char *name, double L_H, iq24_t *l, iq24_t *k,
                       error *e)
{
    const per_unit base = per_unit_of(m);
    const double value = IQFOC_RAW_FLUX_L(L_H, base.T_s, base.I_A, base.U_V);
    *k = iq24_from_double(1.0 / value);
    return constant(m, key, name, value, IQFOC_MIN_FLUX_L, IQFOC_MAX_FLUX_L, l, e);
}

bool flux_predictor_from_motor(const motor *m, iqfoc_flux_predictor_t *predictor, error *e)
{
    const per_unit base = per_unit_of(m);
    double L_d_H;
    double L_q_H;
    iqfoc_flux_predictor_t made;
    motor_inductances(m, &L_d_H, &L_q_H);
    if (!inductance(m, "L_d_H", "l_d = L_d I_b/(T U_b)", L_d_H, &made.l_d, &made.k_d, e) ||
        !inductance(m, "L_q_H", "l_q = L_q I_b/(T U_b)", L_q_H, &made.l_q, &made.k_q, e) ||
        !constant(m, "R_ohm", "R I_b/U_b", IQFOC_RAW_FLUX_R(m->R_ohm, base.I_A, base.U_V), 0.0,
                  IQFOC_MAX_FLUX_R, &made.r, e) ||
        !constant(m, "psi_f_Wb", "psi/(T U_b)", IQFOC_RAW_FLUX_PSI(m->psi_f_Wb, base.T_s, base.U_V), 0.0,
                  IQFOC_MAX_FLUX_PSI, &made.psi, e)) {
        return false;
    }
    *predictor = made;
    return true;
}
