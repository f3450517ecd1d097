/* Residuals as voltages, their bins and orders (residual.h). */
#include "residual.h"

#include <math.h>
#include <string.h>

bool residual_at(const residual *r, size_t k, residual_point *p)
{
    const recording *rec = r->rec;
    if (k == 0 || !isfinite(r->error[k].alpha)) {
        return false;
    }
    const double T_s = rec->T_s;
    p->omega_rad_s = rec->omega_e_rad_s[k - 1];
    p->theta_rad = rec->theta_e_rad[k - 1] + 0.5 * p->omega_rad_s * T_s;
    const double c = cos(rec->theta_e_rad[k]);
    const double s = sin(rec->theta_e_rad[k]);
    const double v_d = r->L_d_H / T_s * (r->error[k].alpha * c + r->error[k].beta * s);
    const double v_q = r->L_q_H / T_s * (r->error[k].beta * c - r->error[k].alpha * s);
    p->v_V = (vec_ab){v_d * c - v_q * s, v_d * s + v_q * c};
    vec_to_phases(p->v_V, p->v_phase_V);
    recording_voltage(rec, k - 1, p->u_phase_V);
    for (int x = 0; x < 3; x++) {
        p->i_phase_A[x] = 0.5 * (rec->i_A[x][k - 1] + rec->i_A[x][k]);
    }
    return true;
}

static double wrapped(double theta)
{
    return theta - 2.0 * VEC_PI * floor(theta / (2.0 * VEC_PI));
}

static void add(residual_bin bins[RESIDUAL_BINS], double low, double high, double x, double y)
{
    const double at = (x - low) / (high - low) * RESIDUAL_BINS;
    if (at >= 0.0 && at < RESIDUAL_BINS) {
        residual_bin *b = &bins[(size_t)at];
        b->x += x;
        b->y += y;
        b->count++;
    }
}

void residual_bins(const residual *r, residual_axis axis, double low, double high,
                   residual_bin bins[RESIDUAL_BINS])
{
    const bool by_phase = axis == AXIS_CURRENT || axis == AXIS_VOLTAGE;
    memset(bins, 0, RESIDUAL_BINS * sizeof *bins);
    for (size_t k = 1; k < r->rec->rows; k++) {
        residual_point p;
        if (!residual_at(r, k, &p)) {
            continue;
        }
        if (by_phase) {
            for (int x = 0; x < 3; x++) {
                add(bins, low, high, axis == AXIS_CURRENT ? p.i_phase_A[x] : p.u_phase_V[x], p.v_phase_V[x]);
            }
        } else {
            add(bins, low, high, axis == AXIS_ANGLE ? wrapped(p.theta_rad) : p.omega_rad_s,
                p.v_V.alpha * p.v_V.alpha + p.v_V.beta * p.v_V.beta);
        }
    }
    for (size_t n = 0; n < RESIDUAL_BINS; n++) {
        if (bins[n].count > 0) {
            bins[n].x /= (double)bins[n].count;
            bins[n].y /= (double)bins[n].count;
            bins[n].y = by_phase ? bins[n].y : sqrt(bins[n].y);
        }
    }
}

int order_parts(int pole_pairs)
{
    const int twice = 2 * pole_pairs;
    return twice <= ORDER_PARTS_MAX ? twice : (pole_pairs <= ORDER_PARTS_MAX ? pole_pairs : ORDER_PARTS_MAX);
}

int order_count(int parts)
{
    return 2 * ORDER_MAX * parts + 1;
}

double order_of(int parts, int n)
{
    return (double)n / parts - ORDER_MAX;
}

/* One stretch: adds rows * |amplitude|^2 to the power of every order that its sampling shows. */
static void add_stretch(const residual *r, const stretch *s, int parts, double power[ORDERS],
                        double rows[ORDERS])
{
    const int orders = order_count(parts);
    double re[ORDERS] = {0.0};
    double im[ORDERS] = {0.0};
    double weight = 0.0;
    double fastest = 0.0;
    double angle = 0.0; /* without its wraps: a part of an order counts the turns */
    for (size_t k = s->first + 1; k < s->first + s->count; k++) {
        residual_point p;
        if (!residual_at(r, k, &p)) {
            continue;
        }
        const double w = 1.0 - cos(2.0 * VEC_PI * (double)(k - s->first) / (double)s->count);
        angle += remainder(p.theta_rad - angle, 2.0 * VEC_PI);
        double c = cos(ORDER_MAX * angle);
        double sn = sin(ORDER_MAX * angle);
        const double step_c = cos(angle / parts);
        const double step_s = -sin(angle / parts);
        fastest = fmax(fastest, fabs(p.omega_rad_s) * r->rec->T_s);
        weight += w;
        for (int n = 0; n < orders; n++) {
            re[n] += w * (p.v_V.alpha * c - p.v_V.beta * sn);
            im[n] += w * (p.v_V.alpha * sn + p.v_V.beta * c);
            const double next = c * step_c - sn * step_s;
            sn = c * step_s + sn * step_c;
            c = next;
        }
    }
    for (int n = 0; n < orders && weight > 0.0; n++) {
        if (fabs(order_of(parts, n)) * fastest < VEC_PI) {
            power[n] += (double)s->count * (re[n] * re[n] + im[n] * im[n]) / (weight * weight);
            rows[n] += (double)s->count;
        }
    }
}

void residual_orders(const residual *r, int parts, double amplitude_V[ORDERS])
{
    double power[ORDERS] = {0.0};
    double rows[ORDERS] = {0.0};
    for (size_t n = 0; n < r->rec->stretches; n++) {
        if (r->rec->stretch[n].count >= 64) {
            add_stretch(r, &r->rec->stretch[n], parts, power, rows);
        }
    }
    for (int n = 0; n < ORDERS; n++) {
        amplitude_V[n] = rows[n] > 0.0 ? sqrt(power[n] / rows[n]) : NAN;
    }
}
