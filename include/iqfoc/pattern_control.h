/*
 * Control of a pulse pattern by its flux trajectory, for drives with 3 to 15 pulses per electrical period (docs/patterns.md): the current
 * settles within a millisecond, where a pattern in open loop takes several time constants L/R. For non-salient machines.
 *
 * The integral of a pattern's voltage is a trajectory of the stator flux. The flux error at the start of a cycle moves the next
 * edges of each leg:
 *
 *     psi* = integral of the pattern's voltage + j (R i_ref + v)/omega - r u s         omega: electrical speed
 *     e = psi* - (L i + psi_f e^(j theta))
 *     a rising edge is earlier by e_leg/u_dc, a falling one later                      e_leg: e on the axis of the leg
 *
 * r is the share by which the link is off its mean: the last sample, extrapolated over two cycles by the one before, less the mean, held to
 * 1/8. s is the mean time between two edges of a leg, and u the voltage of the reference. A link that is off makes the flux r u s between
 * two edges. The trajectory is less by it, so that the torque keeps its mean.
 *
 * If all edges of a leg are within 1/8 turn of the zero crossings of its voltage, as in six-step and in few pulses near it, the levels are
 * too long for that. The link then changes i_d and not the torque: in place of r u s, the trajectory is more by (2/pi) r/omega on the d axis.
 * r is that of the link after five cycles and tan(delta)/omega more, by the same extrapolation; delta: angle of u from the q axis, as its sine.
 * One leg at a time has edges there: each is moved by (3/2) e_leg, as the other two legs cannot correct their part of the flux on its axis.
 *
 * An edge moves at most to the places of its neighbours. The flux that remains is an error of the next cycle.
 *
 * i is the current at the start of the next cycle. The exact step of predictor_exact.h predicts it from the mean u of the edges that
 * were commanded, as u (1 + j rho phi/12): the pattern's voltage turns by phi in a cycle. The share `correction` of the prediction
 * error corrects i. The remainder decays by the step's factor e^-rho and is part of the next prediction error. The new part of an error,
 * its innovation, held to +-16, adds to the disturbance voltage v in the rotor frame:
 *
 *     innovation = miss - (1 - correction) e^-rho miss of the last cycle                    miss: sample less prediction
 *     v += disturbance l e^(-j theta) innovation                                            theta: at the sample
 *
 * With true parameters v does not depend on `correction` or on the speed: its pole is 1 - disturbance. v brings the mean current to
 * its reference if R, L or psi_f is wrong. With a small `correction`, the harmonics of i follow from the voltage by the same L as those
 * of psi*. A wrong L then moves no edges.
 *
 * Beyond a row that is not joined to the next one, its angles go on as from the row before, up to two rows further and if they stay in order.
 * At such a jump of the angles the present row remains until the legs change as iqfoc_pattern_control_change says. In six-step,
 * the voltage has one length: u_d of the reference remains, and with it i_q; i_d follows from the length.
 *
 *     at each peak:    iqfoc_pattern_control_aim(&control, i_ref, speed);
 *     at each valley:  iqfoc_pattern_control_step(&control, i, theta, u_dc, edges);
 *
 * The edges act in the cycle that begins at the next valley. The peak computes all that does not depend on the sample.
 *
 * Tested at 0.01 ... 1/8 turn per cycle, with R +-50 % and L +-20 %.
 *
 * The caller owns the state; one context at a time may call its functions.
 */
#ifndef IQFOC_PATTERN_CONTROL_H
#define IQFOC_PATTERN_CONTROL_H

#include "pattern.h"
#include "predictor_exact.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Lowest speed: 1/128 turn per cycle. Below it, the pattern is that of this speed. */
#define IQFOC_PATTERN_CONTROL_SPEED_MIN INT32_C(131072)

/* The machine and the two gains. */
typedef struct iqfoc_pattern_control_config {
    iqfoc_exact_winding_t
        winding;        /* IQFOC_EXACT_WINDING with T the control cycle; 1/8 <= k_u, psi_f/(U_b T) <= 16 */
    iq24_t correction;  /* share of the prediction error per cycle that corrects i: 0 ... 1; tested: 0.1 */
    iq24_t disturbance; /* share of the innovation that adds to v: 0 ... 1/4; tested: 0.01 */
} iqfoc_pattern_control_config_t;

#define IQFOC_PATTERN_EDGES_HALF (2 * IQFOC_PATTERN_ANGLES_MAX + 1)

