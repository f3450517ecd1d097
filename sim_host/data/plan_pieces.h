/*
 * Test segments of a recording: pulses and steps at standstill, steps at speeds of both directions, run-ups, currents
 * through zero. Each is one run of a scenario, of any length, within the limits.
 */
#ifndef SIM_HOST_DATA_PLAN_PIECES_H
#define SIM_HOST_DATA_PLAN_PIECES_H

#include "motor.h"
#include "scenario.h"

typedef struct plan_limits {
    double current_A;    /* peak, of the vector, excitation included */
    double speed_rpm;    /* either way */
    double u_dc_V;       /* of the link while recording */
    double seconds;      /* of all runs, settling included */
    double noise_A;      /* standard deviation of a current sample */
    int bits;            /* of the current's converter */
    double full_scale_A; /* its range, either way */
} plan_limits;

enum { PLAN_PIECES = 120, PLAN_SETTLE_CYCLES = 60 };

/* References and speed; ramps go from begin to end over the run, a square is added. */
typedef struct plan_piece {
    const char *words;
    double rpm[2];
    double i_d_A[2], i_q_A[2];
    double square_d_A, square_q_A;    /* amplitudes; 0: none */
    int half_d_cycles, half_q_cycles; /* half periods */
    double theta_e_rad;               /* at the start */
} plan_piece;

/* Fills `piece` with the segments whose steady voltage leaves a tenth of the link's; returns their number. */
size_t plan_pieces_list(const motor *m, const plan_limits *limits, plan_piece piece[PLAN_PIECES]);

/* The segment as a run of so many logged cycles. */
scenario_run plan_piece_run(const plan_piece *p, const motor *m, const plan_limits *limits, long cycles);

/* A scenario of these runs with the limits' sensors; the runs stay the caller's. */
scenario plan_scenario(const plan_limits *limits, scenario_run *run, size_t runs);

#endif
