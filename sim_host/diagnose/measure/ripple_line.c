/* Search for one frequency in all pieces (ripple_line.h). */
#include "ripple_line.h"

#include "base/fourier.h"
#include "base/vector.h"
#include "ripple_spectrum.h"

#include <math.h>
#include <stdlib.h>

enum { REFINE_STEPS = 30 };

static const double CHANCE =
    60.0;                         /* -log of the chance that noise alone makes such a line at one frequency */
static const double BESIDE = 0.2; /* the most across, of the power along */
static const double SHOULD_SHOW =
    9.0;                        /* times the noise: a piece in which a ripple of that size is visible */
static const double SEEN = 0.5; /* of those pieces it is */

/* How unlikely noise alone makes what all pieces show at a bin: -log of the chance. */
static double surprise_at(const ripple_spectra *s, size_t bin)
{
    double sum = 0.0;
    double n = 0.0;
    for (size_t k = 0; k < s->all->pieces; k++) {
        if (s->of[k].power[bin] >= 0.0 && s->of[k].noise[bin] > 0.0) {
            sum += s->of[k].power[bin] / s->of[k].noise[bin];
            n += 1.0;
        }
    }
    const double mean = n > 0.0 ? sum / n : 0.0;
    return mean > 1.0 ? n * (mean - 1.0 - log(mean)) : 0.0;
}

typedef struct weighed {
    double share, weight;
} weighed;

static int by_share(const void *x, const void *y)
{
    const weighed *a = x;
    const weighed *b = y;
    return (a->share > b->share) - (a->share < b->share);
}

/* The middle of the pieces' shares, by weight. */
static double share_at(const ripple_spectra *s, size_t bin)
{
    weighed *list = calloc(s->all->pieces + 1, sizeof *list);
    double all = 0.0;
    double share = 0.0;
    size_t n = 0;
    for (size_t k = 0; list && k < s->all->pieces; k++) {
        const ripple_spectrum *of = &s->of[k];
        if (of->power[bin] >= 0.0 && of->noise[bin] > 0.0 && of->gain > 0.0) {
            list[n] = (weighed){sqrt(of->power[bin]) / of->gain, of->gain / sqrt(of->noise[bin])};
            all += list[n++].weight;
        }
    }
    if (list) {
        qsort(list, n, sizeof *list, by_share);
    }
    double sum = 0.0;
    for (size_t k = 0; k < n && sum < 0.5 * all; k++) {
        sum += list[k].weight;
        share = list[k].share;
    }
    free(list);
    return share;
}

/* Whether it is seen where a ripple of that size should be, and along what the voltage does. */
static bool is_the_link(const ripple_spectra *s, size_t bin, double share)
{
    double along = 0.0;
    double across = 0.0;
    size_t should = 0;
    size_t seen = 0;
    for (size_t k = 0; k < s->all->pieces; k++) {
        const ripple_spectrum *of = &s->of[k];
        const double expected = share * share * of->gain * of->gain;
        if (of->power[bin] < 0.0 || !(expected > SHOULD_SHOW * of->noise[bin])) {
            continue;
        }
        should++;
        seen += of->power[bin] > 0.25 * expected && of->power[bin] < 4.0 * expected;
        along += of->power[bin];
        across += of->beside[bin];
    }
    return should > 0 && (double)seen >= SEEN * (double)should && across < BESIDE * along;
}

/* Likelihood of a frequency between bins, noise and order as at a bin; each piece by a sum of its own. */
static double likelihood(const ripple_spectra *s, size_t bin, double frequency_Hz)
{
    double sum = 0.0;
    for (size_t n = 0; n < s->all->pieces; n++) {
        const ripple_piece *p = &s->all->piece[n];
        const ripple_spectrum *of = &s->of[n];
        if (of->power[bin] < 0.0 || !(of->noise[bin] > 0.0)) {
            continue;
        }
        const vec_rotor by = rotor_at(VEC_TWO_PI * frequency_Hz * s->T_s);
        vec_rotor at = {1.0, 0.0};
        double re = 0.0;
        double im = 0.0;
        for (size_t j = 0; j < p->count; j++) {
            const double y = fourier_window(j, p->count) * s->all->along[p->first + j];
            re += y * at.cos;
            im += y * at.sin;
            at = rotor_turned(at, by);
        }
        sum += (re * re + im * im) / of->noise[bin];
    }
    return sum;
}

