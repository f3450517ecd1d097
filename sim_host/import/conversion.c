#include "conversion.h"

#include <stdlib.h>

bool conversion_out_of_memory(const conversion *v)
{
    return error_failure(v->e, 0, "%s: out of memory", v->t->path);
}

double *conversion_column(const conversion *v)
{
    double *made = calloc(v->c.rows + 1, sizeof *made);
    if (made == NULL) {
        conversion_out_of_memory(v);
    }
    return made;
}

/* Three columns at once. */
bool conversion_three(const conversion *v, double *column[3])
{
    for (int x = 0; x < 3; x++) {
        column[x] = conversion_column(v);
    }
    return v->e->status == STATUS_DONE;
}

int conversion_has(const conversion *v, quantity first, int count)
{
    int have = 0;
    for (int n = 0; n < count; n++) {
        have += v->map->column[(int)first + n].there ? 1 : 0;
    }
    return have;
}
