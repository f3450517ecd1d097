/*
 * The cheapest sufficient mean of the dq current: a map over SFFR, modulation index and load. Steady state on the
 * switching-level drive; the truth is its mean seen from the turning rotor, over each cycle.
 *
 * The speed sets the SFFR at the motor file's switching frequency. The modulation index, voltage over the
 * highest of linear modulation, is set by the DC link, which this takes as free: at low SFFR some of it lies
 * beyond any real link. The load is i_q, of the rated current, at i_d = 0.
 */
#ifndef SIM_HOST_REPRODUCE_MEAN_MAP_H
#define SIM_HOST_REPRODUCE_MEAN_MAP_H

#include "base/json.h"
#include "steady_drive.h"

/* In the order of what they cost. */
typedef enum mean_method {
    MEAN_MIDPOINT,       /* the sample at the carrier's peak, turned by its angle */
    MEAN_LINEAR,         /* that as the mean of a current that changes linearly: 2016 (10) */
    MEAN_QUASI_DISCRETE, /* 2019 (10) corrected by 2016 (10) */
    MEAN_MODULATED,      /* iqfoc/mean_modulated.h; of a salient machine predictor_salient.h with ripple.h */
    MEAN_METHODS
} mean_method;

const char *mean_method_name(mean_method which);

enum { MEAN_MAP_RATIOS = 41, MEAN_MAP_INDICES = 16, MEAN_MAP_LOADS = 3 };

typedef struct mean_map {
    double ratio[MEAN_MAP_RATIOS], index[MEAN_MAP_INDICES], load[MEAN_MAP_LOADS];
    /* Largest error of any cycle, percent of the rated current. */
    double percent[MEAN_MAP_LOADS][MEAN_MAP_INDICES][MEAN_MAP_RATIOS][MEAN_METHODS];
} mean_map;

bool mean_map_run(const motor *m, mean_map *map, error *e);

json_t *mean_map_json(const mean_map *map);

/* The cheapest method whose error is within the limit; MEAN_METHODS where none is. */
mean_method mean_map_enough(const double percent[MEAN_METHODS], double limit_percent);

/* DIRECTORY/index.html with the map, and the map as DIRECTORY/mean-map.svg. */
bool mean_map_page(const char *directory, const motor *m, const mean_map *map, error *e);

#endif
