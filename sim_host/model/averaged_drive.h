/*
 * The averaged drive: the exact averaged machine (averaged.h) with every effect that the diagnosis knows, in the models of
 * docs/interfaces.md. It maps the true current at the start of a cycle to the true current at its end; what sensors show of these is in
 * sensor_chain.h, sensor_lag.h and sensor_nonlinearity.h.
 *
 * The machine's own step is exact. The effects are small additions to it and enter to second order in the cycle: dead time sees the current
 * at each edge, unequal resistances its mean over the cycle, and the drop over R that saturation changes is that at the cycle's start.
 * Saturation itself is exact in flux: flux advances, and the current is what carries that flux.
 */
#ifndef SIM_HOST_MODEL_AVERAGED_DRIVE_H
#define SIM_HOST_MODEL_AVERAGED_DRIVE_H

#include "../base/vector.h"
#include "../data/current_sensors.h"
#include "../data/motor.h"
#include "averaged.h"

#include <stdbool.h>
#include <stddef.h>

/* How the loss at an edge depends on the current that it finds near zero (found_edges.h); far from zero it tends to v_dead. */
typedef enum edge_law {
    EDGE_CHARGED, /* the current first charges the devices' capacitance: 1 - knee/(2|i|) */
    EDGE_CLIPPED, /* sat(i / knee): the law of interfaces.md and of the firmware */
    EDGE_LAWS
} edge_law;

/*
 * A part of the iron that saturates (flux_map.h): energy, the currents d and q at which it does, and the current d about which it is
 * symmetric.
 */
typedef struct iron_part {
    double E_J, I_d_A, I_q_A, I_c_A;
} iron_part;

enum { IRON_PARTS = 2 };

/* Plain numbers, so that a fit can move any of them. averaged_drive_of fills them from a motor file. */
typedef struct averaged_drive {
    double R_ohm, L_d_H, L_q_H, psi_f_Wb;
    double saturation;             /* 1/I_sat^2 (1/A^2); L_d_H and L_q_H then are those at zero current */
    double w_ddd, w_dqq;           /* flux map (flux_map.h), Wb/A^2; L_d_H and L_q_H as with saturation */
    double w_dddd, w_ddqq, w_qqqq; /* Wb/A^3 */
    iron_part iron[IRON_PARTS];    /* the map's parts that saturate; E_J = 0: none */
    /*
     * v_dead: what a leg loses far from zero current. A compensation has added compensation_V by the current at the cycle's start,
     * sat(i / compensation_knee_A), so that dead time and drops themselves take their sum.
     */
    double v_dead_V, i_knee_A;
    double compensation_V, compensation_knee_A;
    bool sign_is_doubted; /* noise may turn the sign of a current near zero (observer.h) */
    edge_law edge;
    /* How much of the ripple each edge sees: 0, the mean current, to 1, all that the duties tell. */
    double edge_ripple;
    /* Of what dead time and drops take, the share of devices that conduct: all through the cycle, at no edge. */
    double conduction;
    double k_u;
    double u_noise;        /* how much of a row's u_noise_V is no voltage */
    double offset_ab_A[2]; /* current sensors, stationary frame */
    double offset_zero_A;  /* mean of the three sensors' offsets: shows only where all three are used */
    double g[3];
    /* What moves, per second from the middle of the recording. */
    double R_rate_ohm_s, psi_rate_Wb_s, offset_rate_ab_A_s[2], g_rate_s[3];
    double theta_0_rad, t_delay_s;
    /* Angle error c cos(n theta_mech) + s sin(n theta_mech), n of motor_order_of. */
    double harmonic_cos_rad[ANGLE_ORDERS], harmonic_sin_rad[ANGLE_ORDERS];
    double sensor_lag_s; /* sensor_lag.h */
    double u_delay[2];   /* cycles by which the voltage acts late: of the first, of the second */
    double psi_5_Wb, psi_7_Wb, psi_11_Wb, psi_13_Wb;
    double dR_ohm[3];
    double dL_H[3];
    double alpha_R, alpha_psi; /* by which R and psi_f grow per kelvin above the mean of temp_C */
    double fe_S, fe_tau_s; /* iron: 1 / R_fe of its branch, and the branch's time constant (iron_branch.h) */
    double short_S[3];     /* the same of a loop along one phase's axis: turns that are shorted */
    /* Effects that the diagnosis does not name; fitted to see that no named effect is taken for them. */
    double iron_S;   /* 1 / resistance of an eddy current in addition to the flux-producing current */
    double iron_s_S; /* that times the time by which the iron's current comes late */
    /* The same by the voltage of the cycle that ends and of the one before: eddy currents that come late. */
    double eddy_S[2];
    /* Poles of unequal strength: the share c cos(n theta_mech) + s sin(n theta_mech) that the magnet's flux has more, n = 1 and 2. */
    double pole_cos[2], pole_sin[2];
    /* The share of phase a that the channel of b reads, of b that c's reads, of c that a's reads. */
    double crosstalk[3];
    double cubic_A2[3], zone_A; /* sensors that are not linear, */
    double ring_A, ring_sum_A,
        ring_share; /* and samples in which a leg's edge still rings (sensor_nonlinearity.h) */
} averaged_drive;

