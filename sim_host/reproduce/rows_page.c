/* Rows of the comparison on the report page (rows_page.h). */
#include "rows_page.h"

#include <math.h>
#include <string.h>

static bool wanted(const comparison_row *r, const char *paper, const char *item, const char *part)
{
    return strcmp(r->paper, paper) == 0 && strcmp(r->item, item) == 0 &&
           (part == NULL || strstr(r->condition, part) != NULL || strstr(r->quantity, part) != NULL);
}

/* What the paper prints, as it prints it; what is computed to three digits, zeros at the end among them. */
static void number_cell(page *p, double value, bool printed)
{
    if (!isfinite(value)) {
        page_cell(p, true, "–");
    } else if (value != 0.0 && fabs(value) < 1e-3) {
        page_cell(p, true, "%.2e", value);
    } else if (printed || fabs(value) >= 100.0) {
        page_cell(p, true, "%.3g", value);
    } else {
        page_cell(p, true, "%#.3g", value);
    }
}

/* A condition without what all rows of the table have in common. */
static const char *rest_of(const char *condition, const char *part)
{
    const size_t length = part == NULL ? 0 : strlen(part);
    if (length == 0 || strncmp(condition, part, length) != 0) {
        return condition;
    }
    return condition + length + strspn(condition + length, ", ");
}

static void put_row(page *p, const comparison_row *r, const char *part, int note)
{
    const double ratio = comparison_ratio(r);
    page_row_begin(p);
    page_cell(p, false, "%s%s%s, %s", r->quantity, r->method[0] != '\0' ? ", " : "", r->method, r->unit);
    page_cell(p, false, "%s", rest_of(r->condition, part));
    number_cell(p, r->paper_value, true);
    number_cell(p, r->value, false);
    number_cell(p, r->value_iq24, false);
    if (isfinite(ratio)) {
        page_cell(p, true, "%.3f", ratio);
    } else {
        page_cell(p, true, "–");
    }
    if (note > 0) {
        page_cell(p, true, "[%d]", note);
    } else {
        page_cell(p, true, " ");
    }
    page_row_end(p);
}

void rows_page_table(page *p, const comparison *c, const char *paper, const char *item, const char *part)
{
    static const char *const heads[] = {"", "", "\tpaper", "\tdouble", "\tIQ24", "\tratio", ""};
    const char *notes[COMPARISON_NOTES];
    int count = 0;
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t n = 0; n < c->count; n++) {
        if (wanted(&c->row[n], paper, item, part)) {
            put_row(p, &c->row[n], part, comparison_note(notes, &count, c->row[n].note));
        }
    }
    page_table_end(p);
    for (int n = 0; n < count; n++) {
        page_note(p, "[%d] %s", n + 1, notes[n]);
    }
}

bool rows_page_figure(page *p, plot *drawing, const char *id, const char *caption, const comparison *c,
                      const char *paper, const char *item, const char *part, error *e)
{
    page_pair_begin(p);
    const bool ok = page_figure(p, drawing, id, caption, e);
    page_pair_beside(p);
    rows_page_table(p, c, paper, item, part);
    page_pair_end(p);
    return ok;
}

bool rows_page_charts(page *p, const chart *charts, size_t count, const char *id, const char *caption,
                      const comparison *c, const char *paper, const char *item, const char *part, error *e)
{
    page_pair_begin(p);
    const bool ok = page_charts(p, charts, count, id, caption, e);
    page_pair_beside(p);
    rows_page_table(p, c, paper, item, part);
    page_pair_end(p);
    return ok;
}
