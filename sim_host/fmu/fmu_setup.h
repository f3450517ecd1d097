/*
 * What an FMU is made from: the files in its folder `resources`, which `iqfoc export-fmu` puts there.
 *
 *     motor.toml      the motor file, as the user has it
 *     scenario.toml   the scenario, if there is one
 *     setup.toml      kind, run, seed, effects, and the token that modelDescription.xml has too
 */
#ifndef SIM_HOST_FMU_FMU_SETUP_H
#define SIM_HOST_FMU_FMU_SETUP_H

#include "fmu_variable.h"

#include "base/error.h"
#include "data/motor.h"
#include "data/scenario.h"

enum { FMU_EFFECTS_MAX = 32, FMU_EFFECT_SIZE = 256, FMU_TOKEN_SIZE = 64 };

typedef struct fmu_setup {
    fmu_kind kind;
    motor motor;
    scenario scenario; /* without one: no run, perfect sensors, the firmware's own choices */
    bool has_scenario;
    size_t run; /* of the scenario, from 0 */
    long seed;
    int effects;
    char effect[FMU_EFFECTS_MAX][FMU_EFFECT_SIZE]; /* as --effect takes them */
    char token[FMU_TOKEN_SIZE];
} fmu_setup;

/* Motor and scenario (NULL: none) from their files; the caller sets the rest. On failure nothing is to be freed. */
bool fmu_setup_read_files(fmu_setup *s, const char *motor_path, const char *scenario_path, error *e);

/* All of it from a folder `resources`. Out of memory is an error here. */
bool fmu_setup_read(fmu_setup *s, const char *folder, error *e);

void fmu_setup_free(fmu_setup *s);

#endif
