/* The averaged drive's laws over a cycle (averaged_drive.h). */
#include "averaged_drive.h"
#include "found_edges.h"
#include "iron_branch.h"

#include "flux_map.h"

#include <complex.h>
#include <math.h>

/* The 5th and 11th run backwards, the 7th and 13th forwards. */
vec_ab averaged_drive_harmonics(const averaged_drive *d, vec_rotor one)
{
    vec_rotor two = rotor_turned(one, one);
    vec_rotor four = rotor_turned(two, two);
    vec_rotor five = rotor_turned(four, one);
    vec_rotor seven = rotor_turned(five, two);
    vec_ab flux = {d->psi_5_Wb * five.cos + d->psi_7_Wb * seven.cos,
                   -d->psi_5_Wb * five.sin + d->psi_7_Wb * seven.sin};
    if (d->psi_11_Wb != 0.0 || d->psi_13_Wb != 0.0) {
        vec_rotor eleven = rotor_turned(seven, four);
        vec_rotor thirteen = rotor_turned(eleven, two);
        flux.alpha += d->psi_11_Wb * eleven.cos + d->psi_13_Wb * thirteen.cos;
        flux.beta += -d->psi_11_Wb * eleven.sin + d->psi_13_Wb * thirteen.sin;
    }
    return flux;
}

static bool has_unequal_poles(const averaged_drive *d)
{
    return d->pole_cos[0] != 0.0 || d->pole_sin[0] != 0.0 || d->pole_cos[1] != 0.0 || d->pole_sin[1] != 0.0;
}

/* One order's error at n times an angle: those of sin and cos. */
static double swing(const averaged_drive *d, size_t n, vec_rotor at)
{
    return d->harmonic_cos_rad[n] * at.cos + d->harmonic_sin_rad[n] * at.sin;
}

/* Its derivative by n times the angle. */
static double swing_slope(const averaged_drive *d, size_t n, vec_rotor at)
{
    return d->harmonic_sin_rad[n] * at.cos - d->harmonic_cos_rad[n] * at.sin;
}

static vec_rotor turned_back(vec_rotor r, double angle_rad)
{
    return rotor_turned(r, (vec_rotor){cos(angle_rad), -sin(angle_rad)});
}

static bool swings(const averaged_drive *d, size_t n)
{
    return d->harmonic_cos_rad[n] != 0.0 || d->harmonic_sin_rad[n] != 0.0;
}

/*
 * How far the recorded angle lies ahead of the true one. An error that repeats with the turn moves the very angle that it depends
 * on, the electrical one and the mechanical one of the same sensor: two steps of Newton's leave the seventh power of order times
 * amplitude.
 */
static double angle_error(const averaged_drive *d, const cycle_row *row)
{
    const vec_rotor mech = {row->cos_mech, row->sin_mech};
    const vec_rotor recorded = {row->cos_theta, row->sin_theta};
    const bool by_turn = swings(d, 0) || swings(d, 1);
    const bool by_electrical = swings(d, 2) || swings(d, 3);
    const double still = d->theta_0_rad + d->t_delay_s * row->omega_rad_s;
    double ahead = still;
    if (by_turn) {
        ahead += swing(d, 0, mech) + swing(d, 1, rotor_turned(mech, mech));
    }
    if (!by_electrical && (!by_turn || row->mech_moves == 0.0)) {
        return ahead;
    }
    for (int again = 0; again < 2; again++) {
        double is = still;
        double steeper = 0.0;
        if (by_turn) {
            const vec_rotor r = turned_back(mech, row->mech_moves * ahead);
            const vec_rotor two = rotor_turned(r, r);
            is += swing(d, 0, r) + swing(d, 1, two);
            steeper += row->mech_moves * (swing_slope(d, 0, r) + 2.0 * swing_slope(d, 1, two));
        }
        if (by_electrical) {
            const vec_rotor r = turned_back(recorded, ahead);
            const vec_rotor two = rotor_turned(r, r);
            is += swing(d, 2, r) + swing(d, 3, two);
            steeper += swing_slope(d, 2, r) + 2.0 * swing_slope(d, 3, two);
        }
        ahead += (is - ahead) / (1.0 + steeper);
    }
    return ahead;
}

