#include "averaged_drive.h"

#include <math.h>

/* v turned by the angle whose cosine and sine are c and s. */
static vec_ab turn(vec_ab v, double c, double s)
{
    return (vec_ab){v.alpha * c - v.beta * s, v.alpha * s + v.beta * c};
}

static double saturated(double x)
{
    return x > 1.0 ? 1.0 : (x < -1.0 ? -1.0 : x);
}

/*
 * After a leg is switched off the current must charge its devices' capacitance before the voltage has
 * changed: with knee = 2 C u_dc / t_dead the edge loses 1 - knee / (2 |i|) of its dead time, and below the
 * knee, where the charge is never complete, |i| / (2 knee).
 */
static double charged(double x)
{
    double size = fabs(x);
    return size < 1.0 ? 0.5 * x : (x > 0.0 ? 1.0 : -1.0) * (1.0 - 0.5 / size);
}

double averaged_drive_edge(edge_law law, double x)
{
    return law == EDGE_CHARGED ? charged(x) : saturated(x);
}

/* Flux of a current in the rotor frame, without the magnet's. */
static vec_ab flux_of(const averaged_drive *d, vec_ab i)
{
    double square = i.alpha * i.alpha + i.beta * i.beta;
    double fall = 1.0 / (1.0 + d->saturation * square);
    double fall_q = d->saturation_q == 0.0 ? fall : 1.0 / (1.0 + (d->saturation + d->saturation_q) * square);
    return (vec_ab){d->L_d_H * i.alpha * fall, d->L_q_H * i.beta * fall_q};
}

/*
 * The current that carries a flux, by fixed-point iteration with the guess at hand. The law i = x (1 + s
 * |i|^2) / L contracts while s |i|^2 < 1/3 or so; beyond |i| = I_sat the flux of interfaces.md's law falls
 * again and has no unique current, so the iteration is bounded and the last value stands.
 */
static vec_ab current_of(const averaged_drive *d, vec_ab flux, vec_ab guess)
{
    vec_ab i = guess;
    if (d->saturation == 0.0 && d->saturation_q == 0.0) {
        return (vec_ab){flux.alpha / d->L_d_H, flux.beta / d->L_q_H};
    }
    for (int k = 0; k < 8; k++) {
        vec_ab wrong = flux_of(d, i);
        wrong.alpha = flux.alpha - wrong.alpha;
        wrong.beta = flux.beta - wrong.beta;
        /* Newton with the radial part of the inductance: dx/d|i| = L (1 - s i^2) / (1 + s i^2)^2 along the
         * current. */
        double square = i.alpha * i.alpha + i.beta * i.beta;
        double s = d->saturation;
        double fall = 1.0 / (1.0 + s * square);
        double down = 2.0 * s * fall * fall;
        double m11 = d->L_d_H * (fall - down * i.alpha * i.alpha);
        double m12 = -d->L_d_H * down * i.alpha * i.beta;
        double m21 = -d->L_q_H * down * i.alpha * i.beta;
        double m22 = d->L_q_H * (fall - down * i.beta * i.beta);
        double det = m11 * m22 - m12 * m21;
        if (!(det >
              0.05 * d->L_d_H * d->L_q_H)) { /* close to the law's turning point: step as if unsaturated */
            m11 = d->L_d_H;
            m22 = d->L_q_H;
            m12 = m21 = 0.0;
            det = m11 * m22;
        }
        double da = (m22 * wrong.alpha - m12 * wrong.beta) / det;
        double db = (m11 * wrong.beta - m21 * wrong.alpha) / det;
        i.alpha += da;
        i.beta += db;
        if (fabs(da) + fabs(db) <
            1e-6 * (fabs(i.alpha) + fabs(i.beta)) + 1e-12) { /* the next step would be its square */
            break;
        }
    }
    return i;
}

/* Magnet flux harmonics as a stationary vector: the 5th and 11th run backwards, the 7th and 13th forwards. */
static vec_ab harmonic_flux(const averaged_drive *d, double c, double s)
{
    vec_ab one = {c, s};
    vec_ab two = turn(one, c, s);
    vec_ab four = turn(two, two.alpha, two.beta);
    vec_ab five = turn(four, c, s);
    vec_ab seven = turn(five, two.alpha, two.beta);
    vec_ab flux = {d->psi_5_Wb * five.alpha + d->psi_7_Wb * seven.alpha,
                   -d->psi_5_Wb * five.beta + d->psi_7_Wb * seven.beta};
    if (d->psi_11_Wb != 0.0 || d->psi_13_Wb != 0.0) {
        vec_ab eleven = turn(seven, four.alpha, four.beta);
        vec_ab thirteen = turn(eleven, two.alpha, two.beta);
        flux.alpha += d->psi_11_Wb * eleven.alpha + d->psi_13_Wb * thirteen.alpha;
        flux.beta += -d->psi_11_Wb * eleven.beta + d->psi_13_Wb * thirteen.beta;
    }
    return flux;
}

