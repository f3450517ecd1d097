/* The table of the FMU's variables (fmu_variable.h). */
#include "fmu_variable.h"

#include "plant/plant_config.h"

const char *const fmu_kind_words[2] = {"plant", "drive"};

#define OF_PLANT                                                                                             \
    {                                                                                                        \
        true, false                                                                                          \
    }
#define OF_DRIVE                                                                                             \
    {                                                                                                        \
        false, true                                                                                          \
    }
#define OF_BOTH                                                                                              \
    {                                                                                                        \
        true, true                                                                                           \
    }

const fmu_variable fmu_variables[FMU_VARIABLES] = {
#define VARIABLE(id, role, type, kinds, unit, what)                                                          \
    {#id, FMU_ROLE_##role, FMU_TYPE_##type, OF_##kinds, unit, what, 0},
#define PARAMETER(id, field, unit, what)                                                                     \
    {#id, FMU_ROLE_TUNABLE, FMU_TYPE_REAL, OF_BOTH, unit, what, offsetof(plant_config, field)},
#include "fmu_variables.def"
};
