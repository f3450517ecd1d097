/* The speeds of the rows (row_speeds.h). */
#include "row_speeds.h"

#include <math.h>
#include <stdlib.h>

enum { CORRECT_ROWS_MIN = 200 /* fewer rows determine the speed worse than its column does */ };

/*
 * Adds to the speeds at a stretch's samples what makes their integral follow the angle over the whole of it: a constant, and a change in
 * proportion to time.
 */
static void follow_angle(diagnose_rows *r, const stretch *s)
{
    const recording *rec = r->recording;
    double difference = 0.0;
    double sum[3] = {0}; /* moments of the difference with the Legendre polynomials of the stretch */
    for (size_t j = 0; j < s->count; j++) {
        size_t k = s->first + j;
        if (j > 0) {
            double step = rec->theta_e_rad[k] - rec->theta_e_rad[k - 1] -
                          0.5 * (r->row[k].omega_rad_s + r->row[k - 1].omega_rad_s) * r->T_s;
            difference += step - VEC_TWO_PI * round(step / VEC_TWO_PI);
        }
        double x = 2.0 * ((double)j + 0.5) / (double)s->count - 1.0;
        sum[1] += difference * x * 3.0 / (double)s->count;
        sum[2] += difference * (1.5 * x * x - 0.5) * 5.0 / (double)s->count;
    }
    double per_row = 2.0 / ((double)s->count * r->T_s); /* dx/dt */
    for (size_t j = 0; j < s->count; j++) {
        double x = 2.0 * ((double)j + 0.5) / (double)s->count - 1.0;
        double change = (sum[1] + 3.0 * sum[2] * x) * per_row;
        cycle_row *row = &r->row[s->first + j];
        if (fabs(change) < 0.01 * fabs(row->omega_rad_s) + 0.5) {
            row->omega_rad_s += change;
        }
    }
}

void rows_correct_speed(diagnose_rows *r)
{
    for (size_t n = 0; n < r->recording->stretches; n++) {
        const stretch *s = &r->recording->stretch[n];
        if (s->count >= CORRECT_ROWS_MIN) {
            follow_angle(r, s);
        }
        for (size_t j = 0; j < s->count; j++) {
            cycle_row *row = &r->row[s->first + j];
            if (j + 1 < s->count) {
                row->omega_rad_s = 0.5 * (row->omega_rad_s + row[1].omega_rad_s);
            }
            row->cos_turn = cos(row->omega_rad_s * r->T_s);
            row->sin_turn = sin(row->omega_rad_s * r->T_s);
        }
    }
}

/*
 * The rows before correction n, the present rows (n is the number of corrections), or those before their angle was smoothed; NULL:
 * there are no such rows.
 */
static cycle_row *rows_of(const diagnose_rows *r, size_t n)
{
    if (n < r->corrections) {
        return r->correction[n].before;
    }
    return n == r->corrections ? r->row : r->rough;
}

static void find_range(const diagnose_rows *r, double step, long *lowest, long *highest)
{
    *lowest = *highest = lround(r->row[0].omega_rad_s / step);
    for (size_t m = 0; m <= r->corrections + 1; m++) {
        const cycle_row *row = rows_of(r, m);
        for (size_t k = 0; row && k < r->rows; k++) {
            const long n = lround(row[k].omega_rad_s / step);
            *lowest = n < *lowest ? n : *lowest;
            *highest = n > *highest ? n : *highest;
        }
    }
}

bool rows_place_nodes(diagnose_rows *r)
{
    const double step = AVERAGED_NODE_STEP / r->T_s;
    long lowest;
    long highest;
    find_range(r, step, &lowest, &highest);
    const size_t span = (size_t)(highest - lowest + 1);
    size_t *index = calloc(span, sizeof *index);
    free(r->node_omega_rad_s);
    r->nodes = 0;
    r->node_omega_rad_s = calloc(span, sizeof *r->node_omega_rad_s);
    if (!index || !r->node_omega_rad_s) {
        free(index);
        return false;
    }
    for (size_t m = 0; m <= r->corrections + 1; m++) {
        cycle_row *row = rows_of(r, m);
        for (size_t k = 0; row && k < r->rows; k++) {
            const double exact = row[k].omega_rad_s / step;
            const long n = lround(exact);
            size_t *slot = &index[n - lowest];
            if (*slot == 0) {
                r->node_omega_rad_s[r->nodes] = (double)n * step;
                *slot = ++r->nodes;
            }
            row[k].node = *slot - 1;
            row[k].node_h = exact - (double)n;
        }
    }
    free(index);
    return true;
}
