/* The calls of FMI 3.0 that an FMU must have and this one, by its description, is never asked for: each is refused. */
#include "fmu_instance.h"

static fmi3Status refuse(fmi3Instance instance, const char *what)
{
    return fmu_say(instance, what);
}

/* Types that none of the variables has. To ask for no value is no mistake. */
#define NO_VALUES(TYPE)                                                                                      \
    fmi3Status fmi3Get##TYPE(FMI3_REFERENCES, fmi3##TYPE values[], size_t count)                             \
    {                                                                                                        \
        (void)references, (void)values, (void)count;                                                         \
        return reference_count == 0 ? fmi3OK : refuse(instance, "no variable is a " #TYPE);                  \
    }                                                                                                        \
    fmi3Status fmi3Set##TYPE(FMI3_REFERENCES, const fmi3##TYPE values[], size_t count)                       \
    {                                                                                                        \
        (void)references, (void)values, (void)count;                                                         \
        return reference_count == 0 ? fmi3OK : refuse(instance, "no variable is a " #TYPE);                  \
    }

NO_VALUES(Float32)
NO_VALUES(Int8)
NO_VALUES(UInt8)
NO_VALUES(Int16)
NO_VALUES(UInt16)
NO_VALUES(UInt32)
NO_VALUES(Int64)
NO_VALUES(String)

fmi3Status fmi3GetBinary(FMI3_REFERENCES, size_t sizes[], fmi3Binary values[], size_t count)
{
    (void)references, (void)sizes, (void)values, (void)count;
    return reference_count == 0 ? fmi3OK : refuse(instance, "no variable is a Binary");
}

fmi3Status fmi3SetBinary(FMI3_REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t count)
{
    (void)references, (void)sizes, (void)values, (void)count;
    return reference_count == 0 ? fmi3OK : refuse(instance, "no variable is a Binary");
}

/* Clocks and their intervals. */
#define NO_CLOCKS(NAME, ...)                                                                                 \
    fmi3Status NAME(FMI3_REFERENCES, __VA_ARGS__)                                                            \
    {                                                                                                        \
        (void)references, (void)a;                                                                           \
        return reference_count == 0 ? fmi3OK : refuse(instance, #NAME ": there is no clock");                \
    }
#define NO_CLOCK_PAIRS(NAME, ...)                                                                            \
    fmi3Status NAME(FMI3_REFERENCES, __VA_ARGS__)                                                            \
    {                                                                                                        \
        (void)references, (void)a, (void)b;                                                                  \
        return reference_count == 0 ? fmi3OK : refuse(instance, #NAME ": there is no clock");                \
    }

NO_CLOCKS(fmi3GetClock, fmi3Clock a[])
NO_CLOCKS(fmi3SetClock, const fmi3Clock a[])
NO_CLOCK_PAIRS(fmi3GetIntervalDecimal, fmi3Float64 a[], fmi3IntervalQualifier b[])
NO_CLOCKS(fmi3GetShiftDecimal, fmi3Float64 a[])
NO_CLOCK_PAIRS(fmi3GetShiftFraction, fmi3UInt64 a[], fmi3UInt64 b[])
NO_CLOCKS(fmi3SetIntervalDecimal, const fmi3Float64 a[])
NO_CLOCK_PAIRS(fmi3SetIntervalFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])
NO_CLOCKS(fmi3SetShiftDecimal, const fmi3Float64 a[])
NO_CLOCK_PAIRS(fmi3SetShiftFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])

fmi3Status fmi3GetIntervalFraction(FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier qualifiers[])
{
    (void)references, (void)counters, (void)resolutions, (void)qualifiers;
    return reference_count == 0 ? fmi3OK : refuse(instance, "fmi3GetIntervalFraction: there is no clock");
}

/* Events: the FMU has none, its cycles are its own affair. */
fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    return refuse(instance, "fmi3EnterEventMode: there are no events");
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
    return refuse(instance, "fmi3EvaluateDiscreteStates: there are no events");
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *need_update, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                    fmi3Boolean *next_time_defined, fmi3Float64 *next_time)
{
    *need_update = *terminate = *nominals_changed = *values_changed = *next_time_defined = false;
    (void)next_time;
    return refuse(instance, "fmi3UpdateDiscreteStates: there are no events");
}

/* No structural parameters, no derivatives, no dependencies reported, no state as bytes. */
fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
{
    return refuse(instance, "fmi3EnterConfigurationMode: there are no structural parameters");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
{
    return refuse(instance, "fmi3ExitConfigurationMode: there are no structural parameters");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference reference,
                                               size_t *count)
{
    (void)reference, (void)count;
    return refuse(instance, "fmi3GetNumberOfVariableDependencies: not provided");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                       size_t dependent_elements[], fmi3ValueReference independents[],
                                       size_t independent_elements[], fmi3DependencyKind kinds[],
                                       size_t count)
{
    (void)dependent, (void)dependent_elements, (void)independents, (void)independent_elements;
    (void)kinds, (void)count;
    return refuse(instance, "fmi3GetVariableDependencies: not provided");
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    (void)state, (void)size;
    return refuse(instance, "fmi3SerializedFMUStateSize: the state cannot leave the process");
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    (void)state, (void)bytes, (void)size;
    return refuse(instance, "fmi3SerializeFMUState: the state cannot leave the process");
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state)
{
    (void)bytes, (void)size, (void)state;
    return refuse(instance, "fmi3DeserializeFMUState: the state cannot leave the process");
}

#define NO_DERIVATIVES(NAME)                                                                                 \
    fmi3Status NAME(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t unknown_count,        \
                    const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],         \
                    size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)                  \
    {                                                                                                        \
        (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count, (void)seed;                    \
        (void)seed_count, (void)sensitivity, (void)sensitivity_count;                                        \
        return refuse(instance, #NAME ": there are none");                                                   \
    }

NO_DERIVATIVES(fmi3GetDirectionalDerivative)
NO_DERIVATIVES(fmi3GetAdjointDerivative)

fmi3Status fmi3GetOutputDerivatives(FMI3_REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
                                    size_t count)
{
    (void)references, (void)reference_count, (void)orders, (void)values, (void)count;
    return refuse(instance, "fmi3GetOutputDerivatives: there are none");
}
