/*
 * FMI 2.0 around a clearance joint, for model exchange and co-simulation. `cylcontact export` puts a
 * few definitions before this text: JOINT(name), GUID, RATE_FLOOR, TOUCH and the joint's header.
 *
 * The inputs are the positions and velocities of the two bodies, the outputs the wrench that follows
 * from them. There are no continuous states, and one event indicator, the penetration. The impact
 * rate is the only memory. It changes in `settle`: at events and completed integrator steps in model
 * exchange, at the end of each step in co-simulation. During a communication step the bodies go on
 * at the velocities that were set, so the outputs after it are those at its end.
 *
 * The types are those of fmi2TypesPlatform.h and fmi2FunctionTypes.h of the FMI standard 2.0.
 */
#include <stdlib.h>
#include <string.h>

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

/* Value references as in modelDescription.xml: inputs, outputs, and what is local. */
enum { INPUTS = 12, REALS = 25 };

/* All that a saved state of the FMU holds. */
typedef struct {
    double input[INPUTS]; /* bearing, then pin: x, y, angle, v_x, v_y, spin */
    double ahead;         /* the time that the bodies have gone on since */
    JOINT(state) contact;
    int flag; /* as of the last event or step: a discrete variable */
} Memory;

typedef struct {
    Memory memory;
    fmi2CallbackFunctions callbacks;
    char *name;
} Instance;

static fmi2Status refuse(const Instance *joint, const char *message)
{
    if (joint->callbacks.logger != NULL)
        joint->callbacks.logger(joint->callbacks.componentEnvironment, joint->name, fmi2Error,
                                "logStatusError", "%s", message);
    return fmi2Error;
}

/* Both bodies where they are now. */
static void bodies_of(const Memory *memory, double bodies[INPUTS])
{
    int k;
    memcpy(bodies, memory->input, sizeof memory->input);
    for (k = 0; k < 3; k++) {
        bodies[k] += memory->ahead * bodies[k + 3];
        bodies[k + 6] += memory->ahead * bodies[k + 9];
    }
}

static void wrench_of(const Memory *memory, JOINT(wrench) *wrench)
{
    double bodies[INPUTS];
    bodies_of(memory, bodies);
    JOINT(evaluate)(&memory->contact, bodies, bodies + 6, wrench);
}

/*
 * Let the contact begin, last or end, and the flag follow; return whether anything changed.
 * An importer may locate the event of a touch a hair before it: within TOUCH, an approach is one.
 */
static int settle(Memory *memory, int at_event)
{
    const double rate = memory->contact.impact_rate;
    const int flag = memory->flag;
    double bodies[INPUTS];
    JOINT(wrench) wrench;

    bodies_of(memory, bodies);
    wrench_of(memory, &wrench);
    if (wrench.penetration > 0.0 || wrench.penetration < -TOUCH || !(wrench.penetration_rate > 0.0))
        JOINT(accept)(&memory->contact, bodies, bodies + 6);
    else if (at_event && !(rate > 0.0))
        memory->contact.impact_rate =
            wrench.penetration_rate > RATE_FLOOR ? wrench.penetration_rate : RATE_FLOOR;
    wrench_of(memory, &wrench);
    memory->flag = wrench.flag;
    /* Not a comparison of floats with !=, which compilers warn of. */
    return memory->flag != flag || memory->contact.impact_rate < rate
           || memory->contact.impact_rate > rate;
}

static void start(Memory *memory)
{
    memset(memory, 0, sizeof *memory);
    JOINT(start)(&memory->contact);
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
    Instance *joint;
    const size_t length = name == NULL ? 1 : strlen(name) + 1;
    (void)type, (void)resources, (void)visible, (void)logging;
    joint = (Instance *)calloc(1, sizeof *joint);
    if (joint == NULL)
        return NULL;
    joint->name = (char *)calloc(length, 1);
    if (joint->name == NULL) {
        free(joint);
        return NULL;
    }
    if (name != NULL)
        memcpy(joint->name, name, length);
    if (callbacks != NULL)
        joint->callbacks = *callbacks;
    if (guid == NULL || strcmp(guid, GUID) != 0) {
        refuse(joint, "the GUID is not that of this FMU: unpack it anew");
        free(joint->name);
        free(joint);
        return NULL;
    }
    start(&joint->memory);
    return joint;
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
    const Instance *joint = (const Instance *)c;
    double all[REALS];
    JOINT(wrench) wrench;
    size_t k;

    wrench_of(&joint->memory, &wrench);
    memcpy(all, joint->memory.input, sizeof joint->memory.input);
    all[12] = wrench.force_bearing[0];
    all[13] = wrench.force_bearing[1];
    all[14] = wrench.moment_bearing;
    all[15] = wrench.force_pin[0];
    all[16] = wrench.force_pin[1];
    all[17] = wrench.moment_pin;
    all[18] = wrench.penetration;
    all[19] = wrench.penetration_rate;
    all[20] = wrench.normal_force;
    all[21] = wrench.friction_force;
    all[22] = wrench.tangential_velocity;
    all[23] = wrench.dissipated_power;
    all[24] = joint->memory.contact.impact_rate;
    for (k = 0; k < count; k++) {
        if (which[k] >= REALS)
            return refuse(joint, "there is no such real variable");
        values[k] = all[which[k]];
    }
    return fmi2OK;
}

EXPORT fmi2Status NAME(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference which[],
                                       size_t count, fmi2Integer values[])
{
    const Instance *joint = (const Instance *)c;
    size_t k;
    for (k = 0; k < count; k++) {
        if (which[k] != 0)
            return refuse(joint, "there is no such integer variable");
        values[k] = joint->memory.flag;
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
    Instance *joint = (Instance *)c;
    size_t k;
    for (k = 0; k < count; k++) {
        if (which[k] >= INPUTS)
            return refuse(joint, "only the inputs can be set");
        joint->memory.input[which[k]] = values[k];
        joint->memory.ahead = 0.0;
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

static fmi2Status without_states(const Instance *joint, size_t count)
{
    return count == 0 ? fmi2OK : refuse(joint, "there are no continuous states");
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
    JOINT(wrench) wrench;
    if (count != 1)
        return refuse((const Instance *)c, "there is one event indicator");
    wrench_of(&((const Instance *)c)->memory, &wrench);
    indicators[0] = wrench.penetration;
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
static fmi2Status no_status(const Instance *joint)
{
    refuse(joint, "no step is pending");
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