vec_rotor averaged_drive_rotor(const averaged_drive *d, const cycle_row *row)
{
    const vec_rotor recorded = {row->cos_theta, row->sin_theta};
    const double ahead = angle_error(d, row);
    return ahead != 0.0 ? turned_back(recorded, ahead) : recorded;
}

double averaged_drive_magnet(const averaged_drive *d, const cycle_row *row)
{
    return d->psi_f_Wb * (1.0 + d->alpha_psi * row->temperature_K) + d->psi_rate_Wb_s * row->elapsed_s;
}

/* A mean, and a part that turns with twice the angle. */
void averaged_drive_per_H(const averaged_drive *d, double share, vec_rotor r, double k[3])
{
    const double per_d = 1.0 / d->L_d_H;
    const double per_q = 1.0 / d->L_q_H;
    const double even = share * 0.5 * (per_d + per_q);
    const double odd = share * 0.5 * (per_d - per_q);
    const vec_rotor twice = rotor_turned(r, r);
    k[0] = even + odd * twice.cos;
    k[1] = odd * twice.sin;
    k[2] = even - odd * twice.cos;
}

/* By how much the winding is above R, all phases alike. */
static double drifted_ohm(const averaged_drive *d, const cycle_row *row)
{
    return d->R_rate_ohm_s * row->elapsed_s + d->R_ohm * d->alpha_R * row->temperature_K;
}

vec_ab averaged_drive_drop(const averaged_drive *d, const cycle_row *row, vec_ab i)
{
    const double all_ohm = d->R_ohm + drifted_ohm(d, row);
    vec_ab drop = {all_ohm * i.alpha, all_ohm * i.beta};
    if (d->dR_ohm[0] != 0.0 || d->dR_ohm[1] != 0.0 || d->dR_ohm[2] != 0.0) {
        const vec_ab more = vec_times_phases(i, d->dR_ohm);
        drop.alpha += more.alpha;
        drop.beta += more.beta;
    }
    return drop;
}

static vec_rotor rotor_six_times(vec_rotor one)
{
    const vec_rotor two = rotor_turned(one, one);
    return rotor_turned(rotor_turned(two, two), two);
}

/*
 * What the unequal part of the resistances, warm as they are, takes of a cycle's voltage: it sees the mean current, which is bent as at the
 * edges, and which the drop itself lowers by half of what it lowers the end by.
 */
static vec_ab unequal_losses(const averaged_drive *d, const cycle_row *row, const found_way *way, double T_s)
{
    const double drifted = drifted_ohm(d, row);
    double more_ohm[3];
    double mean_A[3];
    double k[3];
    for (size_t x = 0; x < 3; x++) {
        more_ohm[x] = d->dR_ohm[x] + drifted;
        mean_A[x] = 0.5 * (way->first[x] + way->last[x]) + 2.0 / 3.0 * way->bow[x];
    }
    averaged_drive_per_H(d, 0.5 * T_s, way->turn->middle, k);
    const vec_ab lost = vec_times_phases(vec_from_phases(mean_A), more_ohm);
    const vec_ab of_alpha = vec_times_phases((vec_ab){k[0], k[1]}, more_ohm);
    const vec_ab of_beta = vec_times_phases((vec_ab){k[1], k[2]}, more_ohm);
    const double per_det =
        1.0 / ((1.0 + of_alpha.alpha) * (1.0 + of_beta.beta) - of_alpha.beta * of_beta.alpha);
    return (vec_ab){per_det * ((1.0 + of_beta.beta) * lost.alpha - of_beta.alpha * lost.beta),
                    per_det * ((1.0 + of_alpha.alpha) * lost.beta - of_alpha.beta * lost.alpha)};
}

