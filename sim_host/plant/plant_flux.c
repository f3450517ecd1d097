/* Flux of the iron and its rate by the current (plant_flux.h). */
#include "plant_flux.h"

#include <math.h>

#define SATURATION_LAW_ENDS 0.8 /* of I_sat */

void machine_saturation(const plant_machine *m, double i_A, double *factor, double *slope_over_i)
{
    *factor = 1.0;
    *slope_over_i = 0.0;
    if (m->I_sat_A <= 0.0) {
        return;
    }
    const double x = i_A / m->I_sat_A;
    if (x <= SATURATION_LAW_ENDS) {
        *factor = 1.0 / (1.0 + x * x);
        *slope_over_i = -2.0 * *factor * *factor / (m->I_sat_A * m->I_sat_A);
        return;
    }
    const double x_end = SATURATION_LAW_ENDS;
    const double factor_end = 1.0 / (1.0 + x_end * x_end);
    const double slope_flux = (1.0 - x_end * x_end) * factor_end * factor_end; /* of x * factor */
    const double flux = x_end * factor_end + slope_flux * (x - x_end);
    *factor = flux / x;
    *slope_over_i = (slope_flux - *factor) / (i_A * i_A);
}

static bool has_terms(const plant_machine *m)
{
    return m->w_ddd != 0.0 || m->w_dqq != 0.0 || m->w_dddd != 0.0 || m->w_ddqq != 0.0 || m->w_qqqq != 0.0;
}

bool plant_flux_has_map(const plant_machine *m)
{
    return has_terms(m) || m->iron[0].E_J != 0.0 || m->iron[1].E_J != 0.0;
}

/* Both axes' fall with the current: the flux is the gradient of a function of x^2 = a_d i_d^2 + a_q i_q^2 alone. */
static void falling(const plant_machine *m, vec_dq i, bool without_end, plant_flux *f)
{
    const double a_d = 2.0 * m->L_d_H / (m->L_d_H + m->L_q_H);
    const double a_q = 2.0 - a_d;
    const double square = a_d * i.d * i.d + a_q * i.q * i.q;
    double factor, slope;
    if (without_end && m->I_sat_A > 0.0) {
        factor = 1.0 / (1.0 + square / (m->I_sat_A * m->I_sat_A));
        slope = -2.0 * factor * factor / (m->I_sat_A * m->I_sat_A);
    } else {
        machine_saturation(m, sqrt(square), &factor, &slope);
    }
    f->psi_Wb = (vec_dq){m->L_d_H * factor * i.d, m->L_q_H * factor * i.q};
    f->L_dd_H = m->L_d_H * (factor + slope * a_d * i.d * i.d);
    f->L_dq_H = m->L_d_H * slope * a_q * i.d * i.q; /* L_d a_q = L_q a_d: the same in both axes */
    f->L_qq_H = m->L_q_H * (factor + slope * a_q * i.q * i.q);
}

/* First and second derivatives of the map's energy, from its terms w d^n q^k. */
static void add_terms(const plant_machine *m, vec_dq i, plant_flux *f)
{
    const struct {
        double w;
        int n, k;
    } term[] = {{m->w_ddd, 3, 0}, {m->w_dqq, 1, 2}, {m->w_dddd, 4, 0}, {m->w_ddqq, 2, 2}, {m->w_qqqq, 0, 4}};
    double d[5] = {1.0};
    double q[5] = {1.0};
    for (int n = 1; n <= 4; n++) {
        d[n] = d[n - 1] * i.d;
        q[n] = q[n - 1] * i.q;
    }
    for (size_t t = 0; t < sizeof term / sizeof *term; t++) {
        const int n = term[t].n;
        const int k = term[t].k;
        const double w = term[t].w;
        f->psi_Wb.d += n >= 1 ? w * n * d[n - 1] * q[k] : 0.0;
        f->psi_Wb.q += k >= 1 ? w * k * d[n] * q[k - 1] : 0.0;
        f->L_dd_H += n >= 2 ? w * n * (n - 1) * d[n - 2] * q[k] : 0.0;
        f->L_dq_H += n >= 1 && k >= 1 ? w * n * k * d[n - 1] * q[k - 1] : 0.0;
        f->L_qq_H += k >= 2 ? w * k * (k - 1) * d[n] * q[k - 2] : 0.0;
    }
}

/* First and second derivatives of E sqrt(g), g = 1 + ((d - c)/D)^2 + (q/Q)^2: those of g times E/(2 sqrt(g)), and the chain's. */
static void iron_at(const plant_iron *p, vec_dq i, plant_flux *f)
{
    const double g_d = 2.0 * (i.d - p->I_c_A) / (p->I_d_A * p->I_d_A);
    const double g_q = 2.0 * i.q / (p->I_q_A * p->I_q_A);
    const double g = 1.0 + 0.5 * g_d * (i.d - p->I_c_A) + 0.5 * g_q * i.q;
    const double one = 0.5 * p->E_J / sqrt(g);
    const double two = -0.5 * one / g;
    f->psi_Wb = (vec_dq){one * g_d, one * g_q};
    f->L_dd_H = one * 2.0 / (p->I_d_A * p->I_d_A) + two * g_d * g_d;
    f->L_dq_H = two * g_d * g_q;
    f->L_qq_H = one * 2.0 / (p->I_q_A * p->I_q_A) + two * g_q * g_q;
}

