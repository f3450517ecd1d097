/* A leg's edges, dead time and voltages (plant_inverter.h). */
#include "plant_inverter.h"
#include "../base/vector.h"

#include <math.h>

void leg_command(inverter_leg *leg, bool high, double t_s, double t_dead_s)
{
    if (high != leg->high) {
        leg->high = high;
        leg->on_at_s = t_s + t_dead_s;
        leg->edged = true;
        leg->edge_s = t_s;
    }
}

void leg_begin_cycle(inverter_leg *leg, double duty, double duty_from_peak, double T_s, double t_dead_s)
{
    leg_command(leg, duty >= 1.0, 0.0, t_dead_s);
    leg->rise_s = duty < 1.0 ? 0.5 * T_s * (1.0 - fmax(duty, 0.0)) : INFINITY;
    leg->fall_s = duty_from_peak < 1.0 ? 0.5 * T_s * (1.0 + fmax(duty_from_peak, 0.0)) : INFINITY;
    if (duty <= 0.0 && duty_from_peak <= 0.0) {
        leg->rise_s = leg->fall_s = INFINITY;
    }
}

void leg_begin_half(inverter_leg *leg, double duty, bool to_peak, double T_s, double t_dead_s)
{
    const bool pulse = duty > 0.0 && duty < 1.0;
    leg_command(leg, to_peak ? duty >= 1.0 : duty > 0.0, 0.0, t_dead_s);
    leg->rise_s = pulse && to_peak ? T_s * (1.0 - duty) : INFINITY;
    leg->fall_s = pulse && !to_peak ? T_s * duty : INFINITY;
}

double leg_next_change(const inverter_leg *leg, double t_s)
{
    double next = fmin(leg->rise_s, leg->fall_s);
    return leg->on_at_s > t_s ? fmin(next, leg->on_at_s) : next;
}

void leg_pass(inverter_leg *leg, double t_s, double t_dead_s)
{
    if (leg->rise_s <= t_s) {
        leg_command(leg, true, leg->rise_s, t_dead_s);
        leg->rise_s = INFINITY;
    }
    if (leg->fall_s <= t_s) {
        leg_command(leg, false, leg->fall_s, t_dead_s);
        leg->fall_s = INFINITY;
    }
}

void leg_rebase(inverter_leg *leg, double duration_s)
{
    leg->on_at_s -= duration_s;
    leg->edge_s -= duration_s;
}

void leg_voltages(const inverter_leg *leg, const plant_inverter *inverter, bool off, double u_dc_V,
                  double *least_V, double *most_V)
{
    if (off) {
        *least_V = -inverter->v_diode_V;
        *most_V = u_dc_V + inverter->v_diode_V;
    } else if (leg->high) {
        *least_V = u_dc_V - inverter->v_switch_V;
        *most_V = u_dc_V + inverter->v_diode_V;
    } else {
        *least_V = -inverter->v_diode_V;
        *most_V = inverter->v_switch_V;
    }
}

static double swing(double amplitude_V, double frequency_Hz, double t_s)
{
    return amplitude_V != 0.0 ? amplitude_V * sin(2.0 * VEC_PI * frequency_Hz * t_s) : 0.0;
}

double inverter_link(const plant_inverter *v, double t_s)
{
    const double mean_V = v->k_u * v->u_dc_V;
    return mean_V + swing(v->ripple_V, v->ripple_Hz, t_s) +
           swing(v->unlogged_share * mean_V, v->unlogged_Hz, t_s);
}

double inverter_logged_link(const plant_inverter *v, double t_s)
{
    const double mean_V = v->k_u * v->u_dc_V;
    return v->ripple_logged ? mean_V + swing(v->ripple_V, v->ripple_Hz, t_s) : mean_V;
}
