/* The ideal drive of a motor file, and what no drive can have (plant_config.h). */
#include "plant_config.h"

#include "plant_flux.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

plant_config plant_config_from_motor(const motor *m)
{
    plant_config c;
    memset(&c, 0, sizeof c);
    c.machine.pole_pairs = m->pole_pairs;
    c.machine.R_ohm = m->R_ohm;
    motor_inductances(m, &c.machine.L_d_H, &c.machine.L_q_H);
    c.machine.psi_f_Wb = m->psi_f_Wb;
    c.inverter.u_dc_V = m->u_dc_V;
    c.inverter.k_u = 1.0;
    for (int x = 0; x < 3; x++) {
        c.sensors.current_gain[x] = 1.0;
    }
    c.sensors.loose_samples = 1.0;
    for (int n = 0; n < PLANT_HARMONICS; n++) {
        c.sensors.harmonic[n].order = 1.0;
    }
    c.shaft.mode = PLANT_SHAFT_GIVEN;
    c.T_s = 1.0 / m->f_pwm_Hz;
    c.I_scale_A = motor_rated_peak_A(m);
    c.seed = 1;
    return c;
}

void plant_config_extend(plant_config *c, const motor *m, cause_id cause)
{
#define PLANT(ID, field, member)                                                                             \
    c->member = cause == CAUSE_##ID && m->ext.has[CAUSE_##ID] ? m->ext.field : c->member;
#include "data/causes.def"
}

typedef struct range {
    const char *name;
    double value;
    double least, above, most; /* least <= value <= most, and value > above */
} range;

/* The current of a shorter time constant follows its voltage at once, and solving it step by step would not end. */
static bool check_time_constant(const plant_config *c, error *e)
{
    const double CYCLES_LEAST = 1e-3;
    const double L_H = fmin(c->machine.L_d_H, c->machine.L_q_H);
    return L_H >= CYCLES_LEAST * c->machine.R_ohm * c->T_s ||
           error_input(
               e, NULL, 0, 0,
               "drive: L is %g H, expected at least %.3g H: a time constant L/R of 0.001 control cycles", L_H,
               CYCLES_LEAST * c->machine.R_ohm * c->T_s);
}

/* A flux that falls from a tenth of the rated current on is not that of a machine. */
static bool check_map(const plant_config *c, error *e)
{
    plant_machine m = c->machine;
    if (!plant_flux_has_map(&m)) {
        return true;
    }
    const double reach_A = plant_flux_find_reach(&m, c->I_scale_A);
    return reach_A > 0.1 * c->I_scale_A ||
           error_input(e, NULL, 0, 0,
                       "drive: the flux map's inductance falls to a tenth at %g A, expected a current beyond "
                       "a tenth of the rated %g A",
                       reach_A, c->I_scale_A);
}