/* How far the recorded angle lies ahead of the true one. */
static double angle_error(const averaged_drive *d, const cycle_row *row)
{
    double c2 = row->cos_mech * row->cos_mech - row->sin_mech * row->sin_mech;
    double s2 = 2.0 * row->cos_mech * row->sin_mech;
    return d->theta_0_rad + d->t_delay_s * row->omega_rad_s + d->harmonic_cos_rad[0] * row->cos_mech +
           d->harmonic_sin_rad[0] * row->sin_mech + d->harmonic_cos_rad[1] * c2 + d->harmonic_sin_rad[1] * s2;
}

/*
 * Voltage lost in a cycle, stationary frame. A leg's dead time delays its rising edge if the current then
 * flows out, its falling edge if it flows in; each edge is half of v_dead. Between the two the current
 * differs by its ripple, which the duties tell: a clipped law of the mean current alone would take the
 * ripple's width for a knee and pass the rest on to the resistance. The unequal part of the resistances sees
 * the mean current.
 */
static vec_ab phase_losses(const averaged_drive *d, const cycle_row *row, vec_ab i_start, vec_ab i_end,
                           double cos_2, double sin_2, double T_s)
{
    double first[3];
    double last[3];
    double lost[3];
    vec_to_phases(i_start, first);
    vec_to_phases(i_end, last);
    double per_knee = 1.0 / d->i_knee_A;
    /* 1/L in the stationary frame: a mean, and a part that turns with twice the angle. */
    double even = d->edge_ripple * 0.5 * (1.0 / d->L_d_H + 1.0 / d->L_q_H);
    double odd = d->edge_ripple * 0.5 * (1.0 / d->L_d_H - 1.0 / d->L_q_H);
    /* The drop lowers the end current, and with it its own mid-cycle value: a leg sees 2/3 of its loss, half
     * of that by mid-cycle. */
    double third = T_s / 3.0 * 0.5 * (1.0 / d->L_d_H + 1.0 / d->L_q_H);
    for (size_t x = 0; x < 3; x++) {
        double mid = 0.5 * (first[x] + last[x]);
        vec_ab flux = row->edge_ripple_Wb[x];
        double i_ripple[3];
        vec_to_phases((vec_ab){(even + odd * cos_2) * flux.alpha + odd * sin_2 * flux.beta,
                               odd * sin_2 * flux.alpha + (even - odd * cos_2) * flux.beta},
                      i_ripple);
        double apart = i_ripple[x] - (0.5 - row->rise[x]) * (last[x] - first[x]);
        lost[x] = 0.5 * d->v_dead_V *
                      (averaged_drive_edge(d->edge, (mid + apart) * per_knee) +
                       averaged_drive_edge(d->edge, (mid - apart) * per_knee)) +
                  d->dR_ohm[x] * mid / (1.0 + d->dR_ohm[x] * third);
    }
    return vec_from_phases(lost);
}

/* Flux that is induced evenly over the cycle decays on average for half a cycle: e^{-a T/2}, from det decay =
 * e^{-2 a T}. */
static double half_decay(const averaged_step *m)
{
    return sqrt(sqrt(m->decay[0][0] * m->decay[1][1] - m->decay[0][1] * m->decay[1][0]));
}

/* Flux linkage of the unequal part of the phases' inductances. */
static vec_ab phase_flux(const averaged_drive *d, vec_ab i)
{
    double flux[3];
    vec_to_phases(i, flux);
    for (size_t x = 0; x < 3; x++) {
        flux[x] *= d->dL_H[x];
    }
    return vec_from_phases(flux);
}

/*
 * What that part takes of the flux left for the rest by the end of a cycle, whose current without it would have
 * changed by `free`. With M its matrix, of whose flux `half` has not decayed by then, and K the inverse inductance,
 * all stationary, the change x that is left solves (1 + half K M) x = free, and half M x is what it takes.
 */
static vec_ab phase_share(const averaged_drive *d, vec_ab free, double half, double cos_2, double sin_2)
{
    const double even = half * 0.5 * (1.0 / d->L_d_H + 1.0 / d->L_q_H);
    const double odd = half * 0.5 * (1.0 / d->L_d_H - 1.0 / d->L_q_H);
    const vec_ab one = phase_flux(d, (vec_ab){1.0, 0.0});
    const vec_ab two = phase_flux(d, (vec_ab){0.0, 1.0});
    const double k11 = even + odd * cos_2;
    const double k12 = odd * sin_2;
    const double k22 = even - odd * cos_2;
    const double a11 = 1.0 + k11 * one.alpha + k12 * one.beta;
    const double a12 = k11 * two.alpha + k12 * two.beta;
    const double a21 = k12 * one.alpha + k22 * one.beta;
    const double a22 = 1.0 + k12 * two.alpha + k22 * two.beta;
    const double det = a11 * a22 - a12 * a21;
    const vec_ab change = {(a22 * free.alpha - a12 * free.beta) / det,
                           (a11 * free.beta - a21 * free.alpha) / det};
    const vec_ab flux = phase_flux(d, change);
    return (vec_ab){half * flux.alpha, half * flux.beta};
}

