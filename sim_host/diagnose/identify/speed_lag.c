/* Finds and corrects a speed that lags the angle (speed_lag.h). */
#include "speed_lag.h"

#include "corrected_rows.h"
#include "model/late_speed.h"
#include "row_speeds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * A stretch is cut into parts. In each part the difference between the angle and the integrated speed begins at any value, because
 * what adds up over longer times has other causes. A point is the mean of some rows, so that the column's noise is small against its
 * change.
 */
enum { PARTS = 8, PART_ROWS_LEAST = 64, PART_ROWS_MOST = 400, POINTS = 16, PARTS_LEAST = 6 };

static const double LEAST_CYCLES = 1.5;  /* an angle delay is shorter */
static const double MOST_S = 1.0;        /* a slower speed column is of no use */
static const double CERTAIN = 8.0;       /* in standard deviations */
static const double LEAST_SIGNAL = 0.75; /* of the speed's variance: with less, the noise would shorten tau */
static const double LEAST_ERROR =
    0.005; /* of the fastest speed, rms: with less, the EMF is right for practical purposes */
static const double MORE = 0.02; /* model error of tau, as a share: part of each interval */

/* The columns of a point: possible causes of the integrated difference (time, angle turned, speed), and that difference. */
enum { TIME, TURNED, SPEED, DIFFERENCE, COLUMNS };

typedef struct points {
    size_t count;
    double (*at)[COLUMNS]; /* about the part's mean */
    size_t *part;
    size_t parts;
    double noise; /* sum over the points: variance of their speeds by the column's noise */
} points;

static void add_part(const recording *rec, size_t first, size_t rows, points *p)
{
    const size_t wide = rows / POINTS > 0 ? rows / POINTS : 1;
    const size_t begin = p->count;
    double at[COLUMNS] = {0.0};
    double sum[COLUMNS] = {0.0};
    double mean[COLUMNS] = {0.0};
    double steps = 0.0;
    for (size_t j = 0; j < rows / wide * wide; j++) {
        const size_t k = first + j;
        const double omega = rec->omega_e_rad_s[k];
        if (j > 0) {
            const double before = rec->omega_e_rad_s[k - 1];
            const double expected = 0.5 * (omega + before) * rec->T_s;
            const double step = rec->theta_e_rad[k] - rec->theta_e_rad[k - 1] - expected;
            at[DIFFERENCE] += step - VEC_TWO_PI * round(step / VEC_TWO_PI);
            at[TURNED] += expected;
            at[TIME] += rec->T_s;
            steps += (omega - before) * (omega - before);
        }
        at[SPEED] = omega;
        for (size_t n = 0; n < COLUMNS; n++) {
            sum[n] += at[n] / (double)wide;
        }
        if ((j + 1) % wide == 0) {
            memcpy(p->at[p->count], sum, sizeof sum);
            memset(sum, 0, sizeof sum);
            p->part[p->count++] = p->parts;
        }
    }
    const double count = (double)(p->count - begin);
    for (size_t k = begin; k < p->count; k++) {
        for (size_t n = 0; n < COLUMNS; n++) {
            mean[n] += p->at[k][n] / count;
        }
    }
    for (size_t k = begin; k < p->count; k++) {
        for (size_t n = 0; n < COLUMNS; n++) {
            p->at[k][n] -= mean[n];
        }
    }
    p->noise += (count - 1.0) * 0.5 * steps / (double)rows / (double)wide;
    p->parts++;
}

static void collect(const recording *rec, points *p)
{
    for (size_t s = 0; s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        size_t rows = st->count / PARTS;
        rows = rows < PART_ROWS_LEAST ? PART_ROWS_LEAST : (rows > PART_ROWS_MOST ? PART_ROWS_MOST : rows);
        for (size_t first = 0; first + rows <= st->count; first += rows) {
            add_part(rec, st->first + first, rows, p);
        }
    }
}

static double product(const points *p, size_t a, size_t b)
{
    double sum = 0.0;
    for (size_t k = 0; k < p->count; k++) {
        sum += p->at[k][a] * p->at[k][b];
    }
    return sum;
}

/* Removes from column n its regression on column `by`, with one factor for all points. */
static void clear_of(points *p, size_t n, size_t by, double own)
{
    const double norm = product(p, by, by);
    const double factor = norm > 1e-9 * own ? product(p, n, by) / norm : 0.0;
    for (size_t k = 0; k < p->count; k++) {
        p->at[k][n] -= factor * p->at[k][by];
    }
}

