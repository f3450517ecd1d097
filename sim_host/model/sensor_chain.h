/*
 * Current sensors with gains and offsets, which may drift: true currents to recorded ones, and back.
 *
 * measured = g true + o of each phase. Minus the sum of two stands for a third that is not measured (data/current_sensors.h), so that
 * with low-side shunts the map changes from sector to sector.
 */
#ifndef SIM_HOST_MODEL_SENSOR_CHAIN_H
#define SIM_HOST_MODEL_SENSOR_CHAIN_H

#include "averaged_drive.h"

/* The sensor chain as matrices: recorded = forward true + offset, and back; what the three's mean shows. */
typedef struct sensor_map {
    double forward[2][2], back[2][2];
    vec_ab offset;
    double zero
        [2]; /* mean of the three recorded currents = zero . true + zero_offset_A, if all three are measured */
    double zero_offset_A;
} sensor_map;

/* One map over a recording: all but the inverse goes evenly from the map at its middle. */
typedef struct sensor_drift {
    sensor_map middle;
    double forward_rate[2][2], zero_rate[2]; /* per second */
    vec_ab offset_rate;
} sensor_drift;

/* Over a recording, by the phase that is not measured; only those of its sensors are filled. */
typedef struct sensor_course {
    bool drifts;
    bool
        changes; /* from row to row: it drifts, or another phase is missing. Else the map is the same at all rows */
    sensor_drift of[MISSING_PHASES];
} sensor_course;

sensor_course sensor_course_of(const averaged_drive *drive, sensor_set sensors);
/* At a row of the recording. */
sensor_map sensor_course_at(const sensor_course *course, const cycle_row *row);
/* At the recording's middle, without one phase. */
sensor_map sensor_map_of(const averaged_drive *drive, missing_phase missing);

static inline vec_ab sensor_map_measure(const sensor_map *map, vec_ab i_true)
{
    return (vec_ab){map->forward[0][0] * i_true.alpha + map->forward[0][1] * i_true.beta + map->offset.alpha,
                    map->forward[1][0] * i_true.alpha + map->forward[1][1] * i_true.beta + map->offset.beta};
}

static inline vec_ab sensor_map_unmeasure(const sensor_map *map, vec_ab i_recorded)
{
    const double a = i_recorded.alpha - map->offset.alpha;
    const double b = i_recorded.beta - map->offset.beta;
    return (vec_ab){map->back[0][0] * a + map->back[0][1] * b, map->back[1][0] * a + map->back[1][1] * b};
}

#endif
