/* The machine's and the shaft's equations (plant_machine.h). */
#include "plant_machine.h"

#include "plant_flux.h"

#include <math.h>

/*
 * dpsi/dtheta, at constant phase current, of the magnet's harmonics: those of order 6 n - 1 are of negative sequence,
 * those of order 6 n + 1 of positive one.
 */
static vec_ab harmonic_emf_per_speed(const plant_machine *m, double theta_e_rad)
{
    const struct {
        double order, psi_Wb, sequence;
    } harmonic[] = {{5.0, m->psi_5_Wb, -1.0},
                    {7.0, m->psi_7_Wb, 1.0},
                    {11.0, m->psi_11_Wb, -1.0},
                    {13.0, m->psi_13_Wb, 1.0}};
    vec_ab v = {0.0, 0.0};
    for (size_t k = 0; k < sizeof harmonic / sizeof *harmonic; k++) {
        if (harmonic[k].psi_Wb != 0.0) {
            const vec_rotor at = rotor_at(harmonic[k].order * theta_e_rad);
            const double rate = harmonic[k].order * harmonic[k].psi_Wb;
            v.alpha -= rate * at.sin;
            v.beta += harmonic[k].sequence * rate * at.cos;
        }
    }
    return v;
}

static bool in_series(const plant_machine *m)
{
    return m->dL_H[0] != 0.0 || m->dL_H[1] != 0.0 || m->dL_H[2] != 0.0;
}

/* The voltage that currents of this rate of change need across the unequal part of the phases' inductances. */
static vec_ab series_voltage(const plant_machine *m, vec_ab rate_A_s)
{
    double u_V[3];
    for (int x = 0; x < 3; x++) {
        u_V[x] = m->dL_H[x] * vec_phase(rate_A_s, x);
    }
    return vec_from_phases(u_V);
}

/*
 * Puts the series inductance M in front of a machine whose current changes by rate u + drift: of u it leaves
 * u - M di/dt, so that di/dt = (1 + rate M)^-1 (rate u + drift).
 */
static void put_in_series(const plant_machine *m, machine_terms *t)
{
    double a[2][2]; /* 1 + rate M */
    for (int k = 0; k < 2; k++) {
        const vec_ab unit = {k == 0 ? 1.0 : 0.0, k == 0 ? 0.0 : 1.0};
        const vec_ab u = series_voltage(m, unit);
        a[0][k] = unit.alpha + t->rate[0][0] * u.alpha + t->rate[0][1] * u.beta;
        a[1][k] = unit.beta + t->rate[1][0] * u.alpha + t->rate[1][1] * u.beta;
    }
    const double determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    const double left[2][2] = {{a[1][1] / determinant, -a[0][1] / determinant},
                               {-a[1][0] / determinant, a[0][0] / determinant}};
    for (int k = 0; k < 2; k++) {
        const double alpha = t->rate[0][k];
        const double beta = t->rate[1][k];
        t->rate[0][k] = left[0][0] * alpha + left[0][1] * beta;
        t->rate[1][k] = left[1][0] * alpha + left[1][1] * beta;
    }
    const vec_ab drift = t->drift_A_s;
    t->drift_A_s.alpha = left[0][0] * drift.alpha + left[0][1] * drift.beta;
    t->drift_A_s.beta = left[1][0] * drift.alpha + left[1][1] * drift.beta;
}

double machine_warmer_K(const plant_machine *m, double clock_s)
{
    return m->heating_K != 0.0 ? m->heating_K * -expm1(-fmax(clock_s, 0.0) / m->heating_s) : 0.0;
}

/* The rate of machine_warmer_K. */
static double warming_K_s(const plant_machine *m, double clock_s)
{
    const bool warms = m->heating_K != 0.0 && clock_s > 0.0;
    return warms ? m->heating_K / m->heating_s * exp(-clock_s / m->heating_s) : 0.0;
}

