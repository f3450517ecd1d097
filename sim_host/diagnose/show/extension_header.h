/*
 * Writes iqfoc_extension.h: the values of a diagnosis as constants of the library, each with its physical value, unit and 95 % interval.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_EXTENSION_HEADER_H
#define SIM_HOST_DIAGNOSE_SHOW_EXTENSION_HEADER_H

#include "base/error.h"
#include "diagnose/result.h"
#include "firmware_map.h"

/* Compiles as C99 without warnings against include/; a value outside the library's range gives a compile error with its name. */
bool extension_header_write(const char *path, const diagnosis *d, const firmware_map *map, error *e);

#endif
