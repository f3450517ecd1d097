/*
 * The line of a ripple in series of many pieces: one frequency, about one size, each piece's phase its own.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_RIPPLE_LINE_H
#define SIM_HOST_DIAGNOSE_MEASURE_RIPPLE_LINE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct ripple_piece {
    size_t first, count;                 /* rows */
    double slowest_rad_s, fastest_rad_s; /* electrical */
    bool turns;                          /* by a turn or more */
    double cos_share, sin_share;         /* from its first row on; what ripple_fit finds */
    double square_A2;                    /* of its errors, summed */
} ripple_piece;

typedef struct ripple_pieces {
    size_t pieces;
    ripple_piece *piece;
    /* By row: the error along what the row's voltage does, and across it, each times that; and the square of what it does. */
    double *along, *across, *weight;
} ripple_pieces;

typedef struct ripple_found {
    double share; /* 0: there is none */
    double share_half;
    double frequency_Hz, frequency_half_Hz; /* half: of the 95 % interval */
} ripple_found;

/* False: out of memory. */
bool ripple_find(const ripple_pieces *all, double T_s, ripple_found *found);

/* A piece's own size and phase at the frequency found; no more than twice the size. Returns the reduction of its
 * squared errors. */
double ripple_fit(const ripple_pieces *all, ripple_piece *piece, double T_s, const ripple_found *found);

#endif
