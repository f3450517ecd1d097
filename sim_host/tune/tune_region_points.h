/* Between the two files of a region: its points, when all else of it stands. */
#ifndef SIM_HOST_TUNE_TUNE_REGION_POINTS_H
#define SIM_HOST_TUNE_TUNE_REGION_POINTS_H

#include "tune_region.h"

/* The centre, then each direction of the ellipsoid with each corner of the box. */
void tune_region_add_points(tune_region *region);

#endif
