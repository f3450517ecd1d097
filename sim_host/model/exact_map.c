/* The one exact model of a salient machine (exact_map.h). */
#include "exact_map.h"

#include <math.h>
#include <stddef.h>

/* Terms of the power series: at a norm of 8 the last one is under 1e-20. */
enum { TERMS = 50 };

typedef double matrix[2][2];

/* out = (a x + more)/n. */
static void next_term(matrix a, matrix x, matrix more, int n, matrix out)
{
    for (size_t row = 0; row < 2; row++) {
        for (size_t col = 0; col < 2; col++) {
            out[row][col] = (a[row][0] * x[0][col] + a[row][1] * x[1][col] + more[row][col]) / n;
        }
    }
}

/* sum += share * term. Returns the term's largest entry. */
static double add_term(matrix sum, matrix term, double share)
{
    double largest = 0.0;
    for (size_t row = 0; row < 2; row++) {
        for (size_t col = 0; col < 2; col++) {
            sum[row][col] += share * term[row][col];
            largest = fmax(largest, fabs(term[row][col]));
        }
    }
    return largest;
}

/* One term of e^(M T) = sum (M T)^n/n!, M = [A 1 1; 0 -j omega 0; 0 0 0]: its first row, and what drives it. */
typedef struct series_term {
    exact_map map;
    matrix voltage; /* as the turning rotor sees it, s */
} series_term;

void exact_maps(double R_ohm, double L_d_H, double L_q_H, double span_s, double omega_rad_s, exact_map *end,
                exact_map *mean)
{
    const double phi = omega_rad_s * span_s;
    const double per_s = span_s > 0.0 ? 1.0 / span_s : 0.0;
    matrix A = {{-R_ohm * span_s / L_d_H, phi}, {-phi, -R_ohm * span_s / L_q_H}};
    matrix turn = {{0.0, phi}, {-phi, 0.0}};
    matrix zero = {{0.0, 0.0}, {0.0, 0.0}};
    matrix span = {{span_s, 0.0}, {0.0, span_s}};
    series_term term = {.map.decay = {{1.0, 0.0}, {0.0, 1.0}}, .voltage = {{span_s, 0.0}, {0.0, span_s}}};
    double largest = 1.0;
    *end = (exact_map){.decay = {{0.0}}};
    if (mean != NULL) {
        *mean = *end;
    }
    for (int n = 0; n < TERMS && largest > 1e-20; n++) {
        largest = add_term(end->decay, term.map.decay, 1.0);
        largest = fmax(largest, per_s * add_term(end->drive, term.map.drive, 1.0));
        largest = fmax(largest, per_s * add_term(end->push, term.map.push, 1.0));
        if (mean != NULL) {
            /* A power's mean over the span is its (n+1)th part. */
            (void)add_term(mean->decay, term.map.decay, 1.0 / (n + 1));
            (void)add_term(mean->drive, term.map.drive, 1.0 / (n + 1));
            (void)add_term(mean->push, term.map.push, 1.0 / (n + 1));
        }
        series_term next = term;
        next_term(A, term.map.decay, zero, n + 1, next.map.decay);
        next_term(A, term.map.drive, term.voltage, n + 1, next.map.drive);
        next_term(A, term.map.push, n == 0 ? span : zero, n + 1, next.map.push);
        next_term(turn, term.voltage, zero, n + 1, next.voltage);
        term = next;
    }
}
