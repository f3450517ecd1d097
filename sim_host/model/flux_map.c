/* Flux of a current and current of a flux (flux_map.h). */
#include "flux_map.h"

#include <math.h>

enum { NEWTON_STEPS = 8 };

bool flux_map_has_terms(const averaged_drive *d)
{
    return d->w_ddd != 0.0 || d->w_dqq != 0.0 || d->w_dddd != 0.0 || d->w_ddqq != 0.0 || d->w_qqqq != 0.0;
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

/* The step towards a flux by the incremental inductance where the map is known. Close to where the flux turns: as if unsaturated. */
static inline vec_dq newton_step(const averaged_drive *d, bool terms, vec_dq flux, const flux_map_point *at)
{
    /* The plain law has no iron beyond a tenth of its inductances; of a map both may be less. */
    const double least = terms ? 0.002 : 0.05;
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
    const vec_dq more = newton_step(d, flux_map_has_terms(d), flux, at);
    return (vec_dq){i.d + more.d, i.q + more.q};
}

vec_dq flux_map_current(const averaged_drive *d, vec_dq flux, vec_dq guess)
{
    const bool terms = flux_map_has_terms(d);
    if (!flux_map_bends(d)) {
        return (vec_dq){flux.d / d->L_d_H, flux.q / d->L_q_H};
    }
    vec_dq i = guess;
    vec_dq first = guess;
    for (int k = 0; k < NEWTON_STEPS; k++) {
        const flux_map_point at = map_at(d, terms, i);
        const vec_dq more = newton_step(d, terms, flux, &at);
        i.d += more.d;
        i.q += more.q;
        first = k == 0 ? i : first;
        /* The next step would be this one's square: 1e-10. */
        if (fabs(more.d) + fabs(more.q) < 1e-5 * (fabs(i.d) + fabs(i.q)) + 1e-12) {
            return i;
        }
    }
    return terms ? first : i;
}
