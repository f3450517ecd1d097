/* Whether the catalogue explains the error (borne_out.h). */
#include "borne_out.h"

#include "diagnose/result.h"

#include <math.h>

static const double LEFT_INSIDE = 0.05;
static const double ODDS_INSIDE = 10.0;

double borne_out_left(double nominal, double extended, double floor)
{
    const double noise = DIAGNOSIS_FLOOR_TOLERANCE * floor;
    if (!(nominal > noise)) {
        return NAN;
    }
    if (isnan(extended)) {
        return INFINITY;
    }
    return fmax(extended * extended - noise * noise, 0.0) / (nominal * nominal - noise * noise);
}

double borne_out_probability(double left)
{
    const double odds = isnan(left) ? ODDS_INSIDE : ODDS_INSIDE * exp(-left / LEFT_INSIDE) / LEFT_INSIDE;
    return odds / (1.0 + odds);
}
