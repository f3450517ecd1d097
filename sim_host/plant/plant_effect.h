/*
 * Effects: how the true drive differs from its motor file. "id[:key=value,...]", as `iqfoc simulate --effect`
 * takes it.
 *
 * Ids that the diagnosis knows carry its names and units (interfaces.md); the others are disturbances and
 * sensor properties. A key may be written with its unit behind it (`R=1.2` or `R_ohm=1.2`). A key that is not
 * given stays as it is; with no key at all the effect takes a typical size, which plant_effect_list shows.
 */
#ifndef SIM_HOST_PLANT_PLANT_EFFECT_H
#define SIM_HOST_PLANT_PLANT_EFFECT_H

#include "plant_config.h"

#include <stdio.h>

/* Changes the configuration; on failure it is untouched and *e says what was expected. Later effects win. */
bool plant_effect_apply(plant_config *c, const char *text, error *e);

/* One line per effect: id, keys with units, what it does. For --list-effects. */
void plant_effect_list(FILE *stream);

#endif
