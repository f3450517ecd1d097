/* Flux of a current and current of a flux (flux_map.h). */
#include "flux_map.h"

#include <math.h>

enum { NEWTON_STEPS = 8 };

static bool has_iron(const averaged_drive *d)
{
    return d->iron[0].E_J != 0.0 || d->iron[1].E_J != 0.0;
}

bool flux_map_has_terms(const averaged_drive *d)
{
    return has_iron(d) || d->w_ddd != 0.0 || d->w_dqq != 0.0 || d->w_dddd != 0.0 || d->w_ddqq != 0.0 ||
           d->w_qqqq != 0.0;
}

bool flux_map_bends(const averaged_drive *d)
{
    return d->saturation != 0.0 || flux_map_has_terms(d);
}

/* What the terms beyond the second order add. */
static inline void add_terms(const averaged_drive *d, vec_dq i, flux_map_point *to)
{
    const double dd = i.d * i.d;
    const double qq = i.q * i.q;
    to->flux.d += 3.0 * d->w_ddd * dd + d->w_dqq * qq + i.d * (4.0 * d->w_dddd * dd + 2.0 * d->w_ddqq * qq);
    to->flux.q += i.q * (2.0 * d->w_dqq * i.d + 2.0 * d->w_ddqq * dd + 4.0 * d->w_qqqq * qq);
    to->slope.dd += 6.0 * d->w_ddd * i.d + 12.0 * d->w_dddd * dd + 2.0 * d->w_ddqq * qq;
    to->slope.dq += i.q * (2.0 * d->w_dqq + 4.0 * d->w_ddqq * i.d);
    to->slope.qq += 2.0 * d->w_dqq * i.d + 2.0 * d->w_ddqq * dd + 12.0 * d->w_qqqq * qq;
}

flux_map_slope flux_map_part_slope(const iron_part *p)
{
    const double from = p->I_c_A / p->I_d_A;
    const double per_root = 1.0 / sqrt(1.0 + from * from);
    return (flux_map_slope){p->E_J / (p->I_d_A * p->I_d_A) * per_root * per_root * per_root, 0.0,
                            p->E_J / (p->I_q_A * p->I_q_A) * per_root};
}

/* A part's flux and slope, less those that L_d_H, L_q_H and psi_f_Wb have already. */
static inline void add_iron(const iron_part *p, vec_dq i, flux_map_point *to)
{
    const double per_dd = p->E_J / (p->I_d_A * p->I_d_A);
    const double per_qq = p->E_J / (p->I_q_A * p->I_q_A);
    const double x = (i.d - p->I_c_A) / p->I_d_A;
    const double y = i.q / p->I_q_A;
    const double from = p->I_c_A / p->I_d_A;
    const double per_root = 1.0 / sqrt(1.0 + x * x + y * y);
    const double cubed = per_root * per_root * per_root;
    const flux_map_slope fall = flux_map_part_slope(p);
    to->flux.d += per_dd * ((i.d - p->I_c_A) * per_root + p->I_c_A / sqrt(1.0 + from * from)) - fall.dd * i.d;
    to->flux.q += per_qq * i.q * per_root - fall.qq * i.q;
    to->slope.dd += per_dd * (1.0 + y * y) * cubed - fall.dd;
    to->slope.dq -= p->E_J / (p->I_d_A * p->I_q_A) * x * y * cubed;
    to->slope.qq += per_qq * (1.0 + x * x) * cubed - fall.qq;
}

/* Both at once, as most of it is common; inlined, where one is not asked for it is not computed. */
static inline flux_map_point map_at(const averaged_drive *d, bool terms, vec_dq i)
{
    flux_map_point at = {{d->L_d_H * i.d, d->L_q_H * i.q}, {d->L_d_H, 0.0, d->L_q_H}};
    if (d->saturation != 0.0) {
        /* (i/I_sat)^2 by the energy that the current stores unsaturated */
        const double per_energy = 2.0 * d->saturation / (d->L_d_H + d->L_q_H);
        const double fall = 1.0 / (1.0 + per_energy * (at.flux.d * i.d + at.flux.q * i.q));
        const double down = 2.0 * per_energy * fall * fall;
        at.slope.dd = d->L_d_H * fall - down * at.flux.d * at.flux.d;
        at.slope.dq = -down * at.flux.d * at.flux.q;
        at.slope.qq = d->L_q_H * fall - down * at.flux.q * at.flux.q;
        at.flux.d *= fall;
        at.flux.q *= fall;
    }
    if (terms) {
        add_terms(d, i, &at);
    }
    for (size_t k = 0; terms && k < IRON_PARTS; k++) {
        if (d->iron[k].E_J != 0.0) {
            add_iron(&d->iron[k], i, &at);
        }
    }
    return at;
}

