/* Rows before and after each correction (the header explains them). */
#include "corrected_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool corrected_rows_are_news(const row_correction *found, const motor *file)
{
    size_t n = 0;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length && n < CORRECTION_VALUES;
         v++) {
        if (v->cause != found->cause) {
            continue;
        }
        const double told = file->ext.has[v->cause] ? motor_value_of(file, v) : v->absent;
        if (isnan(told) || told < found->low[n] || told > found->high[n]) {
            return true;
        }
        n++;
    }
    return false;
}

bool corrected_rows_keep(diagnose_rows *r, const row_correction *found, const motor *file)
{
    if (!corrected_rows_are_news(found, file) || r->corrections == ROWS_CORRECTIONS) {
        return true;
    }
    row_correction kept = *found;
    kept.before = malloc(r->rows * sizeof *kept.before);
    if (!kept.before) {
        return false;
    }
    memcpy(kept.before, r->row, r->rows * sizeof *kept.before);
    r->correction[r->corrections++] = kept;
    return true;
}

diagnose_rows corrected_rows_before(const diagnose_rows *r, size_t n)
{
    diagnose_rows plain = *r;
    plain.row = n < r->corrections ? r->correction[n].before : (r->rough && n == 0 ? r->rough : r->row);
    return plain;
}
