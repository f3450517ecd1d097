/* Rows in which one of three current sensors is at fault (sensor_fault.h). */
#include "sensor_fault.h"

#include "base/solve.h"
#include "base/sort.h"
#include "diagnose/identify/corrected_rows.h"
#include "diagnose/identify/observer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What three sound sensors leave of their sum: an offset, gains, a cubic of each. */
enum { TERMS = 6, FITS = 4 };
/* Multiples of the rows' deviation: beyond the first a row is reported and left out of a fit; beyond the second it is
 * corrected, once the sensor is known. */
static const double TOLD = 8.0;
static const double CORRECTED = 5.0;
static const double LEFT_OUT = 4.0;
static const double INNER = 0.95; /* of the rows: these tell the deviation */
/* So many rows at the least, so large a part at the most. */
enum { LEAST_ROWS = 4 };
static const double MOST_ROWS = 0.3;
/* More rows than this part are not left out of a fit: hardly any would stay. */
static const double MOST_LEFT_OUT = 0.03;
/* Log of the odds of a phase against the next best, and the part of what the rows cost beyond sound ones that may stay with it. */
static const double CERTAIN = 10.0;
static const double STAYS = 0.5;

/* The three phases, and none of them: the rows as they were recorded. */
enum { AS_RECORDED = 3, SUSPECTS };

typedef struct fault {
    diagnose_rows *r;
    double *left_A;  /* of the sum, beyond what sound sensors leave */
    double *scratch; /* as many */
    double deviation_A;
    double term[TERMS];
} fault;

static void terms_of(vec_ab i, double x[TERMS])
{
    double phase[3];
    vec_to_phases(i, phase);
    x[0] = 1.0;
    x[1] = i.alpha;
    x[2] = i.beta;
    for (size_t n = 0; n < 3; n++) {
        x[3 + n] = phase[n] * phase[n] * phase[n];
    }
}

/* What sound sensors show as the sum of three at a current. */
static double sound(const fault *f, vec_ab i)
{
    double x[TERMS];
    double sum = 0.0;
    terms_of(i, x);
    for (size_t n = 0; n < TERMS; n++) {
        sum += f->term[n] * x[n];
    }
    return sum;
}

/* Of the inner rows, by what they would have of a normal noise: rounding to a coarse step leaves no middle that tells. */
static void measure_deviation(fault *f)
{
    const size_t rows = f->r->rows;
    for (size_t k = 0; k < rows; k++) {
        f->scratch[k] = fabs(f->left_A[k]);
    }
    sort_ascending(f->scratch, rows);
    const size_t inner = (size_t)(INNER * (double)rows);
    double square = 0.0;
    for (size_t k = 0; k < inner; k++) {
        square += f->scratch[k] * f->scratch[k];
    }
    const double cut = 0.759; /* of a normal's square, its inner 95 % */
    f->deviation_A = inner > 0 ? sqrt(square / (double)inner / cut) : 0.0;
}

/* Fitted to the rows that do not stand out, again and again. */
static void fit_sound(fault *f)
{
    const diagnose_rows *r = f->r;
    for (int again = 0; again < FITS; again++) {
        double h[TERMS * TERMS] = {0.0};
        double g[TERMS] = {0.0};
        for (size_t k = 0; k < r->rows; k++) {
            double x[TERMS];
            if (again > 0 && fabs(f->left_A[k]) > LEFT_OUT * f->deviation_A) {
                continue;
            }
            terms_of(r->row[k].i_A, x);
            for (size_t n = 0; n < TERMS; n++) {
                g[n] += x[n] * 3.0 * r->row[k].i_zero_A;
                for (size_t m = 0; m < TERMS; m++) {
                    h[n * TERMS + m] += x[n] * x[m];
                }
            }
        }
        memset(f->term, 0, sizeof f->term);
        if (!solve_positive(TERMS, TERMS, h, g, f->term)) {
            /* Currents along one line: only an offset can be found. */
            memset(f->term, 0, sizeof f->term);
            f->term[0] = h[0] > 0.0 ? g[0] / h[0] : 0.0;
        }
        for (size_t k = 0; k < r->rows; k++) {
            f->left_A[k] = 3.0 * r->row[k].i_zero_A - sound(f, r->row[k].i_A);
        }
        measure_deviation(f);
    }
}

static bool stands_out(const fault *f, size_t k, double deviations)
{
    return fabs(f->left_A[k]) > deviations * f->deviation_A;
}

/* Subtracts the excess of the row's sum from phase x: the sum is then that of sound sensors. */
static void take_from(const fault *f, cycle_row *row, size_t x)
{
    for (int again = 0; again < 3; again++) {
        const double left_A = 3.0 * row->i_zero_A - sound(f, row->i_A);
        row->i_A.alpha -= 2.0 / 3.0 * vec_phase_axis[x].alpha * left_A;
        row->i_A.beta -= 2.0 / 3.0 * vec_phase_axis[x].beta * left_A;
        row->i_zero_A -= left_A / 3.0;
    }
}

/* Squares of the one-cycle errors into each row, into f->scratch, with phase x corrected in the outlying rows. */
static bool errors_with(const fault *f, const averaged_drive *drive, const averaged_node *nodes, size_t x,
                        vec_ab *wrong)
{
    const diagnose_rows *r = f->r;
    diagnose_rows other = *r;
    other.row = malloc(r->rows * sizeof *other.row);
    if (!other.row) {
        return false;
    }
    memcpy(other.row, r->row, r->rows * sizeof *other.row);
    for (size_t k = 0; k < r->rows; k++) {
        if (x != AS_RECORDED && stands_out(f, k, TOLD)) {
            take_from(f, &other.row[k], x);
        }
    }
    for (size_t n = 0; n < r->recording->stretches; n++) {
        const stretch *st = &r->recording->stretch[n];
        observer_one_cycle(&other, drive, nodes, st->first, st->count, wrong);
        for (size_t j = 0; j < st->count; j++) {
            f->scratch[st->first + j] = wrong[j].alpha * wrong[j].alpha + wrong[j].beta * wrong[j].beta;
        }
    }
    free(other.row);
    return true;
}

