/*
 * The C interface of FMI 3.0 (Functional Mock-up Interface, fmi-standard.org), in the standard's own names: the calls that
 * all FMUs have and those of co-simulation; and those of the two other kinds, as simulators look for them in any FMU.
 * tests/cli/fmu.py compiles this together with the standard's headers, so that a signature that differs does not pass.
 */
#ifndef SIM_HOST_FMU_FMI3_H
#define SIM_HOST_FMU_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FMI3_VISIBLE __attribute__((visibility("default")))

#ifdef FMI3_STANDARD_HEADERS
#include "fmi3Functions.h"
#else
typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment environment, fmi3Status status,
                                       fmi3String category, fmi3String message);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment environment, fmi3Float64 time,
                                               fmi3Boolean set_requested, fmi3Boolean get_allowed,
                                               fmi3Boolean step_finished, fmi3Boolean can_return_early,
                                               fmi3Boolean *early_return_requested,
                                               fmi3Float64 *early_return_time);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment environment);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);
#endif

/* What every call that concerns values begins with: which variables. */
#define FMI3_REFERENCES fmi3Instance instance, const fmi3ValueReference references[], size_t reference_count

FMI3_VISIBLE const char *fmi3GetVersion(void);
FMI3_VISIBLE fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t category_count,
                                            const fmi3String categories[]);
FMI3_VISIBLE fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
    size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update);
FMI3_VISIBLE void fmi3FreeInstance(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                                    fmi3Float64 tolerance, fmi3Float64 start_time,
                                                    fmi3Boolean stop_time_defined, fmi3Float64 stop_time);
FMI3_VISIBLE fmi3Status fmi3ExitInitializationMode(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3EnterEventMode(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3Terminate(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3Reset(fmi3Instance instance);

/* fmi3GetFloat64(...), fmi3SetFloat64(...) and their sisters. */
#define FMI3_GET_AND_SET(TYPE)                                                                               \
    FMI3_VISIBLE fmi3Status fmi3Get##TYPE(FMI3_REFERENCES, fmi3##TYPE values[], size_t count);               \
    FMI3_VISIBLE fmi3Status fmi3Set##TYPE(FMI3_REFERENCES, const fmi3##TYPE values[], size_t count);
FMI3_GET_AND_SET(Float32)
FMI3_GET_AND_SET(Float64)
FMI3_GET_AND_SET(Int8)
FMI3_GET_AND_SET(UInt8)
FMI3_GET_AND_SET(Int16)
FMI3_GET_AND_SET(UInt16)
FMI3_GET_AND_SET(Int32)
FMI3_GET_AND_SET(UInt32)
FMI3_GET_AND_SET(Int64)
FMI3_GET_AND_SET(UInt64)
FMI3_GET_AND_SET(Boolean)
FMI3_GET_AND_SET(String)
#undef FMI3_GET_AND_SET
FMI3_VISIBLE fmi3Status fmi3GetBinary(FMI3_REFERENCES, size_t sizes[], fmi3Binary values[], size_t count);
FMI3_VISIBLE fmi3Status fmi3SetBinary(FMI3_REFERENCES, const size_t sizes[], const fmi3Binary values[],
                                      size_t count);
FMI3_VISIBLE fmi3Status fmi3GetClock(FMI3_REFERENCES, fmi3Clock values[]);
FMI3_VISIBLE fmi3Status fmi3SetClock(FMI3_REFERENCES, const fmi3Clock values[]);

FMI3_VISIBLE fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance,
                                                            fmi3ValueReference reference, size_t *count);
FMI3_VISIBLE fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                                    size_t dependent_elements[],
                                                    fmi3ValueReference independents[],
                                                    size_t independent_elements[], fmi3DependencyKind kinds[],
                                                    size_t count);

FMI3_VISIBLE fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state);
FMI3_VISIBLE fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state);
FMI3_VISIBLE fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state);
FMI3_VISIBLE fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size);
FMI3_VISIBLE fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                                              size_t size);
FMI3_VISIBLE fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                                fmi3FMUState *state);

