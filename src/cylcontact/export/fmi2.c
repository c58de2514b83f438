/*
 * FMI 2.0 around a model in C, for model exchange and co-simulation. `cylcontact export` puts before
 * this text the name and GUID of the model, the type Memory with all that a saved state holds, and
 * these parts of the model:
 *
 *   INPUTS, REALS       real variables that can be set, with the lowest references, and all of them
 *   INDICATORS          event indicators
 *   start(memory)       the initial state
 *   settle(memory, at_event)
 *                       let discrete variables follow; return whether anything changed
 *   reals_of(memory, reals), integer_of(memory, which, value), indicators_of(memory, indicators)
 *
 * There are no continuous states. During a communication step `memory->ahead` grows.
 *
 * The types are those of fmi2TypesPlatform.h and fmi2FunctionTypes.h of the FMI standard 2.0.
 */
#include <stdlib.h>

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
enum { fmi2False = 0, fmi2True = 1 };

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

/* A library has the plain names; linked statically, with the prefix that the user defines. */
#ifdef FMI2_FUNCTION_PREFIX
#define PASTE(a, b) a##b
#define PASTED(a, b) PASTE(a, b)
#define NAME(function) PASTED(FMI2_FUNCTION_PREFIX, function)
#define EXPORT
#else
#define NAME(function) function
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT
#endif
#endif

typedef struct {
    Memory memory;
    fmi2CallbackFunctions callbacks;
    char *name;
} Instance;

static fmi2Status refuse(const Instance *instance, const char *message)
{
    if (instance->callbacks.logger != NULL)
        instance->callbacks.logger(instance->callbacks.componentEnvironment, instance->name,
                                   fmi2Error, "logStatusError", "%s", message);
    return fmi2Error;
}

/* ---- Common functions ---- */

EXPORT const char *NAME(fmi2GetTypesPlatform)(void)
{
    return "default";
}

EXPORT const char *NAME(fmi2GetVersion)(void)
{
    return "2.0";
}

EXPORT fmi2Status NAME(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count,
                                            const fmi2String categories[])
{
    (void)c, (void)on, (void)count, (void)categories;
    return fmi2OK;
}

EXPORT fmi2Component NAME(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                           fmi2String resources,
                                           const fmi2CallbackFunctions *callbacks,
                                           fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *instance;
    const size_t length = name == NULL ? 1 : strlen(name) + 1;
    (void)type, (void)resources, (void)visible, (void)logging;
    instance = (Instance *)calloc(1, sizeof *instance);
    if (instance == NULL)
        return NULL;
    instance->name = (char *)calloc(length, 1);
    if (instance->name == NULL) {
        free(instance);
        return NULL;
    }
    if (name != NULL)
        memcpy(instance->name, name, length);
    if (callbacks != NULL)
        instance->callbacks = *callbacks;
    if (guid == NULL || strcmp(guid, GUID) != 0) {
        refuse(instance, "the GUID is not that of this FMU: unpack it anew");
        free(instance->name);
        free(instance);
        return NULL;
    }
    start(&instance->memory);
    return instance;
}

EXPORT void NAME(fmi2FreeInstance)(fmi2Component c)
{
    if (c != NULL) {
        free(((Instance *)c)->name);
        free(c);
    }
}

