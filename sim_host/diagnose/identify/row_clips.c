/* The end of the current sensors' range (row_clips.h). */
#include "row_clips.h"

#include <math.h>

/* The ranges "at the end" and "just below", as shares of the end. The two ends of a converter differ by one step. */
static const double AT_END = 0.999;
static const double BELOW = 0.98;
/* Least number of rows at the end, for each of two phases or signs, and least ratio of the rows at the end to those just below it. */
enum { LEAST_ROWS = 4, TIMES_BELOW = 3 };
/* If a current is cut, the sum of the three is larger: least ratio of its rms there to that elsewhere. */
static const double TIMES_SUM = 5.0;

typedef struct tally {
    size_t at[6]; /* rows, by phase and sign */
    size_t all, below;
    double sum_at, sum_else; /* squares of the three's sum */
    double rows_at, rows_else;
} tally;

static bool is_at(double i_A, double end_A)
{
    return fabs(i_A) > AT_END * end_A;
}

static void count_row(const recording *rec, size_t k, double end_A, tally *t)
{
    double sum = 0.0;
    for (size_t x = 0; x < 3; x++) {
        const double i_A = rec->i_A[x][k];
        const bool at = is_at(i_A, end_A);
        t->at[2 * x + (i_A > 0.0 ? 1 : 0)] += at;
        t->all += at;
        t->below += !at && fabs(i_A) > BELOW * end_A;
        sum += i_A;
    }
    if (row_clips_at(rec, k, end_A)) {
        t->sum_at += sum * sum;
        t->rows_at += 1.0;
    } else {
        t->sum_else += sum * sum;
        t->rows_else += 1.0;
    }
}

double row_clips_end_A(const recording *rec)
{
    double end_A = 0.0;
    size_t ways = 0;
    tally t = {.all = 0};
    if (!recording_three_sensors(rec)) {
        return INFINITY;
    }
    for (size_t x = 0; x < 3; x++) {
        for (size_t k = 0; k < rec->rows; k++) {
            end_A = fmax(end_A, fabs(rec->i_A[x][k]));
        }
    }
    for (size_t k = 0; k < rec->rows; k++) {
        count_row(rec, k, end_A, &t);
    }
    for (size_t n = 0; n < sizeof t.at / sizeof *t.at; n++) {
        ways += t.at[n] >= LEAST_ROWS;
    }
    const bool adds_up = t.sum_at * t.rows_else <= TIMES_SUM * TIMES_SUM * t.sum_else * t.rows_at;
    return ways >= 2 && t.all > TIMES_BELOW * t.below && !adds_up ? end_A : INFINITY;
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
