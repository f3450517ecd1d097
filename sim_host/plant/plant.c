/* The drive's time: cycles, edges, samples and means (plant.h). */
#include "plant.h"
#include "plant_electrical.h"
#include "plant_flux.h"
#include "plant_solver.h"

#include <math.h>
#include <string.h>

enum { STREAM_GLITCH = 16 };

/* Is everything linear with constant coefficients between edges? */
static bool is_linear(const plant_config *c)
{
    const plant_machine *m = &c->machine;
    const plant_inverter *v = &c->inverter;
    const bool equal_phases = m->dR_ohm[0] == 0.0 && m->dR_ohm[1] == 0.0 && m->dR_ohm[2] == 0.0 &&
                              m->dL_H[0] == 0.0 && m->dL_H[1] == 0.0 && m->dL_H[2] == 0.0;
    const bool steady =
        m->R_rate_ohm_s == 0.0 && m->psi_rate_Wb_s == 0.0 && m->alpha_R == 0.0 && m->alpha_psi == 0.0;
    const bool plain_machine = steady && equal_phases && m->I_sat_A == 0.0 && !plant_flux_has_map(m) &&
                               m->R_fe_ohm == 0.0 && m->short_turns == 0.0 && m->weak_pole == 0.0 &&
                               m->eccentricity == 0.0 && m->psi_5_Wb == 0.0 && m->psi_7_Wb == 0.0 &&
                               m->psi_11_Wb == 0.0 && m->psi_13_Wb == 0.0;
    const bool ideal_legs =
        v->t_dead_s == 0.0 && v->v_switch_V == 0.0 && v->v_diode_V == 0.0 && !inverter_link_swings(v);
    const bool constant_speed = c->shaft.mode == PLANT_SHAFT_GIVEN && c->shaft.accel_e_rad_s2 == 0.0;
    return plain_machine && ideal_legs && constant_speed;
}

void plant_init(plant *p, const plant_config *c)
{
    memset(p, 0, sizeof *p);
    p->config = *c;
    (void)plant_flux_find_reach(&p->config.machine, c->I_scale_A);
    p->linear = is_linear(c);
    p->state.y[STATE_THETA_E] = c->shaft.theta_mech_start_rad * c->machine.pole_pairs;
    p->state.y[STATE_OMEGA_E] = c->shaft.omega_e_start_rad_s;
    p->state.y[STATE_CLOCK] = c->clock_s;
    for (int x = 0; x < 3; x++) {
        p->leg[x].rise_s = INFINITY;
        p->leg[x].fall_s = INFINITY;
    }
    sensor_init(&p->sensors, c->seed);
    plant_random_seed(&p->glitch_random, c->seed, STREAM_GLITCH);
}

void plant_set_current(plant *p, vec_dq i_dq_A)
{
    const vec_ab i = vec_to_ab(i_dq_A, rotor_at(p->state.y[STATE_THETA_E]));
    p->state.y[STATE_I_ALPHA] = i.alpha;
    p->state.y[STATE_I_BETA] = i.beta;
    p->state.seen_A = i;
}

void plant_set_config(plant *p, const plant_config *c)
{
    p->config = *c;
    (void)plant_flux_find_reach(&p->config.machine, c->I_scale_A);
    p->linear = is_linear(c);
}

void plant_set_speed(plant *p, double omega_e_rad_s, double accel_e_rad_s2)
{
    p->state.y[STATE_OMEGA_E] = omega_e_rad_s;
    p->config.shaft.accel_e_rad_s2 = accel_e_rad_s2;
    p->linear = is_linear(&p->config);
}

void plant_set_load(plant *p, double T_load_Nm)
{
    p->config.shaft.T_load_Nm = T_load_Nm;
}

static void trace_point(plant *p)
{
    if (p->trace != NULL) {
        const plant_point point = plant_now(p);
        p->trace(p->trace_context, &point);
    }
}

