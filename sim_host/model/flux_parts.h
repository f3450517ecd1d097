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

typedef struct flux_parts {
    double L_d_H, L_q_H; /* straight iron */
    iron_part part[IRON_PARTS];
    double off; /* rms of the flux by which it is off, over that of the drive's flux less psi_f */
} flux_parts;

/* `parts`: 1 or 2; one that brings nothing has no energy. There must be a current, and a flux that is not psi_f. */
flux_parts flux_parts_closest(const averaged_drive *drive, const vec_dq *i, size_t count,
                              const flux_parts_limits *limits, size_t parts);

/* The inductances at no current: those of straight iron and of the parts. */
void flux_parts_inductances(const flux_parts *p, double *L_d_H, double *L_q_H);

#endif
