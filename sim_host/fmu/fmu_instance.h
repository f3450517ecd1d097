/* An instance of the FMU, as its two files of calls share it (fmu_calls.c, fmu_refused.c). */
#ifndef SIM_HOST_FMU_FMU_INSTANCE_H
#define SIM_HOST_FMU_FMU_INSTANCE_H

#include "fmi3.h"
#include "fmu_model.h"

typedef enum fmu_phase {
    FMU_INSTANTIATED,
    FMU_INITIALISING,
    FMU_STEPPING,
    FMU_ENDED /* terminated, or stopped by an error: reset or free */
} fmu_phase;

typedef struct fmu_instance {
    fmu_model model;
    fmu_phase phase;
    double start_s, now_s;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} fmu_instance;

/* Tells the simulator; returns fmi3Error. */
fmi3Status fmu_say(const fmu_instance *instance, const char *text);

#endif
