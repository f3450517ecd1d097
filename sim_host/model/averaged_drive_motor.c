/* The averaged drive from a motor file and back: [motor] and [extension.*] as interfaces.md defines them. */
#include "averaged_drive.h"

#include <math.h>

static const double HALF_SQRT3 = 0.86602540378443864676;
static const double INV_SQRT3 = 0.57735026918962576451;

averaged_drive averaged_drive_of(const motor *m)
{
    averaged_drive d = {.R_ohm = m->R_ohm,
                        .L_d_H = m->L_d_H,
                        .L_q_H = m->L_q_H,
                        .psi_f_Wb = m->psi_f_Wb,
                        .i_knee_A = 0.02 * m->I_rated_A_rms,
                        .edge = m->ext.has[EXT_DEAD_TIME] ? EDGE_CLIPPED : EDGE_CHARGED,
                        .k_u = 1.0,
                        .g = {1.0, 1.0, 1.0}};
    const motor_extension *x = &m->ext;
    if (x->has[EXT_SATURATION]) {
        d.L_d_H = x->L_0_H * 2.0 * m->L_d_H / (m->L_d_H + m->L_q_H);
        d.L_q_H = x->L_0_H * 2.0 * m->L_q_H / (m->L_d_H + m->L_q_H);
        d.saturation = 1.0 / (x->I_sat_A * x->I_sat_A);
    }
    if (x->has[EXT_DEAD_TIME]) {
        d.v_dead_V = x->v_dead_V;
        d.i_knee_A = x->i_knee_A;
    }
    if (x->has[EXT_VOLTAGE_GAIN]) {
        d.k_u = x->k_u;
    }
    if (x->has[EXT_CURRENT_OFFSET]) {
        d.offset_ab_A[0] = (2.0 * x->o_A[0] - x->o_A[1] - x->o_A[2]) / 3.0;
        d.offset_ab_A[1] = (x->o_A[1] - x->o_A[2]) * INV_SQRT3;
        d.offset_zero_A = (x->o_A[0] + x->o_A[1] + x->o_A[2]) / 3.0;
    }
    for (size_t phase = 0; phase < 3; phase++) {
        if (x->has[EXT_CURRENT_GAIN]) {
            d.g[phase] = x->g[phase];
        }
        if (x->has[EXT_PHASE_ASYMMETRY]) {
            d.dR_ohm[phase] = x->dR_ohm[phase];
        }
    }
    if (x->has[EXT_ANGLE_OFFSET]) {
        d.theta_0_rad = x->theta_0_rad;
    }
    if (x->has[EXT_ANGLE_HARMONIC]) {
        size_t n = x->harmonic_order > 1.5 ? 1 : 0;
        d.harmonic_cos_rad[n] = x->harmonic_amplitude_rad * cos(x->harmonic_phase_rad);
        d.harmonic_sin_rad[n] = -x->harmonic_amplitude_rad * sin(x->harmonic_phase_rad);
    }
    if (x->has[EXT_ANGLE_DELAY]) {
        d.t_delay_s = x->t_delay_s;
    }
    if (x->has[EXT_VOLTAGE_DELAY]) {
        d.u_delay[0] = x->voltage_delay_cycles == 1 ? 1.0 : 0.0;
        d.u_delay[1] = x->voltage_delay_cycles >= 2 ? 1.0 : 0.0;
    }
    if (x->has[EXT_EMF_HARMONICS]) {
        d.psi_5_Wb = x->psi_5_Wb;
        d.psi_7_Wb = x->psi_7_Wb;
    }
    return d;
}

motor averaged_drive_motor(const averaged_drive *d, const motor *base)
{
    motor m = *base;
    motor_extension *x = &m.ext;
    m.R_ohm = d->R_ohm;
    m.psi_f_Wb = d->psi_f_Wb;
    m.L_d_H = d->L_d_H;
    m.L_q_H = d->L_q_H;
    x->has[EXT_SATURATION] = d->saturation > 0.0;
    if (x->has[EXT_SATURATION]) {
        x->L_0_H = 0.5 * (d->L_d_H + d->L_q_H);
        x->I_sat_A = 1.0 / sqrt(d->saturation);
    }
    x->has[EXT_DEAD_TIME] = d->v_dead_V != 0.0;
    x->v_dead_V = d->v_dead_V;
    x->i_knee_A = d->i_knee_A;
    x->has[EXT_VOLTAGE_GAIN] = d->k_u != 1.0;
    x->k_u = d->k_u;
    /* Only the two-phase information of the offsets counts: their common part is left out. */
    x->has[EXT_CURRENT_OFFSET] = d->offset_ab_A[0] != 0.0 || d->offset_ab_A[1] != 0.0;
    x->o_A[0] = d->offset_ab_A[0];
    x->o_A[1] = -0.5 * d->offset_ab_A[0] + HALF_SQRT3 * d->offset_ab_A[1];
    x->o_A[2] = -0.5 * d->offset_ab_A[0] - HALF_SQRT3 * d->offset_ab_A[1];
    x->has[EXT_CURRENT_GAIN] = false;
    x->has[EXT_PHASE_ASYMMETRY] = false;
    for (size_t phase = 0; phase < 3; phase++) {
        x->g[phase] = d->g[phase];
        x->dR_ohm[phase] = d->dR_ohm[phase];
        x->has[EXT_CURRENT_GAIN] = x->has[EXT_CURRENT_GAIN] || d->g[phase] != 1.0;
        x->has[EXT_PHASE_ASYMMETRY] = x->has[EXT_PHASE_ASYMMETRY] || d->dR_ohm[phase] != 0.0;
    }
    x->has[EXT_ANGLE_OFFSET] = d->theta_0_rad != 0.0;
    x->theta_0_rad = d->theta_0_rad;
    size_t n = hypot(d->harmonic_cos_rad[1], d->harmonic_sin_rad[1]) >
                       hypot(d->harmonic_cos_rad[0], d->harmonic_sin_rad[0])
                   ? 1
                   : 0;
    x->harmonic_order = (double)(n + 1);
    x->harmonic_amplitude_rad = hypot(d->harmonic_cos_rad[n], d->harmonic_sin_rad[n]);
    x->harmonic_phase_rad = atan2(-d->harmonic_sin_rad[n], d->harmonic_cos_rad[n]);
    x->has[EXT_ANGLE_HARMONIC] = x->harmonic_amplitude_rad > 0.0;
    x->has[EXT_ANGLE_DELAY] = d->t_delay_s != 0.0;
    x->t_delay_s = d->t_delay_s;
    x->voltage_delay_cycles = d->u_delay[1] > 0.5 ? 2 : (d->u_delay[0] > 0.5 ? 1 : 0);
    x->has[EXT_VOLTAGE_DELAY] = x->voltage_delay_cycles != 0;
    x->has[EXT_EMF_HARMONICS] = d->psi_5_Wb != 0.0 || d->psi_7_Wb != 0.0;
    x->psi_5_Wb = d->psi_5_Wb;
    x->psi_7_Wb = d->psi_7_Wb;
    return m;
}