static bool unequal(const averaged_drive *d)
{
    return d->R_rate_ohm_s != 0.0 || d->alpha_R != 0.0 || d->dR_ohm[0] != 0.0 || d->dR_ohm[1] != 0.0 ||
           d->dR_ohm[2] != 0.0;
}

/* Voltage lost in a cycle, stationary frame. */
static vec_ab phase_losses(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn,
                           const edge_iron *iron, vec_ab i_start, vec_ab i_end, vec_ab i_seen, double T_s,
                           edge_losses *each)
{
    const found_way way = found_way_of(d, row, turn, iron, i_start, i_end, i_seen);
    vec_ab all = {0.0, 0.0};
    if (averaged_drive_loses(d)) {
        double lost[3];
        found_edges_lost(d, row, &way, T_s, lost, each);
        all = vec_from_phases(lost);
    }
    if (unequal(d)) {
        const vec_ab more = unequal_losses(d, row, &way, T_s);
        all.alpha += more.alpha;
        all.beta += more.beta;
    }
    return all;
}

/* Flux that is induced evenly over the cycle decays on average for half a cycle: e^{-a T/2}, as det decay is
 * e^{-2 a T}. */
static double half_decay(const averaged_step *m)
{
    return sqrt(sqrt(m->decay[0][0] * m->decay[1][1] - m->decay[0][1] * m->decay[1][0]));
}

/*
 * Adds to the flux y at a cycle's end what a magnet induces whose flux in the rotor frame, the real part of psi e^{j k theta}, turns by
 * k times the rotor's angle: at[0] at the cycle's start, at[1] at its end. With M the matrix of the currents' flux, that goes to
 * -psi + w, where w' = M w + (R/L) psi, and what it is off by at the start decays.
 */
static void induce(const averaged_drive *d, const averaged_step *m, double omega_rad_s, double k,
                   double complex psi_d, double complex psi_q, const vec_rotor at[2], vec_dq *y)
{
    const double a_d = d->R_ohm / d->L_d_H;
    const double a_q = d->R_ohm / d->L_q_H;
    const double complex turn = I * k * omega_rad_s;
    const double complex det = (turn + a_d) * (turn + a_q) + omega_rad_s * omega_rad_s;
    const double size = creal(det) * creal(det) + cimag(det) * cimag(det);
    const double complex inverse = size > 0.0 ? conj(det) / size : 0.0; /* 0: nothing is induced over R */
    const double complex to_d = inverse * ((turn + a_q) * a_d * psi_d + omega_rad_s * a_q * psi_q) - psi_d;
    const double complex to_q = inverse * ((turn + a_d) * a_q * psi_q - omega_rad_s * a_d * psi_d) - psi_q;
    const double complex start = at[0].cos + I * at[0].sin;
    const double complex end = at[1].cos + I * at[1].sin;
    const vec_dq off = {creal(to_d * start), creal(to_q * start)};
    y->d += creal(to_d * end) - m->decay[0][0] * off.d - m->decay[0][1] * off.q;
    y->q += creal(to_q * end) - m->decay[1][0] * off.d - m->decay[1][1] * off.q;
}

/* Of two neighbouring harmonics: the one that runs backwards and the one that runs forwards are order k in the rotor frame. */
static void induce_pair(const averaged_drive *d, const averaged_step *m, double omega_rad_s, double k,
                        double back_Wb, double on_Wb, const vec_rotor at[2], vec_dq *y)
{
    if (back_Wb != 0.0 || on_Wb != 0.0) {
        induce(d, m, omega_rad_s, k, on_Wb + back_Wb, -I * (on_Wb - back_Wb), at, y);
    }
}

/*
 * What that part takes of the flux left for the rest by the end of a cycle, whose current without it would
 * have changed by `free`. With M its matrix, of whose flux `half` has not decayed by then, and K the inverse
 * inductance, all stationary, the change x that is left solves (1 + half K M) x = free; half M x is taken.
 */
