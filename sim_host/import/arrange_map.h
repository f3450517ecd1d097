/*
 * An arrangement as changes of a map, in words and as the map's lines.
 */
#ifndef SIM_HOST_IMPORT_ARRANGE_MAP_H
#define SIM_HOST_IMPORT_ARRANGE_MAP_H

#include "arrange.h"
#include "data/motor.h"
#include "map.h"

#include <stdio.h>

/* What the map leaves to be tried. */
arrange_freedom arrange_freedom_of(const import_map *map, const motor *m);

/* What fits best, by how much, and the lines of the map for it. */
void arrange_print(FILE *out, const import_map *map, const motor *m, const arrange_result *r);

#endif
