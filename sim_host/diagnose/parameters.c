#include "parameters.h"

#include <math.h>
#include <stddef.h>

#define FIELD(name) offsetof(averaged_drive, name)

static const size_t field[P_COUNT] = {
    [P_R] = FIELD(R_ohm),
    [P_L_D] = FIELD(L_d_H),
    [P_L_Q] = FIELD(L_q_H),
    [P_PSI] = FIELD(psi_f_Wb),
    [P_SATURATION] = FIELD(saturation),
    [P_V_DEAD] = FIELD(v_dead_V),
    [P_KNEE] = FIELD(i_knee_A),
    [P_K_U] = FIELD(k_u),
    [P_OFFSET_A] = FIELD(offset_ab_A),
    [P_OFFSET_B] = FIELD(offset_ab_A) + sizeof(double),
    [P_OFFSET_ZERO] = FIELD(offset_zero_A),
    [P_GAIN_A] = FIELD(g),
    [P_GAIN_B] = FIELD(g) + sizeof(double),
    [P_GAIN_C] = FIELD(g) + 2 * sizeof(double),
    [P_THETA_0] = FIELD(theta_0_rad),
    [P_HARMONIC_1C] = FIELD(harmonic_cos_rad),
    [P_HARMONIC_1S] = FIELD(harmonic_sin_rad),
    [P_HARMONIC_2C] = FIELD(harmonic_cos_rad) + sizeof(double),
    [P_HARMONIC_2S] = FIELD(harmonic_sin_rad) + sizeof(double),
    [P_T_DELAY] = FIELD(t_delay_s),
    [P_U_DELAY_1] = FIELD(u_delay),
    [P_U_DELAY_2] = FIELD(u_delay) + sizeof(double),
    [P_PSI_5] = FIELD(psi_5_Wb),
    [P_PSI_7] = FIELD(psi_7_Wb),
    [P_DR_A] = FIELD(dR_ohm),
    [P_DR_B] = FIELD(dR_ohm) + sizeof(double),
    [P_DR_C] = FIELD(dR_ohm) + 2 * sizeof(double),
    [P_IRON] = FIELD(iron_S),
    [P_IRON_LATE] = FIELD(iron_s_S),
    [P_EDDY] = FIELD(eddy_S),
    [P_EDDY_LATER] = FIELD(eddy_S) + sizeof(double),
    [P_SATURATION_Q] = FIELD(saturation_q),
    [P_PSI_11] = FIELD(psi_11_Wb),
    [P_PSI_13] = FIELD(psi_13_Wb),
    [P_PSI_TEMPERATURE] = FIELD(psi_temperature),
    [P_R_TEMPERATURE] = FIELD(R_temperature),
    [P_RIPPLE] = FIELD(edge_ripple),

};

static bool is_logarithmic(parameter_id id)
{
    return id == P_L_D || id == P_L_Q || id == P_KNEE;
}

static double *at(averaged_drive *d, parameter_id id)
{
    return (double *)(void *)((unsigned char *)d + field[id]);
}

static double value_of(const averaged_drive *d, parameter_id id)
{
    return *(const double *)(const void *)((const unsigned char *)d + field[id]);
}