/* Finishes the running cycle, and resets time and integrals. */
static void begin(plant *p, double duration_s)
{
    plant_advance_to(p, p->duration_s);
    for (int x = 0; x < 3; x++) {
        leg_rebase(&p->leg[x], p->duration_s);
    }
    p->t_begin_s += p->duration_s;
    p->t_cycle_s = 0.0;
    p->duration_s = duration_s;
    double *y = p->state.y;
    for (int n = STATE_CONTROLLED; n < STATE_COUNT; n++) {
        y[n] = 0.0;
    }
    const double revolution = 2.0 * VEC_PI * p->config.machine.pole_pairs;
    if (y[STATE_THETA_E] < 0.0 || y[STATE_THETA_E] >= revolution) {
        y[STATE_THETA_E] -= revolution * floor(y[STATE_THETA_E] / revolution);
    }
}

/* What acts from this valley on, given what is commanded now: perhaps late, perhaps missed. */
static void take_duties(plant *p, const double duty[3])
{
    const plant_inverter *v = &p->config.inverter;
    const bool first = !p->duties_seen;
    p->duties_seen = true;
    const int whole = (int)v->delay_cycles;
    for (int n = 0; n < whole; n++) {
        memcpy(p->duty_queue[n], first ? duty : p->duty_queue[n + 1], sizeof p->duty_queue[n]);
    }
    memcpy(p->duty_queue[whole], duty, sizeof p->duty_queue[0]);
    memcpy(p->duty_to_peak, first ? duty : p->duty_in_force, sizeof p->duty_to_peak);
    p->glitched =
        v->glitch_probability > 0.0 && plant_random_uniform(&p->glitch_random) < v->glitch_probability;
    if (p->glitched && !first) {
        p->glitches++;
    } else {
        memcpy(p->duty_in_force, p->duty_queue[0], sizeof p->duty_in_force);
    }
    if (v->delay_cycles == (double)whole) {
        memcpy(p->duty_to_peak, p->duty_in_force, sizeof p->duty_to_peak);
    }
}

/* What the gate signals have against dead time and drops: a voltage along each phase current, as it is at the valley. */
static void compensate(plant *p)
{
    const plant_inverter *v = &p->config.inverter;
    const vec_ab i = {p->state.y[STATE_I_ALPHA], p->state.y[STATE_I_BETA]};
    for (int x = 0; x < 3 && v->compensation_V != 0.0; x++) {
        const double i_A = vec_phase(i, x);
        const double sat =
            fabs(i_A) < v->compensation_knee_A ? i_A / v->compensation_knee_A : copysign(1.0, i_A);
        const double more = sat * v->compensation_V / v->u_dc_V;
        p->duty_to_gate[0][x] += more;
        p->duty_to_gate[1][x] += more;
    }
}

void plant_begin_cycle(plant *p, const double duty[3])
{
    begin(p, p->config.T_s);
    take_duties(p, duty);
    memcpy(p->duty_to_gate[0], p->duty_to_peak, sizeof p->duty_to_gate[0]);
    memcpy(p->duty_to_gate[1], p->duty_in_force, sizeof p->duty_to_gate[1]);
    compensate(p);
    for (int x = 0; x < 3; x++) {
        leg_begin_cycle(&p->leg[x], p->duty_to_gate[0][x], p->duty_to_gate[1][x], p->duration_s,
                        p->config.inverter.t_dead_s);
    }
}

void plant_begin_half(plant *p, const double duty[3], bool to_peak)
{
    begin(p, p->config.T_s);
    take_duties(p, duty);
    for (int x = 0; x < 3; x++) {
        leg_begin_half(&p->leg[x], p->duty_in_force[x], to_peak, p->duration_s, p->config.inverter.t_dead_s);
    }
}

void plant_begin_interval(plant *p, const bool high[3], double duration_s)
{
    begin(p, duration_s);
    for (int x = 0; x < 3; x++) {
        leg_command(&p->leg[x], high[x], 0.0, p->config.inverter.t_dead_s);
    }
}

void plant_switch(plant *p, int x)
{
    leg_command(&p->leg[x], !p->leg[x].high, p->t_cycle_s, p->config.inverter.t_dead_s);
}

static vec_ab ideal_voltage(const plant *p)
{
    const double u_dc_V = p->config.inverter.k_u * p->config.inverter.u_dc_V;
    double u_leg[3];
    for (int x = 0; x < 3; x++) {
        u_leg[x] = p->leg[x].high ? u_dc_V : 0.0;
    }
    return vec_from_phases(u_leg);
}