/* What one row of a recording says about its cycle. Angles as recorded. */
typedef struct cycle_row {
    vec_ab u_V[3];    /* recorded voltage of this cycle, of the one before and of two before */
    vec_ab u_noise_V; /* what of this cycle's is likely noise */
    double cos_theta, sin_theta;
    double cos_turn, sin_turn; /* of omega T */
    double omega_rad_s;        /* mean of the cycle */
    double cos_mech, sin_mech;
    /* How far an error of the recorded angle moves this one with it: 1 / pole pairs where both are one sensor's, else 0. */
    double mech_moves;
    double per_pole; /* 1 / pole pairs */
    size_t periods;  /* of the carrier in the cycle; 0 is 1 */
    double rise[3];  /* when each leg rises, as a share of a period: (1 - duty)/2 */
    double no_rise[3],
        no_fall[3]; /* edges less than a pulse's one: 1 of a leg that is held at a rail; the edge to or from
                                      the high rail lies at the valley between, and is one more of its cycle */
    double fell[3]; /* when each leg fell ahead of the cycle's start, as a share of it */
    double u_dc_V;
    vec_ab edge_ripple_Wb[3]; /* flux ripple when each leg rises; the opposite when it falls */
    double node_h;            /* where the speed lies from its node, in node steps */
    size_t node;              /* index into the table */
    double elapsed_s;         /* from the mean of the recording's times */
    double T_s;
    size_t history;        /* rows of its stretch before it */
    double temperature_K;  /* above the recording's mean; 0 without temp_C */
    vec_ab i_A;            /* recorded currents, Clarke (amplitude-invariant) */
    missing_phase missing; /* whose current is minus the sum of the other two */
    double i_zero_A;       /* mean of the three recorded currents; 0 if only two were recorded */
} cycle_row;

averaged_drive averaged_drive_of(const motor *m);

/* The motor file that says the same: extensions where an effect is there; names and ratings are `base`'s. */
motor averaged_drive_motor(const averaged_drive *drive, const motor *base);

/* What the iron is carried on by from row to row (iron_branch.h). */
typedef struct iron_memory iron_memory;

/* The rotor's turn over a row's cycle, and what follows from it for the currents at the edges (found_edges.h). */
typedef struct cycle_turn {
    vec_rotor start, end;
    /* These of a drive that loses voltage by its current, or whose iron conducts: */
    vec_rotor half, middle; /* half the turn, and where it leads */
    /* Flux of the magnet's harmonics half-way, above the mean of both ends, in the middle's frame. */
    vec_dq harmonics_Wb;
    /* The current of a flux by a leg, by as much of the ripple as edge_ripple says: at a share of the cycle the sum of these by its powers. */
    double per_H[3][3];
    vec_ab per_Wb[3]; /* half-way, of each leg */
} cycle_turn;

