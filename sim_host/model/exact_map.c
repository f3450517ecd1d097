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

/* Terms of e^(M T) = sum (M T)^n/n! for M = [A 1 1; 0 -j omega 0; 0 0 0], whose first row holds the three
 * matrices; a term's mean over the span is its (n+1)th part. */
void exact_maps(double R_ohm, double L_d_H, double L_q_H, double span_s, double omega_rad_s, exact_map *end,
                exact_map *mean)
{
    const double phi = omega_rad_s * span_s;
    matrix A = {{-R_ohm * span_s / L_d_H, phi}, {-phi, -R_ohm * span_s / L_q_H}};
    matrix turn = {{0.0, phi}, {-phi, 0.0}}; /* of the voltage, seen from the rotor */
    matrix zero = {{0.0, 0.0}, {0.0, 0.0}};
    matrix span = {{span_s, 0.0}, {0.0, span_s}};
    exact_map term = {.decay = {{1.0, 0.0}, {0.0, 1.0}}};
    matrix u = {{span_s, 0.0}, {0.0, span_s}};
    double largest = 1.0;
    *end = (exact_map){.decay = {{0.0}}};
    if (mean != NULL) {
        *mean = *end;
    }
    for (int n = 0; n < TERMS && largest > 1e-20; n++) {
        const double per_s = span_s > 0.0 ? 1.0 / span_s : 0.0;
        largest = add_term(end->decay, term.decay, 1.0);
        largest = fmax(largest, per_s * add_term(end->drive, term.drive, 1.0));
        largest = fmax(largest, per_s * add_term(end->push, term.push, 1.0));
        if (mean != NULL) {
            (void)add_term(mean->decay, term.decay, 1.0 / (n + 1));
            (void)add_term(mean->drive, term.drive, 1.0 / (n + 1));
            (void)add_term(mean->push, term.push, 1.0 / (n + 1));
        }
        exact_map next;
        matrix u_next;
        next_term(A, term.decay, zero, n + 1, next.decay);
        next_term(A, term.drive, u, n + 1, next.drive);
        next_term(A, term.push, n == 0 ? span : zero, n + 1, next.push);
        next_term(turn, u, zero, n + 1, u_next);
        term = next;
        u[0][0] = u_next[0][0];
        u[0][1] = u_next[0][1];
        u[1][0] = u_next[1][0];
        u[1][1] = u_next[1][1];
    }
}
