/* The part of the voltages that is likely noise (row_noise.h). */
#include "row_noise.h"

#include "base/fourier.h"
#include "base/two_sided.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    LONGEST = 256, /* rows of a spectrum's window */
    SHORTEST = 32, /* a shorter one shows nothing of a machine's memory */
    WINDOWS = 8,   /* windows of a stretch, side by side */
    SLOW_LINES =
        2,      /* of a spectrum: what they hold the mean voltage has taken, and noise is not seen in it */
    COLUMNS = 5 /* numbers of each row to work with */
};

/* The weight of a neighbour in the mean voltage: of a hundred rows to either side. */
static const double MEAN_WEIGHT = 0.99;
/* rad per row: at lower speeds what the machine remembers is what the controller sets. */
static const double LEAST_TURN = 0.1;

/* A stretch's voltages in the rotor frame: a mean from both sides, and what is more, along it and across, as shares of it. */
typedef struct seen_voltage {
    size_t rows;
    double *mean_d, *mean_q, *along, *across;
} seen_voltage;

/* How these vary at each frequency: variances, and the covariance. */
typedef struct line {
    double along, across;
    fourier_number both;
} line;

typedef struct noise_work {
    fourier *transform;
    double *column; /* of the longest stretch, COLUMNS times */
    double window[LONGEST];
    fourier_number in[LONGEST], out[LONGEST];
    line spectrum[LONGEST];
    double from_along[LONGEST],
        from_across[LONGEST]; /* the filter, by rows behind; those ahead from the end */
} noise_work;

static vec_rotor rotor_of(const cycle_row *row)
{
    return (vec_rotor){row->cos_theta, row->sin_theta};
}

static size_t window_of(size_t rows)
{
    size_t n = LONGEST;
    while (n >= SHORTEST && rows < WINDOWS * n) {
        n /= 2;
    }
    return n >= SHORTEST ? n : 0;
}

static bool turns(const cycle_row *row)
{
    return fabs(row->omega_rad_s) * row->T_s >= LEAST_TURN;
}

static seen_voltage see(const cycle_row *row, size_t rows, double *column)
{
    const seen_voltage u = {rows, column, column + rows, column + 2 * rows, column + 3 * rows};
    double *work = column + 4 * rows;
    for (size_t j = 0; j < rows; j++) {
        const vec_dq is = vec_to_dq(row[j].u_V[0], rotor_of(&row[j]));
        u.mean_d[j] = is.d;
        u.mean_q[j] = is.q;
        u.along[j] = is.d;
        u.across[j] = is.q;
    }
    two_sided_mean(u.mean_d, work, rows, MEAN_WEIGHT);
    two_sided_mean(u.mean_q, work, rows, MEAN_WEIGHT);
    for (size_t j = 0; j < rows; j++) {
        const vec_dq mean = {u.mean_d[j], u.mean_q[j]};
        const vec_dq more = {u.along[j] - mean.d, u.across[j] - mean.q};
        const double square = mean.d * mean.d + mean.q * mean.q;
        const double per = square > 0.0 && turns(&row[j]) ? 1.0 / square : 0.0;
        u.along[j] = per * (more.d * mean.d + more.q * mean.q);
        u.across[j] = per * (more.q * mean.d - more.d * mean.q);
    }
    return u;
}

/* Adds the spectrum of a window of n rows. */
static void add_window(noise_work *w, const seen_voltage *u, size_t first, size_t n)
{
    for (size_t j = 0; j < n; j++) {
        w->in[j] = (fourier_number){w->window[j] * u->along[first + j], w->window[j] * u->across[first + j]};
    }
    fourier_forward(w->transform, n, w->in, w->out);
    for (size_t k = 0; k < n; k++) {
        /* Both are real: their own transforms are the even and the odd part. */
        const fourier_number z = w->out[k];
        const fourier_number m = w->out[(n - k) % n];
        const fourier_number a = {0.5 * (z.re + m.re), 0.5 * (z.im - m.im)};
        const fourier_number b = {0.5 * (z.im + m.im), 0.5 * (m.re - z.re)};
        line *at = &w->spectrum[k];
        at->along += a.re * a.re + a.im * a.im;
        at->across += b.re * b.re + b.im * b.im;
        at->both.re += a.re * b.re + a.im * b.im;
        at->both.im += a.im * b.re - a.re * b.im;
    }
}

