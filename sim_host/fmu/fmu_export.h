/*
 * An FMU of a motor file: FMI 3.0, co-simulation, for this kind of machine.
 *
 *     modelDescription.xml          the variables, with the motor file's values as start values
 *     binaries/x86_64-linux/...     the shared library, which this program carries within itself
 *     resources/                    what it reads: fmu_setup.h
 */
#ifndef SIM_HOST_FMU_FMU_EXPORT_H
#define SIM_HOST_FMU_FMU_EXPORT_H

#include "fmu_variable.h"

#include "base/error.h"

#include <stddef.h>

typedef struct fmu_request {
    const char *motor_path, *scenario_path, *out_path; /* scenario_path may be NULL */
    fmu_kind kind;
    size_t run; /* of the scenario, from 0 */
    long seed;
    const char *const *effect; /* as --effect takes them */
    int effects;
} fmu_request;

bool fmu_export(const fmu_request *r, error *e);

#endif
