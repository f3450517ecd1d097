/* The noise floor (floor.h). */
#include "floor.h"

#include "diagnose/identify/observer.h"
#include "model/sensor_chain.h"

#include <math.h>
#include <stdlib.h>

/* Variance of the fast part of a column, from third differences; `wrap` > 0 for an angle. */
static double fast_variance(const recording *rec, const double *x, double wrap)
{
    double sum = 0.0;
    double n = 0.0;
    for (size_t s = 0; s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        for (size_t j = 3; j < st->count; j++) {
            const double *v = x + st->first + j;
            double d = v[0] - 3.0 * v[-1] + 3.0 * v[-2] - v[-3];
            d -= wrap > 0.0 ? wrap * round(d / wrap) : 0.0;
            sum += d * d;
            n += 1.0;
        }
    }
    return n > 0.0 ? sum / (20.0 * n) : 0.0;
}

/* What the one-cycle errors of a drive say of the sensors' noise, as variances of a sample's vector. */
typedef struct error_sums {
    double lag_two;  /* 0: they say nothing */
    double quietest; /* no more than this; INFINITY where no operating point has rows */
} error_sums;

/* Of white noise an operating point's sums over n rows scatter by about sqrt(1.5/n): three times that, and some more. */
static double at_most(double square, double rows)
{
    return square / rows * (1.0 + 4.0 / sqrt(rows));
}

/*
 * Two measures that structure disturbs less than it does the filter's gain. The one-cycle error of white sensor noise is a
 * difference, v(k+1) - v(k), and the lag-two autocovariance of the differenced error is its variance; white disturbances and slow
 * ones leave it alone. And sensors are as noisy at one operating point as at another: where the error is smallest it is noise at
 * the most, whatever fast structure others have.
 */
static error_sums sum_errors(const diagnose_rows *r, const averaged_drive *drive, double per_variance)
{
    averaged_node *nodes = rows_nodes(r, drive);
    size_t longest = 1;
    for (size_t b = 0; b < r->blocks; b++) {
        longest = r->block[b].count > longest ? r->block[b].count : longest;
    }
    vec_ab *e = calloc(longest, sizeof *e);
    if (!nodes || !e) {
        rows_note_no_memory(r);
    }
    double lagged = 0.0;
    double n = 0.0;
    double square[ROWS_MAX_GROUPS] = {0};
    double rows[ROWS_MAX_GROUPS] = {0};
    for (size_t b = 0; nodes && e && b < r->blocks; b++) {
        const row_block *block = &r->block[b];
        observer_one_cycle(r, drive, nodes, block->first, block->count, e);
        for (size_t j = 4; j < block->count; j++) {
            const unsigned char *bad = r->outlier + block->first + j;
            if (bad[0] || bad[-1] || bad[-2] || bad[-3]) {
                continue;
            }
            lagged += (e[j].alpha - e[j - 1].alpha) * (e[j - 2].alpha - e[j - 3].alpha) +
                      (e[j].beta - e[j - 1].beta) * (e[j - 2].beta - e[j - 3].beta);
            n += 1.0;
            square[block->group] += e[j].alpha * e[j].alpha + e[j].beta * e[j].beta;
            rows[block->group] += 1.0;
        }
    }
    free(e);
    free(nodes);
    error_sums sums = {.lag_two = n > 0.0 ? lagged / n : 0.0, .quietest = INFINITY};
    for (size_t g = 0; g < r->groups; g++) {
        if (rows[g] > 0.0) {
            sums.quietest = fmin(sums.quietest, at_most(square[g], rows[g]) / per_variance);
        }
    }
    return sums;
}

/*
 * A compensation uses the sign of the current at the cycle's start. If noise of that variance changes the sign of the
 * recorded current, a perfect model errs by twice the compensation: the mean square over the rows.
 */
