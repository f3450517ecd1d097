/* Optimal pulse patterns over the index: candidates at each index, and the best path through them (patterns.h). */
#include "patterns.h"

#include "base/vector.h"
#include "carrier_ripple.h"
#include "pattern_search.h"

#include <complex.h>
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

enum { FAMILIES = 2, STARTS = 12, KEPT = 10, CANDIDATES = FAMILIES * KEPT };

/* A jump is worth it if it removes 50 % of distortion, summed over rows of 1 % of six-step. */
static const double JUMP_COST = 0.5;
/* Two patterns are the same below, rad. */
static const double SAME_RAD = 1e-4;
/* Halfway between two rows that are joined: error of the index, and the distortion over the larger of both. */
static const double JOINED_INDEX = 1e-3;
static const double JOINED_DISTORTION = 1.05;

typedef struct candidate {
    pattern_shape shape;
    double distortion;            /* of flux */
    double cost;                  /* of the best path to it from row 0 */
    const struct candidate *from; /* the row before on that path */
} candidate;

typedef struct candidates {
    int count[FAMILIES];
    candidate of[FAMILIES][KEPT];
} candidates;

double patterns_index(int row)
{
    return 0.3 + 0.01 * row;
}

double patterns_index_of(const motor *m, double w, double i_d, double i_q)
{
    const double complex i = (i_d + I * i_q) * motor_rated_peak_A(m);
    return cabs(m->R_ohm * i + I * w * (m->psi_f_Wb + m->L_d_H * i)) / m->u_dc_V * VEC_PI / 2.0;
}

/* Least angle between commanded edges, rad. */
static double gap_at(const patterns_request *a, int row)
{
    return VEC_TWO_PI * a->six_step_Hz * patterns_index(row) * (a->on_time_s + a->dead_time_s);
}

/* Keeps the best KEPT different ones of a family, best first. */
static void keep(candidates *c, const pattern_shape *s, double distortion)
{
    const int family = s->start > 0 ? 0 : 1;
    candidate *all = c->of[family];
    int n = c->count[family];
    for (int k = 0; k < n; k++) {
        double most = 0.0;
        for (int a = 0; a < s->angles; a++) {
            most = fmax(most, fabs(all[k].shape.angle[a] - s->angle[a]));
        }
        if (most < SAME_RAD) {
            return;
        }
    }
    if (n == KEPT && distortion >= all[n - 1].distortion) {
        return;
    }
    n = n < KEPT ? n : KEPT - 1;
    for (; n > 0 && all[n - 1].distortion > distortion; n--) {
        all[n] = all[n - 1];
    }
    all[n] = (candidate){*s, distortion, 0.0, NULL};
    c->count[family] += c->count[family] < KEPT;
}

static void try_from(candidates *c, pattern_shape s, const patterns_result *r, int row)
{
    if (pattern_minimum(&s, patterns_index(row), gap_at(&r->asked, row), &r->weight)) {
        keep(c, &s, pattern_distortion(&s, &r->weight));
    }
}

static void try_neighbours(candidates *c, const candidates *from, const patterns_result *r, int row)
{
    for (int family = 0; family < FAMILIES; family++) {
        for (int k = 0; k < from->count[family]; k++) {
            try_from(c, from->of[family][k].shape, r, row);
        }
    }
}

/* Starts that are spread over all patterns: exponential shares, from a fixed seed. */
static void try_anywhere(candidates *c, uint32_t *seed, const patterns_result *r, int row)
{
    const int angles = (r->asked.pulses - 1) / 2;
    for (int n = 0; n < FAMILIES * STARTS; n++) {
        pattern_shape s = {.angles = angles, .start = n % FAMILIES == 0 ? 1 : -1};
        double share[PATTERN_ANGLES_MOST + 1];
        for (int k = 0; k <= angles; k++) {
            *seed = *seed * UINT32_C(1664525) + UINT32_C(1013904223);
            share[k] = -log(((double)(*seed >> 8) + 0.5) / 16777216.0);
        }
        pattern_spread(&s, gap_at(&r->asked, row), share);
        try_from(c, s, r, row);
    }
}

static pattern_shape halfway(const pattern_shape *a, const pattern_shape *b)
{
    pattern_shape s = *a;
    for (int k = 0; k < s.angles; k++) {
        s.angle[k] = 0.5 * (a->angle[k] + b->angle[k]);
    }
    return s;
}

/* Error of the index halfway to the next row; NAN: the two cannot be joined. */
static double joint_error(const candidate *a, const candidate *b, int row, const patterns_result *r)
{
    if (a->shape.start != b->shape.start) {
        return NAN;
    }
    const pattern_shape s = halfway(&a->shape, &b->shape);
    const double off = fabs(pattern_index(&s) - 0.5 * (patterns_index(row) + patterns_index(row + 1)));
    const double limit = JOINED_DISTORTION * fmax(a->distortion, b->distortion);
    return off <= JOINED_INDEX && pattern_distortion(&s, &r->weight) <= limit ? off : NAN;
}

