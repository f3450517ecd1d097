/* Mean, standard deviation and largest size of numbers that come one by one. Start with {0}. NAN where there were none. */
#ifndef SIM_HOST_BASE_SPREAD_H
#define SIM_HOST_BASE_SPREAD_H

typedef struct spread {
    long count;
    double sum, squares;
    double most; /* largest size */
} spread;

void spread_add(spread *s, double x);
double spread_mean(const spread *s);
double spread_deviation(const spread *s); /* about the mean */
double spread_rms(const spread *s);       /* about 0 */
double spread_most(const spread *s);

#endif
