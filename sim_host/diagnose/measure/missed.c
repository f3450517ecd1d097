/* Cycles under the command of the cycle before (missed.h). */
#include "missed.h"

#include "base/normal.h"
#include "base/sort.h"
#include "diagnose/identify/corrected_rows.h"
#include "diagnose/identify/observer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In deviations: what a missed update must do to be counted, and how near the error must come to it. */
static const double CLEAR = 8.0;
static const double NEAR = 4.0;
/* What is counted must be this many rows at the least, and so many times those that err the opposite way. */
enum { LEAST_ROWS = 4, TIMES_OPPOSITE = 5 };
/* Commands that are late by less than this share of a cycle short of a whole one are late by the whole one. */
static const double NEARLY = 0.15;

/* Pairs of rows as they were before a change, in its order; no_memory: one could not be kept. */
typedef struct kept_rows {
    size_t count, room;
    struct kept_pair {
        size_t at;
        cycle_row row[2];
    } * pair;
    bool no_memory;
} kept_rows;

typedef struct count {
    diagnose_rows *r;
    const averaged_drive *drive;
    const averaged_node *nodes;
    size_t late; /* whole cycles by which the newest command that acts in a cycle is */
    double deviation_A[ROWS_MAX_GROUPS];
    double odds; /* log of share / (1 - share); NAN while rows are counted and not corrected */
    size_t told, missed, opposite, corrected;
    size_t wild; /* rows that err by CLEAR, whatever their command does */
    kept_rows kept;
} count;

static bool find_deviations(count *c)
{
    const diagnose_rows *r = c->r;
    double *square = calloc(r->rows + 1, sizeof *square);
    vec_ab *wrong = calloc(r->rows + 1, sizeof *wrong);
    for (size_t g = 0; square && wrong && g < r->groups; g++) {
        size_t n = 0;
        for (size_t b = 0; b < r->blocks; b++) {
            if (r->block[b].group == g) {
                observer_one_cycle(r, c->drive, c->nodes, r->block[b].first, r->block[b].count, wrong);
            }
            for (size_t j = 1; r->block[b].group == g && j < r->block[b].count; j++) {
                square[n++] = wrong[j].alpha * wrong[j].alpha + wrong[j].beta * wrong[j].beta;
            }
        }
        sort_ascending(square, n);
        c->deviation_A[g] = n > 0 ? sqrt(square[n / 2] / NORMAL_MEDIAN_SQUARE) : 0.0;
    }
    const bool ok = square && wrong;
    free(square);
    free(wrong);
    return ok;
}

/* The cycle of a row without its newest command, which is `late` cycles old: the one before acts on. */
static void hold_command(cycle_row *row, size_t late)
{
    row->u_V[late] = row[-1].u_V[late];
    if (late == 0) {
        memcpy(row->rise, row[-1].rise, sizeof row->rise);
        memcpy(row->no_rise, row[-1].no_rise, sizeof row->no_rise);
        memcpy(row->no_fall, row[-1].no_fall, sizeof row->no_fall);
        memcpy(row->edge_ripple_Wb, row[-1].edge_ripple_Wb, sizeof row->edge_ripple_Wb);
    }
}

/* What the row after it knows of what acted. Newer commands wait for their turn. */
static void tell_next(cycle_row *next, size_t late)
{
    for (size_t n = late; n < 2; n++) {
        next->u_V[n + 1] = next[-1].u_V[n];
    }
    if (late == 0) {
        memcpy(next->fell, next[-1].rise, sizeof next->fell);
    }
}

static void keep(kept_rows *kept, size_t at, cycle_row own, cycle_row next)
{
    if (kept->count == kept->room) {
        const size_t room = 2 * kept->room + 64;
        struct kept_pair *more = realloc(kept->pair, room * sizeof *more);
        if (!more) {
            kept->no_memory = true;
            return;
        }
        kept->pair = more;
        kept->room = room;
    }
    kept->pair[kept->count++] = (struct kept_pair){at, {own, next}};
}

/* The last change first, as the pairs overlap. */
static void put_back(kept_rows *kept, cycle_row *row)
{
    while (kept->count > 0) {
        const struct kept_pair *pair = &kept->pair[--kept->count];
        memcpy(&row[pair->at], pair->row, sizeof pair->row);
    }
    free(kept->pair);
    *kept = (kept_rows){.no_memory = kept->no_memory};
}

