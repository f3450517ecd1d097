/* Sets that were fitted already (fitted_sets.h). */
#include "fitted_sets.h"

#include <stdlib.h>

const fitted_set *fitted_sets_find(const fitted_sets *f, hypothesis_set asked, hypothesis_set allowed)
{
    for (size_t k = 0; k < f->count; k++) {
        if (f->one[k].asked == asked && (f->one[k].state.set & ~allowed) == 0) {
            return &f->one[k];
        }
    }
    return NULL;
}

void fitted_sets_keep(fitted_sets *f, hypothesis_set asked, const fit_state *state, double worth)
{
    if (f->count == f->room) {
        const size_t room = 2 * f->room + 16;
        fitted_set *more = realloc(f->one, room * sizeof *more);
        if (!more) {
            return;
        }
        f->one = more;
        f->room = room;
    }
    f->one[f->count++] = (fitted_set){.asked = asked, .worth = worth, .state = *state};
}

void fitted_sets_forget(fitted_sets *f, edge_law edge)
{
    f->count = 0;
    f->edge = edge;
}

void fitted_sets_free(fitted_sets *f)
{
    free(f->one);
    *f = (fitted_sets){0};
}