static vec_ab phase_share(const averaged_drive *d, vec_ab free, double half, vec_rotor r)
{
    double k[3];
    averaged_drive_per_H(d, half, r, k);
    const vec_ab one = vec_times_phases((vec_ab){1.0, 0.0}, d->dL_H);
    const vec_ab two = vec_times_phases((vec_ab){0.0, 1.0}, d->dL_H);
    const double a11 = 1.0 + k[0] * one.alpha + k[1] * one.beta;
    const double a12 = k[0] * two.alpha + k[1] * two.beta;
    const double a21 = k[1] * one.alpha + k[2] * one.beta;
    const double a22 = 1.0 + k[1] * two.alpha + k[2] * two.beta;
    const double det = a11 * a22 - a12 * a21;
    const vec_ab change = {(a22 * free.alpha - a12 * free.beta) / det,
                           (a11 * free.beta - a21 * free.alpha) / det};
    const vec_ab flux = vec_times_phases(change, d->dL_H);
    return (vec_ab){half * flux.alpha, half * flux.beta};
}

/* The iron's current by the flux that turns through it, a short time late: (1 - j omega tau) j omega psi G */
static vec_dq iron_share(const averaged_drive *d, double omega_rad_s, vec_dq flux)
{
    double along = d->iron_s_S * omega_rad_s * omega_rad_s;
    double across = d->iron_S * omega_rad_s;
    return (vec_dq){along * flux.d - across * flux.q, along * flux.q + across * flux.d};
}

/* The eddy current in addition to the current i, from the last cycle's voltage u[0] and the one's before it. */
static vec_ab eddy_current(const averaged_drive *d, const vec_ab *u, vec_ab i)
{
    double drop = (d->eddy_S[0] + d->eddy_S[1]) * d->R_ohm;
    return (vec_ab){d->k_u * (d->eddy_S[0] * u[0].alpha + d->eddy_S[1] * u[1].alpha) - drop * i.alpha,
                    d->k_u * (d->eddy_S[0] * u[0].beta + d->eddy_S[1] * u[1].beta) - drop * i.beta};
}

/*
 * The cycle's voltage, as one that acts evenly: of late commands the older acts first, for a cycles of the first
 * and b of the second. What acts x ahead of the cycle's middle decays for x longer, by R over the inductance (with
 * the rotor at the end of the cycle: near enough). Less than a part in twenty late is no part of each cycle but a
 * share of all cycles (updates that are missed).
 */
static vec_ab voltage_of(const averaged_drive *d, const cycle_row *row, vec_rotor end, double T_s)
{
    const double a = d->u_delay[0];
    const double b = d->u_delay[1];
    const double share[3] = {d->k_u * (1.0 - a), d->k_u * (a - b), d->k_u * b};
    const double part = a < 1.0 ? a : b;
    vec_ab u = {0.0, 0.0};
    for (size_t n = 0; n < 3; n++) {
        u.alpha += share[n] * row->u_V[n].alpha;
        u.beta += share[n] * row->u_V[n].beta;
    }
    for (size_t n = 0; n < 3 && d->u_noise != 0.0; n++) {
        const vec_ab noise = n <= row->history ? row[-(ptrdiff_t)n].u_noise_V : row->u_noise_V;
        u.alpha -= d->u_noise * share[n] * noise.alpha;
        u.beta -= d->u_noise * share[n] * noise.beta;
    }
    if (part > 0.05 && part < 0.95) {
        const double behind[3] = {0.5 * a, 0.5 * (a + b - 1.0), 0.5 * (b - 1.0)}; /* the middle, in cycles */
        vec_ab moment = {0.0, 0.0};
        double k[3];
        averaged_drive_per_H(d, d->R_ohm * T_s, end, k);
        for (size_t n = 0; n < 3; n++) {
            moment.alpha += behind[n] * share[n] * row->u_V[n].alpha;
            moment.beta += behind[n] * share[n] * row->u_V[n].beta;
        }
        u.alpha += k[0] * moment.alpha + k[1] * moment.beta;
        u.beta += k[1] * moment.alpha + k[2] * moment.beta;
    }
    return u;
}