/* The trajectory of the next cycles, from iqfoc_pattern_control_aim. */
typedef struct iqfoc_pattern_trajectory {
    iq24_t speed;      /* movement of the rotor in a cycle: 1/128 ... 1/8, with its sign */
    int32_t sense;     /* of it: 1 or -1 */
    iq24_t u_place;    /* the pattern's angle of leg a at rotor angle 0, in the sense of time: turns */
    iq24_t third_turn; /* from a leg's to the next one's */
    iq24_t speed_abs;  /* |speed| */
    int32_t l_q28;     /* flux per current, over the link: turns */
    iqfoc_dq_t
        steady_q28; /* (j (R i_ref + v)/omega - psi_f)/u_dc: flux in addition to the pattern's, less the magnet's: turns */
    iqfoc_ab_t per_link_q26; /* current that the voltage of the commanded cycle makes, over the link */
    iqfoc_dq_t
        drift_q26; /* current that EMF and disturbance make in a cycle, at the cycle's end: held to +-32 */
    int32_t cycles_q22; /* per turn, Q22: 8 ... 128 */
    bool long_levels;   /* all edges of a leg are within 1/8 turn of its zero crossings */
    int32_t start;      /* level of a leg after angle 0: 1 or -1; 0: no row yet */
    int32_t edges;      /* of a leg in half a turn */
    iq24_t angle[IQFOC_PATTERN_EDGES_HALF + 2]; /* of those, and of the next two: turns */
    /*
     * At an angle x after an edge, the integral of the leg's level, 1 or -1, from 1/4 turn to x is level (x + ahead).
     */
    iq24_t ahead[IQFOC_PATTERN_EDGES_HALF];
} iqfoc_pattern_trajectory_t;

/* A leg at the end of the commanded cycle. Edges have their numbers in half a turn: 0 ... edges - 1, from angle 0 or 1/2. */
typedef struct iqfoc_pattern_control_leg {
    int32_t place; /* the last edge at or before the leg's angle at the start of that cycle */
    int32_t edge;  /* the last edge that was moved into a cycle; -1: none in this pattern */
    int32_t level; /* after it: 1 or -1; 0: the pattern's, until there is one */
} iqfoc_pattern_control_leg_t;

/* The state. All fields may be read. */
typedef struct iqfoc_pattern_control {
    iqfoc_pattern_modulator_t modulator; /* table, least time, levels at the end of the commanded cycle */
    iqfoc_exact_law_t law;
    iq24_t l;   /* L I_b/(U_b T), flux in U_b T per current: 1/16 ... 8 */
    iq24_t r;   /* R I_b/U_b: 0 ... 8 */
    iq24_t psi; /* psi_f/(U_b T): 0 ... 16 */
    iq24_t correction;
    iq24_t keeps;         /* (1 - correction) e^-rho: of a prediction error one cycle later */
    int32_t later_q31;    /* rho phi/12 per turn: rho pi/6 */
    iq24_t disturbance_l; /* disturbance l: voltage per current in error */
    iqfoc_pattern_trajectory_t trajectory;
    iqfoc_pattern_control_leg_t leg[3]; /* a, b, c */
    const iqfoc_pattern_t *wanted;      /* table that is asked for, or NULL */
    iq24_t waited;                      /* angle since then: turns, 0 ... 1 */
    iq24_acc_t nearest_q48;             /* the least cost of the change since then: turns squared */
    iq24_t theta;                       /* rotor angle at the start of the commanded cycle */
    bool predicted;                     /* i_next is a prediction for the next step */
    iqfoc_abc_t high;                   /* share of the commanded cycle that each leg is high */
    iqfoc_ab_t i_next;       /* estimated current at the start of the commanded cycle, held to +-8 */
    iqfoc_ab_t miss;         /* prediction error of the last sample */
    iqfoc_ab_t carried;      /* its part that follows from the error before it */
    iq24_sincos_t sc;        /* of the rotor angle at the start of the commanded cycle */
    iq24_sincos_t sc_sample; /* of the rotor angle at the last sample */
    iqfoc_dq_t v;            /* disturbance voltage, held to +-1/2 */
    iq24_t u_dc;             /* of the last sample */
    iq24_t u_slope;          /* it less the sample before */
    iq24_t u_mean;           /* mean of the link: moves by 1/64 of the difference per cycle */
    iq24_t u_dc_inverse;     /* 1/u_mean */
    iqfoc_ab_t
        error; /* flux error at the start of the commanded cycle over the mean link, as movement: turns, held to +-4 */
} iqfoc_pattern_control_t;

