/* Which devices conduct, and the voltages that follow (plant_conduction.h). */
#include "plant_conduction.h"

#include <math.h>

void conduction_bounds(conduction *k, const plant_inverter *inverter, double t_s)
{
    const double u_dc_V = inverter_link(inverter, t_s);
    k->ideal = true;
    for (int x = 0; x < 3; x++) {
        leg_voltages(&k->leg[x], inverter, k->off[x], u_dc_V, &k->least_V[x], &k->most_V[x]);
        k->ideal = k->ideal && k->most_V[x] <= k->least_V[x];
    }
}

static bool one_voltage(const conduction *k, int x)
{
    return k->most_V[x] <= k->least_V[x];
}

static int clamped(const conduction *k)
{
    int n = 0;
    for (int x = 0; x < 3; x++) {
        n += k->leg[x].flow == LEG_FLOW_NONE;
    }
    return n;
}

/* The voltage vector at which no current changes; meant for no current at all. */
static vec_ab holding_voltage(const machine_terms *t)
{
    const double determinant = t->rate[0][0] * t->rate[1][1] - t->rate[0][1] * t->rate[1][0];
    vec_ab u = {-(t->rate[1][1] * t->drift_A_s.alpha - t->rate[0][1] * t->drift_A_s.beta) / determinant,
                -(t->rate[0][0] * t->drift_A_s.beta - t->rate[1][0] * t->drift_A_s.alpha) / determinant};
    return u;
}

static double phase_rate(const machine_terms *t, vec_ab u, int x)
{
    const vec_ab rate = {t->rate[0][0] * u.alpha + t->rate[0][1] * u.beta,
                         t->rate[1][0] * u.alpha + t->rate[1][1] * u.beta};
    return vec_phase(rate, x);
}

static double flow_voltage(const conduction *k, int x)
{
    return k->leg[x].flow == LEG_FLOW_IN ? k->most_V[x] : k->least_V[x];
}

/* The leg voltage that holds the current of the one clamped leg x; the others flow. */
static double clamp_voltage(const conduction *k, const machine_terms *t, int x)
{
    double u_leg[3];
    for (int y = 0; y < 3; y++) {
        u_leg[y] = y == x ? 0.0 : flow_voltage(k, y);
    }
    const vec_ab from_others = vec_from_phases(u_leg);
    const vec_ab from_one_volt = {2.0 / 3.0 * vec_phase_axis[x].alpha, 2.0 / 3.0 * vec_phase_axis[x].beta};
    return -(phase_rate(t, from_others, x) + vec_phase(t->drift_A_s, x)) / phase_rate(t, from_one_volt, x);
}

vec_ab conduction_voltage(const conduction *k, const machine_terms *t)
{
    double u_leg[3];
    const int n = k->ideal ? 0 : clamped(k);
    if (n >= 2) {
        return holding_voltage(t);
    }
    for (int x = 0; x < 3; x++) {
        const bool clamp = n == 1 && k->leg[x].flow == LEG_FLOW_NONE;
        u_leg[x] = clamp ? clamp_voltage(k, t, x) : flow_voltage(k, x);
    }
    return vec_from_phases(u_leg);
}

/* With no current at all: the legs that have least room, and the room between them; see conduction_margin. */
static double standstill_room_V(const conduction *k, const machine_terms *t, int *pushes_out, int *pulls_in)
{
    const vec_ab u = holding_voltage(t);
    double highest = -INFINITY, lowest = INFINITY;
    for (int x = 0; x < 3; x++) {
        const double v = vec_phase(u, x);
        if (k->least_V[x] - v > highest) {
            highest = k->least_V[x] - v;
            *pushes_out = x;
        }
        if (k->most_V[x] - v < lowest) {
            lowest = k->most_V[x] - v;
            *pulls_in = x;
        }
    }
    return lowest - highest; /* the star point can float between the two */
}

double conduction_margin(const conduction *k, const machine_terms *t, int x, double I_scale_A,
                         double u_scale_V)
{
    if (clamped(k) >= 2) {
        int unused[2];
        return standstill_room_V(k, t, &unused[0], &unused[1]) / u_scale_V;
    }
    if (one_voltage(k, x)) {
        return INFINITY;
    }
    if (k->leg[x].flow == LEG_FLOW_NONE) {
        const double u = clamp_voltage(k, t, x);
        return fmin(u - k->least_V[x], k->most_V[x] - u) / u_scale_V;
    }
    return (double)k->leg[x].flow * vec_phase(t->i_A, x) / I_scale_A;
}

/* Takes the phase's current out of the state exactly. */
static void set_phase_zero(plant_state *s, int x)
{
    const vec_ab i = {s->y[STATE_I_ALPHA], s->y[STATE_I_BETA]};
    const double i_x = vec_phase(i, x);
    s->y[STATE_I_ALPHA] -= vec_phase_axis[x].alpha * i_x;
    s->y[STATE_I_BETA] -= vec_phase_axis[x].beta * i_x;
}

bool conduction_settle(conduction *k, const machine_terms *t, double zero_A, plant_state *s)
{
    int undecided = 0; /* legs at zero current that could be held there */
    for (int x = 0; x < 3; x++) {
        const double i = vec_phase(t->i_A, x);
        if (one_voltage(k, x)) {
            k->leg[x].flow = LEG_FLOW_OUT;
        } else if (fabs(i) > zero_A) {
            k->leg[x].flow = i > 0.0 ? LEG_FLOW_OUT : LEG_FLOW_IN;
        } else {
            k->leg[x].flow = LEG_FLOW_NONE;
            set_phase_zero(s, x);
            undecided++;
        }
    }
    if (undecided >= 2) {
        s->y[STATE_I_ALPHA] = 0.0;
        s->y[STATE_I_BETA] = 0.0;
        int out = 0, in = 0;
        if (standstill_room_V(k, t, &out, &in) >= 0.0) {
            for (int x = 0; x < 3; x++) {
                k->leg[x].flow = LEG_FLOW_NONE;
            }
            return true;
        }
        k->leg[out].flow = LEG_FLOW_OUT;
        k->leg[in].flow = LEG_FLOW_IN;
    }
    for (int x = 0; x < 3; x++) {
        if (k->leg[x].flow == LEG_FLOW_NONE) {
            const double u = clamp_voltage(k, t, x);
            if (u < k->least_V[x]) {
                k->leg[x].flow = LEG_FLOW_OUT;
            } else if (u > k->most_V[x]) {
                k->leg[x].flow = LEG_FLOW_IN;
            }
        }
    }
    return undecided > 0;
}
