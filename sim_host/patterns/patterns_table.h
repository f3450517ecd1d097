/* A computed pattern as a table of the firmware. */
#ifndef SIM_HOST_PATTERNS_PATTERNS_TABLE_H
#define SIM_HOST_PATTERNS_PATTERNS_TABLE_H

#include "patterns.h"

#include "iqfoc/pattern.h"

/* Fills the rows, and the table that refers to them. */
void patterns_table(const patterns_result *r, iqfoc_pattern_row_t row[PATTERNS_ROWS], iqfoc_pattern_t *table);

/* The same of a machine without saliency, computed now. False with *e set if memory runs out. */
bool patterns_table_find(int pulses, iqfoc_pattern_row_t row[PATTERNS_ROWS], iqfoc_pattern_t *table,
                         error *e);

#endif
