/* A line of the DC link in the one-cycle errors (link_ripple.h). */
#include "link_ripple.h"

#include "ripple_line.h"

#include "base/normal.h"
#include "base/sort.h"
#include "diagnose/identify/corrected_rows.h"
#include "diagnose/identify/observer.h"
#include "model/link_ripple.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIECE_ROWS_MOST = 4096, PIECE_ROWS_LEAST = 128, PIECES_SEARCHED = 32 };

static const double STEP = 1e-3;      /* of the voltage, for its effect */
static const double MOST_LATE = 0.15; /* cycles */
static const double WILD = 6.0;       /* an error of so many deviations counts as that many */
static const double LEAST_SHARE = 0.003;
static const double SHARE_LOOSE = 0.03,
                    FREQUENCY_LOOSE = 5e-4; /* what the law leaves: intervals say no less */

static size_t pieces_of(const stretch *s)
{
    const size_t usable = s->count > ROWS_HISTORY + 1 ? s->count - ROWS_HISTORY - 1 : 0;
    const size_t n = (usable + PIECE_ROWS_MOST - 1) / PIECE_ROWS_MOST;
    return n == 0 || usable / n < PIECE_ROWS_LEAST ? 0 : n;
}

static bool cut(const diagnose_rows *r, ripple_pieces *all)
{
    const recording *rec = r->recording;
    size_t count = 0;
    for (size_t s = 0; s < rec->stretches; s++) {
        count += pieces_of(&rec->stretch[s]);
    }
    all->piece = calloc(count + 1, sizeof *all->piece);
    all->along = calloc(r->rows, sizeof *all->along);
    all->across = calloc(r->rows, sizeof *all->across);
    all->weight = calloc(r->rows, sizeof *all->weight);
    for (size_t s = 0; all->piece && s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        const size_t n = pieces_of(st);
        for (size_t j = 0; j < n; j++) {
            const size_t usable = st->count - ROWS_HISTORY - 1;
            const size_t begin = st->first + ROWS_HISTORY + j * usable / n;
            all->piece[all->pieces++] = (ripple_piece){
                .first = begin, .count = st->first + ROWS_HISTORY + (j + 1) * usable / n - begin};
        }
    }
    return all->piece && all->along && all->across && all->weight;
}

/* Length beyond which an error is shortened to it. */
static double wild_of(const vec_ab *wrong, size_t n, double *scratch)
{
    for (size_t k = 0; k < n; k++) {
        scratch[k] = wrong[k].alpha * wrong[k].alpha + wrong[k].beta * wrong[k].beta;
    }
    sort_ascending(scratch, n);
    return WILD * sqrt(scratch[n / 2] / NORMAL_MEDIAN_SQUARE);
}

/* The series of one piece: of its cycle k, whose error shows in the row after it. */
static bool fill(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                 ripple_pieces *all, ripple_piece *p)
{
    const size_t n = p->count + 1;
    cycle_row *copy = malloc(n * sizeof *copy);
    vec_ab *wrong = calloc(2 * n, sizeof *wrong);
    double *scratch = calloc(n, sizeof *scratch);
    const bool ok = copy && wrong && scratch;
    if (ok) {
        /* Copies, which know nothing of the rows ahead of the piece: an iron's past is looked up there. */
        diagnose_rows own = *r;
        own.row = copy;
        memcpy(copy, r->row + p->first, n * sizeof *copy);
        for (size_t j = 0; j < n; j++) {
            copy[j].history = copy[j].history < j ? copy[j].history : j;
        }
        observer_one_cycle(&own, drive, nodes, 0, n, wrong);
        for (size_t j = 0; j < n; j++) {
            link_ripple_scale(&copy[j], 1.0 + STEP);
        }
        observer_one_cycle(&own, drive, nodes, 0, n, wrong + n);
        const double wild_A = wild_of(wrong + 1, p->count, scratch);
        double turned = 0.0;
        p->slowest_rad_s = INFINITY;
        p->fastest_rad_s = -INFINITY;
        for (size_t j = 0; j < p->count; j++) {
            const size_t k = p->first + j;
            const vec_ab e = wrong[j + 1];
            const vec_ab does = {(e.alpha - wrong[n + j + 1].alpha) / STEP,
                                 (e.beta - wrong[n + j + 1].beta) / STEP};
            const double size = hypot(e.alpha, e.beta);
            const double shorter = size > wild_A ? wild_A / size : 1.0;
            all->along[k] = shorter * (does.alpha * e.alpha + does.beta * e.beta);
            all->across[k] = shorter * (does.alpha * e.beta - does.beta * e.alpha);
            all->weight[k] = does.alpha * does.alpha + does.beta * does.beta;
            p->square_A2 += shorter * shorter * size * size;
            p->slowest_rad_s = fmin(p->slowest_rad_s, r->row[k].omega_rad_s);
            p->fastest_rad_s = fmax(p->fastest_rad_s, r->row[k].omega_rad_s);
            turned += fabs(r->row[k].omega_rad_s) * r->T_s;
        }
        p->turns = turned > VEC_TWO_PI;
    }
    free(copy);
    free(wrong);
    free(scratch);
    return ok;
}

/* Of many pieces some, evenly spread: the search needs no more. */
static size_t thinned(const ripple_pieces *all, ripple_piece *some)
{
    const size_t n = all->pieces < PIECES_SEARCHED ? all->pieces : PIECES_SEARCHED;
    for (size_t k = 0; k < n; k++) {
        some[k] = all->piece[k * all->pieces / n];
    }
    return n;
}