static double square_of(vec_ab a)
{
    return a.alpha * a.alpha + a.beta * a.beta;
}

/* One-cycle error of a pair of rows with the first unchanged. */
static vec_ab error_of(const count *c, size_t k)
{
    vec_ab wrong[2];
    observer_one_cycle(c->r, c->drive, c->nodes, k, 2, wrong);
    return wrong[1];
}

static void look_at(count *c, size_t k, double deviation_A)
{
    cycle_row *row = &c->r->row[k];
    if (observer_sign_is_unsure(c->r, c->drive, row->missing, row->i_A)) {
        return;
    }
    const cycle_row own = *row;
    const cycle_row next = row[1];
    const vec_ab e = error_of(c, k);
    hold_command(row, c->late);
    tell_next(row + 1, c->late);
    const vec_ab held = error_of(c, k);
    /* Twice its own error less that of the held command: the error if the opposite had been done. */
    const vec_ab opposite = {2.0 * e.alpha - held.alpha, 2.0 * e.beta - held.beta};
    const vec_ab does = {e.alpha - held.alpha, e.beta - held.beta};
    const double near = NEAR * NEAR * deviation_A * deviation_A;
    const bool tells = square_of(does) > CLEAR * CLEAR * deviation_A * deviation_A;
    if (isnan(c->odds)) {
        c->wild += square_of(e) > CLEAR * CLEAR * deviation_A * deviation_A;
        c->told += tells;
        c->opposite += tells && square_of(opposite) < near;
        if (tells && square_of(held) < near) {
            c->missed++; /* the next row is checked too: a command that is half a cycle late acts in both */
            keep(&c->kept, k, own, next);
            return;
        }
    } else if (0.5 * (square_of(e) - square_of(held)) + c->odds * deviation_A * deviation_A > 0.0) {
        c->corrected++;
        return;
    }
    row[0] = own;
    row[1] = next;
}

static void look_at_all(count *c)
{
    const recording *rec = c->r->recording;
    size_t b = 0;
    for (size_t s = 0; s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        for (; b < c->r->blocks && c->r->block[b].stretch < s; b++) {
        }
        if (b == c->r->blocks || c->r->block[b].stretch != s) {
            continue;
        }
        size_t own = b;
        for (size_t k = st->first + ROWS_HISTORY; k + 1 < st->first + st->count; k++) {
            while (own + 1 < c->r->blocks && c->r->block[own + 1].stretch == s &&
                   c->r->block[own + 1].first <= k) {
                own++;
            }
            look_at(c, k, c->deviation_A[c->r->block[own].group]);
        }
    }
}

/* The rows stay as they are. False: out of memory. */
static bool count_all(count *c)
{
    look_at_all(c);
    put_back(&c->kept, c->r->row);
    return !c->kept.no_memory;
}

/* Wilson's interval of a share. */
static row_correction share_of(const count *c)
{
    const double z = 1.959963984540054;
    const double n = (double)c->told;
    const double p = (double)c->missed / n;
    const double middle = (p + 0.5 * z * z / n) / (1.0 + z * z / n);
    const double half = z / (1.0 + z * z / n) * sqrt(p * (1.0 - p) / n + 0.25 * z * z / (n * n));
    return (row_correction){.cause = CAUSE_MISSED_UPDATE,
                            .value = {p},
                            .low = {fmin(middle - half, p)},
                            .high = {fmax(middle + half, p)}};
}

bool measure_missed(diagnose_rows *r, const averaged_drive *drive, const motor *file, size_t *corrected)
{
    averaged_node *nodes = rows_nodes(r, drive);
    const double late = fmin(fmax(drive->u_delay[0] + drive->u_delay[1], 0.0), 2.0);
    count c = {.r = r, .drive = drive, .nodes = nodes, .late = (size_t)floor(late + NEARLY), .odds = NAN};
    *corrected = 0;
    bool ok = nodes && find_deviations(&c) && count_all(&c);
    if (ok && c.missed >= LEAST_ROWS && c.missed > TIMES_OPPOSITE * c.opposite && 2 * c.missed >= c.wild) {
        const row_correction found = share_of(&c);
        ok = corrected_rows_keep(r, &found, file);
        if (ok) {
            c.odds = log(found.value[0] / (1.0 - fmin(found.value[0], 0.5)));
            look_at_all(&c);
            *corrected = c.corrected;
        }
    }
    free(nodes);
    return ok;
}
