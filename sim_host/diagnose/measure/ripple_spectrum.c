/* Transforms of the pieces' series, and the noise in them (ripple_spectrum.h). */
#include "ripple_spectrum.h"

#include "base/fourier.h"
#include "base/sort.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

enum {
    PADDED = 4,        /* bins of the padded transform to one of the piece's own length, at the least */
    MAIN_LOBE = 3,     /* half width of a line under the window, in bins of the piece's length, */
    NOISE_BINS = 12,   /* and over how many beyond it the noise is measured */
    PERIODS_LEAST = 4, /* in a piece */
    ORDERS = 24        /* of the electrical speed */
};

static const double HIGHEST = 0.45; /* of the cycles' frequency */

double ripple_frequency_Hz(const ripple_spectra *s, double bin)
{
    return bin / ((double)s->length * s->T_s);
}

/* How many padded bins one of the piece's length is. */
static double bin_of(const ripple_spectra *s, const ripple_piece *p)
{
    return (double)s->length / (double)p->count;
}

static bool is_order(const ripple_spectra *s, const ripple_piece *p, double frequency_Hz)
{
    const double near_Hz = MAIN_LOBE / ((double)p->count * s->T_s);
    const double slow_Hz = fmin(fabs(p->slowest_rad_s), fabs(p->fastest_rad_s)) / VEC_TWO_PI;
    const double fast_Hz = fmax(fabs(p->slowest_rad_s), fabs(p->fastest_rad_s)) / VEC_TWO_PI;
    for (int n = 1; p->turns && n <= ORDERS; n++) {
        if (frequency_Hz > n * slow_Hz - near_Hz && frequency_Hz < n * fast_Hz + near_Hz) {
            return true;
        }
    }
    return false;
}

/* The middle of the power at both sides of a possible line, one bin of the piece's length after another, as a mean. */
static double noise_at(const double *power, size_t bins, size_t at, size_t bin)
{
    double scratch[2 * NOISE_BINS];
    size_t n = 0;
    for (size_t k = MAIN_LOBE + 1; k <= MAIN_LOBE + NOISE_BINS; k++) {
        if (k * bin <= at) {
            scratch[n++] = power[at - k * bin];
        }
        if (at + k * bin < bins) {
            scratch[n++] = power[at + k * bin];
        }
    }
    sort_ascending(scratch, n);
    return n > 0 ? scratch[n / 2] / 0.6931471805599453 : 0.0;
}

static bool transform_piece(ripple_spectra *s, fourier *f, const ripple_piece *p, ripple_spectrum *out)
{
    const double *series[2] = {s->all->along, s->all->across};
    fourier_number *in = calloc(2 * s->length, sizeof *in);
    const bool ok = in != NULL;
    for (size_t n = 0; ok && n < 2; n++) {
        double *power = n == 0 ? out->power : out->beside;
        double level = 0.0;
        double area = 0.0;
        out->gain = 0.0;
        for (size_t j = 0; j < p->count; j++) {
            level += series[n][p->first + j];
            area += s->all->weight[p->first + j];
        }
        for (size_t j = 0; j < p->count; j++) {
            const double w = s->all->weight[p->first + j];
            /* What is the same throughout is no ripple, and its own line would spread. */
            in[j] = (fourier_number){fourier_window(j, p->count) *
                                         (series[n][p->first + j] - (area > 0.0 ? level / area * w : 0.0)),
                                     0.0};
            out->gain += 0.5 * fourier_window(j, p->count) * w;
        }
        fourier_forward(f, s->length, in, in + s->length);
        for (size_t k = 0; k < s->bins; k++) {
            const fourier_number y = in[s->length + k];
            power[k] = y.re * y.re + y.im * y.im;
        }
    }
    free(in);
    return ok;
}

/* Measured once for each bin of the piece's own length: it changes slowly. */
static void measure_noise(const ripple_spectra *s, const ripple_piece *p, ripple_spectrum *of)
{
    const size_t bin = (size_t)ceil(bin_of(s, p));
    for (size_t k = 0; k < s->bins; k += bin) {
        const double noise = noise_at(of->power, s->bins, k, bin);
        for (size_t j = k; j < s->bins && j < k + bin; j++) {
            of->noise[j] = noise;
        }
    }
    for (size_t k = 0; k < s->bins; k++) {
        const double f = ripple_frequency_Hz(s, (double)k);
        if (f * (double)p->count * s->T_s < PERIODS_LEAST || is_order(s, p, f)) {
            of->power[k] = -1.0;
        }
    }
}

static bool allocate(ripple_spectra *s)
{
    size_t longest = 1;
    for (size_t k = 0; k < s->all->pieces; k++) {
        longest = s->all->piece[k].count > longest ? s->all->piece[k].count : longest;
    }
    for (s->length = 1; s->length < PADDED * longest; s->length *= 2) {
    }
    s->bins = (size_t)(HIGHEST * (double)s->length);
    s->of = calloc(s->all->pieces + 1, sizeof *s->of);
    for (size_t k = 0; s->of && k < s->all->pieces; k++) {
        s->of[k].power = calloc(3 * s->bins, sizeof *s->of[k].power);
        if (!s->of[k].power) {
            return false;
        }
        s->of[k].beside = s->of[k].power + s->bins;
        s->of[k].noise = s->of[k].power + 2 * s->bins;
    }
    return s->of != NULL;
}

bool ripple_spectra_make(ripple_spectra *s, const ripple_pieces *all, double T_s)
{
    *s = (ripple_spectra){.all = all, .T_s = T_s};
    fourier *f = fourier_new();
    bool ok = f && allocate(s);
    for (size_t k = 0; ok && k < all->pieces; k++) {
        ok = s->of[k].power && transform_piece(s, f, &all->piece[k], &s->of[k]);
        if (ok) {
            measure_noise(s, &all->piece[k], &s->of[k]);
        }
    }
    fourier_free(f);
    return ok;
}

void ripple_spectra_free(ripple_spectra *s)
{
    for (size_t k = 0; s->of && k < s->all->pieces; k++) {
        free(s->of[k].power);
    }
    free(s->of);
}
