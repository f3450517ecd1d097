/*
 * A pulse pattern of one leg: a few switching angles within the first quarter of a turn. Symmetry gives the rest:
 *
 *     u(pi - x) = u(x)        u(pi + x) = -u(x)        b_n = (4 start/(pi n)) (1 + 2 sum (-1)^k cos(n angle_k)), n odd
 *
 * b_n: amplitude of sin(n x), as a multiple of half the DC link. The legs b and c are 1/3 and 2/3 of a turn later. With N
 * angles each leg switches 2 N + 1 times on and off in a turn.
 */
#ifndef SIM_HOST_PATTERNS_PATTERN_SHAPE_H
#define SIM_HOST_PATTERNS_PATTERN_SHAPE_H

enum {
    PATTERN_ANGLES_MOST = 7,
    PATTERN_PAIRS = 16, /* of harmonics 6 k - 1 and 6 k + 1: up to 97 */
    PATTERN_ERRORS = 2 * PATTERN_PAIRS
};

typedef struct pattern_shape {
    int angles;
    int start;                         /* of u just above 0: 1 or -1, the two families */
    double angle[PATTERN_ANGLES_MOST]; /* rad, rising, 0 to pi/2 */
} pattern_shape;

/*
 * What a harmonic flux costs, by its direction: along the stator flux of the fundamental and across it. The current is
 * the flux divided by L_d or L_q, so that both are 1 if L_d = L_q.
 */
typedef struct pattern_weight {
    double along, across;
} pattern_weight;

/* b_1 as a share of six-step's 4/pi. */
double pattern_index(const pattern_shape *s);

/* b_n as a multiple of half the DC link. */
double pattern_harmonic(const pattern_shape *s, int n);

/*
 * Harmonic flux, b_n/n of each pair: the sum of both times `along`, the difference times `across`. Half the sum of their
 * squares is the mean square of the flux, in units of half the DC link over the fundamental's angular frequency. slope:
 * derivatives by the angles, or NULL.
 */
void pattern_errors(const pattern_shape *s, const pattern_weight *w, double error[PATTERN_ERRORS],
                    double slope[PATTERN_ERRORS][PATTERN_ANGLES_MOST]);

/* b_1 and its derivatives by the angles. */
double pattern_fundamental(const pattern_shape *s, double slope[PATTERN_ANGLES_MOST]);

/* Rms of the harmonic flux over that of the fundamental, each direction with its weight. */
double pattern_distortion(const pattern_shape *s, const pattern_weight *w);

#endif
