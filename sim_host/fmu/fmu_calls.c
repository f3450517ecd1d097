/* The calls of FMI 3.0 that this FMU answers, over its model (fmu_model.h). */
#include "fmu_instance.h"
#include "golden_hash.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

fmi3Status fmu_say(const fmu_instance *instance, const char *text)
{
    if (instance->log != NULL) {
        instance->log(instance->environment, fmi3Error, "logStatusError", text);
    }
    return fmi3Error;
}

const char *fmi3GetVersion(void)
{
    return "3.0";
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t category_count,
                               const fmi3String categories[])
{
    (void)instance, (void)on, (void)category_count, (void)categories;
    return fmi3OK; /* errors are always reported; there are no other messages */
}

/* The model, from the files next to the binary; made for the description that the simulator has read. */
static bool load(fmu_model *m, const char *folder, const char *token, error *e)
{
    fmu_setup s;
    if (folder == NULL) {
        return error_input(e, NULL, 0, 0,
                           "the simulator gave no resourcePath; this FMU reads its motor file there");
    }
    if (!fmu_setup_read(&s, folder, e)) {
        return false;
    }
    if (token == NULL || strcmp(token, s.token) != 0) {
        fmu_setup_free(&s);
        return error_input(e, NULL, 0, 0, "the instantiation token is not that of this FMU's files");
    }
    if (!fmu_model_load(m, &s, e)) {
        fmu_model_free(m);
        return false;
    }
    return true;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resource_path,
                                         fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                         fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                         size_t intermediate_count, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)name, (void)visible, (void)logging, (void)event_mode, (void)early_return;
    (void)intermediate, (void)intermediate_count, (void)update;
    error e = {0};
    fmu_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return NULL;
    }
    instance->environment = environment;
    instance->log = log;
    if (!load(&instance->model, resource_path, token, &e)) {
        (void)fmu_say(instance, e.text);
        free(instance);
        return NULL;
    }
    return instance;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    fmu_instance *own = instance;
    if (own != NULL) {
        fmu_model_free(&own->model);
        free(own);
    }
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                       fmi3Float64 tolerance, fmi3Float64 start_time,
                                       fmi3Boolean stop_time_defined, fmi3Float64 stop_time)
{
    fmu_instance *own = instance;
    (void)tolerance_defined, (void)tolerance, (void)stop_time_defined, (void)stop_time;
    if (!isfinite(start_time)) {
        return fmu_say(own, "the start time must be a finite number");
    }
    own->phase = FMU_INITIALISING;
    own->start_s = own->now_s = start_time;
    return fmi3OK;
}

/* Once all that is set before the start is set; also for who looks at an output before. */
static fmi3Status begin(fmu_instance *own)
{
    error e = {0};
    if (!own->model.begun && !fmu_model_begin(&own->model, own->start_s, &e)) {
        return fmu_say(own, e.text);
    }
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    fmu_instance *own = instance;
    const fmi3Status status = begin(own);
    own->phase = status == fmi3OK ? FMU_STEPPING : FMU_ENDED;
    return status;
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    fmu_instance *own = instance;
    own->phase = FMU_ENDED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    fmu_instance *own = instance;
    fmu_model_reset(&own->model);
    own->phase = FMU_INSTANTIATED;
    own->start_s = own->now_s = 0.0;
    return fmi3OK;
}

/* The variable of a reference, or NULL where there is none of this type in an FMU of this kind. */
static const fmu_variable *variable_of(const fmu_instance *own, fmi3ValueReference reference, fmu_type type)
{
    if (reference == 0 || reference > FMU_VARIABLES) {
        return NULL;
    }
    const fmu_variable *v = &fmu_variables[reference - 1];
    return v->type == type && v->of[own->model.setup.kind] ? v : NULL;
}

static fmi3Status unknown(const fmu_instance *own, fmi3ValueReference reference)
{
    char text[80];
    (void)snprintf(text, sizeof text, "value reference %u is no variable of this type", (unsigned)reference);
    return fmu_say(own, text);
}

static fmi3Status get(fmu_instance *own, fmi3ValueReference reference, fmu_type type, double *value)
{
    if (reference == 0 && type == FMU_TYPE_REAL) {
        *value = own->now_s;
        return fmi3OK;
    }
    const fmu_variable *v = variable_of(own, reference, type);
    if (v == NULL) {
        return unknown(own, reference);
    }
    if (v->role == FMU_ROLE_OUTPUT && own->phase == FMU_INITIALISING && begin(own) != fmi3OK) {
        return fmi3Error;
    }
    *value = own->model.value[reference - 1];
    return fmi3OK;
}

