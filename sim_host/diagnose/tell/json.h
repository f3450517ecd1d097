/*
 * The diagnosis as JSON: the keys of docs/diagnosis_reference.md.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_JSON_H
#define SIM_HOST_DIAGNOSE_TELL_JSON_H

#include "base/json.h"
#include "diagnose/result.h"

/* A new reference; NULL: out of memory. */
json_t *json_of_diagnosis(const diagnosis *d);

#endif
