/* Model exchange and scheduled execution: simulators look for these calls in every FMU; this one is for co-simulation. */
#include "fmu_instance.h"

static void *not_made(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    if (log != NULL) {
        log(environment, fmi3Error, "logStatusError", "this FMU is for co-simulation alone");
    }
    return NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resource_path,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void)name, (void)token, (void)resource_path, (void)visible, (void)logging;
    return not_made(environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock_update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)resource_path, (void)visible, (void)logging;
    (void)clock_update, (void)lock, (void)unlock;
    return not_made(environment, log);
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return fmu_say(instance, "fmi3ActivateModelPartition: this FMU is for co-simulation alone");
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
    return fmu_say(instance, "fmi3EnterContinuousTimeMode: this FMU is for co-simulation alone");
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_state_before,
                                       fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
{
    (void)no_state_before;
    *enter_event_mode = *terminate = false;
    return fmu_say(instance, "fmi3CompletedIntegratorStep: this FMU is for co-simulation alone");
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    (void)time;
    return fmu_say(instance, "fmi3SetTime: this FMU is for co-simulation alone");
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t count)
{
    (void)states, (void)count;
    return fmu_say(instance, "fmi3SetContinuousStates: this FMU is for co-simulation alone");
}

#define NO_STATE_VALUES(NAME)                                                                                \
    fmi3Status NAME(fmi3Instance instance, fmi3Float64 values[], size_t count)                               \
    {                                                                                                        \
        (void)values, (void)count;                                                                           \
        return fmu_say(instance, #NAME ": this FMU is for co-simulation alone");                             \
    }

NO_STATE_VALUES(fmi3GetContinuousStateDerivatives)
NO_STATE_VALUES(fmi3GetEventIndicators)
NO_STATE_VALUES(fmi3GetContinuousStates)
NO_STATE_VALUES(fmi3GetNominalsOfContinuousStates)

#define NO_STATE_COUNT(NAME)                                                                                 \
    fmi3Status NAME(fmi3Instance instance, size_t *count)                                                    \
    {                                                                                                        \
        *count = 0;                                                                                          \
        return fmu_say(instance, #NAME ": this FMU is for co-simulation alone");                             \
    }

NO_STATE_COUNT(fmi3GetNumberOfEventIndicators)
NO_STATE_COUNT(fmi3GetNumberOfContinuousStates)
