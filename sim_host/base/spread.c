/* Mean, standard deviation and largest size (spread.h). */
#include "spread.h"

#include <math.h>

void spread_add(spread *s, double x)
{
    s->count++;
    s->sum += x;
    s->squares += x * x;
    s->most = fmax(s->most, fabs(x));
}

static double over_count(const spread *s, double x)
{
    return s->count > 0 ? x / (double)s->count : NAN;
}

double spread_mean(const spread *s)
{
    return over_count(s, s->sum);
}

double spread_deviation(const spread *s)
{
    const double mean = spread_mean(s);
    const double variance = over_count(s, s->squares) - mean * mean;
    return variance < 0.0 ? 0.0 : sqrt(variance); /* NAN stays */
}

double spread_rms(const spread *s)
{
    return sqrt(over_count(s, s->squares));
}

double spread_most(const spread *s)
{
    return s->count > 0 ? s->most : NAN;
}
