/* Flux of a current and current of a flux (flux_map.h). */
#include "flux_map.h"

#include <math.h>

enum { NEWTON_STEPS = 8 };

bool flux_map_has_terms(const averaged_drive *d)
{
    return d->w_ddd != 0.0 || d->w_dqq != 0.0 || d->w_dddd != 0.0 || d->w_ddqq != 0.0 || d->w_qqqq != 0.0;
}

/* i^2 by the energy that the current stores unsaturated. */
static double energy_square(const averaged_drive *d, vec_dq i)
{
    return 2.0 * (d->L_d_H * i.d * i.d + d->L_q_H * i.q * i.q) / (d->L_d_H + d->L_q_H);
}

/* What the terms beyond the second order add. */
static vec_dq flux_of_terms(const averaged_drive *d, vec_dq i)
{
    const double dd = i.d * i.d;
    const double qq = i.q * i.q;
    return (vec_dq){3.0 * d->w_ddd * dd + d->w_dqq * qq + i.d * (4.0 * d->w_dddd * dd + 2.0 * d->w_ddqq * qq),
                    i.q * (2.0 * d->w_dqq * i.d + 2.0 * d->w_ddqq * dd + 4.0 * d->w_qqqq * qq)};
}

vec_dq flux_map_flux(const averaged_drive *d, vec_dq i)
{
    vec_dq flux = {d->L_d_H * i.d, d->L_q_H * i.q};
    if (d->saturation != 0.0) {
        const double fall = 1.0 / (1.0 + d->saturation * energy_square(d, i));
        flux.d *= fall;
        flux.q *= fall;
    }
    if (flux_map_has_terms(d)) {
        const vec_dq more = flux_of_terms(d, i);
        flux.d += more.d;
        flux.q += more.q;
    }
    return flux;
}

flux_map_slope flux_map_incremental(const averaged_drive *d, vec_dq i)
{
    flux_map_slope m = {d->L_d_H, 0.0, d->L_q_H};
    if (d->saturation != 0.0) {
        const double fall = 1.0 / (1.0 + d->saturation * energy_square(d, i));
        const double down = 4.0 * d->saturation * fall * fall / (d->L_d_H + d->L_q_H);
        m.dd = d->L_d_H * (fall - down * d->L_d_H * i.d * i.d);
        m.dq = -down * d->L_d_H * d->L_q_H * i.d * i.q;
        m.qq = d->L_q_H * (fall - down * d->L_q_H * i.q * i.q);
    }
    if (flux_map_has_terms(d)) {
        const double dd = i.d * i.d;
        const double qq = i.q * i.q;
        m.dd += 6.0 * d->w_ddd * i.d + 12.0 * d->w_dddd * dd + 2.0 * d->w_ddqq * qq;
        m.dq += i.q * (2.0 * d->w_dqq + 4.0 * d->w_ddqq * i.d);
        m.qq += 2.0 * d->w_dqq * i.d + 2.0 * d->w_ddqq * dd + 12.0 * d->w_qqqq * qq;
    }
    return m;
}

bool flux_map_is_physical(const averaged_drive *d, vec_dq i, double share)
{
    const flux_map_slope m = flux_map_incremental(d, i);
    const double least = share * fmin(d->L_d_H, d->L_q_H);
    const double a = m.dd - least;
    const double b = m.qq - least;
    return a >= 0.0 && b >= 0.0 && a * b >= m.dq * m.dq;
}

/* The step towards a flux by the incremental inductance at i. Close to where the flux turns: as if unsaturated. */
static vec_dq newton_step(const averaged_drive *d, vec_dq flux, vec_dq i)
{
    /* The plain law has no iron beyond a tenth of its inductances; of a map both may be less. */
    const double least = flux_map_has_terms(d) ? 0.002 : 0.05;
    const vec_dq has = flux_map_flux(d, i);
    const vec_dq wrong = {flux.d - has.d, flux.q - has.q};
    flux_map_slope m = flux_map_incremental(d, i);
    double det = m.dd * m.qq - m.dq * m.dq;
    if (!(det > least * d->L_d_H * d->L_q_H && m.dd > 0.0)) {
        m = (flux_map_slope){d->L_d_H, 0.0, d->L_q_H};
        det = m.dd * m.qq;
    }
    const double per_det = 1.0 / det;
    return (vec_dq){(m.qq * wrong.d - m.dq * wrong.q) * per_det, (m.dd * wrong.q - m.dq * wrong.d) * per_det};
}

vec_dq flux_map_current(const averaged_drive *d, vec_dq flux, vec_dq guess)
{
    if (d->saturation == 0.0 && !flux_map_has_terms(d)) {
        return (vec_dq){flux.d / d->L_d_H, flux.q / d->L_q_H};
    }
    vec_dq i = guess;
    vec_dq first = guess;
    for (int k = 0; k < NEWTON_STEPS; k++) {
        const vec_dq more = newton_step(d, flux, i);
        i.d += more.d;
        i.q += more.q;
        first = k == 0 ? i : first;
        /* The next step would be this one's square: 1e-10. */
        if (fabs(more.d) + fabs(more.q) < 1e-5 * (fabs(i.d) + fabs(i.q)) + 1e-12) {
            return i;
        }
    }
    return flux_map_has_terms(d) ? first : i;
}
