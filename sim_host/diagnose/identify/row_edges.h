/*
 * When each leg switches within a row's cycle, and the flux ripple that it finds then.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_EDGES_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_EDGES_H

#include "rows.h"

/* From the recorded duties, or without them from those of a modulator. */
void rows_fill_edges(diagnose_rows *r, const motor *m, modulator which);

#endif