/* By how much the iron's mean over a cycle is more than what it starts with, in the rotor frame. */
static vec_dq iron_above(const averaged_drive *d, const iron_branch *branch, vec_ab i, vec_dq first,
                         const cycle_turn *turn)
{
    /* As near as need be: it turns with the rotor. */
    const vec_ab turned = vec_to_ab(vec_to_dq(i, turn->start), turn->end);
    const vec_dq mean = vec_to_dq(iron_branch_mean(d, branch, i, turned), turn->middle);
    return (vec_dq){mean.d - first.d, mean.q - first.q};
}

/* The current that carries a flux; from a guess where the map has terms. */
static inline vec_dq current_of(const averaged_drive *d, bool bends, vec_dq per_H, vec_dq flux, vec_dq guess)
{
    return bends ? flux_map_current(d, flux, guess) : (vec_dq){flux.d * per_H.d, flux.q * per_H.q};
}

/* What the magnet's harmonics and its unequal poles induce by the end of the row's cycle. */
static vec_dq induced(const averaged_drive *d, const averaged_cycle *c, const cycle_row *row)
{
    vec_dq y = {0.0, 0.0};
    if (averaged_drive_has_harmonics(d)) {
        const vec_rotor six[2] = {rotor_six_times(c->turn.start), rotor_six_times(c->turn.end)};
        const vec_rotor twelve[2] = {rotor_turned(six[0], six[0]), rotor_turned(six[1], six[1])};
        induce_pair(d, &c->step, row->omega_rad_s, 6.0, d->psi_5_Wb, d->psi_7_Wb, six, &y);
        induce_pair(d, &c->step, row->omega_rad_s, 12.0, d->psi_11_Wb, d->psi_13_Wb, twelve, &y);
    }
    if (has_unequal_poles(d)) {
        const double psi_Wb = averaged_drive_magnet(d, row);
        const vec_rotor first = {row->cos_mech, row->sin_mech};
        const vec_rotor last = rotor_turned(first, rotor_at(row->omega_rad_s * row->T_s * row->per_pole));
        const vec_rotor mech[2][2] = {{first, last}, {rotor_turned(first, first), rotor_turned(last, last)}};
        for (size_t n = 0; n < 2; n++) {
            const double complex share = d->pole_cos[n] - I * d->pole_sin[n];
            induce(d, &c->step, row->omega_rad_s, (double)(n + 1) * row->per_pole, psi_Wb * share, 0.0,
                   mech[n], &y);
        }
    }
    return y;
}

/* Whether its cycles' turns are complete. */
static bool needs_turn(const averaged_drive *d)
{
    return averaged_drive_loses(d) || unequal(d) || iron_branch_present(d);
}

averaged_cycle averaged_drive_cycle(const averaged_drive *d, const averaged_node *nodes, const cycle_row *row,
                                    vec_rotor start)
{
    averaged_cycle c = {.step = averaged_node_step(&nodes[row->node], row->node_h)};
    if (needs_turn(d)) {
        c.turn = found_turn_of(d, row, start);
    } else {
        c.turn = (cycle_turn){.start = start,
                              .end = rotor_turned(start, (vec_rotor){row->cos_turn, row->sin_turn})};
    }
    c.u_V = vec_to_dq(voltage_of(d, row, c.turn.end, c.step.push[0][0]), start);
    c.induced_Wb = induced(d, &c, row);
    return c;
}