bool plant_config_check(const plant_config *c, error *e)
{
    const plant_machine *m = &c->machine;
    const plant_inverter *v = &c->inverter;
    const plant_sensors *s = &c->sensors;
    const plant_shaft *h = &c->shaft;
    const double big = INFINITY;
    const double none = -INFINITY;
    const bool inertia = h->mode == PLANT_SHAFT_INERTIA;
    const range ranges[] = {
        {"pole_pairs", m->pole_pairs, 1.0, 0.0, 1000.0},
        {"R", m->R_ohm, 0.0, none, big},
        {"R + dR_a", m->R_ohm + m->dR_ohm[0], 0.0, none, big},
        {"R + dR_b", m->R_ohm + m->dR_ohm[1], 0.0, none, big},
        {"R + dR_c", m->R_ohm + m->dR_ohm[2], 0.0, none, big},
        {"L_d", m->L_d_H, 0.0, 0.0, big},
        {"L_q", m->L_q_H, 0.0, 0.0, big},
        {"L + dL_a", fmin(m->L_d_H, m->L_q_H) + m->dL_H[0], 0.0, 0.0, big},
        {"L + dL_b", fmin(m->L_d_H, m->L_q_H) + m->dL_H[1], 0.0, 0.0, big},
        {"L + dL_c", fmin(m->L_d_H, m->L_q_H) + m->dL_H[2], 0.0, 0.0, big},
        {"psi_f", m->psi_f_Wb, 0.0, none, big},
        {"psi_5", m->psi_5_Wb, none, none, big},
        {"psi_7", m->psi_7_Wb, none, none, big},
        {"psi_11", m->psi_11_Wb, none, none, big},
        {"psi_13", m->psi_13_Wb, none, none, big},
        {"alpha_R", m->alpha_R, none, none, big},
        {"alpha_psi", m->alpha_psi, none, none, big},
        {"heating", m->heating_K, none, none, big},
        {"heating's time constant", m->heating_s, 0.0, m->heating_K != 0.0 ? 0.0 : none, big},
        {"reference temperature", m->reference_K, none, none, big},
        {"R rate", m->R_rate_ohm_s, none, none, big},
        {"psi_f rate", m->psi_rate_Wb_s, none, none, big},
        {"I_sat", m->I_sat_A, 0.0, none, big},
        {"w_ddd", m->w_ddd, none, none, big},
        {"w_dqq", m->w_dqq, none, none, big},
        {"w_dddd", m->w_dddd, none, none, big},
        {"w_ddqq", m->w_ddqq, none, none, big},
        {"w_qqqq", m->w_qqqq, none, none, big},
        {"E_1", m->iron[0].E_J, 0.0, none, big},
        {"I_d1", m->iron[0].I_d_A, 0.0, m->iron[0].E_J > 0.0 ? 0.0 : none, big},
        {"I_q1", m->iron[0].I_q_A, 0.0, m->iron[0].E_J > 0.0 ? 0.0 : none, big},
        {"I_c1", m->iron[0].I_c_A, none, none, big},
        {"E_2", m->iron[1].E_J, 0.0, none, big},
        {"I_d2", m->iron[1].I_d_A, 0.0, m->iron[1].E_J > 0.0 ? 0.0 : none, big},
        {"I_q2", m->iron[1].I_q_A, 0.0, m->iron[1].E_J > 0.0 ? 0.0 : none, big},
        {"I_c2", m->iron[1].I_c_A, none, none, big},
        {"R_fe", m->R_fe_ohm, 0.0, none, big},
        {"shorted turns", m->short_turns, 0.0, none, 1.0},
        {"shorted phase", m->short_phase, 0.0, m->short_turns > 0.0 ? 0.0 : none, 3.0},
        {"resistance of the short", m->short_ohm, 0.0, none, big},
        {"time constant of the short", m->short_s, 0.0, m->short_turns > 0.0 ? 0.0 : none, big},
        {"weak pole", m->weak_pole, 0.0, none, 1.0},
        {"eccentricity", m->eccentricity, 0.0, none, 1.0},
        {"tau_fe", m->tau_fe_s, 0.0, m->R_fe_ohm > 0.0 ? 0.0 : none, big},
        {"u_dc", v->u_dc_V, 0.0, 0.0, big},
        {"k_u", v->k_u, 0.0, 0.0, big},
        {"ripple", fabs(v->ripple_V), 0.0, none, v->k_u * v->u_dc_V},
        {"ripple frequency", v->ripple_Hz, 0.0, none, big},
        {"unlogged ripple's share", v->unlogged_share, 0.0, none, 1.0},
        {"unlogged ripple's frequency", v->unlogged_Hz, 0.0, none, big},
        {"t_dead", v->t_dead_s, 0.0, none, 0.5 * c->T_s},
        {"v_switch", v->v_switch_V, 0.0, none, v->u_dc_V},
        {"v_diode", v->v_diode_V, 0.0, none, v->u_dc_V},
        {"r_on", v->r_on_ohm, 0.0, none, big},
        {"compensation", v->compensation_V, none, none, v->u_dc_V},
        {"compensation's knee", v->compensation_knee_A, 0.0, none, big},
        {"delay cycles", v->delay_cycles, 0.0, none, PLANT_VOLTAGE_DELAY_MAX},
        {"glitch probability", v->glitch_probability, 0.0, none, 1.0},
        {"J", h->J_kgm2, 0.0, inertia ? 0.0 : none, big},
        {"friction", h->friction_Nms, 0.0, none, big},
        {"load torque", h->T_load_Nm, none, none, big},
        {"speed", h->omega_e_start_rad_s, none, none, big},
        {"acceleration", h->accel_e_rad_s2, none, none, big},
        {"initial angle", h->theta_mech_start_rad, none, none, big},
        {"ADC bits", s->current_bits, 0.0, none, 32.0},
        {"ADC full scale", s->current_full_scale_A, 0.0, s->current_bits > 0 ? 0.0 : none, big},
        {"current noise", s->current_noise_A, 0.0, none, big},
        {"late samples", -s->current_lag_s, none, none, 0.45 * c->T_s},
        {"current bandwidth", s->current_bandwidth_Hz, 0.0, none, big},
        {"current gain a", s->current_gain[0], none, none, big},
        {"current gain b", s->current_gain[1], none, none, big},
        {"current gain c", s->current_gain[2], none, none, big},
        {"current offset a", s->current_offset_A[0], none, none, big},
        {"current offset b", s->current_offset_A[1], none, none, big},
        {"current offset c", s->current_offset_A[2], none, none, big},
        {"current gain's rate a", s->current_gain_rate_s[0], none, none, big},
        {"current gain's rate b", s->current_gain_rate_s[1], none, none, big},
        {"current gain's rate c", s->current_gain_rate_s[2], none, none, big},
        {"current offset's rate a", s->current_offset_rate_A_s[0], none, none, big},
        {"current offset's rate b", s->current_offset_rate_A_s[1], none, none, big},
        {"current offset's rate c", s->current_offset_rate_A_s[2], none, none, big},
        {"clock", c->clock_s, none, none, big},
        {"theta_0", s->theta_0_rad, none, none, big},
        {"angle harmonic's order", s->harmonic[0].order, 1.0, none, 1e5},
        {"angle harmonic's amplitude", s->harmonic[0].amplitude_rad, none, none, big},
        {"angle harmonic's phase", s->harmonic[0].phase_rad, none, none, big},
        {"angle harmonic's order", s->harmonic[1].order, 1.0, none, 1e5},
        {"angle harmonic's amplitude", s->harmonic[1].amplitude_rad, none, none, big},
        {"angle harmonic's phase", s->harmonic[1].phase_rad, none, none, big},
        {"angle harmonic's order", s->harmonic[2].order, 1.0, none, 1e5},
        {"angle harmonic's amplitude", s->harmonic[2].amplitude_rad, none, none, big},
        {"angle harmonic's phase", s->harmonic[2].phase_rad, none, none, big},
        {"angle harmonic's order", s->harmonic[3].order, 1.0, none, 1e5},
        {"angle harmonic's amplitude", s->harmonic[3].amplitude_rad, none, none, big},
        {"angle harmonic's phase", s->harmonic[3].phase_rad, none, none, big},
        {"t_delay", s->t_delay_s, none, none, big},
        {"angle noise", s->angle_noise_rad, 0.0, none, big},
        {"speed noise", s->omega_noise_rad_s, 0.0, none, big},
        {"speed lag", s->speed_lag_s, 0.0, none, big},
        {"u_dc noise", s->u_dc_noise_V, 0.0, none, big},
        {"loose channel", s->loose_channel, 0.0, none, 2.0},
        {"faulty phase", s->fault_phase, 0.0, none, 3.0},
        {"loose probability", s->loose_probability, 0.0, none, 1.0},
        {"loose samples", s->loose_samples, 1.0, none, 1e9},
        {"hysteresis", s->hysteresis_A, 0.0, none, big},
        {"crosstalk", s->crosstalk, none, none, 1.0},
        {"hum", s->hum_A, 0.0, none, big},
        {"hum's frequency", s->hum_Hz, 0.0, none, big},
        {"hum's channel", s->hum_channel, 0.0, none, 3.0},
        {"switching noise", s->edge_A, none, none, big},
        {"switching noise's time constant", s->edge_s, 0.0, s->edge_A != 0.0 ? 0.0 : none, big},
        {"switching noise's coupling", s->edge_coupling, none, none, 1.0},
        {"control cycle", c->T_s, 0.0, 0.0, big},
        {"rated current", c->I_scale_A, 0.0, 0.0, big},
    };
    for (size_t k = 0; k < sizeof ranges / sizeof ranges[0]; k++) {
        const range *r = &ranges[k];
        if (!isfinite(r->value) || r->value < r->least || r->value <= r->above || r->value > r->most) {
            const char *bound = r->above >= r->least ? "greater than 0" : "0 or more";
            if (isfinite(r->value) && r->value > r->most) {
                return error_input(e, NULL, 0, 0, "drive: %s is %g, expected at most %g", r->name, r->value,
                                   r->most);
            }
            if (r->least == 1.0) {
                bound = "1 or more";
            } else if (r->least < 0.0 || !isfinite(r->value)) {
                bound = "a finite number";
            }
            return error_input(e, NULL, 0, 0, "drive: %s is %g, expected %s", r->name, r->value, bound);
        }
    }
    if (2.0 * v->delay_cycles != floor(2.0 * v->delay_cycles)) {
        return error_input(e, NULL, 0, 0, "drive: delay cycles is %g, expected a multiple of 0.5",
                           v->delay_cycles);
    }
    if (m->short_phase != floor(m->short_phase)) {
        return error_input(e, NULL, 0, 0, "drive: shorted phase is %g, expected 1, 2 or 3", m->short_phase);
    }
    if (m->short_turns > 0.0 && m->R_fe_ohm > 0.0) {
        return error_input(e, NULL, 0, 0,
                           "drive: shorted turns and an iron loss at once, expected one of them");
    }
    if (s->fault_phase != floor(s->fault_phase)) {
        return error_input(e, NULL, 0, 0, "drive: faulty phase is %g, expected 1, 2 or 3", s->fault_phase);
    }
    return check_time_constant(c, e) && check_map(c, e);
}
