/* More explained than left (borne_out.h). */
#include "borne_out.h"

#include <math.h>

/* Up to this the filter trusts the model: counted angles, duties and a link that is measured leave as much. */
static const double TRUSTED = 0.1;

double borne_out_left(const group_noise *noise, size_t groups)
{
    double left = 0.0;
    for (size_t g = 0; g < groups; g++) {
        /* Two components, each with (1 - gain) of its variance. */
        left -= 2.0 * noise[g].rows * log((1.0 - noise[g].gain) / (1.0 - TRUSTED));
    }
    return fmax(left, 0.0);
}

bool borne_out(double gained, double left, double file, double named, double floor)
{
    const double noise = fmin(floor, named);
    return gained >= left || file * file - named * named >= named * named - noise * noise;
}