/* What a row's cycle is before a current goes through it: the machine's step, the rotor, the voltage and what the magnet induces over it. */
typedef struct averaged_cycle {
    averaged_step step;
    cycle_turn turn;
    vec_dq u_V;
    vec_dq induced_Wb; /* by its harmonics and its unequal poles, at the end */
} averaged_cycle;

/* Where the rotor truly is at the start of the row's cycle, and the flux of its magnet then. */
vec_rotor averaged_drive_rotor(const averaged_drive *drive, const cycle_row *row);
double averaged_drive_magnet(const averaged_drive *drive, const cycle_row *row);

/* `nodes` is the table for this drive's R, L_d, L_q; the rotor is at `start`. */
averaged_cycle averaged_drive_cycle(const averaged_drive *drive, const averaged_node *nodes,
                                    const cycle_row *row, vec_rotor start);

/* Whether every row's cycle is the same for both; whether at least the rotor is at the same place. */
bool averaged_drive_cycles_alike(const averaged_drive *one, const averaged_drive *other);
bool averaged_drive_rotors_alike(const averaged_drive *one, const averaged_drive *other);

/*
 * True current at the end of the row's cycle. i_seen: the one at its start that decides a compensation. `memory`: of a way from row to
 * row with this drive, or NULL, where the rows before are looked up at each.
 */
vec_ab averaged_drive_pass(const averaged_drive *drive, const averaged_cycle *cycle, const cycle_row *row,
                           vec_ab i_true, vec_ab i_seen, iron_memory *memory);

/* The same of a row whose cycle is passed once. */
static inline vec_ab averaged_drive_advance(const averaged_drive *drive, const averaged_node *nodes,
                                            const cycle_row *row, vec_ab i_true, iron_memory *memory)
{
    const averaged_cycle cycle = averaged_drive_cycle(drive, nodes, row, averaged_drive_rotor(drive, row));
    return averaged_drive_pass(drive, &cycle, row, i_true, i_true, memory);
}

/* The drop that a current causes over the phases' resistances, warm and unequal as they are. */
vec_ab averaged_drive_drop(const averaged_drive *drive, const cycle_row *row, vec_ab i_A);

static inline bool averaged_drive_has_harmonics(const averaged_drive *d)
{
    return d->psi_5_Wb != 0.0 || d->psi_7_Wb != 0.0 || d->psi_11_Wb != 0.0 || d->psi_13_Wb != 0.0;
}

/* The harmonics of the magnet's flux, in the stationary frame, the rotor at `one`. */
vec_ab averaged_drive_harmonics(const averaged_drive *drive, vec_rotor one);

/* A share of 1/L in the stationary frame, the rotor at r: aa, ab, bb. */
void averaged_drive_per_H(const averaged_drive *drive, double share, vec_rotor r, double k[3]);

/* Whether the legs lose anything to dead time, or get it back. */
static inline bool averaged_drive_loses(const averaged_drive *d)
{
    return d->v_dead_V != 0.0 || d->compensation_V != 0.0;
}

/*
 * The share of v_dead that an edge loses at x = i / knee.
 *
 * After a leg is switched off the current must charge its devices' capacitance before the voltage has
 * changed: with knee = 2 C u_dc / t_dead the edge loses 1 - knee / (2 |i|) of its dead time, and below the
 * knee, where the charge is never complete, |i| / (2 knee).
 */
static inline double averaged_drive_edge(edge_law law, double x)
{
    const double sign = x > 0.0 ? 1.0 : -1.0;
    const double size = x * sign;
    if (law == EDGE_CHARGED) {
        return size < 1.0 ? 0.5 * x : sign * (1.0 - 0.5 / size);
    }
    return size < 1.0 ? x : sign;
}

/* What a compensation adds to a leg with this current at the cycle's start. */
static inline double averaged_drive_compensation(const averaged_drive *d, double i_A)
{
    return d->compensation_V != 0.0
               ? d->compensation_V * averaged_drive_edge(EDGE_CLIPPED, i_A / d->compensation_knee_A)
               : 0.0;
}

#endif
