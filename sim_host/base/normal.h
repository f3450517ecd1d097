/* Constants of the normal distribution. */
#ifndef SIM_HOST_BASE_NORMAL_H
#define SIM_HOST_BASE_NORMAL_H

/* Standard deviations on each side of the mean that hold 95 %. */
#define NORMAL_95 1.96
/* Median of the squared length in two dimensions, 2 ln 2, as a multiple of one component's variance. */
#define NORMAL_MEDIAN_SQUARE 1.386294361119891

#endif