/* What it has more than at no current: the flux and the straight iron of there are psi_f, L_d and L_q. */
static void add_irons(const plant_machine *m, vec_dq i, plant_flux *f)
{
    for (int n = 0; n < PLANT_IRONS; n++) {
        plant_flux none, at;
        if (m->iron[n].E_J == 0.0) {
            continue;
        }
        iron_at(&m->iron[n], (vec_dq){0.0, 0.0}, &none);
        iron_at(&m->iron[n], i, &at);
        f->psi_Wb.d += at.psi_Wb.d - none.psi_Wb.d - none.L_dd_H * i.d;
        f->psi_Wb.q += at.psi_Wb.q - none.L_qq_H * i.q;
        f->L_dd_H += at.L_dd_H - none.L_dd_H;
        f->L_dq_H += at.L_dq_H;
        f->L_qq_H += at.L_qq_H - none.L_qq_H;
    }
}

static vec_dq direction(int n)
{
    const double angle = 2.0 * VEC_PI * n / PLANT_MAP_DIRECTIONS;
    return (vec_dq){cos(angle), sin(angle)};
}

static vec_dq turned(vec_dq e, double by)
{
    return (vec_dq){e.d * cos(by) - e.q * sin(by), e.d * sin(by) + e.q * cos(by)};
}

/* Steep enough to hold the current: a tenth of the reach further, the wall alone links three times the flux. */
#define WALL 300.0

/* Energy c (x - reach)^3 for x, the current along a direction, beyond the reach: convex, whatever the map does. */
static void add_walls(const plant_machine *m, vec_dq i, plant_flux *f)
{
    if (i.d * i.d + i.q * i.q < m->map_least_A * m->map_least_A) {
        return;
    }
    const double L = m->L_d_H > m->L_q_H ? m->L_d_H : m->L_q_H;
    for (int n = 0; n < PLANT_MAP_DIRECTIONS; n++) {
        const vec_dq e = direction(n);
        const double beyond = i.d * e.d + i.q * e.q - m->map_reach_A[n];
        if (beyond > 0.0) {
            const double c = WALL / 3.0 * L / m->map_reach_A[n];
            const double flux = 3.0 * c * beyond * beyond;
            const double rate = 6.0 * c * beyond;
            f->psi_Wb.d += flux * e.d;
            f->psi_Wb.q += flux * e.q;
            f->L_dd_H += rate * e.d * e.d;
            f->L_dq_H += rate * e.d * e.q;
            f->L_qq_H += rate * e.q * e.q;
        }
    }
}

/* The map without its walls. */
static bool iron_can(const plant_machine *m, vec_dq i)
{
    plant_flux f;
    falling(m, i, true, &f);
    add_terms(m, i, &f);
    add_irons(m, i, &f);
    /* Iron that saturates does so far below a tenth, and does not turn back as a polynomial. */
    const double share = has_terms(m) ? 0.1 : 0.001;
    const double least = share * (m->L_d_H < m->L_q_H ? m->L_d_H : m->L_q_H);
    const double a = f.L_dd_H - least;
    const double b = f.L_qq_H - least;
    return a > 0.0 && b > 0.0 && a * b > f.L_dq_H * f.L_dq_H;
}

double plant_flux_find_reach(plant_machine *m, double I_scale_A)
{
    enum { RAYS = 8, STEPS = 256 }; /* within a direction's share of the turn; of the current */
    const double most_A = 4.0 * I_scale_A;
    if (!plant_flux_has_map(m)) {
        return most_A;
    }
    m->map_least_A = most_A;
    for (int n = 0; n < PLANT_MAP_DIRECTIONS; n++) {
        double reach = most_A;
        for (int ray = 0; ray <= RAYS; ray++) {
            const double off = ((double)ray / RAYS - 0.5) * 2.0 * VEC_PI / PLANT_MAP_DIRECTIONS;
            const vec_dq e = turned(direction(n), off);
            for (int k = 1; k <= STEPS; k++) {
                const double i_A = most_A * k / STEPS;
                if (!iron_can(m, (vec_dq){i_A * e.d, i_A * e.q})) {
                    /* The plane across the direction leaves this point and all behind it outside. */
                    reach = fmin(reach, (i_A - most_A / STEPS) * cos(off));
                    break;
                }
            }
        }
        m->map_reach_A[n] = reach;
        m->map_least_A = fmin(m->map_least_A, reach);
    }
    return m->map_least_A;
}

void plant_flux_at(const plant_machine *m, vec_dq i, plant_flux *f)
{
    const bool map = plant_flux_has_map(m);
    if (!map && m->I_sat_A <= 0.0) {
        *f = (plant_flux){{m->L_d_H * i.d, m->L_q_H * i.q}, m->L_d_H, 0.0, m->L_q_H};
        return;
    }
    falling(m, i, map, f);
    if (map) {
        add_terms(m, i, f);
        add_irons(m, i, f);
        add_walls(m, i, f);
    }
}
