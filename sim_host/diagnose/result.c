/* The result's own functions (result.h). */
#include "result.h"

#include <stdlib.h>
#include <string.h>

void diagnosis_free(diagnosis *d)
{
    free(d->error_nominal);
    free(d->error_extended);
    free(d->free_nominal);
    free(d->free_extended);
    free(d->held_out);
    memset(d, 0, sizeof *d);
}

const char *diagnosis_verdict_id(diagnosis_verdict v)
{
    static const char *const id[] = {"clean", "explained", "partly", "unexplained"};
    return id[v];
}
