/* A row under another DC link (link_ripple.h). */
#include "link_ripple.h"

static vec_ab scaled(vec_ab v, double factor)
{
    return (vec_ab){factor * v.alpha, factor * v.beta};
}

void link_ripple_scale(cycle_row *row, double factor)
{
    row->u_V[0] = scaled(row->u_V[0], factor);
    row->u_dc_V *= factor;
    for (size_t x = 0; x < 3; x++) {
        row->edge_ripple_Wb[x] = scaled(row->edge_ripple_Wb[x], factor);
    }
}

void link_ripple_tell(cycle_row *row, size_t behind)
{
    row->u_V[1] = behind > 0 ? row[-1].u_V[0] : row->u_V[0];
    row->u_V[2] = behind > 0 ? row[-1].u_V[1] : row->u_V[0];
}
