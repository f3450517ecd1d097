#include "averaged_drive.h"

#include <math.h>

static const double HALF_SQRT3 = 0.86602540378443864676;
static const double INV_SQRT3 = 0.57735026918962576451;

/* (a + jb)(c + js) */
static vector_ab turn(vector_ab v, double c, double s)
{
    return (vector_ab){v.a * c - v.b * s, v.a * s + v.b * c};
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

/* Three phase values of a stationary vector, f(phase), back to a vector: the star point takes the common
 * part. */
static vector_ab clarke(const double x[3])
{
    return (vector_ab){(2.0 * x[0] - x[1] - x[2]) / 3.0, (x[1] - x[2]) * INV_SQRT3};
}

static void phases(vector_ab v, double x[3])
{
    x[0] = v.a;
    x[1] = -0.5 * v.a + HALF_SQRT3 * v.b;
    x[2] = -0.5 * v.a - HALF_SQRT3 * v.b;
}

/* Flux of a current in the rotor frame, without the magnet's. */
static vector_ab flux_of(const averaged_drive *d, vector_ab i)
{
    double square = i.a * i.a + i.b * i.b;
    double fall = 1.0 / (1.0 + d->saturation * square);
    double fall_q = d->saturation_q == 0.0 ? fall : 1.0 / (1.0 + (d->saturation + d->saturation_q) * square);
    return (vector_ab){d->L_d_H * i.a * fall, d->L_q_H * i.b * fall_q};
}

/*
 * The current that carries a flux, by fixed-point iteration with the guess at hand. The law i = x (1 + s
 * |i|^2) / L contracts while s |i|^2 < 1/3 or so; beyond |i| = I_sat the flux of interfaces.md's law falls
 * again and has no unique current, so the iteration is bounded and the last value stands.
 */
static vector_ab current_of(const averaged_drive *d, vector_ab flux, vector_ab guess)
{
    vector_ab i = guess;
    if (d->saturation == 0.0 && d->saturation_q == 0.0) {
        return (vector_ab){flux.a / d->L_d_H, flux.b / d->L_q_H};
    }
    for (int k = 0; k < 8; k++) {
        vector_ab wrong = flux_of(d, i);
        wrong.a = flux.a - wrong.a;
        wrong.b = flux.b - wrong.b;
        /* Newton with the radial part of the inductance: dx/d|i| = L (1 - s i^2) / (1 + s i^2)^2 along the
         * current. */
        double square = i.a * i.a + i.b * i.b;
        double s = d->saturation;
        double fall = 1.0 / (1.0 + s * square);
        double down = 2.0 * s * fall * fall;
        double m11 = d->L_d_H * (fall - down * i.a * i.a);
        double m12 = -d->L_d_H * down * i.a * i.b;
        double m21 = -d->L_q_H * down * i.a * i.b;
        double m22 = d->L_q_H * (fall - down * i.b * i.b);
        double det = m11 * m22 - m12 * m21;
        if (!(det >
              0.05 * d->L_d_H * d->L_q_H)) { /* close to the law's turning point: step as if unsaturated */
            m11 = d->L_d_H;
            m22 = d->L_q_H;
            m12 = m21 = 0.0;
            det = m11 * m22;
        }
        double da = (m22 * wrong.a - m12 * wrong.b) / det;
        double db = (m11 * wrong.b - m21 * wrong.a) / det;
        i.a += da;
        i.b += db;
        if (fabs(da) + fabs(db) <
            1e-6 * (fabs(i.a) + fabs(i.b)) + 1e-12) { /* the next step would be its square */
            break;
        }
    }
    return i;
}

/* Magnet flux harmonics as a stationary vector: the 5th and 11th run backwards, the 7th and 13th forwards. */
static vector_ab harmonic_flux(const averaged_drive *d, double c, double s)
{
    vector_ab one = {c, s};
    vector_ab two = turn(one, c, s);
    vector_ab four = turn(two, two.a, two.b);
    vector_ab five = turn(four, c, s);
    vector_ab seven = turn(five, two.a, two.b);
    vector_ab flux = {d->psi_5_Wb * five.a + d->psi_7_Wb * seven.a,
                      -d->psi_5_Wb * five.b + d->psi_7_Wb * seven.b};
    if (d->psi_11_Wb != 0.0 || d->psi_13_Wb != 0.0) {
        vector_ab eleven = turn(seven, four.a, four.b);
        vector_ab thirteen = turn(eleven, two.a, two.b);
        flux.a += d->psi_11_Wb * eleven.a + d->psi_13_Wb * thirteen.a;
        flux.b += -d->psi_11_Wb * eleven.b + d->psi_13_Wb * thirteen.b;
    }
    return flux;
}

/* How far the recorded angle lies ahead of the true one. */
static double angle_error(const averaged_drive *d, const drive_row *row)
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
static vector_ab phase_losses(const averaged_drive *d, const drive_row *row, vector_ab i_start,
                              vector_ab i_end, double cos_2, double sin_2, double T_s)
{
    double first[3];
    double last[3];
    double lost[3];
    phases(i_start, first);
    phases(i_end, last);
    double per_knee = 1.0 / d->i_knee_A;
    /* 1/L in the stationary frame: a mean, and a part that turns with twice the angle. */
    double even = d->edge_ripple * 0.5 * (1.0 / d->L_d_H + 1.0 / d->L_q_H);
    double odd = d->edge_ripple * 0.5 * (1.0 / d->L_d_H - 1.0 / d->L_q_H);
    /* The drop lowers the end current, and with it its own mid-cycle value: a leg sees 2/3 of its loss, half
     * of that by mid-cycle. */
    double third = T_s / 3.0 * 0.5 * (1.0 / d->L_d_H + 1.0 / d->L_q_H);
    for (size_t x = 0; x < 3; x++) {
        double mid = 0.5 * (first[x] + last[x]);
        vector_ab flux = row->edge_ripple_Wb[x];
        double i_ripple[3];
        phases((vector_ab){(even + odd * cos_2) * flux.a + odd * sin_2 * flux.b,
                           odd * sin_2 * flux.a + (even - odd * cos_2) * flux.b},
               i_ripple);
        double apart = i_ripple[x] - (0.5 - row->rise[x]) * (last[x] - first[x]);
        lost[x] = 0.5 * d->v_dead_V *
                      (averaged_drive_edge(d->edge, (mid + apart) * per_knee) +
                       averaged_drive_edge(d->edge, (mid - apart) * per_knee)) +
                  d->dR_ohm[x] * mid / (1.0 + d->dR_ohm[x] * third);
    }
    return clarke(lost);
}

/* The iron's current by the flux that turns through it, late by a short time: (1 - j omega tau) j omega psi
 * G, rotor frame. */
static vector_ab iron_share(const averaged_drive *d, double omega_rad_s, vector_ab flux)
{
    double along = d->iron_s_S * omega_rad_s * omega_rad_s;
    double across = d->iron_S * omega_rad_s;
    return (vector_ab){along * flux.a - across * flux.b, along * flux.b + across * flux.a};
}

/* The eddy current beside the current i, from the last cycle's voltage u[0] and the one's before it. */
static vector_ab eddy_current(const averaged_drive *d, const vector_ab *u, vector_ab i)
{
    double drop = (d->eddy_S[0] + d->eddy_S[1]) * d->R_ohm;
    return (vector_ab){d->k_u * (d->eddy_S[0] * u[0].a + d->eddy_S[1] * u[1].a) - drop * i.a,
                       d->k_u * (d->eddy_S[0] * u[0].b + d->eddy_S[1] * u[1].b) - drop * i.b};
}

vector_ab averaged_drive_advance(const averaged_drive *d, const averaged_node *nodes, const drive_row *row,
                                 vector_ab i_true)
{
    averaged_step m = averaged_node_step(&nodes[row->node], row->node_h);
    double c = row->cos_theta;
    double s = row->sin_theta;
    double ahead = angle_error(d, row);
    if (ahead != 0.0) {
        vector_ab true_angle = turn((vector_ab){c, s}, cos(ahead), -sin(ahead));
        c = true_angle.a;
        s = true_angle.b;
    }
    vector_ab end = turn((vector_ab){c, s}, row->cos_turn, row->sin_turn);

    double now = 1.0 - d->u_delay[0] - d->u_delay[1];
    vector_ab u = {
        d->k_u * (now * row->u_V[0].a + d->u_delay[0] * row->u_V[1].a + d->u_delay[1] * row->u_V[2].a),
        d->k_u * (now * row->u_V[0].b + d->u_delay[0] * row->u_V[1].b + d->u_delay[1] * row->u_V[2].b)};
    const vector_ab total_dq = turn(i_true, c, -s); /* what flows through the winding's resistance */
    if (d->eddy_S[0] != 0.0 || d->eddy_S[1] != 0.0) {
        /* What flows in the iron follows the flux's change over the last cycles, whose mean the voltage less
         * the drop is. */
        vector_ab eddy = eddy_current(d, row->u_V + 1, i_true);
        i_true.a -= eddy.a;
        i_true.b -= eddy.b;
    }
    vector_ab u_dq = turn(u, c, -s);
    vector_ab i_dq = turn(i_true, c, -s);
    double psi = d->psi_f_Wb + d->psi_temperature * row->temperature_K;
    bool iron = d->iron_S != 0.0 || d->iron_s_S != 0.0;
    if (iron) {
        /* The current that makes flux is what the iron leaves. */
        vector_ab flux = flux_of(d, i_dq);
        vector_ab taken = iron_share(d, row->omega_rad_s, (vector_ab){flux.a + psi, flux.b});
        i_dq.a -= taken.a;
        i_dq.b -= taken.b;
    }
    vector_ab x = flux_of(d, i_dq);

    /* Constant forcing in the rotor frame: the magnet, and the drop over R that the linear matrices do not
     * know. */
    vector_ab push = {-d->R_ohm * (total_dq.a - x.a / d->L_d_H), -d->R_ohm * (total_dq.b - x.b / d->L_q_H)};
    push.b -= row->omega_rad_s * psi;
    if (d->R_temperature != 0.0) {
        push.a -= d->R_temperature * row->temperature_K * i_dq.a;
        push.b -= d->R_temperature * row->temperature_K * i_dq.b;
    }
    vector_ab y = {m.decay[0][0] * x.a + m.decay[0][1] * x.b + m.drive[0][0] * u_dq.a +
                       m.drive[0][1] * u_dq.b + m.push[0][0] * push.a + m.push[0][1] * push.b,
                   m.decay[1][0] * x.a + m.decay[1][1] * x.b + m.drive[1][0] * u_dq.a +
                       m.drive[1][1] * u_dq.b + m.push[1][0] * push.a + m.push[1][1] * push.b};
    if (d->v_dead_V != 0.0 || d->dR_ohm[0] != 0.0 || d->dR_ohm[1] != 0.0 || d->dR_ohm[2] != 0.0) {
        /* The current of this cycle as if nothing were lost, in the stationary frame. */
        vector_ab i_end = turn(current_of(d, y, i_dq), end.a, end.b);
        vector_ab i_start = turn(i_dq, c, s);
        vector_ab lost =
            turn(phase_losses(d, row, i_start, i_end, c * c - s * s, 2.0 * c * s, m.push[0][0]), c, -s);
        y.a -= m.drive[0][0] * lost.a + m.drive[0][1] * lost.b;
        y.b -= m.drive[1][0] * lost.a + m.drive[1][1] * lost.b;
    }
    if (d->psi_5_Wb != 0.0 || d->psi_7_Wb != 0.0 || d->psi_11_Wb != 0.0 || d->psi_13_Wb != 0.0) {
        vector_ab before = harmonic_flux(d, c, s);
        vector_ab after = harmonic_flux(d, end.a, end.b);
        /* Induced evenly over the cycle, on average it decays for half a cycle: e^{-a T/2}, from det decay =
         * e^{-2 a T}. */
        double half = sqrt(sqrt(m.decay[0][0] * m.decay[1][1] - m.decay[0][1] * m.decay[1][0]));
        vector_ab change =
            turn((vector_ab){half * (after.a - before.a), half * (after.b - before.b)}, end.a, -end.b);
        y.a -= change.a;
        y.b -= change.b;
    }
    vector_ab i_end = current_of(d, y, i_dq);
    if (iron) {
        vector_ab taken = iron_share(d, row->omega_rad_s, (vector_ab){y.a + psi, y.b});
        i_end.a += taken.a;
        i_end.b += taken.b;
    }
    vector_ab i_next = turn(i_end, end.a, end.b);
    vector_ab eddy = eddy_current(d, row->u_V, i_next);
    i_next.a += eddy.a;
    i_next.b += eddy.b;
    return i_next;
}

sensor_map averaged_drive_sensors(const averaged_drive *d, bool two_sensors)
{
    sensor_map map = {.offset = {d->offset_ab_A[0], d->offset_ab_A[1]}, .zero_offset_A = d->offset_zero_A};
    for (size_t column = 0; column < 2; column++) {
        double i[3];
        phases((vector_ab){column == 0 ? 1.0 : 0.0, column == 1 ? 1.0 : 0.0}, i);
        for (size_t x = 0; x < 3; x++) {
            i[x] *= d->g[x];
        }
        map.zero[column] = (i[0] + i[1] + i[2]) / 3.0;
        if (two_sensors) {
            i[2] = -i[0] - i[1];
        }
        vector_ab v = clarke(i);
        map.forward[0][column] = v.a;
        map.forward[1][column] = v.b;
    }
    double det = map.forward[0][0] * map.forward[1][1] - map.forward[0][1] * map.forward[1][0];
    map.back[0][0] = map.forward[1][1] / det;
    map.back[0][1] = -map.forward[0][1] / det;
    map.back[1][0] = -map.forward[1][0] / det;
    map.back[1][1] = map.forward[0][0] / det;
    return map;
}

vector_ab sensor_map_measure(const sensor_map *m, vector_ab i)
{
    return (vector_ab){m->forward[0][0] * i.a + m->forward[0][1] * i.b + m->offset.a,
                       m->forward[1][0] * i.a + m->forward[1][1] * i.b + m->offset.b};
}

vector_ab sensor_map_unmeasure(const sensor_map *m, vector_ab i)
{
    double a = i.a - m->offset.a;
    double b = i.b - m->offset.b;
    return (vector_ab){m->back[0][0] * a + m->back[0][1] * b, m->back[1][0] * a + m->back[1][1] * b};
}