/* How badly the rows are predicted that a disturbed one takes part in, as minus the log of a likelihood; and as many sound ones. */
typedef struct predicted {
    double cost[SUSPECTS], as_sound;
} predicted;

static bool takes_part(const fault *f, size_t k)
{
    return stands_out(f, k, TOLD) || stands_out(f, k - 1, TOLD);
}

/*
 * Minus the log of the likelihood of the errors in f->scratch, by Student's law of two components with two degrees of freedom: its width
 * is that of the sound rows of the same stretch, and no row can outweigh all others.
 */
static void add_stretch(const fault *f, const stretch *st, double *cost, predicted *p)
{
    double sum_A2 = 0.0;
    size_t rows = 0;
    for (size_t k = st->first; k < st->first + st->count; k++) {
        if (f->r->row[k].history > 0 && !takes_part(f, k)) {
            sum_A2 += f->scratch[k];
            rows++;
        }
    }
    if (rows == 0 || sum_A2 <= 0.0) {
        return;
    }
    const double width_A2 = sum_A2 / (double)rows;
    double sound = 0.0;
    size_t touched = 0;
    for (size_t k = st->first; k < st->first + st->count; k++) {
        if (f->r->row[k].history == 0) {
            continue;
        }
        const double one = 2.0 * log(1.0 + f->scratch[k] / width_A2);
        if (takes_part(f, k)) {
            *cost += one;
            touched++;
        } else {
            sound += one;
        }
    }
    p->as_sound += sound * (double)touched / (double)rows;
}

static bool predict_all(const fault *f, const averaged_drive *drive, predicted *p)
{
    const diagnose_rows *r = f->r;
    averaged_node *nodes = rows_nodes(r, drive);
    vec_ab *wrong = calloc(r->rows + 1, sizeof *wrong);
    bool ok = nodes && wrong;
    *p = (predicted){.as_sound = 0.0};
    for (size_t x = 0; ok && x < SUSPECTS; x++) {
        ok = errors_with(f, drive, nodes, x, wrong);
        p->as_sound = 0.0;
        for (size_t n = 0; ok && n < r->recording->stretches; n++) {
            add_stretch(f, &r->recording->stretch[n], &p->cost[x], p);
        }
    }
    free(nodes);
    free(wrong);
    return ok;
}

/*
 * The phase that by far the likeliest was disturbed, AS_RECORDED if none. The drive may be rough: with the right phase these rows are
 * predicted as badly as all others, with a wrong one worse than as recorded.
 */
static size_t likeliest(const predicted *p)
{
    size_t best = AS_RECORDED;
    for (size_t x = 0; x < AS_RECORDED; x++) {
        best = p->cost[x] < p->cost[best] ? x : best;
    }
    for (size_t x = 0; x < SUSPECTS; x++) {
        if (x != best && p->cost[x] - p->cost[best] < CERTAIN) {
            return AS_RECORDED;
        }
    }
    return p->cost[best] - p->as_sound < STAYS * (p->cost[AS_RECORDED] - p->as_sound) ? best : AS_RECORDED;
}

static size_t count_told(const fault *f)
{
    size_t told = 0;
    for (size_t k = 0; k < f->r->rows; k++) {
        told += stands_out(f, k, TOLD);
    }
    return told;
}

/* A row at fault, and the next, which a model would predict from it: left out of what is fitted, or let in again. */
static void leave_out(const fault *f, bool out)
{
    for (size_t k = 1; k < f->r->rows; k++) {
        if (takes_part(f, k)) {
            f->r->outlier[k] = out ? 1 : 0;
        }
    }
}

static bool look(fault *f, const averaged_drive *drive, const motor *file, size_t *corrected)
{
    diagnose_rows *r = f->r;
    predicted p;
    fit_sound(f);
    const size_t told = count_told(f);
    if (told < LEAST_ROWS || (double)told > MOST_ROWS * (double)r->rows) {
        return true;
    }
    if (!predict_all(f, drive, &p)) {
        return false;
    }
    const size_t phase = likeliest(&p);
    if (phase == AS_RECORDED) {
        leave_out(f, (double)told <= MOST_LEFT_OUT * (double)r->rows);
        return true;
    }
    leave_out(f, false);
    const double number = (double)phase + 1.0;
    const row_correction found = {
        .cause = CAUSE_SENSOR_FAULT, .value = {number}, .low = {number}, .high = {number}};
    if (!corrected_rows_keep(r, &found, file)) {
        return false;
    }
    for (size_t k = 0; k < r->rows; k++) {
        if (stands_out(f, k, CORRECTED)) {
            take_from(f, &r->row[k], phase);
            ++*corrected;
        }
    }
    return true;
}

bool measure_sensor_fault(diagnose_rows *r, const averaged_drive *drive, const motor *file, size_t *corrected)
{
    *corrected = 0;
    if (r->sensors != SENSORS_THREE) {
        return true;
    }
    fault f = {
        .r = r, .left_A = calloc(r->rows, sizeof *f.left_A), .scratch = calloc(r->rows, sizeof *f.scratch)};
    const bool ok = f.left_A && f.scratch && look(&f, drive, file, corrected);
    free(f.left_A);
    free(f.scratch);
    return ok;
}