/*
 * Checks table, least time, machine and gains, and sets the state: all legs low without a recent edge, no disturbance.
 * IQFOC_ERROR_NULL and IQFOC_ERROR_PATTERN as iqfoc_pattern_init; IQFOC_ERROR_PREDICTOR: the winding is out of its range;
 * IQFOC_ERROR_GAINS: a gain is. The state keeps the table's address. Call it before the control runs.
 *
 * To take over from another modulator, call iqfoc_pattern_control_restart, iqfoc_pattern_control_aim and iqfoc_pattern_control_begin.
 */
iqfoc_error_t iqfoc_pattern_control_init(iqfoc_pattern_control_t *control,
                                         const iqfoc_pattern_control_config_t *config,
                                         const iqfoc_pattern_t *table, iq24_t least);

/*
 * Forgets trajectory, prediction error and mean link, for a take-over from another modulator; the disturbance voltage stays. Exact.
 *
 * table: as iqfoc_pattern_control_change. u_dc: 0.5 ... 1.5. Call it at a valley, ahead of iqfoc_pattern_control_aim.
 */
void iqfoc_pattern_control_restart(iqfoc_pattern_control_t *control, const iqfoc_pattern_t *table,
                                   iq24_t u_dc);

/*
 * Asks for another table, for another number of pulses. Both trajectories cross between two valleys. The legs keep their levels, and an edge
 * that is due there is moved to the crossing. iqfoc_pattern_control_aim takes the table in the cycle after which the least flux error is
 * left, by the edges of a copy of the state: cost = left^2 + (error at the start)^2/16. It does so after a sixth of a turn at the earliest,
 * at the first cost within 1.2^2 of the least one in that sixth. With each further cycle the limit of the error rises by 1.5 %. Until then
 * each call takes some 1500 instructions more on a Cortex-M4, and 750 bytes more of the stack. At a jump of the angles, the limit of the
 * error begins at 1/6800 turn, at once, and rises likewise. Its square doubles with each cycle while the index is more than two rows beyond
 * the row that remains.
 *
 * table: one that iqfoc_pattern_init accepts; the state keeps its address. Call it when neither aim nor step runs.
 */
void iqfoc_pattern_control_change(iqfoc_pattern_control_t *control, const iqfoc_pattern_t *table);

/*
 * At the peak of each cycle, or just ahead of iqfoc_pattern_control_step: voltage, index and trajectory of the reference; mean of the link;
 * disturbance voltage from the innovation of the last sample.
 *
 * i_ref: |component| <= 8. speed: the rotor's movement in a cycle, held to 1/128 ... 1/8 of either sign. R i_ref + v is held to 1 and
 * the voltage to 4 a component.
 */
void iqfoc_pattern_control_aim(iqfoc_pattern_control_t *control, iqfoc_dq_t i_ref, iq24_t speed);

/*
 * At the valley of each cycle: the edges of the next cycle.
 *
 * i: sample at this valley, stationary frame, |component| <= 8. theta: rotor angle at this valley, any. u_dc: 0.5 ... 1.5. edges:
 * legs a, b, c; no time between two edges is below the modulator's `least`. At the first call i is the prediction, too.
 *
 * Largest error of 200000 cycles drawn, against the formulas in double, for tables whose angles move by at most 0.2 turns over an index
 * of 1: of i_next 4 LSB times 1 + k_u; of the flux error 10 LSB and of an edge's time 10 LSB over the movement in turns.
 */
void iqfoc_pattern_control_step(iqfoc_pattern_control_t *control, iqfoc_ab_t i, iq24_t theta, iq24_t u_dc,
                                iqfoc_pattern_edges_t edges[3]);

/*
 * The first step after another modulator, in place of iqfoc_pattern_control_step: the edges of the next cycle, without a prediction.
 * Call iqfoc_pattern_control_restart and iqfoc_pattern_control_aim before it.
 *
 * i_next, theta_next: current (stationary frame, |component| <= 8) and rotor angle (any) at the next valley. leg: levels there and
 * times since the last edges, cycles of the pattern's control: 0 ... IQFOC_PATTERN_TIME_MAX. edges, errors: as iqfoc_pattern_control_step.
 */
void iqfoc_pattern_control_begin(iqfoc_pattern_control_t *control, iqfoc_ab_t i_next, iq24_t theta_next,
                                 const iqfoc_pattern_leg_t leg[3], iqfoc_pattern_edges_t edges[3]);

/* Deprecated name of version 0.1. The next version has only the name above. */
#define IQFOC_PATTERN_CONTROL_TURNS_MIN IQFOC_PATTERN_CONTROL_SPEED_MIN

#ifdef __cplusplus
}
#endif

#endif