static fmi3Status set(fmu_instance *own, fmi3ValueReference reference, fmu_type type, double value)
{
    error e = {0};
    const fmu_variable *v = variable_of(own, reference, type);
    if (v == NULL) {
        return unknown(own, reference);
    }
    const bool starting = own->phase == FMU_INSTANTIATED || own->phase == FMU_INITIALISING;
    const bool may =
        v->role == FMU_ROLE_INPUT || v->role == FMU_ROLE_TUNABLE || (v->role == FMU_ROLE_FIXED && starting);
    char text[160];
    if (!may || own->phase == FMU_ENDED) {
        (void)snprintf(text, sizeof text, "%s cannot be set now", v->name);
        return fmu_say(own, text);
    }
    if (!fmu_model_set(&own->model, (fmu_id)(reference - 1), value, &e)) {
        return fmu_say(own, e.text);
    }
    if (starting) {
        own->model.begun = false; /* who looked at an output before: it starts from these values */
    }
    return fmi3OK;
}

/* fmi3GetFloat64 and fmi3SetFloat64, and the same of the other types that the model has. */
#define GET_AND_SET(TYPE, KIND, FROM)                                                                        \
    fmi3Status fmi3Get##TYPE(FMI3_REFERENCES, fmi3##TYPE values[], size_t count)                             \
    {                                                                                                        \
        fmi3Status status = count == reference_count ? fmi3OK : fmi3Error;                                   \
        for (size_t k = 0; k < reference_count && status == fmi3OK; k++) {                                   \
            double value = 0.0;                                                                              \
            status = get(instance, references[k], KIND, &value);                                             \
            values[k] = FROM;                                                                                \
        }                                                                                                    \
        return status;                                                                                       \
    }                                                                                                        \
    fmi3Status fmi3Set##TYPE(FMI3_REFERENCES, const fmi3##TYPE values[], size_t count)                       \
    {                                                                                                        \
        fmi3Status status = count == reference_count ? fmi3OK : fmi3Error;                                   \
        for (size_t k = 0; k < reference_count && status == fmi3OK; k++) {                                   \
            status = set(instance, references[k], KIND, (double)values[k]);                                  \
        }                                                                                                    \
        return status;                                                                                       \
    }

GET_AND_SET(Float64, FMU_TYPE_REAL, value)
GET_AND_SET(Int32, FMU_TYPE_WHOLE, (int32_t)value)
GET_AND_SET(Boolean, FMU_TYPE_FLAG, value != 0.0)

/* The one hash: what the library in this very FMU computes. */
fmi3Status fmi3GetUInt64(FMI3_REFERENCES, fmi3UInt64 values[], size_t count)
{
    for (size_t k = 0; k < reference_count; k++) {
        if (count != reference_count || variable_of(instance, references[k], FMU_TYPE_HASH) == NULL) {
            return unknown(instance, references[k]);
        }
        values[k] = golden_hash(NULL);
    }
    return fmi3OK;
}

fmi3Status fmi3SetUInt64(FMI3_REFERENCES, const fmi3UInt64 values[], size_t count)
{
    (void)values, (void)count;
    return reference_count == 0 ? fmi3OK : set(instance, references[0], FMU_TYPE_HASH, 0.0);
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    const fmu_instance *own = instance;
    fmu_instance *copy = *state != NULL ? *state : malloc(sizeof *copy);
    if (copy == NULL) {
        return fmu_say(own, "out of memory for a copy of the state");
    }
    *copy = *own;
    *state = copy;
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state)
{
    *(fmu_instance *)instance = *(const fmu_instance *)state;
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    ((fmu_instance *)instance)->phase = FMU_STEPPING;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_state_before,
                      fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
                      fmi3Float64 *last_time)
{
    fmu_instance *own = instance;
    error e = {0};
    (void)no_state_before;
    *event_needed = *terminate = *early_return = false;
    *last_time = own->now_s;
    if (own->phase != FMU_STEPPING) {
        return fmu_say(own, "a step was asked for outside of step mode");
    }
    if (!(step >= 0.0)) {
        return fmu_say(own, "a step must not go backwards");
    }
    if (!isfinite(time) || !isfinite(step) || !fmu_model_reaches(&own->model, time + step)) {
        return fmu_say(own, "a step must end within ten million control cycles");
    }
    if (!fmu_model_advance(&own->model, time + step, &e)) {
        own->phase = FMU_ENDED;
        return fmu_say(own, e.text);
    }
    own->now_s = time + step;
    *last_time = own->now_s;
    return fmi3OK;
}