FMI3_VISIBLE fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance,
                                                     const fmi3ValueReference unknowns[],
                                                     size_t unknown_count, const fmi3ValueReference knowns[],
                                                     size_t known_count, const fmi3Float64 seed[],
                                                     size_t seed_count, fmi3Float64 sensitivity[],
                                                     size_t sensitivity_count);
FMI3_VISIBLE fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                                 size_t unknown_count, const fmi3ValueReference knowns[],
                                                 size_t known_count, const fmi3Float64 seed[],
                                                 size_t seed_count, fmi3Float64 sensitivity[],
                                                 size_t sensitivity_count);

FMI3_VISIBLE fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3GetIntervalDecimal(FMI3_REFERENCES, fmi3Float64 intervals[],
                                               fmi3IntervalQualifier qualifiers[]);
FMI3_VISIBLE fmi3Status fmi3GetIntervalFraction(FMI3_REFERENCES, fmi3UInt64 counters[],
                                                fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]);
FMI3_VISIBLE fmi3Status fmi3GetShiftDecimal(FMI3_REFERENCES, fmi3Float64 shifts[]);
FMI3_VISIBLE fmi3Status fmi3GetShiftFraction(FMI3_REFERENCES, fmi3UInt64 counters[],
                                             fmi3UInt64 resolutions[]);
FMI3_VISIBLE fmi3Status fmi3SetIntervalDecimal(FMI3_REFERENCES, const fmi3Float64 intervals[]);
FMI3_VISIBLE fmi3Status fmi3SetIntervalFraction(FMI3_REFERENCES, const fmi3UInt64 counters[],
                                                const fmi3UInt64 resolutions[]);
FMI3_VISIBLE fmi3Status fmi3SetShiftDecimal(FMI3_REFERENCES, const fmi3Float64 shifts[]);
FMI3_VISIBLE fmi3Status fmi3SetShiftFraction(FMI3_REFERENCES, const fmi3UInt64 counters[],
                                             const fmi3UInt64 resolutions[]);
FMI3_VISIBLE fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *need_update,
                                                 fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
                                                 fmi3Boolean *values_changed, fmi3Boolean *next_time_defined,
                                                 fmi3Float64 *next_time);

FMI3_VISIBLE fmi3Status fmi3EnterStepMode(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3GetOutputDerivatives(FMI3_REFERENCES, const fmi3Int32 orders[],
                                                 fmi3Float64 values[], size_t count);
FMI3_VISIBLE fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                                   fmi3Boolean no_state_before, fmi3Boolean *event_needed,
                                   fmi3Boolean *terminate, fmi3Boolean *early_return, fmi3Float64 *last_time);

/* Model exchange. */
FMI3_VISIBLE fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                       fmi3String resource_path, fmi3Boolean visible,
                                                       fmi3Boolean logging,
                                                       fmi3InstanceEnvironment environment,
                                                       fmi3LogMessageCallback log);
FMI3_VISIBLE fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance);
FMI3_VISIBLE fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_state_before,
                                                    fmi3Boolean *enter_event_mode, fmi3Boolean *terminate);
FMI3_VISIBLE fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time);
FMI3_VISIBLE fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[],
                                                size_t count);
FMI3_VISIBLE fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 values[],
                                                          size_t count);
FMI3_VISIBLE fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 values[], size_t count);
FMI3_VISIBLE fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 values[], size_t count);
FMI3_VISIBLE fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 values[],
                                                          size_t count);
FMI3_VISIBLE fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *count);
FMI3_VISIBLE fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *count);

/* Scheduled execution. */
FMI3_VISIBLE fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resource_path, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock_update,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock);
FMI3_VISIBLE fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock,
                                                   fmi3Float64 time);

#endif
