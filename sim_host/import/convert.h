/*
 * Converts a foreign log to a recording: units, signs, frames, angle, speed, duties and the shift between command and
 * current, as its map says.
 */
#ifndef SIM_HOST_IMPORT_CONVERT_H
#define SIM_HOST_IMPORT_CONVERT_H

#include "data/motor.h"
#include "data/recording.h"
#include "log_table.h"
#include "map.h"

/*
 * Reads the columns that the map names from an open table and makes the recording of them. `m` gives the pole
 * pairs for what is mechanical and the cycle that the rows must have; NULL if there is no motor file. On
 * failure *r is empty.
 */
bool convert_log(log_table *t, const import_map *map, const motor *m, recording *r, error *e);

enum { CONVERT_COMMENT = 600 };

/* The comment of the recording: source, map, shift. */
void convert_comment(const log_table *t, const import_map *map, char *text, size_t size);

#endif