/* The exact path: one span between edges. *r is the rotor's angle before and after. */
static void advance_linear(plant *p, double dt_s, vec_rotor *r)
{
    const plant_machine *m = &p->config.machine;
    double *y = p->state.y;
    const electrical_linear machine = {.R_ohm = m->R_ohm + p->config.inverter.r_on_ohm,
                                       .L_d_H = m->L_d_H,
                                       .L_q_H = m->L_q_H,
                                       .psi_f_Wb = m->psi_f_Wb,
                                       .omega_e_rad_s = y[STATE_OMEGA_E]};
    const vec_ab u = ideal_voltage(p);
    const vec_ab i = {y[STATE_I_ALPHA], y[STATE_I_BETA]};
    const vec_rotor start = *r;
    electrical_state x = {vec_to_dq(i, start), {y[STATE_INT_I_D], y[STATE_INT_I_Q]}, {0.0, 0.0}};
    const double bandwidth_rad_s = plant_current_filter(&p->config.sensors);
    if (bandwidth_rad_s > 0.0) {
        const vec_dq before = vec_to_dq(p->state.seen_A, start);
        vec_ab seen = {before.d, before.q};
        electrical_advance_seen(&machine, dt_s, vec_to_dq(u, start), &x, bandwidth_rad_s, &seen);
        p->state.seen_A = vec_to_ab((vec_dq){seen.alpha, seen.beta}, start);
    } else {
        electrical_advance(&machine, dt_s, vec_to_dq(u, start), &x);
    }
    y[STATE_THETA_E] += y[STATE_OMEGA_E] * dt_s;
    y[STATE_CLOCK] += dt_s;
    *r = rotor_at(y[STATE_THETA_E]);
    const vec_ab i_end = vec_to_ab(x.i_dq_A, *r);
    const vec_dq integral_start = {x.integral_start_As.alpha, x.integral_start_As.beta};
    const vec_ab integral = vec_to_ab(integral_start, start);
    y[STATE_I_ALPHA] = i_end.alpha;
    y[STATE_I_BETA] = i_end.beta;
    y[STATE_INT_I_D] = x.integral_dq_As.d;
    y[STATE_INT_I_Q] = x.integral_dq_As.q;
    y[STATE_INT_I_ALPHA] += integral.alpha;
    y[STATE_INT_I_BETA] += integral.beta;
    y[STATE_INT_U_ALPHA] += u.alpha * dt_s;
    y[STATE_INT_U_BETA] += u.beta * dt_s;
}

void plant_advance_to(plant *p, double t_s)
{
    const double target = fmin(t_s, p->duration_s);
    const double t_dead_s = p->config.inverter.t_dead_s;
    vec_rotor r = rotor_at(p->state.y[STATE_THETA_E]);
    while (p->t_cycle_s < target) {
        double next = target;
        for (int x = 0; x < 3; x++) {
            leg_pass(&p->leg[x], p->t_cycle_s, t_dead_s);
            next = fmin(next, leg_next_change(&p->leg[x], p->t_cycle_s));
        }
        if (p->trace != NULL && p->trace_step_s > 0.0) {
            next = fmin(next, p->t_cycle_s + p->trace_step_s);
        }
        p->t_span_s = p->t_cycle_s;
        trace_point(p);
        if (p->linear) {
            advance_linear(p, next - p->t_cycle_s, &r);
        } else {
            solver_advance(&p->config, p->leg, p->t_begin_s, p->t_cycle_s, next, &p->state);
        }
        p->t_cycle_s = next;
        trace_point(p);
    }
}

/* The current that the converter gets: behind its low-pass, or that of a while later, which a copy goes ahead for. */
static vec_ab seen_current(const plant *p)
{
    const plant_sensors *s = &p->config.sensors;
    const double late_s = fmax(-s->current_lag_s, 0.0);
    const plant_state *state = &p->state;
    plant ahead;
    if (late_s > 0.0) {
        ahead = *p;
        ahead.trace = NULL;
        plant_advance_to(&ahead, p->t_cycle_s + late_s);
        state = &ahead.state;
    }
    return plant_current_filter(s) > 0.0 ? state->seen_A
                                         : (vec_ab){state->y[STATE_I_ALPHA], state->y[STATE_I_BETA]};
}

