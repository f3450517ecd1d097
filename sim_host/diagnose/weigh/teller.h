/*
 * Whom the search tells how it goes, while it goes.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_TELLER_H
#define SIM_HOST_DIAGNOSE_WEIGH_TELLER_H

#include "base/progress.h"

#include <stdio.h>

typedef struct diagnose_teller {
    FILE *trace;     /* each set that was tried, and how it did; or NULL */
    progress *shown; /* the line for who waits; or NULL */
} diagnose_teller;

#endif
