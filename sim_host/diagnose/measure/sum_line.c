/* A line in the sum of the three measured currents (sum_line.h). */
#include "sum_line.h"

#include "base/fourier.h"
#include "base/solve.h"
#include "base/vector.h"
#include "model/sensor_chain.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UNKNOWNS = 3, LONGEST = 8192, SHORTEST = 128, STRETCHES_MOST = 200 };

static const double OVER_NOISE = 2.0;       /* rms of the sum, in that of the sensors' noise */
static const double LINE_SHARE = 0.3;       /* of the sum's power, in its strongest line */
static const double SAME_BINS = 2.0;        /* two stretches show one frequency if no further apart */
static const double STRETCHES_SHARE = 0.66; /* of the stretches show it */

/*
 * The mean of the three currents as it would be of sensors with gains and offsets alone: x . (alpha, beta, 1). h: the
 * products of the three columns, summed over the rows.
 */
static bool fit_sensors(const recording *rec, double x[UNKNOWNS], double h[UNKNOWNS][UNKNOWNS])
{
    memset(h, 0, UNKNOWNS * sizeof h[0]);
    double g[UNKNOWNS] = {0.0};
    for (size_t k = 0; k < rec->rows; k++) {
        const double i[3] = {rec->i_A[0][k], rec->i_A[1][k], rec->i_A[2][k]};
        const vec_ab v = vec_from_phases(i);
        const double row[UNKNOWNS] = {v.alpha, v.beta, 1.0};
        for (size_t m = 0; m < UNKNOWNS; m++) {
            g[m] += row[m] * (i[0] + i[1] + i[2]) / 3.0;
            for (size_t n = 0; n < UNKNOWNS; n++) {
                h[m][n] += row[m] * row[n];
            }
        }
    }
    double inverse[UNKNOWNS][UNKNOWNS];
    if (!solve_inverse(UNKNOWNS, UNKNOWNS, &h[0][0], &inverse[0][0])) {
        return false;
    }
    for (size_t m = 0; m < UNKNOWNS; m++) {
        x[m] = 0.0;
        for (size_t n = 0; n < UNKNOWNS; n++) {
            x[m] += inverse[m][n] * g[n];
        }
    }
    return true;
}

static double left_of(const recording *rec, size_t k, const double x[UNKNOWNS])
{
    const double i[3] = {rec->i_A[0][k], rec->i_A[1][k], rec->i_A[2][k]};
    const vec_ab v = vec_from_phases(i);
    return (i[0] + i[1] + i[2]) / 3.0 - x[0] * v.alpha - x[1] * v.beta - x[2];
}

/* The strongest line of one stretch. */
typedef struct line {
    double Hz, bin_Hz, power_A2;
} line;

static line strongest(const recording *rec, const stretch *st, const double x[UNKNOWNS], fourier *transform,
                      fourier_number *from, fourier_number *to)
{
    size_t n = SHORTEST;
    while (2 * n <= st->count && 2 * n <= LONGEST) {
        n *= 2;
    }
    for (size_t j = 0; j < n; j++) {
        from[j] = (fourier_number){left_of(rec, st->first + j, x), 0.0};
    }
    fourier_forward(transform, n, from, to);
    size_t best = 1;
    for (size_t k = 1; k <= n / 2; k++) {
        const double own = to[k].re * to[k].re + to[k].im * to[k].im;
        best = own > to[best].re * to[best].re + to[best].im * to[best].im ? k : best;
    }
    /* A line between two bins lies in both and their neighbours; a real one in as many of negative frequency. */
    double power = 0.0;
    double moment = 0.0;
    for (size_t k = best > 2 ? best - 2 : 1; k <= best + 2 && k <= n / 2; k++) {
        const double own = to[k].re * to[k].re + to[k].im * to[k].im;
        power += own;
        moment += own * (double)k;
    }
    const double bin_Hz = 1.0 / ((double)n * rec->T_s);
    return (line){moment / fmax(power, 1e-300) * bin_Hz, bin_Hz, 2.0 * power / ((double)n * (double)n)};
}