/* All candidates of both families, best first within each. Returns how many. */
static int listed(candidates *c, candidate *of[CANDIDATES])
{
    int n = 0;
    for (int family = 0; family < FAMILIES; family++) {
        for (int k = 0; k < c->count[family]; k++) {
            of[n++] = &c->of[family][k];
        }
    }
    return n;
}

/* The cheapest way to each candidate of a row: distortion over the row's best, and the jumps. */
static void extend_paths(candidates *before, candidates *c, int row, const patterns_result *r)
{
    candidate *here[CANDIDATES];
    candidate *there[CANDIDATES];
    const int count = listed(c, here);
    const int count_before = row > 0 ? listed(before, there) : 0;
    double best = INFINITY;
    for (int n = 0; n < count; n++) {
        best = fmin(best, here[n]->distortion);
    }
    for (int n = 0; n < count; n++) {
        here[n]->cost = row > 0 ? INFINITY : 0.0;
        for (int k = 0; k < count_before; k++) {
            const bool joined = !isnan(joint_error(there[k], here[n], row - 1, r));
            const double cost = there[k]->cost + (joined ? 0.0 : JUMP_COST);
            if (cost < here[n]->cost) {
                here[n]->cost = cost;
                here[n]->from = there[k];
            }
        }
        here[n]->cost += here[n]->distortion / best - 1.0;
    }
}

static const candidate *cheapest(candidates *c)
{
    candidate *of[CANDIDATES];
    const candidate *best = NULL;
    const int count = listed(c, of);
    for (int n = 0; n < count; n++) {
        best = best == NULL || of[n]->cost < best->cost ? of[n] : best;
    }
    return best;
}

/* Follows the path back from its end. */
static void take_path(const candidate *end, patterns_result *r)
{
    const candidate *next = NULL;
    const candidate *c = end;
    for (int row = r->rows - 1; row >= 0 && c != NULL; row--) {
        patterns_row *to = &r->row[row];
        const double off = next != NULL ? joint_error(c, next, row, r) : NAN;
        to->shape = c->shape;
        to->distortion = c->distortion * r->unit;
        to->space_vectors = carrier_ripple(r->asked.pulses, patterns_index(row), &r->weight) * r->unit;
        to->joined = !isnan(off);
        r->jumps += next != NULL && !to->joined;
        r->index_error = to->joined ? fmax(r->index_error, off) : r->index_error;
        next = c;
        c = c->from;
    }
}

/* Flux of the rated current on the q axis: what a harmonic flux costs, and the frequency of each index. */
static void rate(patterns_result *r)
{
    const motor *m = r->asked.m;
    r->weight = (pattern_weight){1.0, 1.0};
    r->unit = 1.0;
    if (m == NULL) {
        return;
    }
    double L_d_H;
    double L_q_H;
    motor_inductances(m, &L_d_H, &L_q_H);
    const double psi_q_Wb = L_q_H * motor_rated_peak_A(m);
    const double psi_Wb = hypot(m->psi_f_Wb, psi_q_Wb);
    const double cosine = m->psi_f_Wb / psi_Wb;
    const double sine = psi_q_Wb / psi_Wb;
    const double ratio = L_d_H / L_q_H;
    r->load_angle_rad = atan2(psi_q_Wb, m->psi_f_Wb);
    r->weight = (pattern_weight){hypot(cosine, ratio * sine), hypot(sine, ratio * cosine)};
    r->unit = psi_Wb / (L_d_H * motor_rated_peak_A(m));
    if (!(r->asked.six_step_Hz > 0.0)) {
        r->asked.six_step_Hz = m->u_dc_V / (VEC_PI * VEC_PI * psi_Wb);
    }
}

static int has(const candidates *c)
{
    return c->count[0] + c->count[1];
}

bool patterns_find(const patterns_request *asked, patterns_result *result, error *e)
{
    *result = (patterns_result){.asked = *asked};
    rate(result);
    const int angles = (asked->pulses - 1) / 2;
    candidates *all = calloc(PATTERNS_ROWS, sizeof *all);
    if (all == NULL) {
        return error_failure(e, ENOMEM, "patterns");
    }
    uint32_t seed = 1;
    int rows = 0;
    for (; rows < PATTERNS_ROWS && pattern_has_room(angles, gap_at(&result->asked, rows)); rows++) {
        if (rows > 0) {
            try_neighbours(&all[rows], &all[rows - 1], result, rows);
        }
        try_anywhere(&all[rows], &seed, result, rows);
        if (has(&all[rows]) == 0) {
            break;
        }
    }
    for (int row = rows - 2; row >= 0; row--) {
        try_neighbours(&all[row], &all[row + 1], result, row);
    }
    for (int row = 0; row < rows; row++) {
        extend_paths(row > 0 ? &all[row - 1] : NULL, &all[row], row, result);
    }
    result->rows = rows;
    take_path(rows > 0 ? cheapest(&all[rows - 1]) : NULL, result);
    free(all);
    return rows > 1 ||
           error_input(e, NULL, 0, 0,
                       "patterns: the least times take %.3g degrees between two edges at index %.2f, "
                       "which leaves no pattern of %d pulses; choose fewer pulses or a lower frequency",
                       360.0 / VEC_TWO_PI * gap_at(&result->asked, rows), patterns_index(rows),
                       asked->pulses);
}
