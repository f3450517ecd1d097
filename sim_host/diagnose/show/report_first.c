/* The first screen (report_first.h). */
#include "report_first.h"

#include "proof.h"
#include "report_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

figure report_first_figure(const report_context *c)
{
    if (c->d->causes > 0) {
        return figure_proof;
    }
    if (c->d->learned.points > 1) {
        return figure_learned;
    }
    return c->d->verdict != VERDICT_CLEAN && c->turns ? figure_orders : figure_current;
}

static void put_errors(page *p, const diagnosis *d)
{
    const double most = fmax(fmax(d->nominal, d->extended), d->noise_floor);
    page_meters_begin(p, "One-cycle current error, % of the current (rms, held-out rows)");
    page_meter(p, "nominal model", d->nominal, "%", most, CHART_ORANGE);
    if (d->causes > 0) {
        page_meter(p, "extended model", d->extended, "%", most, CHART_BLUE);
    }
    page_meter(p, "noise floor", d->noise_floor, "%", most, CHART_GREEN);
    page_meters_end(p);
}

/* "R (R = 0.91 ohm), dead_time (v_dead = 0.1 V)" */
static void list_minors(const diagnosis *d, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t k = 0; k < d->minors && used < size; k++) {
        const diagnosis_parameter *q = &d->minor[k].parameter[0];
        const char *unit = strcmp(q->unit, "1") == 0 ? "" : q->unit;
        const int n = snprintf(text + used, size - used, "%s%s (%s = %.4g%s%s)", k > 0 ? ", " : "",
                               d->minor[k].id, q->name, q->value, unit[0] != '\0' ? " " : "", unit);
        used += n > 0 ? (size_t)n : 0;
    }
}

/* One sentence each: explanations that are not separable, small effects, directions that are not visible, residual structure. */
static void put_remarks(page *p, const diagnosis *d)
{
    char text[512] = "";
    size_t used = 0;
    for (size_t k = 0; k < d->explanations && used < sizeof text; k++) {
        const int n = snprintf(text + used, sizeof text - used, "%s%s (probability %.2g)",
                               k > 0 ? " or " : "", d->explanation[k].words, d->explanation[k].probability);
        used += n > 0 ? (size_t)n : 0;
    }
    if (d->explanations > 0) {
        page_text(p, "This recording cannot separate these explanations: %s.", text);
    }
    if (d->minors > 0) {
        list_minors(d, text, sizeof text);
        page_text(p, "Small or not certain, in the extended motor file: %s.", text);
    }
    for (size_t k = 0; k < d->directions; k++) {
        page_text(p, "Not visible in this recording: %s.", d->not_visible[k].words);
    }
    if (d->structure.words[0] != '\0') {
        page_text(p, "Residual structure: %s.", d->structure.words);
    }
}

bool report_first(page *p, const report_context *c, error *e)
{
    const diagnosis *d = c->d;
    page_first_begin(p);
    page_verdict(p, diagnosis_verdict_id(d->verdict), d->sentence);
    put_remarks(p, d);
    page_first_figure(p);
    if (!report_first_figure(c)(p, c, e)) {
        return false;
    }
    page_first_beside(p);
    put_errors(p, d);
    page_heading(p, 2, "What to do next");
    report_next(p, d, &c->firmware->map);
    page_first_end(p);
    return true;
}