/* Of the current's size, beyond the gains that are named: more than their reporting threshold can make. */
static const double FOLLOWS = 0.004;

/* A part of the mean that follows the currents: its rms in that of the currents, so that an axis without current counts for nothing. */
static void tell_what_follows(const averaged_drive *drive, const double x[UNKNOWNS],
                              double h[UNKNOWNS][UNKNOWNS], diagnosis_structure *found)
{
    const sensor_map sensors = sensor_map_of(drive, MISSING_NONE);
    const double a = x[0] - sensors.zero[0];
    const double b = x[1] - sensors.zero[1];
    const double power = a * a * h[0][0] + 2.0 * a * b * h[0][1] + b * b * h[1][1];
    const double follows = sqrt(2.0 * fmax(power, 0.0) / (h[0][0] + h[1][1]));
    if (follows < FOLLOWS) {
        return;
    }
    const size_t used = strlen(found->words);
    found->certain = true;
    snprintf(found->words + used, sizeof found->words - used,
             "%sthe sum of the three currents, which is 0 in the machine, follows them by %.2g %%: gains of "
             "the current sensors "
             "that no named cause has, or crosstalk between their channels",
             used ? "; " : "", 300.0 * follows);
}

static void tell(diagnosis_structure *found, double Hz, double amplitude_A)
{
    const size_t used = strlen(found->words);
    found->certain = true;
    snprintf(found->words + used, sizeof found->words - used,
             "%sthe sum of the three currents, which is 0 in the machine, swings at %.3g Hz with an "
             "amplitude of %.3g A: "
             "the current sensors or their converter pick it up",
             used ? "; " : "", Hz, amplitude_A);
}

/* The frequency that most of the stretches share. */
static void look(const diagnose_rows *r, double noise_A, const double x[UNKNOWNS], fourier *transform,
                 fourier_number *work, diagnosis_structure *found)
{
    const recording *rec = r->recording;
    line of[STRETCHES_MOST];
    size_t n = 0;
    double total_A2 = 0.0;
    for (size_t k = 0; k < rec->rows; k++) {
        const double left = left_of(rec, k, x);
        total_A2 += left * left / (double)rec->rows;
    }
    /* Of three sensors the mean has a third of the noise's power. */
    if (total_A2 <= OVER_NOISE * OVER_NOISE * noise_A * noise_A / 3.0) {
        return;
    }
    for (size_t s = 0; s < rec->stretches && n < STRETCHES_MOST; s++) {
        if (rec->stretch[s].count >= SHORTEST) {
            of[n++] = strongest(rec, &rec->stretch[s], x, transform, work, work + LONGEST);
        }
    }
    for (size_t k = 0; k < n; k++) {
        size_t alike = 0;
        double power_A2 = 0.0;
        double Hz = 0.0;
        for (size_t j = 0; j < n; j++) {
            if (fabs(of[j].Hz - of[k].Hz) <= SAME_BINS * fmax(of[j].bin_Hz, of[k].bin_Hz)) {
                alike++;
                power_A2 += of[j].power_A2;
                Hz += of[j].Hz;
            }
        }
        if ((double)alike >= STRETCHES_SHARE * (double)n &&
            power_A2 / (double)alike >= LINE_SHARE * total_A2) {
            /* The mean of the three has a third of their sum. */
            tell(found, Hz / (double)alike, 3.0 * sqrt(2.0 * power_A2 / (double)alike));
            return;
        }
    }
}

bool sum_line_tell(const diagnose_rows *r, const averaged_drive *drive, double noise_A,
                   diagnosis_structure *found)
{
    double x[UNKNOWNS];
    double h[UNKNOWNS][UNKNOWNS];
    if (r->sensors != SENSORS_THREE || !fit_sensors(r->recording, x, h)) {
        return true;
    }
    fourier *transform = fourier_new();
    fourier_number *work = calloc(2 * (size_t)LONGEST, sizeof *work);
    const bool ok = transform && work;
    if (ok) {
        tell_what_follows(drive, x, h, found);
        look(r, noise_A, x, transform, work, found);
    }
    fourier_free(transform);
    free(work);
    return ok;
}
