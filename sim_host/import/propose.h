/*
 * Proposes a map for a log from the names in its header.
 */
#ifndef SIM_HOST_IMPORT_PROPOSE_H
#define SIM_HOST_IMPORT_PROPOSE_H

#include "log_table.h"
#include "map.h"

#include <stdio.h>

typedef struct proposal {
    import_map map;
    size_t found;                      /* columns that have an entry */
    bool unit_assumed[QUANTITY_COUNT]; /* neither the name nor a unit row says it */
} proposal;

/* The table is open and not read. */
void propose_map(const log_table *t, proposal *p);

/* As TOML with comments on what is not certain and what is missing. */
void propose_print(FILE *out, const log_table *t, const proposal *p);

#endif