/* The iron's current by the flux that turns through it, late by a short time: (1 - j omega tau) j omega psi
 * G, rotor frame. */
static vec_ab iron_share(const averaged_drive *d, double omega_rad_s, vec_ab flux)
{
    double along = d->iron_s_S * omega_rad_s * omega_rad_s;
    double across = d->iron_S * omega_rad_s;
    return (vec_ab){along * flux.alpha - across * flux.beta, along * flux.beta + across * flux.alpha};
}

/* The eddy current beside the current i, from the last cycle's voltage u[0] and the one's before it. */
static vec_ab eddy_current(const averaged_drive *d, const vec_ab *u, vec_ab i)
{
    double drop = (d->eddy_S[0] + d->eddy_S[1]) * d->R_ohm;
    return (vec_ab){d->k_u * (d->eddy_S[0] * u[0].alpha + d->eddy_S[1] * u[1].alpha) - drop * i.alpha,
                    d->k_u * (d->eddy_S[0] * u[0].beta + d->eddy_S[1] * u[1].beta) - drop * i.beta};
}

vec_ab averaged_drive_advance(const averaged_drive *d, const averaged_node *nodes, const cycle_row *row,
                              vec_ab i_true)
{
    averaged_step m = averaged_node_step(&nodes[row->node], row->node_h);
    double c = row->cos_theta;
    double s = row->sin_theta;
    double ahead = angle_error(d, row);
    if (ahead != 0.0) {
        vec_ab true_angle = turn((vec_ab){c, s}, cos(ahead), -sin(ahead));
        c = true_angle.alpha;
        s = true_angle.beta;
    }
    vec_ab end = turn((vec_ab){c, s}, row->cos_turn, row->sin_turn);

    double now = 1.0 - d->u_delay[0] - d->u_delay[1];
    vec_ab u = {d->k_u * (now * row->u_V[0].alpha + d->u_delay[0] * row->u_V[1].alpha +
                          d->u_delay[1] * row->u_V[2].alpha),
                d->k_u * (now * row->u_V[0].beta + d->u_delay[0] * row->u_V[1].beta +
                          d->u_delay[1] * row->u_V[2].beta)};
    const vec_ab total_dq = turn(i_true, c, -s); /* what flows through the winding's resistance */
    if (d->eddy_S[0] != 0.0 || d->eddy_S[1] != 0.0) {
        /* What flows in the iron follows the flux's change over the last cycles, whose mean the voltage less
         * the drop is. */
        vec_ab eddy = eddy_current(d, row->u_V + 1, i_true);
        i_true.alpha -= eddy.alpha;
        i_true.beta -= eddy.beta;
    }
    vec_ab u_dq = turn(u, c, -s);
    vec_ab i_dq = turn(i_true, c, -s);
    double psi = d->psi_f_Wb + d->psi_temperature * row->temperature_K;
    bool iron = d->iron_S != 0.0 || d->iron_s_S != 0.0;
    if (iron) {
        /* The current that makes flux is what the iron leaves. */
        vec_ab flux = flux_of(d, i_dq);
        vec_ab taken = iron_share(d, row->omega_rad_s, (vec_ab){flux.alpha + psi, flux.beta});
        i_dq.alpha -= taken.alpha;
        i_dq.beta -= taken.beta;
    }
    vec_ab x = flux_of(d, i_dq);

    /* Constant forcing in the rotor frame: the magnet, and the drop over R that the linear matrices do not
     * know. */
    vec_ab push = {-d->R_ohm * (total_dq.alpha - x.alpha / d->L_d_H),
                   -d->R_ohm * (total_dq.beta - x.beta / d->L_q_H)};
    push.beta -= row->omega_rad_s * psi;
    if (d->R_temperature != 0.0) {
        push.alpha -= d->R_temperature * row->temperature_K * i_dq.alpha;
        push.beta -= d->R_temperature * row->temperature_K * i_dq.beta;
    }
    vec_ab y = {m.decay[0][0] * x.alpha + m.decay[0][1] * x.beta + m.drive[0][0] * u_dq.alpha +
                    m.drive[0][1] * u_dq.beta + m.push[0][0] * push.alpha + m.push[0][1] * push.beta,
                m.decay[1][0] * x.alpha + m.decay[1][1] * x.beta + m.drive[1][0] * u_dq.alpha +
                    m.drive[1][1] * u_dq.beta + m.push[1][0] * push.alpha + m.push[1][1] * push.beta};
    if (d->v_dead_V != 0.0 || d->dR_ohm[0] != 0.0 || d->dR_ohm[1] != 0.0 || d->dR_ohm[2] != 0.0) {
        /* The current of this cycle as if nothing were lost, in the stationary frame. */
        vec_ab i_end = turn(current_of(d, y, i_dq), end.alpha, end.beta);
        vec_ab i_start = turn(i_dq, c, s);
        vec_ab lost =
            turn(phase_losses(d, row, i_start, i_end, c * c - s * s, 2.0 * c * s, m.push[0][0]), c, -s);
        y.alpha -= m.drive[0][0] * lost.alpha + m.drive[0][1] * lost.beta;
        y.beta -= m.drive[1][0] * lost.alpha + m.drive[1][1] * lost.beta;
    }
    if (d->psi_5_Wb != 0.0 || d->psi_7_Wb != 0.0 || d->psi_11_Wb != 0.0 || d->psi_13_Wb != 0.0) {
        double half = half_decay(&m);
        vec_ab before = harmonic_flux(d, c, s);
        vec_ab after = harmonic_flux(d, end.alpha, end.beta);
        vec_ab change = turn((vec_ab){half * (after.alpha - before.alpha), half * (after.beta - before.beta)},
                             end.alpha, -end.beta);
        y.alpha -= change.alpha;
        y.beta -= change.beta;
    }
    if (d->dL_H[0] != 0.0 || d->dL_H[1] != 0.0 || d->dL_H[2] != 0.0) {
        vec_ab i_first = turn(i_dq, c, s);
        vec_ab i_last = turn(current_of(d, y, i_dq), end.alpha, end.beta);
        vec_ab change = {i_last.alpha - i_first.alpha, i_last.beta - i_first.beta};
        vec_ab taken = phase_share(d, change, half_decay(&m), end.alpha * end.alpha - end.beta * end.beta,
                                   2.0 * end.alpha * end.beta);
        taken = turn(taken, end.alpha, -end.beta);
        y.alpha -= taken.alpha;
        y.beta -= taken.beta;
    }
    vec_ab i_end = current_of(d, y, i_dq);
    if (iron) {
        vec_ab taken = iron_share(d, row->omega_rad_s, (vec_ab){y.alpha + psi, y.beta});
        i_end.alpha += taken.alpha;
        i_end.beta += taken.beta;
    }
    vec_ab i_next = turn(i_end, end.alpha, end.beta);
    vec_ab eddy = eddy_current(d, row->u_V, i_next);
    i_next.alpha += eddy.alpha;
    i_next.beta += eddy.beta;
    return i_next;
}