EXPORT fmi2Status NAME(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_given,
                                            fmi2Real tolerance, fmi2Real begin,
                                            fmi2Boolean end_given, fmi2Real end)
{
    (void)c, (void)tolerance_given, (void)tolerance, (void)begin, (void)end_given, (void)end;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2EnterInitializationMode)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2ExitInitializationMode)(fmi2Component c)
{
    settle(&((Instance *)c)->memory, 1);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2Terminate)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2Reset)(fmi2Component c)
{
    start(&((Instance *)c)->memory);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2GetReal)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                    fmi2Real values[])
{
    const Instance *instance = (const Instance *)c;
    double all[REALS];
    size_t k;

    reals_of(&instance->memory, all);
    for (k = 0; k < count; k++) {
        if (which[k] >= REALS)
            return refuse(instance, "there is no such real variable");
        values[k] = all[which[k]];
    }
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference which[],
                                       size_t count, fmi2Integer values[])
{
    const Instance *instance = (const Instance *)c;
    size_t k;
    for (k = 0; k < count; k++) {
        if (!integer_of(&instance->memory, which[k], &values[k]))
            return refuse(instance, "there is no such integer variable");
    }
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference which[],
                                       size_t count, fmi2Boolean values[])
{
    (void)which, (void)values;
    return count == 0 ? fmi2OK : refuse((const Instance *)c, "there are no booleans");
}

EXPORT fmi2Status NAME(fmi2GetString)(fmi2Component c, const fmi2ValueReference which[],
                                      size_t count, fmi2String values[])
{
    (void)which, (void)values;
    return count == 0 ? fmi2OK : refuse((const Instance *)c, "there are no strings");
}

EXPORT fmi2Status NAME(fmi2SetReal)(fmi2Component c, const fmi2ValueReference which[], size_t count,
                                    const fmi2Real values[])
{
    Instance *instance = (Instance *)c;
    size_t k;
    for (k = 0; k < count; k++) {
        if (which[k] >= INPUTS)
            return refuse(instance, "only inputs and parameters can be set");
        instance->memory.input[which[k]] = values[k];
        instance->memory.ahead = 0.0;
    }
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference which[],
                                       size_t count, const fmi2Integer values[])
{
    (void)which, (void)values;
    return count == 0 ? fmi2OK : refuse((const Instance *)c, "only the real inputs can be set");
}

EXPORT fmi2Status NAME(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference which[],
                                       size_t count, const fmi2Boolean values[])
{
    (void)which, (void)values;
    return count == 0 ? fmi2OK : refuse((const Instance *)c, "there are no booleans");
}

EXPORT fmi2Status NAME(fmi2SetString)(fmi2Component c, const fmi2ValueReference which[],
                                      size_t count, const fmi2String values[])
{
    (void)which, (void)values;
    return count == 0 ? fmi2OK : refuse((const Instance *)c, "there are no strings");
}

EXPORT fmi2Status NAME(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    if (*state == NULL)
        *state = malloc(sizeof(Memory));
    if (*state == NULL)
        return refuse((const Instance *)c, "there is no memory left");
    memcpy(*state, &((const Instance *)c)->memory, sizeof(Memory));
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    if (state == NULL)
        return refuse((const Instance *)c, "there is no such state");
    memcpy(&((Instance *)c)->memory, state, sizeof(Memory));
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state,
                                                   size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(Memory);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state,
                                              fmi2Byte bytes[], size_t size)
{
    if (size < sizeof(Memory))
        return refuse((const Instance *)c, "a state needs more room than that");
    memcpy(bytes, state, sizeof(Memory));
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[],
                                                size_t size, fmi2FMUstate *state)
{
    if (size != sizeof(Memory))
        return refuse((const Instance *)c, "these bytes are not a state of this FMU");
    if (*state == NULL)
        *state = malloc(sizeof(Memory));
    if (*state == NULL)
        return refuse((const Instance *)c, "there is no memory left");
    memcpy(*state, bytes, sizeof(Memory));
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2GetDirectionalDerivative)(fmi2Component c,
                                                     const fmi2ValueReference unknown[],
                                                     size_t unknowns,
                                                     const fmi2ValueReference known[],
                                                     size_t knowns, const fmi2Real seed[],
                                                     fmi2Real sensitivity[])
{
    (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)seed, (void)sensitivity;
    return refuse((const Instance *)c, "there are no directional derivatives");
}

/* ---- Model exchange ---- */

