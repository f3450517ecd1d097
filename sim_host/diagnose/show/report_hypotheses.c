/* The table of hypotheses (report_hypotheses.h). */
#include "report_hypotheses.h"

#include "diagnose/identify/hypotheses.h"

#include <stdlib.h>
#include <string.h>

/* Chi square below which one more parameter is not significant: 3.2 standard deviations. */
static const double SIGNIFICANT = 10.0;

static const char *missing(hypothesis_need need)
{
    static const char *const text[] = {
        [NEEDS_NOTHING] = "",
        [NEEDS_TURNING] = "needs a turning rotor",
        [NEEDS_POLES_ONCE] = "needs a turning rotor and three pole pairs",
        [NEEDS_POLES_TWICE] = "needs a turning rotor and two pole pairs",
        [NEEDS_MAGNET] = "needs a turning rotor and a magnet",
        [NEEDS_THREE_SENSORS] = "needs three measured currents",
        [NEEDS_A_COUNT] = "checked separately: not found",
        [NEEDS_A_TRIAL] = "tried where much saturates: not found",
        [NEEDS_TEMPERATURE] = "needs the column temp_C with a changing temperature",
    };
    return text[need];
}

/* The k-th row is the k-th hypothesis. */
static hypothesis_set named_set(const diagnosis *d)
{
    hypothesis_set set = 0;
    for (size_t k = 0; k < d->hypotheses && k < H_COUNT; k++) {
        set |= d->hypothesis[k].named ? HYPOTHESIS_BIT(k) : 0;
    }
    return set;
}

static const char *reason_of(const diagnosis *d, const diagnosis_hypothesis *row)
{
    const hypothesis_id h = (hypothesis_id)(row - d->hypothesis);
    if (row->named) {
        return "named";
    }
    if (row->skipped) {
        return "left out by request (--skip)";
    }
    if (!row->possible) {
        return missing(hypothesis_table[h].needs);
    }
    if (!hypothesis_joins(named_set(d), h)) {
        return "excluded by a named cause: contains it, or has the same effect";
    }
    if (row->beyond < SIGNIFICANT) {
        return "no significant effect in the residual";
    }
    return "below its reporting threshold, or smaller than the model error of the named causes";
}

/* Named ones first, then by explained share, then by what they would add. */
static int by_strength(const void *a, const void *b)
{
    const diagnosis_hypothesis *one = *(const diagnosis_hypothesis *const *)a;
    const diagnosis_hypothesis *other = *(const diagnosis_hypothesis *const *)b;
    const double strength[2][4] = {{one->named, one->possible, one->alone, one->beyond},
                                   {other->named, other->possible, other->alone, other->beyond}};
    for (int k = 0; k < 4; k++) {
        if (strength[0][k] != strength[1][k]) {
            return strength[0][k] > strength[1][k] ? -1 : 1;
        }
    }
    return one < other ? -1 : 1;
}

static void put_row(page *p, const diagnosis *d, const diagnosis_hypothesis *h)
{
    page_row_begin(p);
    page_cell(p, false, "%s", h->id);
    page_cell(p, false, "%s", strcmp(h->id, h->words) == 0 ? "" : h->words);
    if (h->possible && d->causes > 0) {
        page_cell(p, true, "%.0f %%", 100.0 * h->alone);
    } else {
        page_cell(p, true, " ");
    }
    if (h->possible && !h->named) {
        page_cell(p, true, "%.3g", h->beyond);
    } else {
        page_cell(p, true, " ");
    }
    page_cell(p, false, "%s", reason_of(d, h));
    page_row_end(p);
}

static void put_table(page *p, const diagnosis *d, const diagnosis_hypothesis *const *row, size_t count)
{
    static const char *const heads[] = {"hypothesis", "meaning", "\talone explains", "\tadds, chi square",
                                        "reason"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t k = 0; k < count; k++) {
        put_row(p, d, row[k]);
    }
    page_table_end(p);
}

void report_hypotheses(page *p, const diagnosis *d)
{
    enum { SHOWN = 10 };
    const diagnosis_hypothesis *sorted[DIAGNOSIS_HYPOTHESES] = {NULL};
    for (size_t k = 0; k < d->hypotheses; k++) {
        sorted[k] = &d->hypothesis[k];
    }
    /* NOLINTNEXTLINE(bugprone-sizeof-expression): an array of pointers is sorted */
    qsort(sorted, d->hypotheses, sizeof sorted[0], by_strength);
    const size_t shown = d->hypotheses < SHOWN ? d->hypotheses : SHOWN;
    put_table(p, d, sorted, shown);
    if (shown < d->hypotheses) {
        char summary[64];
        snprintf(summary, sizeof summary, "%zu more hypotheses", d->hypotheses - shown);
        page_details_begin(p, summary);
        put_table(p, d, &sorted[shown], d->hypotheses - shown);
        page_details_end(p);
    }
    page_note(
        p,
        "Alone explains: share of the likelihood gain of all named causes that this hypothesis reaches by "
        "itself. Adds: chi square that it would remove from the residual of the extended model, linearised "
        "there.");
}