/*
 * The shorted turns: their current, as it shows at the terminals, is i_fe along the phase's axis. They take part of the phase's
 * voltage and give it to the fault; the drop is that of what magnetises.
 */
static void add_short(const plant_machine *m, double R_ohm, vec_ab i_m, machine_terms *t)
{
    const int x = (int)m->short_phase - 1;
    const vec_ab axis = vec_phase_axis[x];
    const double turns = m->short_turns;
    const double around_ohm = m->short_ohm + turns * R_ohm;
    const double i_f = 1.5 / turns * vec_phase(t->i_fe_A, x);
    /* 2/3 turns di_f/dt, with e_x = axis . (u - drop). */
    t->short_axis = axis;
    t->to_short = 2.0 / 3.0 * turns * turns / (around_ohm * m->short_s);
    const double own = turns * R_ohm * (vec_phase(i_m, x) + vec_phase(t->i_fe_A, x)) - around_ohm * i_f;
    t->short_A_s = 2.0 / 3.0 * turns * own / (around_ohm * m->short_s);
    const double against = vec_phase(t->drop_V, x);
    const double drift = t->short_A_s - t->to_short * against;
    t->rate[0][0] += t->to_short * axis.alpha * axis.alpha;
    t->rate[0][1] += t->to_short * axis.alpha * axis.beta;
    t->rate[1][0] += t->to_short * axis.beta * axis.alpha;
    t->rate[1][1] += t->to_short * axis.beta * axis.beta;
    t->drift_A_s.alpha += drift * axis.alpha;
    t->drift_A_s.beta += drift * axis.beta;
}

/* Loss of the magnet's flux at the rotor's position, and its derivative by the angle. */
static double weakness(const plant_machine *m, double theta_e_rad, double *per_rad)
{
    if (m->weak_pole == 0.0 && m->eccentricity == 0.0) {
        *per_rad = 0.0;
        return 0.0;
    }
    const double pole_pairs = (double)m->pole_pairs;
    const double shaft = theta_e_rad / pole_pairs;
    const double swing = m->eccentricity * cos(shaft);
    const double swing_per_rad = -m->eccentricity * sin(shaft) / pole_pairs;
    const double around =
        remainder(theta_e_rad, VEC_TWO_PI * pole_pairs); /* electrical, 0: over the weak pole pair */
    const bool over_it = fabs(around) < VEC_PI;
    /* Half a cosine squared over the pole pair's turn. */
    *per_rad = (over_it ? -0.5 * m->weak_pole * sin(around) : 0.0) - swing_per_rad;
    return (over_it ? 0.5 * m->weak_pole * (1.0 + cos(around)) : 0.0) - swing;
}

/* di/dt by a voltage in the rotor frame, in the stationary frame. */
static vec_ab current_rate(const plant_flux *f, double determinant, vec_dq u, vec_rotor r)
{
    const vec_dq inverse = {(f->L_qq_H * u.d - f->L_dq_H * u.q) / determinant,
                            (f->L_dd_H * u.q - f->L_dq_H * u.d) / determinant};
    return vec_to_ab(inverse, r);
}

bool machine_has_more_states(const plant_machine *m)
{
    return m->R_fe_ohm > 0.0 || m->short_turns > 0.0 || m->alpha_R != 0.0 || m->alpha_psi != 0.0 ||
           m->R_rate_ohm_s != 0.0 || m->psi_rate_Wb_s != 0.0;
}