static void refine(const ripple_spectra *s, size_t bin, double share, ripple_found *found)
{
    double low = ripple_frequency_Hz(s, (double)bin - 1.0);
    double high = ripple_frequency_Hz(s, (double)bin + 1.0);
    for (int n = 0; n < REFINE_STEPS; n++) {
        const double a = low + 0.382 * (high - low);
        const double b = high - 0.382 * (high - low);
        if (likelihood(s, bin, a) > likelihood(s, bin, b)) {
            high = b;
        } else {
            low = a;
        }
    }
    const double f = 0.5 * (low + high);
    const double step = 0.25 * (ripple_frequency_Hz(s, 1.0));
    const double bend =
        (2.0 * likelihood(s, bin, f) - likelihood(s, bin, f - step) - likelihood(s, bin, f + step)) /
        (step * step);
    double precision = 0.0;
    double spread = 0.0;
    for (size_t k = 0; k < s->all->pieces; k++) {
        const ripple_spectrum *of = &s->of[k];
        if (of->power[bin] >= 0.0 && of->noise[bin] > 0.0) {
            const double p = 2.0 * of->gain * of->gain / of->noise[bin];
            const double own = sqrt(of->power[bin]) / of->gain - share;
            precision += p;
            spread += p * p * own * own;
        }
    }
    /* By the noise or by how the pieces differ, whichever says more. */
    const double deviation = fmax(1.0 / sqrt(precision), sqrt(spread) / precision);
    *found = (ripple_found){.share = share,
                            .share_half = 1.959963984540054 * deviation,
                            .frequency_Hz = f,
                            .frequency_half_Hz = bend > 0.0 ? 1.959963984540054 / sqrt(bend) : step};
}

/* A piece that knows one flank of a line only, the other being an order of its speed, makes that the surer one: the line is where it
 * is largest. */
static size_t summit(const ripple_spectra *s, size_t bin)
{
    size_t best = bin;
    double most = share_at(s, bin);
    for (int side = -1; side <= 1; side += 2) {
        for (size_t k = side < 0 ? bin - 1 : bin + 1; k > 1 && k + 1 < s->bins;
             k = side < 0 ? k - 1 : k + 1) {
            const double share = share_at(s, k);
            if (!(share > most) || !is_the_link(s, k, share)) {
                break;
            }
            most = share;
            best = k;
        }
    }
    return best;
}

static void find_line(ripple_spectra *s, ripple_found *found)
{
    size_t best = 0;
    double most = CHANCE;
    for (size_t k = 1; k + 1 < s->bins; k++) {
        const double surprise = surprise_at(s, k);
        if (surprise > most) {
            const double share = share_at(s, k);
            if (is_the_link(s, k, share)) {
                most = surprise;
                best = k;
            }
        }
    }
    if (best > 0) {
        best = summit(s, best);
        refine(s, best, share_at(s, best), found);
    }
}

bool ripple_find(const ripple_pieces *all, double T_s, ripple_found *found)
{
    ripple_spectra s = {0};
    *found = (ripple_found){0};
    if (all->pieces == 0) {
        return true;
    }
    const bool ok = ripple_spectra_make(&s, all, T_s);
    if (ok) {
        find_line(&s, found);
    }
    ripple_spectra_free(&s);
    return ok;
}

double ripple_fit(const ripple_pieces *all, ripple_piece *piece, double T_s, const ripple_found *found)
{
    double h[3] = {0.0, 0.0, 0.0};
    double g[2] = {0.0, 0.0};
    for (size_t j = 0; j < piece->count; j++) {
        const vec_rotor at = rotor_at(VEC_TWO_PI * found->frequency_Hz * T_s * (double)j);
        const double w = all->weight[piece->first + j];
        const double y = all->along[piece->first + j];
        h[0] += w * at.cos * at.cos;
        h[1] += w * at.cos * at.sin;
        h[2] += w * at.sin * at.sin;
        g[0] += y * at.cos;
        g[1] += y * at.sin;
    }
    const double det = h[0] * h[2] - h[1] * h[1];
    piece->cos_share = det > 0.0 ? (h[2] * g[0] - h[1] * g[1]) / det : 0.0;
    piece->sin_share = det > 0.0 ? (h[0] * g[1] - h[1] * g[0]) / det : 0.0;
    const double size = hypot(piece->cos_share, piece->sin_share);
    const double shorter = size > 2.0 * found->share ? 2.0 * found->share / size : 1.0;
    piece->cos_share *= shorter;
    piece->sin_share *= shorter;
    /* What is shortened falls short of the best fit by the square of what it lacks. */
    return (2.0 - shorter) * (piece->cos_share * g[0] + piece->sin_share * g[1]);
}
