/*
 * Keeps the rows of a recording as they were before each correction. Some causes are found without a fit of the averaged drive. The
 * columns show them (a speed that lags the angle, a sensor that breaks the sum of three currents), or single rows do (missed updates,
 * a ripple of the DC link). Such rows get the true values, so that the search finds the other causes. The rows before that are kept,
 * so that the error reduction of each correction can be measured.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_CORRECTED_ROWS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_CORRECTED_ROWS_H

#include "rows.h"

/* Whether a cause that was found is new: the motor file has no value for it, or one outside its interval. */
bool corrected_rows_are_news(const row_correction *found, const motor *file);

/* If the cause is new, keeps a copy of the rows as they are now; call it before they are changed. False: out of memory. */
bool corrected_rows_keep(diagnose_rows *r, const row_correction *found, const motor *file);

/* The rows with the first n corrections; shares all memory with r. n = 0: as recorded, with what the motor file knows. */
diagnose_rows corrected_rows_before(const diagnose_rows *r, size_t n);

#endif
