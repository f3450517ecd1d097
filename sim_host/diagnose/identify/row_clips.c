/* The end of the current sensors' range (row_clips.h). */
#include "row_clips.h"

#include <math.h>

/* The range "at the end", as a share of the end. The two ends of a converter differ by one step. */
static const double AT_END = 0.999;
enum { LEAST_ROWS = 4 };
/* Least ratio of the sum's deviation at the end to that elsewhere, and least of the former as a share of the end: more than digits. */
static const double TIMES_ELSEWHERE = 5.0;
static const double LEAST_SHARE = 1e-6;

/* The sum of the three currents over rows. */
typedef struct tally {
    size_t rows;
    double sum_A, square_A2;
    double short_A; /* by how much it falls short of what the currents at the end would have it */
} tally;

static bool is_at(double i_A, double end_A)
{
    return fabs(i_A) > AT_END * end_A;
}

static void count_row(const recording *rec, size_t k, double end_A, tally *t)
{
    double sum_A = 0.0;
    double sign = 0.0;
    double ended = 0.0;
    for (size_t x = 0; x < 3; x++) {
        const double i_A = rec->i_A[x][k];
        sign += is_at(i_A, end_A) ? copysign(1.0, i_A) : 0.0;
        ended += is_at(i_A, end_A) ? 1.0 : 0.0;
        sum_A += i_A;
    }
    t->rows++;
    t->sum_A += sum_A;
    t->square_A2 += sum_A * sum_A;
    /* Two at opposite ends do not tell which one lacks more. */
    t->short_A -= fabs(sign) >= ended ? sign * sum_A : 0.0;
}

static double deviation_A(const tally *t)
{
    const double rows = (double)t->rows;
    return t->rows > 0 ? sqrt(fmax(t->square_A2 / rows - t->sum_A * t->sum_A / (rows * rows), 0.0)) : 0.0;
}

double row_clips_end_A(const recording *rec)
{
    double end_A = 0.0;
    tally at = {.rows = 0};
    tally elsewhere = {.rows = 0};
    if (!recording_three_sensors(rec)) {
        return INFINITY;
    }
    for (size_t x = 0; x < 3; x++) {
        for (size_t k = 0; k < rec->rows; k++) {
            end_A = fmax(end_A, fabs(rec->i_A[x][k]));
        }
    }
    for (size_t k = 0; k < rec->rows; k++) {
        count_row(rec, k, end_A, row_clips_at(rec, k, end_A) ? &at : &elsewhere);
    }
    const bool moves =
        deviation_A(&at) > fmax(TIMES_ELSEWHERE * deviation_A(&elsewhere), LEAST_SHARE * end_A);
    return at.rows >= LEAST_ROWS && elsewhere.rows >= LEAST_ROWS && moves && at.short_A >= 0.0 ? end_A
                                                                                               : INFINITY;
}

bool row_clips_at(const recording *rec, size_t k, double end_A)
{
    for (size_t x = 0; x < 3; x++) {
        if (is_at(rec->i_A[x][k], end_A)) {
            return true;
        }
    }
    return false;
}
