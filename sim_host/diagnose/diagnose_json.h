/*
 * The diagnosis as the JSON of interfaces.md.
 */
#ifndef SIM_HOST_DIAGNOSE_DIAGNOSE_JSON_H
#define SIM_HOST_DIAGNOSE_DIAGNOSE_JSON_H

#include "diagnose_result.h"

#include <jansson.h>

/* A new reference; NULL: out of memory. */
json_t *diagnose_json(const diagnosis *d, const char *recording_path, const char *motor_path);

#endif
