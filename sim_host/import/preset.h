/*
 * Maps for logs of known tools, made from their public documentation and sources; preset.c says for each from
 * what, and what its logs lack.
 */
#ifndef SIM_HOST_IMPORT_PRESET_H
#define SIM_HOST_IMPORT_PRESET_H

#include "map.h"

typedef struct preset preset;

/* NULL if there is none of this name; then *e lists them. */
const preset *preset_find(const char *name, error *e);

import_map preset_map(const preset *p);

/* As TOML, with what is known and not known of the tool's logs. */
void preset_print(FILE *out, const preset *p);

#endif
