/*
 * One leg of the inverter: its command over a cycle, the dead time, and what voltage it can hold.
 *
 * A leg's output against the negative rail is u_least while current flows out of it (into the motor) and
 * u_most while current flows into it; at zero current it may stand anywhere between, which is what clamps a
 * current at zero. With V_s, V_d the drops of transistor and diode:
 *
 *                     u_least                    u_most
 *     high on         u_dc - V_s                 u_dc + V_d
 *     low on          -V_d                       +V_s
 *     both off        -V_d                       u_dc + V_d
 *
 * On-resistance is the winding's business (it is in series whichever device conducts).
 */
#ifndef SIM_HOST_PLANT_PLANT_INVERTER_H
#define SIM_HOST_PLANT_PLANT_INVERTER_H

#include "plant_config.h"

typedef enum leg_flow {
    LEG_FLOW_IN = -1,  /* current into the leg: negative phase current */
    LEG_FLOW_NONE = 0, /* clamped at zero */
    LEG_FLOW_OUT = 1
} leg_flow;

typedef struct inverter_leg {
    bool high;      /* what is commanded now */
    double on_at_s; /* the commanded switch conducts from then on, in the cycle's time; both off before */
    double rise_s;  /* next commanded edges; INFINITY: none left */
    double fall_s;
    leg_flow flow; /* which way its current flows; the numerical path keeps it */
    bool edged;    /* there has been an edge, */
    double edge_s; /* the last one in the cycle's time */
} inverter_leg;

/* Commands the leg at a time of the cycle; a change starts the dead time. */
void leg_command(inverter_leg *leg, bool high, double t_s, double t_dead_s);

/* Edges of a centre-aligned cycle that starts now, by the duty up to its peak and the one from there on; a duty of 0 or 1
 * has none. */
void leg_begin_cycle(inverter_leg *leg, double duty, double duty_from_peak, double T_s, double t_dead_s);

/* Edges of half a carrier period that starts now: up to the peak the leg rises duty T_s before its end, from the peak on
 * it falls duty T_s after its start. T_s: of the half. */
void leg_begin_half(inverter_leg *leg, double duty, bool to_peak, double T_s, double t_dead_s);

/* The next instant after t_s at which the leg changes, INFINITY if none is planned. */
double leg_next_change(const inverter_leg *leg, double t_s);

/* Carries out the edges planned for t_s or before. */
void leg_pass(inverter_leg *leg, double t_s, double t_dead_s);

/* The cycle's time restarts at zero. */
void leg_rebase(inverter_leg *leg, double duration_s);

static inline bool leg_off(const inverter_leg *leg, double t_s)
{
    return t_s < leg->on_at_s;
}

/* The two voltages of the table above. */
void leg_voltages(const inverter_leg *leg, const plant_inverter *inverter, bool off, double u_dc_V,
                  double *least_V, double *most_V);

/* The DC link at a time since plant_init, and what of it is there to be measured. */
double inverter_link(const plant_inverter *v, double t_s);
double inverter_logged_link(const plant_inverter *v, double t_s);

/* Whether the link changes within a cycle. */
static inline bool inverter_link_swings(const plant_inverter *inverter)
{
    return inverter->ripple_V != 0.0 || inverter->unlogged_share != 0.0;
}

#endif
