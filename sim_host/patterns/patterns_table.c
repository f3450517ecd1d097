/* A computed pattern in IQ24 (patterns_table.h). */
#include "patterns_table.h"

#include "base/vector.h"
#include "per_unit.h"

void patterns_table(const patterns_result *r, iqfoc_pattern_row_t row[PATTERNS_ROWS], iqfoc_pattern_t *table)
{
    for (int n = 0; n < r->rows; n++) {
        const patterns_row *from = &r->row[n];
        row[n] = (iqfoc_pattern_row_t){.start = from->shape.start, .joined = from->joined ? 1 : 0};
        for (int k = 0; k < from->shape.angles; k++) {
            row[n].angle[k] = iq24_from_double(from->shape.angle[k] / VEC_TWO_PI);
        }
    }
    *table = (iqfoc_pattern_t){row, r->rows, (r->asked.pulses - 1) / 2, iq24_from_double(patterns_index(0)),
                               iq24_from_double(PATTERNS_ROWS_PER_INDEX)};
}

bool patterns_table_find(int pulses, iqfoc_pattern_row_t row[PATTERNS_ROWS], iqfoc_pattern_t *table, error *e)
{
    patterns_result found;
    const patterns_request asked = {.pulses = pulses};
    if (!patterns_find(&asked, &found, e)) {
        return false;
    }
    patterns_table(&found, row, table);
    return true;
}
