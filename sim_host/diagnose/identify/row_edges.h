/* Computes when each leg switches within a row's cycle, and the flux ripple at that time. */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_EDGES_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_EDGES_H

#include "rows.h"

/* Uses the recorded duties, or without them those of the modulator `which`. */
void rows_fill_edges(diagnose_rows *r, const motor *m, modulator which);

#endif
