/*
 * The variables of the FMU (fmu_variables.def): one table for the file that describes them and for the calls that read and
 * write them.
 */
#ifndef SIM_HOST_FMU_FMU_VARIABLE_H
#define SIM_HOST_FMU_FMU_VARIABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What the FMU is of. */
typedef enum fmu_kind {
    FMU_KIND_PLANT, /* inverter, machine, shaft and sensors; duties come from outside */
    FMU_KIND_DRIVE  /* the same with the library's control cycle around it */
} fmu_kind;

/* As the command line and setup.toml say it. */
extern const char *const fmu_kind_words[2];

typedef enum fmu_role {
    FMU_ROLE_INPUT,
    FMU_ROLE_FIXED,
    FMU_ROLE_TUNABLE,
    FMU_ROLE_DERIVED,
    FMU_ROLE_OUTPUT
} fmu_role;

typedef enum fmu_type { FMU_TYPE_REAL, FMU_TYPE_WHOLE, FMU_TYPE_FLAG, FMU_TYPE_HASH } fmu_type;

typedef enum fmu_id {
#define VARIABLE(id, role, type, kinds, unit, what) FMU_##id,
#include "fmu_variables.def"
    FMU_VARIABLES
} fmu_id;

typedef struct fmu_variable {
    const char *name;
    fmu_role role;
    fmu_type type;
    bool of[2];       /* fmu_kind */
    const char *unit; /* NULL: none */
    const char *what;
    size_t offset; /* of the double within plant_config; 0: none of it */
} fmu_variable;

extern const fmu_variable fmu_variables[FMU_VARIABLES];

/* Value references: the time is 0, variables follow. */
static inline uint32_t fmu_reference_of(int id)
{
    return (uint32_t)id + 1U;
}

#endif