/* Each row of a piece, and what lies between it and the next one, under the link that its own size and phase give. */
static size_t correct(diagnose_rows *r, const ripple_pieces *all, const ripple_found *found)
{
    const recording *rec = r->recording;
    size_t own = 0;
    size_t changed = 0;
    for (size_t s = 0; s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        const size_t end = st->first + st->count;
        while (own < all->pieces && all->piece[own].first < st->first) {
            own++;
        }
        if (own == all->pieces || all->piece[own].first >= end) {
            continue;
        }
        for (size_t k = st->first; k < end; k++) {
            while (own + 1 < all->pieces && all->piece[own + 1].first <= k) {
                own++;
            }
            const ripple_piece *p = &all->piece[own];
            const double at = VEC_TWO_PI * found->frequency_Hz * r->T_s * ((double)k - (double)p->first);
            link_ripple_scale(&r->row[k], 1.0 + p->cos_share * cos(at) + p->sin_share * sin(at));
            link_ripple_tell(&r->row[k], k - st->first);
            changed++;
        }
    }
    return changed;
}

static bool look(diagnose_rows *r, const averaged_drive *drive, ripple_pieces *all, ripple_found *found)
{
    ripple_piece some[PIECES_SEARCHED];
    averaged_node *nodes = rows_nodes(r, drive);
    bool ok = nodes != NULL && cut(r, all);
    for (size_t n = 0; ok && n < all->pieces; n++) {
        ok = fill(r, drive, nodes, all, &all->piece[n]);
    }
    free(nodes);
    if (ok) {
        ripple_pieces searched = *all;
        searched.piece = some;
        searched.pieces = thinned(all, some);
        ok = ripple_find(&searched, r->T_s, found);
    }
    return ok;
}

static row_correction told(const ripple_found *f)
{
    const double frequency_Hz = f->frequency_half_Hz + FREQUENCY_LOOSE * f->frequency_Hz;
    const double share = f->share_half + SHARE_LOOSE * f->share;
    return (row_correction){.cause = CAUSE_DC_LINK_RIPPLE,
                            .value = {f->frequency_Hz, f->share},
                            .low = {f->frequency_Hz - frequency_Hz, f->share - share},
                            .high = {f->frequency_Hz + frequency_Hz, f->share + share}};
}

/* Fits each piece. True if the fits reduce the squared error by at least so much of the residual beyond the noise. */
static bool is_worth_it(const diagnose_rows *r, ripple_pieces *all, const ripple_found *found, double floor_A,
                        double of_rest)
{
    double off = 0.0;
    double rest = 0.0;
    for (size_t n = 0; n < all->pieces; n++) {
        ripple_piece *p = &all->piece[n];
        const double own = ripple_fit(all, p, r->T_s, found);
        off += own;
        rest += p->square_A2 - own - (double)p->count * floor_A * floor_A;
    }
    return off >= of_rest * rest;
}

/* A speed that swings by this part of the line's share can make the line itself, if its column is a little late or small. */
static const double SPEED_MAKES = 0.5;

/* The swing of the recorded speed at that frequency, as a share of the fastest speed: rms over the pieces. */
static double speed_swing(const diagnose_rows *r, const ripple_pieces *all, double frequency_Hz)
{
    double square = 0.0;
    double fastest = 0.0;
    for (size_t n = 0; n < all->pieces; n++) {
        const ripple_piece *p = &all->piece[n];
        double mean = 0.0;
        double re = 0.0;
        double im = 0.0;
        for (size_t j = 0; j < p->count; j++) {
            mean += r->row[p->first + j].omega_rad_s / (double)p->count;
        }
        for (size_t j = 0; j < p->count; j++) {
            const double at = VEC_TWO_PI * frequency_Hz * r->T_s * (double)j;
            const double off = r->row[p->first + j].omega_rad_s - mean;
            re += 2.0 * off * cos(at) / (double)p->count;
            im += 2.0 * off * sin(at) / (double)p->count;
        }
        square += (re * re + im * im) / (double)all->pieces;
        fastest = fmax(fastest, fabs(mean));
    }
    return fastest > 0.0 ? sqrt(square) / fastest : 0.0;
}

bool measure_link_ripple(diagnose_rows *r, const averaged_drive *drive, double floor_A, double of_rest,
                         const motor *file, size_t *corrected)
{
    ripple_pieces all = {0};
    ripple_found found = {0};
    *corrected = 0;
    averaged_drive prompt = *drive;
    if (drive->u_delay[0] >= 1.0 || drive->u_delay[1] != 0.0) {
        return true;
    }
    /* A link that swings between two cycles looks like a part of their voltage that acts late. */
    if (fabs(drive->u_delay[0]) > MOST_LATE) {
        prompt.u_delay[0] = 0.0;
    }
    bool ok = look(r, &prompt, &all, &found);
    if (ok && found.share >= LEAST_SHARE &&
        speed_swing(r, &all, found.frequency_Hz) < SPEED_MAKES * found.share &&
        is_worth_it(r, &all, &found, floor_A, of_rest)) {
        const row_correction correction = told(&found);
        ok = corrected_rows_keep(r, &correction, file);
        *corrected = ok ? correct(r, &all, &found) : 0;
    }
    free(all.piece);
    free(all.along);
    free(all.across);
    free(all.weight);
    return ok;
}