/* tau and its interval, by the scores of the parts. False: the speed hardly changes, or a lag is not certain. */
static bool slope_of(points *p, double T_s, row_correction *found)
{
    /* Removes what an offset or a scale error of the speed column can make of the difference. */
    const double turned = product(p, TURNED, TURNED);
    clear_of(p, TURNED, TIME, 0.0);
    clear_of(p, SPEED, TIME, 0.0);
    clear_of(p, DIFFERENCE, TIME, 0.0);
    clear_of(p, SPEED, TURNED, turned);
    clear_of(p, DIFFERENCE, TURNED, turned);
    const double power = product(p, SPEED, SPEED);
    const double signal = power - p->noise;
    if (p->parts < PARTS_LEAST || !(signal > LEAST_SIGNAL * power)) {
        return false;
    }
    const double tau_s = product(p, SPEED, DIFFERENCE) / signal;
    double scores = 0.0;
    for (size_t k = 0; k < p->count;) {
        double score = 0.0;
        const size_t part = p->part[k];
        for (; k < p->count && p->part[k] == part; k++) {
            score += p->at[k][SPEED] * (p->at[k][DIFFERENCE] - tau_s * p->at[k][SPEED]);
        }
        scores += score * score;
    }
    const double parts = (double)p->parts;
    const double deviation_s = sqrt(scores * parts / (parts - 3.0)) / signal;
    const double half_s = 1.959963984540054 * deviation_s + MORE * fabs(tau_s);
    *found = (row_correction){
        .cause = CAUSE_SPEED_LAG, .value = {tau_s}, .low = {tau_s - half_s}, .high = {tau_s + half_s}};
    return tau_s > CERTAIN * deviation_s && tau_s - half_s > LEAST_CYCLES * T_s && tau_s < MOST_S;
}

static bool find(const recording *rec, row_correction *found, bool *certain)
{
    points p = {.at = calloc(rec->rows + 1, sizeof *p.at), .part = calloc(rec->rows + 1, sizeof *p.part)};
    const bool ok = p.at && p.part;
    if (ok) {
        collect(rec, &p);
        *certain = slope_of(&p, rec->T_s, found);
    }
    free(p.at);
    free(p.part);
    return ok;
}

/* The true speeds of all rows; NULL: out of memory. */
static double *true_speeds(const diagnose_rows *r, double tau_s)
{
    const recording *rec = r->recording;
    double *true_speed = calloc(r->rows, sizeof *true_speed);
    for (size_t s = 0; true_speed && s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        late_speed_undo(rec->omega_e_rad_s + st->first, st->count, r->T_s, tau_s, true_speed + st->first);
    }
    return true_speed;
}

/* The rms error of the speed column, as a share of the fastest speed. */
static double share_of(const diagnose_rows *r, const double *true_speed)
{
    double square = 0.0;
    double fastest = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const double off = true_speed[k] - r->recording->omega_e_rad_s[k];
        square += off * off / (double)r->rows;
        fastest = fmax(fastest, fabs(true_speed[k]));
    }
    return fastest > 0.0 ? sqrt(square) / fastest : 0.0;
}

static bool give_speeds(diagnose_rows *r, const double *true_speed)
{
    for (size_t k = 0; k < r->rows; k++) {
        cycle_row *row = &r->row[k];
        row->omega_rad_s = true_speed[k];
        row->cos_turn = cos(row->omega_rad_s * r->T_s);
        row->sin_turn = sin(row->omega_rad_s * r->T_s);
    }
    rows_correct_speed(r);
    return rows_place_nodes(r);
}

static bool give_known(diagnose_rows *r, double tau_s)
{
    double *known = true_speeds(r, tau_s);
    const bool ok = known && give_speeds(r, known);
    free(known);
    return ok;
}

bool speed_lag_correct(diagnose_rows *r, const motor *file, bool search)
{
    const recording *rec = r->recording;
    const double known_s = file->ext.has[CAUSE_SPEED_LAG] ? file->ext.speed_lag_s : 0.0;
    row_correction found = {.cause = CAUSE_SPEED_LAG};
    bool certain = false;
    if (known_s != 0.0 && !give_known(r, known_s)) {
        return false;
    }
    if (rec->omega_derived || !search || !find(rec, &found, &certain)) {
        return rec->omega_derived || !search;
    }
    /* A lag that the motor file has already is kept. */
    if (!certain || !corrected_rows_are_news(&found, file)) {
        return true;
    }
    double *speeds = true_speeds(r, found.value[0]);
    const bool ok = speeds && (share_of(r, speeds) < LEAST_ERROR ||
                               (corrected_rows_keep(r, &found, file) && give_speeds(r, speeds)));
    free(speeds);
    return ok;
}
