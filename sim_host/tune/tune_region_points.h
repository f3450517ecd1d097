/* Shared by the two files of an uncertainty set: its points, once its other members are set. */
#ifndef SIM_HOST_TUNE_TUNE_REGION_POINTS_H
#define SIM_HOST_TUNE_TUNE_REGION_POINTS_H

#include "tune_region.h"

/* The centre, then each direction of the ellipsoid with each corner of the box. */
void tune_region_add_points(tune_region *region);

/* The largest share by which an inductance of the points is off the centre's. */
double tune_region_L_off(const tune_region *region);

#endif