static double by_wrong_signs(const diagnose_rows *r, const averaged_drive *drive, double variance)
{
    const double L = 0.5 * (drive->L_d_H + drive->L_q_H);
    const double jump_A = 2.0 * drive->compensation_V * 2.0 / 3.0 * r->T_s / L;
    const sensor_course course = sensor_course_of(drive, r->sensors);
    double sum = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const sensor_map *sensors = &course.of[r->row[k].missing].middle;
        const vec_ab i = sensor_map_unmeasure(sensors, r->row[k].i_A);
        for (int x = 0; x < 3; x++) {
            const double noise_A = rows_phase_noise(sqrt(variance), r->row[k].missing, x);
            const double wrong = 0.5 * erfc(fabs(vec_phase(i, x)) / (sqrt(2.0) * noise_A));
            sum += wrong * (1.0 - wrong);
        }
    }
    /* Of a soft switch more currents are in doubt, but each errs by less. A knee where no sign is known may be none. */
    const double per_noise = drive->compensation_knee_A / sqrt(variance);
    const double whole = per_noise > OBSERVER_SIGN_KNOWN ? 1.0 / per_noise : 1.0;
    return whole * jump_A * jump_A * sum / (double)r->rows;
}

/* A gain above which the filter does not trust the model, and says little of the noise. */
static const double UNTRUSTED = 0.6;

/* What a fit says of the noise, as the variance of a sample's vector, and whether its filter trusts the model. */
typedef struct filtered_noise {
    double variance;
    bool trusted;
} filtered_noise;

static filtered_noise filtered_noise_of(const diagnose_rows *r, const fit_state *s)
{
    double trust = 0.0;
    double noise = 0.0;
    double rows = 0.0;
    double gain = 0.0;
    for (size_t g = 0; g < r->groups; g++) {
        const group_noise *n = &s->noise[g];
        const double weight = n->rows * (1.0 - n->gain) * (1.0 - n->gain);
        noise += weight * (1.0 - n->gain) * (n->cov[0] + n->cov[2]);
        trust += weight;
        gain += n->rows * n->gain;
        rows += n->rows;
    }
    return (filtered_noise){trust > 0.0 ? noise / trust : 0.0, !(rows > 0.0 && gain / rows > UNTRUSTED)};
}

double measure_phase_noise(const diagnose_rows *r, const fit_state *s)
{
    const filtered_noise noise = filtered_noise_of(r, s);
    /* A phase of a vector has half of its power. */
    return noise.trusted ? sqrt(0.5 * noise.variance) : INFINITY;
}

double measure_floor(const diagnose_rows *r, const fit_state *s, const averaged_drive *drive,
                     double *sensor_rms_A)
{
    const filtered_noise filtered = filtered_noise_of(r, s);
    double variance = filtered.variance;
    double L = 0.5 * (drive->L_d_H + drive->L_q_H);
    double decay = exp(-drive->R_ohm * r->T_s / L);
    const double per_variance = 1.0 + decay * decay;
    if (!filtered.trusted) {
        const error_sums sums = sum_errors(r, drive, per_variance);
        variance = fmin(sums.lag_two > 0.0 ? sums.lag_two : variance, sums.quietest);
    }
    /* Three sensors: a vector carries 4/3 of one's variance. Two: alpha has 1, beta 5/3. */
    *sensor_rms_A = sqrt(variance / (r->sensors == SENSORS_THREE ? 4.0 / 3.0 : 8.0 / 3.0));
    double angle = fast_variance(r->recording, r->recording->theta_e_rad, VEC_TWO_PI);
    double link = r->recording->u_dc_V ? fast_variance(r->recording, r->recording->u_dc_V, 0.0) : 0.0;
    double more = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const cycle_row *row = &r->row[k];
        double emf = row->omega_rad_s * drive->psi_f_Wb;
        more += emf * emf * angle;
        if (r->recording->u_dc_V && r->recording->u_dc_V[k] > 0.0) {
            double share = hypot(row->u_V[0].alpha, row->u_V[0].beta) / r->recording->u_dc_V[k];
            more += share * share * link;
        }
    }
    more *= r->T_s * r->T_s / (L * L * (double)r->rows);
    if (drive->compensation_V != 0.0 && variance > 0.0) {
        /* A phase of a vector has half of its power. */
        more += by_wrong_signs(r, drive, 0.5 * variance);
    }
    return sqrt(variance * per_variance + more);
}