void machine_linearise(const plant_config *c, const plant_state *s, machine_terms *t)
{
    const plant_machine *m = &c->machine;
    const double omega = s->y[STATE_OMEGA_E];
    const double clock_s = s->y[STATE_CLOCK];
    const double above_K = machine_warmer_K(m, clock_s) - m->reference_K;
    const double theta = s->y[STATE_THETA_E];
    double lost_per_rad = 0.0;
    const double lost = weakness(m, theta, &lost_per_rad);
    const double psi_f_Wb = m->psi_f_Wb * (1.0 + m->alpha_psi * above_K - lost) + m->psi_rate_Wb_s * clock_s;
    const double weakening_V = m->psi_rate_Wb_s + m->psi_f_Wb * m->alpha_psi * warming_K_s(m, clock_s) -
                               m->psi_f_Wb * lost_per_rad * omega;
    t->r = rotor_at(theta);
    t->i_A = (vec_ab){s->y[STATE_I_ALPHA], s->y[STATE_I_BETA]};
    t->i_fe_A = (vec_ab){s->y[STATE_FE_ALPHA], s->y[STATE_FE_BETA]};
    t->i_dq_A = vec_to_dq(t->i_A, t->r);
    const vec_ab i_m_ab = {t->i_A.alpha - t->i_fe_A.alpha, t->i_A.beta - t->i_fe_A.beta};
    const vec_dq i_m = vec_to_dq(i_m_ab, t->r);

    plant_flux iron;
    plant_flux_at(m, i_m, &iron);
    const vec_dq psi_i = iron.psi_Wb; /* the current's share of the flux */
    const double L_dd = iron.L_dd_H;
    const double L_dq = iron.L_dq_H;
    const double L_qq = iron.L_qq_H;
    const double determinant = L_dd * L_qq - L_dq * L_dq;

    /* dpsi/dtheta at constant phase current: the flux turns with the rotor, the current in its frame back. */
    const vec_dq turn = {-psi_i.q + L_dd * i_m.q - L_dq * i_m.d,
                         psi_i.d + psi_f_Wb + L_dq * i_m.q - L_qq * i_m.d};
    const vec_ab harmonic = harmonic_emf_per_speed(m, theta);
    vec_ab emf = vec_to_ab(turn, t->r);
    /* A magnet that weakens induces along its own axis. */
    emf.alpha = omega * (emf.alpha + harmonic.alpha) + weakening_V * t->r.cos;
    emf.beta = omega * (emf.beta + harmonic.beta) + weakening_V * t->r.sin;

    /* The inverse of the differential inductance, turned into the stationary frame column by column. */
    const vec_ab from_alpha = current_rate(&iron, determinant, (vec_dq){t->r.cos, -t->r.sin}, t->r);
    const vec_ab from_beta = current_rate(&iron, determinant, (vec_dq){t->r.sin, t->r.cos}, t->r);
    t->rate[0][0] = from_alpha.alpha;
    t->rate[0][1] = from_beta.alpha;
    t->rate[1][0] = from_alpha.beta;
    t->rate[1][1] = from_beta.beta;

    const double R =
        fmax(m->R_ohm * (1.0 + m->alpha_R * above_K) + m->R_rate_ohm_s * clock_s, 0.0) + c->inverter.r_on_ohm;
    double drop[3];
    const vec_ab through_A = m->short_turns > 0.0 ? i_m_ab : t->i_A;
    for (int x = 0; x < 3; x++) {
        drop[x] = (R + m->dR_ohm[x]) * vec_phase(through_A, x);
    }
    t->drop_V = vec_from_phases(drop);
    const double against_alpha = t->drop_V.alpha + emf.alpha;
    const double against_beta = t->drop_V.beta + emf.beta;
    t->drift_A_s.alpha = -(t->rate[0][0] * against_alpha + t->rate[0][1] * against_beta);
    t->drift_A_s.beta = -(t->rate[1][0] * against_alpha + t->rate[1][1] * against_beta);

    t->to_iron[0] = 0.0;
    t->to_iron[1] = 0.0;
    t->to_short = t->short_A_s = 0.0;
    t->short_axis = (vec_ab){0.0, 0.0};
    if (m->short_turns > 0.0) {
        add_short(m, R, i_m_ab, t);
    }
    if (m->R_fe_ohm > 0.0) {
        t->to_iron[0] = 1.0 / (m->tau_fe_s * m->R_fe_ohm);
        t->to_iron[1] = 1.0 / m->tau_fe_s;
        t->rate[0][0] += t->to_iron[0];
        t->rate[1][1] += t->to_iron[0];
        t->drift_A_s.alpha -= t->to_iron[0] * t->drop_V.alpha + t->to_iron[1] * t->i_fe_A.alpha;
        t->drift_A_s.beta -= t->to_iron[0] * t->drop_V.beta + t->to_iron[1] * t->i_fe_A.beta;
    }

    if (in_series(m)) {
        put_in_series(m, t);
    }

    const double reluctance_and_magnet = (psi_i.d + psi_f_Wb) * i_m.q - psi_i.q * i_m.d;
    const double harmonics = harmonic.alpha * i_m_ab.alpha + harmonic.beta * i_m_ab.beta;
    t->torque_Nm = 1.5 * m->pole_pairs * (reluctance_and_magnet + harmonics);
}