/* Whether what the magnet induces is the same. */
static bool induce_alike(const averaged_drive *a, const averaged_drive *b)
{
    bool alike = a->psi_5_Wb == b->psi_5_Wb && a->psi_7_Wb == b->psi_7_Wb && a->psi_11_Wb == b->psi_11_Wb &&
                 a->psi_13_Wb == b->psi_13_Wb;
    for (size_t n = 0; n < 2; n++) {
        alike = alike && a->pole_cos[n] == b->pole_cos[n] && a->pole_sin[n] == b->pole_sin[n];
    }
    return alike && (!has_unequal_poles(a) || (a->psi_f_Wb == b->psi_f_Wb && a->alpha_psi == b->alpha_psi &&
                                               a->psi_rate_Wb_s == b->psi_rate_Wb_s));
}

bool averaged_drive_rotors_alike(const averaged_drive *a, const averaged_drive *b)
{
    bool alike = a->theta_0_rad == b->theta_0_rad && a->t_delay_s == b->t_delay_s;
    for (size_t n = 0; n < ANGLE_ORDERS; n++) {
        alike = alike && a->harmonic_cos_rad[n] == b->harmonic_cos_rad[n] &&
                a->harmonic_sin_rad[n] == b->harmonic_sin_rad[n];
    }
    return alike;
}

bool averaged_drive_cycles_alike(const averaged_drive *a, const averaged_drive *b)
{
    return a->R_ohm == b->R_ohm && a->L_d_H == b->L_d_H && a->L_q_H == b->L_q_H && a->k_u == b->k_u &&
           a->u_noise == b->u_noise && a->u_delay[0] == b->u_delay[0] && a->u_delay[1] == b->u_delay[1] &&
           a->edge_ripple == b->edge_ripple && needs_turn(a) == needs_turn(b) &&
           averaged_drive_rotors_alike(a, b) && induce_alike(a, b);
}

