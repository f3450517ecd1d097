/* Rows before and after each correction (the header explains them). */
#include "mended.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool mended_is_news(const row_mend *found, const motor *file)
{
    size_t n = 0;
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length && n < MEND_VALUES;
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

bool mended_keep(diagnose_rows *r, const row_mend *found, const motor *file)
{
    if (!mended_is_news(found, file) || r->mends == ROWS_MENDS) {
        return true;
    }
    row_mend kept = *found;
    kept.before = malloc(r->rows * sizeof *kept.before);
    if (!kept.before) {
        return false;
    }
    memcpy(kept.before, r->row, r->rows * sizeof *kept.before);
    r->mend[r->mends++] = kept;
    return true;
}

diagnose_rows mended_rows(const diagnose_rows *r, size_t n)
{
    diagnose_rows plain = *r;
    plain.row = n < r->mends ? r->mend[n].before : (r->rough && n == 0 ? r->rough : r->row);
    return plain;
}