static double acceleration(const plant_config *c, double omega_e_rad_s, double torque_Nm)
{
    const plant_shaft *shaft = &c->shaft;
    if (shaft->mode == PLANT_SHAFT_GIVEN) {
        return shaft->accel_e_rad_s2;
    }
    const double pole_pairs = c->machine.pole_pairs;
    const double friction_Nm = shaft->friction_Nms * omega_e_rad_s / pole_pairs;
    return pole_pairs * (torque_Nm - shaft->T_load_Nm - friction_Nm) / shaft->J_kgm2;
}

static void add_iron_rates(const plant_config *c, const machine_terms *t, vec_ab u_V,
                           double rate[STATE_COUNT])
{
    vec_ab e_V = {u_V.alpha - t->drop_V.alpha, u_V.beta - t->drop_V.beta};
    if (in_series(&c->machine)) {
        const vec_ab rate_A_s = {rate[STATE_I_ALPHA], rate[STATE_I_BETA]};
        const vec_ab series_V = series_voltage(&c->machine, rate_A_s);
        e_V.alpha -= series_V.alpha;
        e_V.beta -= series_V.beta;
    }
    const double short_A_s =
        t->to_short * (t->short_axis.alpha * e_V.alpha + t->short_axis.beta * e_V.beta) + t->short_A_s;
    rate[STATE_FE_ALPHA] =
        t->to_iron[0] * e_V.alpha - t->to_iron[1] * t->i_fe_A.alpha + short_A_s * t->short_axis.alpha;
    rate[STATE_FE_BETA] =
        t->to_iron[0] * e_V.beta - t->to_iron[1] * t->i_fe_A.beta + short_A_s * t->short_axis.beta;
}

void machine_rates(const plant_config *c, const plant_state *s, const machine_terms *t, vec_ab u_V,
                   double rate[STATE_COUNT])
{
    rate[STATE_I_ALPHA] = t->rate[0][0] * u_V.alpha + t->rate[0][1] * u_V.beta + t->drift_A_s.alpha;
    rate[STATE_I_BETA] = t->rate[1][0] * u_V.alpha + t->rate[1][1] * u_V.beta + t->drift_A_s.beta;
    rate[STATE_FE_ALPHA] = rate[STATE_FE_BETA] = 0.0;
    if (t->to_iron[1] != 0.0 || t->to_short != 0.0) {
        add_iron_rates(c, t, u_V, rate);
    }
    rate[STATE_THETA_E] = s->y[STATE_OMEGA_E];
    rate[STATE_OMEGA_E] = acceleration(c, s->y[STATE_OMEGA_E], t->torque_Nm);
    rate[STATE_CLOCK] = 1.0;
    rate[STATE_INT_I_ALPHA] = t->i_A.alpha;
    rate[STATE_INT_I_BETA] = t->i_A.beta;
    rate[STATE_INT_I_D] = t->i_dq_A.d;
    rate[STATE_INT_I_Q] = t->i_dq_A.q;
    rate[STATE_INT_U_ALPHA] = u_V.alpha;
    rate[STATE_INT_U_BETA] = u_V.beta;
}