flux_map_point flux_map_at(const averaged_drive *d, vec_dq i)
{
    return map_at(d, flux_map_has_terms(d), i);
}

vec_dq flux_map_flux(const averaged_drive *d, vec_dq i)
{
    return map_at(d, flux_map_has_terms(d), i).flux;
}

bool flux_map_is_physical(const averaged_drive *d, vec_dq i, double share)
{
    const flux_map_slope m = flux_map_at(d, i).slope;
    const double least = share * fmin(d->L_d_H, d->L_q_H);
    const double a = m.dd - least;
    const double b = m.qq - least;
    return a >= 0.0 && b >= 0.0 && a * b >= m.dq * m.dq;
}

bool flux_map_is_convex(const averaged_drive *d, double share)
{
    const double least = share * fmin(d->L_d_H, d->L_q_H);
    flux_map_slope far = {d->L_d_H, 0.0, d->L_q_H};
    for (size_t k = 0; k < IRON_PARTS; k++) {
        const flux_map_slope fall = flux_map_part_slope(&d->iron[k]);
        far.dd -= d->iron[k].E_J != 0.0 ? fall.dd : 0.0;
        far.qq -= d->iron[k].E_J != 0.0 ? fall.qq : 0.0;
    }
    return far.dd >= least && far.qq >= least;
}

/* The step towards a flux by the incremental inductance where the map is known. Close to where the flux turns: as if unsaturated. */
static inline vec_dq newton_step(const averaged_drive *d, vec_dq flux, const flux_map_point *at)
{
    const double least = has_iron(d) ? 0.0004 : 0.002; /* saturated parts leave little */
    const vec_dq wrong = {flux.d - at->flux.d, flux.q - at->flux.q};
    flux_map_slope m = at->slope;
    double det = m.dd * m.qq - m.dq * m.dq;
    if (!(det > least * d->L_d_H * d->L_q_H && m.dd > 0.0)) {
        m = (flux_map_slope){d->L_d_H, 0.0, d->L_q_H};
        det = m.dd * m.qq;
    }
    const double per_det = 1.0 / det;
    return (vec_dq){(m.qq * wrong.d - m.dq * wrong.q) * per_det, (m.dd * wrong.q - m.dq * wrong.d) * per_det};
}

vec_dq flux_map_guess(const averaged_drive *d, vec_dq flux, vec_dq i, const flux_map_point *at)
{
    const vec_dq more = newton_step(d, flux, at);
    return (vec_dq){i.d + more.d, i.q + more.q};
}

/*
 * The plain law: i = s flux/L with s = 1 + k e s^2, where k e is (i/I_sat)^2 of the current that would make the flux unsaturated. At the
 * largest flux that the law has, s is 2; so it is beyond.
 */
static inline vec_dq plain_current(const averaged_drive *d, vec_dq flux)
{
    const vec_dq i = {flux.d / d->L_d_H, flux.q / d->L_q_H};
    const double per_energy = 2.0 * d->saturation / (d->L_d_H + d->L_q_H);
    const double root = 1.0 - 4.0 * per_energy * (flux.d * i.d + flux.q * i.q);
    const double s = 2.0 / (1.0 + sqrt(root > 0.0 ? root : 0.0));
    return (vec_dq){s * i.d, s * i.q};
}

vec_dq flux_map_current(const averaged_drive *d, vec_dq flux, vec_dq guess)
{
    if (!flux_map_has_terms(d)) {
        return plain_current(d, flux);
    }
    vec_dq i = guess;
    vec_dq first = guess;
    for (int k = 0; k < NEWTON_STEPS; k++) {
        const flux_map_point at = map_at(d, true, i);
        const vec_dq more = newton_step(d, flux, &at);
        i.d += more.d;
        i.q += more.q;
        first = k == 0 ? i : first;
        /* The next step would be this one's square: 1e-10. */
        if (fabs(more.d) + fabs(more.q) < 1e-5 * (fabs(i.d) + fabs(i.q)) + 1e-12) {
            return i;
        }
    }
    return first;
}
