/* One-cycle errors (errors.h). */
#include "errors.h"

#include "diagnose/identify/corrected_rows.h"
#include "diagnose/identify/observer.h"

#include <math.h>
#include <stdlib.h>

static bool counts(const row_block *b, size_t group, bool held_out_only)
{
    return (group == MEASURE_ALL || b->group == group) && (b->held_out || !held_out_only);
}

double measure_current(const diagnose_rows *r, size_t group, bool held_out_only)
{
    double sum = 0.0;
    double n = 0.0;
    for (size_t b = 0; b < r->blocks; b++) {
        for (size_t j = 0; counts(&r->block[b], group, held_out_only) && j < r->block[b].count; j++) {
            vec_ab i = r->row[r->block[b].first + j].i_A;
            sum += i.alpha * i.alpha + i.beta * i.beta;
            n += 1.0;
        }
    }
    return n > 0.0 ? sqrt(sum / n) : 0.0;
}

typedef struct wanted {
    size_t group;
    bool held_out_only, glitches;
} wanted;

/* Whether the prediction into row k begins or ends at a glitch. */
static bool is_glitch(const diagnose_rows *r, size_t k)
{
    return r->outlier[k - 1] || r->outlier[k];
}

static double measure(const diagnose_rows *r, const averaged_drive *drive, wanted which)
{
    size_t longest = 1;
    for (size_t b = 0; b < r->blocks; b++) {
        longest = r->block[b].count > longest ? r->block[b].count : longest;
    }
    averaged_node *nodes = rows_nodes(r, drive);
    vec_ab *wrong = calloc(longest, sizeof *wrong);
    double sum = 0.0;
    double n = 0.0;
    if (!nodes || !wrong) {
        rows_note_no_memory(r);
    }
    for (size_t b = 0; nodes && wrong && b < r->blocks; b++) {
        const row_block *block = &r->block[b];
        if (!counts(block, which.group, which.held_out_only)) {
            continue;
        }
        observer_one_cycle(r, drive, nodes, block->first, block->count, wrong);
        for (size_t j = 1; j < block->count; j++) {
            if (!which.glitches && is_glitch(r, block->first + j)) {
                continue;
            }
            sum += wrong[j].alpha * wrong[j].alpha + wrong[j].beta * wrong[j].beta;
            n += 1.0;
        }
    }
    free(nodes);
    free(wrong);
    double current = measure_current(r, which.group, which.held_out_only);
    return n > 0.0 && current > 0.0 ? 100.0 * sqrt(sum / n) / current : NAN;
}

double measure_one_cycle(const diagnose_rows *r, const averaged_drive *drive, size_t group,
                         bool held_out_only)
{
    return measure(r, drive, (wanted){.group = group, .held_out_only = held_out_only, .glitches = true});
}

double measure_without_glitches(const diagnose_rows *r, const averaged_drive *drive)
{
    return measure(r, drive, (wanted){.group = MEASURE_ALL, .held_out_only = true});
}

double measure_gain_of_correction(const diagnose_rows *r, size_t n, const averaged_drive *drive)
{
    const diagnose_rows without = corrected_rows_before(r, n);
    const diagnose_rows with = corrected_rows_before(r, n + 1);
    const double after = measure_one_cycle(&with, drive, MEASURE_ALL, true);
    return after > 0.0 ? measure_one_cycle(&without, drive, MEASURE_ALL, true) / after : 1.0;
}
