/* A recording's stretches, and its current and voltage in a row (recording.h). */
#include "recording.h"
#include "base/sort.h"

#include "recording_columns.h"
#include "time_stamps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A step longer than this many control cycles is a gap: interfaces.md, "The recording". */
static const double gap_in_cycles = 1.5;

void recording_free(recording *r)
{
    for (int id = 0; id < COL_COUNT; id++) {
        double **column = recording_column(r, (column_id)id);
        if (column != NULL) {
            free(*column);
        }
    }
    free(r->run);
    free(r->line);
    free(r->stretch);
    *r = (recording){0};
}

bool recording_three_sensors(const recording *r)
{
    double sum2 = 0.0;
    double size2 = 0.0;
    for (size_t k = 0; r->i_c_measured && k < r->rows; k++) {
        const double sum = r->i_A[0][k] + r->i_A[1][k] + r->i_A[2][k];
        sum2 += sum * sum;
        size2 += r->i_A[0][k] * r->i_A[0][k] + r->i_A[1][k] * r->i_A[1][k];
    }
    return sum2 > 1e-8 * size2;
}

vec_ab recording_current(const recording *r, size_t k)
{
    const double i_A[3] = {r->i_A[0][k], r->i_A[1][k], r->i_A[2][k]};
    return vec_from_phases(i_A);
}

void recording_commanded(const double duty[3], double u_dc_V, double u_V[3])
{
    const double mean = (duty[0] + duty[1] + duty[2]) / 3.0;
    for (int phase = 0; phase < 3; phase++) {
        u_V[phase] = (duty[phase] - mean) * u_dc_V;
    }
}

void recording_voltage(const recording *r, size_t k, double u_V[3])
{
    if (r->u_V[0] != NULL) {
        for (int phase = 0; phase < 3; phase++) {
            u_V[phase] = r->u_V[phase][k];
        }
        return;
    }
    const double duty[3] = {r->duty[0][k], r->duty[1][k], r->duty[2][k]};
    recording_commanded(duty, r->u_dc_V[k], u_V);
}

static bool is_same_run(const recording *r, size_t k)
{
    return r->run == NULL || r->run[k] == r->run[k - 1];
}

/* Median step of t_s within runs, of the steps not longer than `longest`; 0 if there is none. */
static double median_step(const recording *r, double longest, double *steps)
{
    size_t count = 0;
    for (size_t k = 1; k < r->rows; k++) {
        const double step = r->t_s[k] - r->t_s[k - 1];
        if (is_same_run(r, k) && step <= longest) {
            steps[count++] = step;
        }
    }
    if (count == 0) {
        return 0.0;
    }
    sort_ascending(steps, count);
    return count % 2 == 1 ? steps[count / 2] : 0.5 * (steps[count / 2 - 1] + steps[count / 2]);
}

/* Marks the first row after each gap or change of run; returns their number. */
static size_t mark_starts(const recording *r, unsigned char *starts)
{
    size_t count = 0;
    for (size_t k = 0; k < r->rows; k++) {
        starts[k] = k == 0 || !is_same_run(r, k) || r->t_s[k] - r->t_s[k - 1] > gap_in_cycles * r->T_s;
        count += starts[k];
    }
    return count;
}

static size_t count_starts(const unsigned char *starts, size_t rows)
{
    size_t count = 0;
    for (size_t k = 0; k < rows; k++) {
        count += starts[k];
    }
    return count;
}

/* Finds T_s and where stretches start, and how many there are. */
static size_t find_starts(recording *r, unsigned char *starts, unsigned char *coarse, double *steps)
{
    /* Gaps count in the first median too. They are few and long, so that it still tells what a gap is. */
    const double first = median_step(r, INFINITY, steps);
    r->T_s = median_step(r, gap_in_cycles * first, steps);
    const size_t found = mark_starts(r, starts);
    /* A ladder that explains the stamps cuts no more than a median does; stamps that jitter have none. */
    const double ladder = time_stamps_ladder(r, first, coarse, steps);
    const size_t on_ladder = ladder > 0.0 ? count_starts(coarse, r->rows) : 0;
    if (on_ladder == 0 || on_ladder > found) {
        return found;
    }
    r->T_s = ladder;
    memcpy(starts, coarse, r->rows);
    return on_ladder;
}

static bool fill_stretches(recording *r, const unsigned char *starts, size_t count)
{
    r->stretch = calloc(count, sizeof *r->stretch);
    if (r->stretch == NULL) {
        return false;
    }
    for (size_t k = 0; k < r->rows; k++) {
        if (k == 0 || starts[k]) {
            r->stretch[r->stretches++] = (stretch){.first = k, .run = r->run != NULL ? r->run[k] : 0};
        }
        r->stretch[r->stretches - 1].count++;
    }
    return true;
}

bool recording_find_stretches(recording *r)
{
    free(r->stretch);
    r->stretch = NULL;
    r->stretches = 0;
    if (r->rows == 0) {
        return true;
    }
    double *steps = malloc(r->rows * sizeof *steps);
    unsigned char *starts = malloc(2 * r->rows);
    const bool ok = steps != NULL && starts != NULL &&
                    fill_stretches(r, starts, find_starts(r, starts, starts + r->rows, steps));
    free(steps);
    free(starts);
    return ok;
}