EXPORT fmi2Status NAME(fmi2EnterEventMode)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info)
{
    settle(&((Instance *)c)->memory, 1);
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2EnterContinuousTimeMode)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2CompletedIntegratorStep)(fmi2Component c, fmi2Boolean no_going_back,
                                                    fmi2Boolean *enter_event_mode,
                                                    fmi2Boolean *terminate)
{
    (void)no_going_back;
    *enter_event_mode = settle(&((Instance *)c)->memory, 0) ? fmi2True : fmi2False;
    *terminate = fmi2False;
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SetTime)(fmi2Component c, fmi2Real time)
{
    (void)c, (void)time;
    return fmi2OK;
}

static fmi2Status without_states(const Instance *instance, size_t count)
{
    return count == 0 ? fmi2OK : refuse(instance, "there are no continuous states");
}

EXPORT fmi2Status NAME(fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t count)
{
    (void)x;
    return without_states((const Instance *)c, count);
}

EXPORT fmi2Status NAME(fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t count)
{
    (void)x;
    return without_states((const Instance *)c, count);
}

EXPORT fmi2Status NAME(fmi2GetDerivatives)(fmi2Component c, fmi2Real derivatives[], size_t count)
{
    (void)derivatives;
    return without_states((const Instance *)c, count);
}

EXPORT fmi2Status NAME(fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real x[],
                                                          size_t count)
{
    (void)x;
    return without_states((const Instance *)c, count);
}

EXPORT fmi2Status NAME(fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicators[],
                                               size_t count)
{
    const Instance *instance = (const Instance *)c;
    if (count != INDICATORS)
        return refuse(instance, "there are fewer or more event indicators");
    indicators_of(&instance->memory, indicators);
    return fmi2OK;
}

/* ---- Co-simulation ---- */

EXPORT fmi2Status NAME(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real step,
                                   fmi2Boolean no_going_back)
{
    Memory *memory = &((Instance *)c)->memory;
    (void)time, (void)no_going_back;
    memory->ahead += step;
    settle(memory, 0);
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2SetRealInputDerivatives)(fmi2Component c,
                                                    const fmi2ValueReference which[], size_t count,
                                                    const fmi2Integer order[],
                                                    const fmi2Real values[])
{
    (void)which, (void)count, (void)order, (void)values;
    return refuse((const Instance *)c, "the inputs have their velocities already");
}

EXPORT fmi2Status NAME(fmi2GetRealOutputDerivatives)(fmi2Component c,
                                                     const fmi2ValueReference which[], size_t count,
                                                     const fmi2Integer order[], fmi2Real values[])
{
    (void)which, (void)count, (void)order, (void)values;
    return refuse((const Instance *)c, "the outputs come without derivatives");
}

EXPORT fmi2Status NAME(fmi2CancelStep)(fmi2Component c)
{
    return refuse((const Instance *)c, "no step is under way");
}

/* No step is ever pending, so that there is nothing to ask. */
static fmi2Status no_status(const Instance *instance)
{
    refuse(instance, "no step is pending");
    return fmi2Discard;
}

EXPORT fmi2Status NAME(fmi2GetStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    return no_status((const Instance *)c);
}

EXPORT fmi2Status NAME(fmi2GetRealStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Real *value)
{
    (void)kind, (void)value;
    return no_status((const Instance *)c);
}

EXPORT fmi2Status NAME(fmi2GetIntegerStatus)(fmi2Component c, fmi2StatusKind kind,
                                             fmi2Integer *value)
{
    (void)kind, (void)value;
    return no_status((const Instance *)c);
}

EXPORT fmi2Status NAME(fmi2GetBooleanStatus)(fmi2Component c, fmi2StatusKind kind,
                                             fmi2Boolean *value)
{
    (void)kind, (void)value;
    return no_status((const Instance *)c);
}

EXPORT fmi2Status NAME(fmi2GetStringStatus)(fmi2Component c, fmi2StatusKind kind,
                                            fmi2String *value)
{
    (void)kind, (void)value;
    return no_status((const Instance *)c);
}