/* The mean of the spectra of windows of n rows that overlap by half, as variances of white noise with the same spectrum. */
static void find_spectrum(noise_work *w, const seen_voltage *u, size_t n)
{
    double square = 0.0;
    double windows = 0.0;
    for (size_t j = 0; j < n; j++) {
        w->window[j] = fourier_window(j, n);
        square += w->window[j] * w->window[j];
    }
    memset(w->spectrum, 0, sizeof w->spectrum);
    for (size_t first = 0; first + n <= u->rows; first += n / 2) {
        add_window(w, u, first, n);
        windows += 1.0;
    }
    const double per = 1.0 / (square * fmax(windows, 1.0));
    for (size_t k = 0; k < n; k++) {
        line *at = &w->spectrum[k];
        *at = (line){per * at->along, per * at->across, {per * at->both.re, per * at->both.im}};
    }
}

/* What the part along varies by at a frequency if the part across is known. */
static double left_along(const line *at)
{
    return at->across > 0.0 ? at->along - (at->both.re * at->both.re + at->both.im * at->both.im) / at->across
                            : at->along;
}

static double least_left(const noise_work *w, size_t n)
{
    double least = INFINITY;
    for (size_t k = SLOW_LINES; k <= n - SLOW_LINES; k++) {
        least = fmin(least, left_along(&w->spectrum[k]));
    }
    return least;
}

/* A filter by its response, as so many rows about the present one. */
static void response_to_rows(noise_work *w, size_t n, double *rows)
{
    for (size_t k = 0; k < n; k++) {
        w->in[k].im = -w->in[k].im;
    }
    fourier_forward(w->transform, n, w->in, w->out);
    for (size_t j = 0; j < n; j++) {
        const double taper = 0.5 + 0.5 * cos(VEC_TWO_PI * (double)j / (double)n);
        rows[j] = taper * w->out[j].re / (double)n;
    }
}

/* The share of noise of this variance in what is along the mean, at line k of n. */
static double noise_share(const noise_work *w, size_t n, size_t k, double variance)
{
    const bool slow = k < SLOW_LINES || k > n - SLOW_LINES;
    return slow ? 0.0 : variance / fmax(left_along(&w->spectrum[k]), variance);
}

/* The best estimate of that noise: its share of what is along the mean, less what is across tells of that. */
static void find_filter(noise_work *w, size_t n, double variance)
{
    for (size_t k = 0; k < n; k++) {
        w->in[k] = (fourier_number){noise_share(w, n, k, variance), 0.0};
    }
    response_to_rows(w, n, w->from_along);
    for (size_t k = 0; k < n; k++) {
        const line *at = &w->spectrum[k];
        const double per = at->across > 0.0 ? noise_share(w, n, k, variance) / at->across : 0.0;
        w->in[k] = (fourier_number){-per * at->both.re, -per * at->both.im};
    }
    response_to_rows(w, n, w->from_across);
}

static void fill_in(const noise_work *w, const seen_voltage *u, size_t n, cycle_row *row)
{
    for (size_t k = 0; k < u->rows; k++) {
        double share = 0.0;
        const size_t low = k >= n / 2 ? k - n / 2 + 1 : 0;
        const size_t high = k + n / 2 < u->rows ? k + n / 2 : u->rows - 1;
        for (size_t m = low; m <= high; m++) {
            const size_t behind = (k + n - m) % n;
            share += w->from_along[behind] * u->along[m] + w->from_across[behind] * u->across[m];
        }
        const vec_dq noise = {share * u->mean_d[k], share * u->mean_q[k]};
        row[k].u_noise_V = turns(&row[k]) ? vec_to_ab(noise, rotor_of(&row[k])) : (vec_ab){0.0, 0.0};
    }
}

static void find_all(diagnose_rows *r, noise_work *w)
{
    const recording *rec = r->recording;
    double variance = INFINITY;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t s = 0; s < rec->stretches; s++) {
            const stretch *st = &rec->stretch[s];
            const size_t n = window_of(st->count);
            if (n == 0) {
                continue;
            }
            const seen_voltage u = see(r->row + st->first, st->count, w->column);
            find_spectrum(w, &u, n);
            const double least = least_left(w, n);
            if (!(least > 0.0)) {
                continue;
            }
            if (pass == 0) {
                variance = fmin(variance, least);
            } else {
                find_filter(w, n, variance);
                fill_in(w, &u, n, r->row + st->first);
                r->noise_shows = true;
            }
        }
    }
}

bool rows_find_voltage_noise(diagnose_rows *r)
{
    const recording *rec = r->recording;
    size_t longest = 0;
    for (size_t s = 0; s < rec->stretches; s++) {
        longest = rec->stretch[s].count > longest ? rec->stretch[s].count : longest;
    }
    noise_work *w = malloc(sizeof *w);
    double *column = malloc(COLUMNS * longest * sizeof *column);
    fourier *transform = fourier_new();
    const bool ok = w != NULL && column != NULL && transform != NULL;
    if (ok) {
        w->transform = transform;
        w->column = column;
        find_all(r, w);
    }
    fourier_free(transform);
    free(column);
    free(w);
    return ok;
}