sensor_map averaged_drive_sensors(const averaged_drive *d, bool two_sensors)
{
    sensor_map map = {.offset = {d->offset_ab_A[0], d->offset_ab_A[1]}, .zero_offset_A = d->offset_zero_A};
    for (size_t column = 0; column < 2; column++) {
        double i[3];
        vec_to_phases((vec_ab){column == 0 ? 1.0 : 0.0, column == 1 ? 1.0 : 0.0}, i);
        for (size_t x = 0; x < 3; x++) {
            i[x] *= d->g[x];
        }
        map.zero[column] = (i[0] + i[1] + i[2]) / 3.0;
        if (two_sensors) {
            i[2] = -i[0] - i[1];
        }
        vec_ab v = vec_from_phases(i);
        map.forward[0][column] = v.alpha;
        map.forward[1][column] = v.beta;
    }
    double det = map.forward[0][0] * map.forward[1][1] - map.forward[0][1] * map.forward[1][0];
    map.back[0][0] = map.forward[1][1] / det;
    map.back[0][1] = -map.forward[0][1] / det;
    map.back[1][0] = -map.forward[1][0] / det;
    map.back[1][1] = map.forward[0][0] / det;
    return map;
}

vec_ab sensor_map_measure(const sensor_map *m, vec_ab i)
{
    return (vec_ab){m->forward[0][0] * i.alpha + m->forward[0][1] * i.beta + m->offset.alpha,
                    m->forward[1][0] * i.alpha + m->forward[1][1] * i.beta + m->offset.beta};
}

vec_ab sensor_map_unmeasure(const sensor_map *m, vec_ab i)
{
    double a = i.alpha - m->offset.alpha;
    double b = i.beta - m->offset.beta;
    return (vec_ab){m->back[0][0] * a + m->back[0][1] * b, m->back[1][0] * a + m->back[1][1] * b};
}
