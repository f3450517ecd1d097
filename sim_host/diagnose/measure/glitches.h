/*
 * Glitches: rows that stand out of all proportion and would drag every estimate.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_GLITCHES_H
#define SIM_HOST_DIAGNOSE_MEASURE_GLITCHES_H

#include "diagnose/identify/fit_data.h"

/* Marks them in d->rows->outlier. Returns how many: no result where memory runs out, which d->rows->no_memory says. */
size_t measure_glitches(fit_data *d, const fit_state *s);

#endif
