/*
 * What `iqfoc sweep` does beside its table over speed: the map of mean currents.
 */
#ifndef SIM_HOST_COMMANDS_SWEEP_SPECIAL_H
#define SIM_HOST_COMMANDS_SWEEP_SPECIAL_H

#include "data/motor.h"

/*
 * The map of means as a page in `directory` and as JSON in json_path, if that is not NULL. Without a directory
 * the page goes to "sweep-map", or is left out if there is JSON.
 */
bool sweep_map(const motor *m, const char *directory, const char *json_path, error *e);

#endif
