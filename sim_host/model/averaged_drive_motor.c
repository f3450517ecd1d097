/* The averaged drive from a motor file and back: [motor] and [extension.*] as interfaces.md defines them. */
#include "averaged_drive.h"

#include "flux_map.h"

/* Where no current saturates the iron: beyond any that flows, and finite, so that it can be written down. */
static const double NEVER = 1e6; /* of the rated peak */

static void take_laws(averaged_drive *d, const motor *m)
{
    motor_extension read = m->ext;
    const motor_extension *x = &read;
    if (x->has[CAUSE_SATURATION]) {
        d->saturation = 1.0 / (x->I_sat_A * x->I_sat_A);
    }
    if (x->has[CAUSE_SATURATION_DQ] && x->I_sat_dq_A > 0.0) {
        d->saturation = 1.0 / (x->I_sat_dq_A * x->I_sat_dq_A);
    }
    const iron_part iron[IRON_PARTS] = {{x->E_1_J, x->I_d1_A, x->I_q1_A, x->I_c1_A},
                                        {x->E_2_J, x->I_d2_A, x->I_q2_A, x->I_c2_A}};
    for (size_t k = 0; x->has[CAUSE_SATURATION_DQ] && k < IRON_PARTS; k++) {
        d->iron[k] = iron[k].E_J > 0.0 ? iron[k] : d->iron[k];
    }
    if (x->has[CAUSE_DEAD_TIME] && x->compensation_knee_A > 0.0) {
        d->compensation_knee_A = x->compensation_knee_A;
    }
    if (x->has[CAUSE_IRON_LOSS]) {
        d->fe_S = 1.0 / x->R_fe_ohm;
        d->fe_tau_s = x->tau_fe_s;
    }
    if (x->has[CAUSE_CURRENT_OFFSET]) {
        const vec_ab offset = vec_from_phases(x->o_A);
        d->offset_ab_A[0] = offset.alpha;
        d->offset_ab_A[1] = offset.beta;
        const vec_ab rate = vec_from_phases(x->o_rate_A_s);
        d->offset_rate_ab_A_s[0] = rate.alpha;
        d->offset_rate_ab_A_s[1] = rate.beta;
        d->offset_zero_A = (x->o_A[0] + x->o_A[1] + x->o_A[2]) / 3.0;
    }
    for (size_t k = 0; k < ANGLE_ORDERS; k++) {
        const motor_harmonic entry = motor_harmonic_of(&read, k);
        if (x->has[entry.cause]) {
            const size_t n = motor_angle_order(m, *entry.order);
            d->harmonic_cos_rad[n] = *entry.amplitude_rad * cos(*entry.phase_rad);
            d->harmonic_sin_rad[n] = -*entry.amplitude_rad * sin(*entry.phase_rad);
        }
    }
    if (x->has[CAUSE_VOLTAGE_DELAY]) {
        d->u_delay[0] = fmin(x->voltage_delay_cycles, 1.0);
        d->u_delay[1] = x->voltage_delay_cycles - d->u_delay[0];
    }
}

averaged_drive averaged_drive_of(const motor *m)
{
    const double I_A = motor_rated_peak_A(m);
    const iron_part none = {0.0, I_A, I_A, 0.0};
    averaged_drive d = {.R_ohm = m->R_ohm,
                        .psi_f_Wb = m->psi_f_Wb,
                        .iron = {none, none},
                        .i_knee_A = 0.02 * m->I_rated_A_rms,
                        .compensation_knee_A = 0.02 * m->I_rated_A_rms,
                        .edge = m->ext.has[CAUSE_DEAD_TIME] ? EDGE_CLIPPED : EDGE_CHARGED,
                        .k_u = 1.0,
                        .fe_tau_s = 0.5 / m->f_pwm_Hz,
                        .ring_share = 0.25,
                        .g = {1.0, 1.0, 1.0}};
#define MODEL(ID, field, member) d.member = m->ext.has[CAUSE_##ID] ? m->ext.field : d.member;
#include "../data/causes.def"
    motor_inductances(m, &d.L_d_H, &d.L_q_H);
    take_laws(&d, m);
    return d;
}