void plant_sample(plant *p, plant_samples *s)
{
    const double *y = p->state.y;
    const vec_ab i = seen_current(p);
    const bool given = p->config.shaft.mode == PLANT_SHAFT_GIVEN;
    sensor_truth truth = {.t_s = p->t_begin_s + p->t_cycle_s,
                          .clock_s = y[STATE_CLOCK],
                          .theta_mech_rad = y[STATE_THETA_E] / p->config.machine.pole_pairs,
                          .omega_e_rad_s = y[STATE_OMEGA_E],
                          .accel_e_rad_s2 = given ? p->config.shaft.accel_e_rad_s2 : 0.0};
    for (int x = 0; x < 3; x++) {
        truth.i_A[x] = vec_phase(i, x);
        truth.edge_age_s[x] = p->leg[x].edged ? p->t_cycle_s - p->leg[x].edge_s : INFINITY;
        truth.edge_sign[x] = p->leg[x].high ? 1.0 : -1.0;
    }
    truth.u_dc_V = inverter_logged_link(&p->config.inverter, truth.t_s);
    sensor_read(&p->config, &p->sensors, &truth, s);
}

plant_means plant_mean(const plant *p)
{
    const double *y = p->state.y;
    plant_means m = {.duration_s = p->t_cycle_s};
    const double per_s = p->t_cycle_s > 0.0 ? 1.0 / p->t_cycle_s : 0.0;
    m.i_ab_A = (vec_ab){y[STATE_INT_I_ALPHA] * per_s, y[STATE_INT_I_BETA] * per_s};
    m.i_dq_A = (vec_dq){y[STATE_INT_I_D] * per_s, y[STATE_INT_I_Q] * per_s};
    const double r_on = p->config.inverter.r_on_ohm;
    m.u_ab_V = (vec_ab){y[STATE_INT_U_ALPHA] * per_s - r_on * m.i_ab_A.alpha,
                        y[STATE_INT_U_BETA] * per_s - r_on * m.i_ab_A.beta};
    for (int x = 0; x < 3; x++) {
        m.i_A[x] = vec_phase(m.i_ab_A, x);
        m.u_V[x] = vec_phase(m.u_ab_V, x);
    }
    return m;
}

plant_point plant_now(const plant *p)
{
    /* Copies: to look must not change what conducts. */
    plant_state state = p->state;
    inverter_leg leg[3];
    memcpy(leg, p->leg, sizeof leg);
    machine_terms t;
    machine_linearise(&p->config, &state, &t);
    plant_point point = {.t_s = p->t_begin_s + p->t_cycle_s,
                         .theta_e_rad = state.y[STATE_THETA_E],
                         .omega_e_rad_s = state.y[STATE_OMEGA_E],
                         .i_dq_A = t.i_dq_A,
                         .torque_Nm = t.torque_Nm};
    conduction k = {.leg = leg};
    for (int x = 0; x < 3; x++) {
        k.off[x] = leg_off(&leg[x], p->t_span_s);
    }
    conduction_bounds(&k, &p->config.inverter, point.t_s);
    (void)conduction_settle(&k, &t, SOLVER_ZERO_CURRENT * p->config.I_scale_A, &state);
    const vec_ab u = conduction_voltage(&k, &t);
    for (int x = 0; x < 3; x++) {
        point.i_A[x] = vec_phase(t.i_A, x);
        point.u_V[x] = vec_phase(u, x) - p->config.inverter.r_on_ohm * point.i_A[x];
    }
    return point;
}

void plant_cycle(plant *p, const double duty[3], plant_samples *valley, plant_samples *peak,
                 plant_means *means)
{
    plant_begin_cycle(p, duty);
    if (valley != NULL) {
        plant_sample(p, valley);
    }
    plant_advance_to(p, 0.5 * p->config.T_s);
    if (peak != NULL) {
        plant_sample(p, peak);
    }
    plant_advance_to(p, p->config.T_s);
    if (means != NULL) {
        *means = plant_mean(p);
    }
}