vec_ab averaged_drive_pass(const averaged_drive *d, const averaged_cycle *cycle, const cycle_row *row,
                           vec_ab i_true, vec_ab i_seen, iron_memory *memory)
{
    const averaged_step m = cycle->step;
    const vec_rotor r = cycle->turn.start;
    const vec_rotor end = cycle->turn.end;
    const vec_dq total_dq = vec_to_dq(i_true, r); /* what flows through the winding's resistance */
    vec_dq mean_dq = total_dq; /* with the iron's mean over the cycle in it, not what it starts with */
    iron_branch branch = {.row = NULL};
    if (iron_branch_present(d)) {
        branch = iron_branch_of(d, row, i_true, memory);
        const vec_ab taken = iron_branch_begin(d, &branch);
        const vec_dq more = iron_above(d, &branch, i_true, vec_to_dq(taken, r), &cycle->turn);
        mean_dq.d += more.d;
        mean_dq.q += more.q;
        i_true.alpha -= taken.alpha;
        i_true.beta -= taken.beta;
    }
    if (d->eddy_S[0] != 0.0 || d->eddy_S[1] != 0.0) {
        /* What flows in the iron follows the flux's change over the last cycles, whose mean the voltage less
         * the drop is. */
        vec_ab eddy = eddy_current(d, row->u_V + 1, i_true);
        i_true.alpha -= eddy.alpha;
        i_true.beta -= eddy.beta;
    }
    const vec_dq u_dq = cycle->u_V;
    vec_dq i_dq = vec_to_dq(i_true, r);
    const double psi = averaged_drive_magnet(d, row);
    bool iron = d->iron_S != 0.0 || d->iron_s_S != 0.0;
    if (iron) {
        /* The current that makes flux is what the iron leaves. */
        vec_dq flux = flux_map_flux(d, i_dq);
        vec_dq taken = iron_share(d, row->omega_rad_s, (vec_dq){flux.d + psi, flux.q});
        i_dq.d -= taken.d;
        i_dq.q -= taken.q;
    }
    const bool bends = flux_map_bends(d);
    const vec_dq per_H = {1.0 / d->L_d_H, 1.0 / d->L_q_H};
    const flux_map_point at = flux_map_at(d, i_dq);
    const vec_dq x = at.flux;

    /* Constant forcing in the rotor frame: the magnet, and the drop over R that the matrices do not know. */
    vec_dq push = {-d->R_ohm * (mean_dq.d - x.d * per_H.d), -d->R_ohm * (mean_dq.q - x.q * per_H.q)};
    push.q -= row->omega_rad_s * psi;
    vec_dq y = {m.decay[0][0] * x.d + m.decay[0][1] * x.q + m.drive[0][0] * u_dq.d + m.drive[0][1] * u_dq.q +
                    m.push[0][0] * push.d + m.push[0][1] * push.q,
                m.decay[1][0] * x.d + m.decay[1][1] * x.q + m.drive[1][0] * u_dq.d + m.drive[1][1] * u_dq.q +
                    m.push[1][0] * push.d + m.push[1][1] * push.q};
    vec_dq near = i_dq; /* to the current that makes y */
    if (flux_map_has_terms(d)) {
        near = flux_map_guess(d, y, i_dq, &at);
    }
    y.d += cycle->induced_Wb.d;
    y.q += cycle->induced_Wb.q;
    if (averaged_drive_loses(d) || unequal(d)) {
        /* The current of this cycle as if nothing were lost, with what the iron takes of it, in the stationary frame. */
        near = current_of(d, bends, per_H, y, near);
        const edge_iron *at_edges = branch.edges.per_H > 0.0 ? &branch.edges : NULL;
        vec_dq all = {near.d + total_dq.d - i_dq.d, near.q + total_dq.q - i_dq.q};
        vec_ab still = {0.0, 0.0};
        if (at_edges) {
            still = at_edges->start_A;
            const vec_dq turns = vec_to_dq(still, r);
            all.d -= turns.d;
            all.q -= turns.q;
        }
        vec_ab i_end = vec_to_ab(all, end);
        i_end.alpha += still.alpha;
        i_end.beta += still.beta;
        edge_losses each = {.rise_V = {0.0}};
        vec_dq lost = vec_to_dq(phase_losses(d, row, &cycle->turn, at_edges, vec_to_ab(total_dq, r), i_end,
                                             i_seen, m.push[0][0], &each),
                                r);
        if (iron_branch_present(d)) {
            const vec_dq less = vec_to_dq(iron_branch_loses(d, &branch, memory, &each), cycle->turn.middle);
            y.d += d->R_ohm * (m.push[0][0] * less.d + m.push[0][1] * less.q);
            y.q += d->R_ohm * (m.push[1][0] * less.d + m.push[1][1] * less.q);
        }
        y.d -= m.drive[0][0] * lost.d + m.drive[0][1] * lost.q;
        y.q -= m.drive[1][0] * lost.d + m.drive[1][1] * lost.q;
    }
    if (d->dL_H[0] != 0.0 || d->dL_H[1] != 0.0 || d->dL_H[2] != 0.0) {
        vec_ab i_first = vec_to_ab(i_dq, r);
        near = current_of(d, bends, per_H, y, near);
        vec_ab i_last = vec_to_ab(near, end);
        vec_ab change = {i_last.alpha - i_first.alpha, i_last.beta - i_first.beta};
        vec_dq taken = vec_to_dq(phase_share(d, change, half_decay(&m), end), end);
        y.d -= taken.d;
        y.q -= taken.q;
    }
    vec_dq i_end = current_of(d, bends, per_H, y, near);
    if (iron) {
        vec_dq taken = iron_share(d, row->omega_rad_s, (vec_dq){y.d + psi, y.q});
        i_end.d += taken.d;
        i_end.q += taken.q;
    }
    vec_ab i_next = vec_to_ab(i_end, end);
    if (iron_branch_present(d)) {
        vec_ab taken = iron_branch_end(d, &branch, i_next);
        i_next.alpha += taken.alpha;
        i_next.beta += taken.beta;
    }
    vec_ab eddy = eddy_current(d, row->u_V, i_next);
    i_next.alpha += eddy.alpha;
    i_next.beta += eddy.beta;
    return i_next;
}