parameter_set parameters_of(const motor *m, const diagnose_rows *r)
{
    parameter_set p = {.nominal = averaged_drive_of(m)};
    const averaged_drive *d = &p.nominal;
    double L = 0.5 * (d->L_d_H + d->L_q_H);
    double I = sqrt(2.0) * m->I_rated_A_rms;
    double psi = d->psi_f_Wb > 0.0 ? d->psi_f_Wb : L * I;
    /* A file may say R = 0: then what counts as much is a tenth of the reactance of a cycle. */
    double R = fmax(d->R_ohm, 0.01 * L / r->T_s);
    double omega = fmax(r->omega_max_rad_s, 1.0);
    p.i_rated_peak_A = I;
    p.pole_pairs = m->pole_pairs;
    p.knee_max_A = 0.25 * I;
    for (size_t k = 0; k < P_COUNT; k++) {
        p.scale[k] = 1.0;
    }
    p.scale[P_R] = p.scale[P_DR_A] = p.scale[P_DR_B] = p.scale[P_DR_C] = R;
    p.scale[P_PSI] = p.scale[P_PSI_5] = p.scale[P_PSI_7] = p.scale[P_PSI_11] = p.scale[P_PSI_13] = psi;
    p.scale[P_SATURATION] = p.scale[P_SATURATION_Q] = 1.0 / (I * I);
    p.scale[P_V_DEAD] = 0.01 * m->u_dc_V;
    p.scale[P_OFFSET_A] = p.scale[P_OFFSET_B] = p.scale[P_OFFSET_ZERO] = I;
    p.scale[P_T_DELAY] = r->T_s;
    p.scale[P_EDDY] = p.scale[P_EDDY_LATER] = p.scale[P_IRON] = 0.01 * I / (omega * psi);
    p.scale[P_IRON_LATE] = p.scale[P_IRON] * r->T_s;
    p.scale[P_PSI_TEMPERATURE] = 0.01 * psi;
    p.scale[P_R_TEMPERATURE] = 0.01 * R;
    return p;
}

averaged_drive parameters_drive(const parameter_set *p, const double z[P_COUNT])
{
    averaged_drive d = p->nominal;
    for (parameter_id id = 0; id < P_COUNT; id++) {
        if (z[id] != 0.0 && id != P_EDGE) {
            double nominal = value_of(&p->nominal, id);
            *at(&d, id) = is_logarithmic(id) ? nominal * exp(z[id]) : nominal + z[id] * p->scale[id];
        }
    }
    /* A dead time that the file states is that of the plain law; one that is fitted chooses. */
    if (p->nominal.v_dead_V == 0.0 || z[P_V_DEAD] != 0.0) {
        d.edge = (edge_law)lround(z[P_EDGE]);
    }
    return d;
}

double parameters_slope(const parameter_set *p, parameter_id id, const double z[P_COUNT])
{
    return is_logarithmic(id) ? value_of(&p->nominal, id) * exp(z[id]) : p->scale[id];
}

double parameters_step(parameter_id id)
{
    switch (id) {
    case P_SATURATION:
    case P_SATURATION_Q:
        return 1e-3;
    case P_KNEE:
        return 1e-2; /* wide enough to average over the kinks of the clipped law */
    case P_V_DEAD:
    case P_RIPPLE:
        return 1e-2;
    default:
        return 1e-4;
    }
}

void parameters_bound(const parameter_set *p, double z[P_COUNT])
{
    z[P_R] = fmax(z[P_R], -0.95 * p->nominal.R_ohm / p->scale[P_R]);
    z[P_L_D] = fmin(fmax(z[P_L_D], -2.5), 2.5);
    z[P_L_Q] = fmin(fmax(z[P_L_Q], -2.5), 2.5);
    z[P_PSI] = fmax(z[P_PSI], -p->nominal.psi_f_Wb / p->scale[P_PSI]);
    z[P_SATURATION] = fmin(fmax(z[P_SATURATION], -0.2), 1.5);
    double knee = log(p->knee_max_A / p->nominal.i_knee_A);
    z[P_KNEE] = fmin(fmax(z[P_KNEE], log(1e-3 * p->i_rated_peak_A / p->nominal.i_knee_A)), knee);
    z[P_RIPPLE] = fmin(fmax(z[P_RIPPLE], 0.0), 1.2);
    z[P_THETA_0] = fmin(fmax(z[P_THETA_0], -1.5), 1.5);
    for (parameter_id id = P_GAIN_A; id <= P_GAIN_C; id++) {
        /* Beyond that it is no sensor error but another sign, unit or motor. */
        z[id] = fmin(fmax(z[id], -0.4), 0.6);
    }
    z[P_K_U] = fmax(z[P_K_U], 0.05 - p->nominal.k_u);
}
