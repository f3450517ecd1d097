/*
 * A motor's flux map as the firmware holds it: parts that saturate (iqfoc/flux_map.h). A map of parts alone is held as it is. One with
 * terms of third and fourth order or with I_sat, and one beyond the library's ranges, gets the parts within those ranges whose flux is
 * the closest to its own at the recorded currents (model/flux_parts.h).
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_FIRMWARE_MAP_H
#define SIM_HOST_DIAGNOSE_SHOW_FIRMWARE_MAP_H

#include "data/motor.h"
#include "data/recording.h"
#include "extension_host.h"

typedef struct firmware_map {
    bool there;  /* the motor has a map, and the library holds it */
    bool fitted; /* by other parts than its own */
    double off;  /* rms of the flux by which these are off, over that of the map's flux less psi_f */
    flux_map_values values;
    iqfoc_flux_map_t map;
} firmware_map;

firmware_map firmware_map_of(const recording *rec, const motor *m);

/* The library's correction for a cause of a motor with this map. */
cause_firmware firmware_correction(const firmware_map *map, cause_id id);

#endif
