/*
 * Iron as parts that saturate (flux_map.h) in place of a drive's map: straight iron and one or two parts whose flux is the closest to the
 * drive's at given currents, by least squares within bounds. The flux at no current stays the magnet's.
 */
#ifndef SIM_HOST_MODEL_FLUX_PARTS_H
#define SIM_HOST_MODEL_FLUX_PARTS_H

#include "averaged_drive.h"

/* What the numbers may be. */
typedef struct flux_parts_limits {
    double L_low_H, L_high_H; /* of straight iron */
    double E_high_J;
    double I_low_A, I_high_A; /* at which a part saturates, in either axis */
    double I_c_high_A;        /* length of the current about which it is alike */
} flux_parts_limits;

enum { FLUX_PARTS_CURRENTS = 600 };

/*
 * Sets *to to the drive with `parts` parts, 1 or 2, in place of its map; one that brings nothing has no energy. The rms of the flux by which
 * it is off, over that of the drive's flux less psi_f. `count` is FLUX_PARTS_CURRENTS at most; there must be a current, and a flux that is
 * not psi_f.
 */
double flux_parts_closest(const averaged_drive *drive, const vec_dq *i, size_t count,
                          const flux_parts_limits *limits, size_t parts, averaged_drive *to);

#endif