/* How large an angle's error of that order is. */
static double swing_rad(const averaged_drive *d, size_t n)
{
    return hypot(d->harmonic_cos_rad[n], d->harmonic_sin_rad[n]);
}

/* A part of no energy has no currents either: nothing is written of it. */
static void put_iron(motor_extension *x, const averaged_drive *d)
{
    double *const to[IRON_PARTS][4] = {{&x->E_1_J, &x->I_d1_A, &x->I_q1_A, &x->I_c1_A},
                                       {&x->E_2_J, &x->I_d2_A, &x->I_q2_A, &x->I_c2_A}};
    for (size_t k = 0; k < IRON_PARTS; k++) {
        const iron_part p = d->iron[k].E_J > 0.0 ? d->iron[k] : (iron_part){0.0, 0.0, 0.0, 0.0};
        *to[k][0] = p.E_J;
        *to[k][1] = p.I_d_A;
        *to[k][2] = p.I_q_A;
        *to[k][3] = p.I_c_A;
    }
}

static void put_laws(motor *m, const averaged_drive *d)
{
    motor_extension *x = &m->ext;
    const double I_A = motor_rated_peak_A(m);
    x->L_0_H = 0.5 * (d->L_d_H + d->L_q_H);
    x->L_d0_H = d->L_d_H;
    x->L_q0_H = d->L_q_H;
    put_iron(x, d);
    /* With terms of a flux map, saturation with the current is a part of the map. */
    x->I_sat_dq_A = d->saturation > 0.0 && flux_map_has_terms(d) ? 1.0 / sqrt(d->saturation) : 0.0;
    x->I_sat_A = d->saturation > 0.0 ? 1.0 / sqrt(d->saturation) : NEVER * I_A;
    x->R_fe_ohm = d->fe_S > 0.0 ? 1.0 / d->fe_S : NEVER * m->u_dc_V / I_A;
    x->tau_fe_s = d->fe_tau_s;
    vec_to_phases((vec_ab){d->offset_ab_A[0], d->offset_ab_A[1]}, x->o_A);
    /* The model's currents see nothing of what the offsets have in common: by itself it is no effect. */
    const bool has_offsets = x->o_A[0] != 0.0 || x->o_A[1] != 0.0 || x->o_A[2] != 0.0;
    for (int phase = 0; has_offsets && phase < 3; phase++) {
        x->o_A[phase] += d->offset_zero_A;
    }
    vec_to_phases((vec_ab){d->offset_rate_ab_A_s[0], d->offset_rate_ab_A_s[1]}, x->o_rate_A_s);
    for (size_t n = 0; n < ANGLE_ORDERS; n++) {
        const motor_harmonic entry = motor_harmonic_of(x, n);
        const bool swings = swing_rad(d, n) > 0.0;
        *entry.order = swings ? motor_order_of(m, n) : 0.0;
        *entry.amplitude_rad = swing_rad(d, n);
        *entry.phase_rad = swings ? atan2(-d->harmonic_sin_rad[n], d->harmonic_cos_rad[n]) : 0.0;
    }
    x->voltage_delay_cycles = d->u_delay[0] + d->u_delay[1];
}

motor averaged_drive_motor(const averaged_drive *d, const motor *base)
{
    motor m = *base;
    m.R_ohm = d->R_ohm;
    m.psi_f_Wb = d->psi_f_Wb;
    m.L_d_H = d->L_d_H;
    m.L_q_H = d->L_q_H;
#define MODEL(ID, field, member) m.ext.field = d->member;
#include "../data/causes.def"
    put_laws(&m, d);
    m.ext.i_knee_A = averaged_drive_loses(d) ? d->i_knee_A : 0.0;
    m.ext.compensation_knee_A = d->compensation_V != 0.0 ? d->compensation_knee_A : 0.0;
    for (int id = 0; id < CAUSE_COUNT; id++) {
        motor_note_extension(&m, (cause_id)id);
    }
    m.ext.has[CAUSE_SATURATION] = d->saturation > 0.0 && !flux_map_has_terms(d);
    m.ext.has[CAUSE_IRON_LOSS] = d->fe_S > 0.0;
    return m;
}
