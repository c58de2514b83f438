/*
 * FMI 2.0 around $name, for model exchange and co-simulation.
 *
 * There are no continuous states. During a communication step `ahead` grows.
 $if contacts
 * The bodies then go on at the velocities that were set, so the outputs after a step are those at
 * its end. The event indicators are the penetrations. The impact rates are the only memory: they
 * change in `settle`, at events and completed integrator steps in model exchange, at the end of each
 * step in co-simulation.
 $end
 *
 * The types are those of fmi2TypesPlatform.h and fmi2FunctionTypes.h of the FMI standard 2.0.
 */
#include <stdlib.h>
#include <string.h>
$if contacts

#include "$name.h"
$end

/* Functions of the standard have arguments that this model does not need. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

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

/* Value references as in modelDescription.xml: what can be set, and all of the real variables. */
enum { INPUTS = $inputs, REALS = $reals, INDICATORS = $indicators };

/* All that a saved state of the FMU holds. */
typedef struct {
    double input[INPUTS], ahead; /* ahead: the time since the inputs were set */
    $if contacts
    ${name}_state contact;
    int flag; /* as of the last event or step: a discrete variable */
    $end
} Memory;

static void start(Memory *memory)
{
    static const double first[INPUTS] = {$first};
    memset(memory, 0, sizeof *memory);
    memcpy(memory->input, first, sizeof first);
}

$if contacts
/* Both bodies where they are now, and the wrench. */
static ${name}_wrench wrench_of(const Memory *memory, double bodies[INPUTS])
{
    const double ahead = memory->ahead, *const input = memory->input;
    ${name}_wrench wrench;
    $bodies
    ${name}_evaluate(&memory->contact, bodies, bodies + INPUTS / 2, &wrench);
    return wrench;
}

/*
 * Let contacts begin, last or end, and the flag follow; return whether anything changed.
 * An importer may locate the event of a touch a hair before it: within TOUCH, an approach is one.
 */
static int settle(Memory *memory, int at_event)
{
    static const double TOUCH = $touch, FLOOR = $floor;
    ${name}_state next = memory->contact;
    double bodies[INPUTS], *rates = $rates, *accepted = $accepted;
    const ${name}_wrench wrench = wrench_of(memory, bodies);
    const double *depths = $depths, *speeds = $speeds;
    int k, flag = memory->flag, changed = 0;

    ${name}_accept(&next, bodies, bodies + INPUTS / 2);
    for (k = 0; k < INDICATORS; k++) {
        const double rate = rates[k];
        if (depths[k] > 0.0 || depths[k] < -TOUCH || !(speeds[k] > 0.0))
            rates[k] = accepted[k];
        else if (at_event && !(rate > 0.0))
            rates[k] = speeds[k] > FLOOR ? speeds[k] : FLOOR;
        /* Not a comparison of floats with !=, which compilers warn of. */
        changed = changed || rates[k] < rate || rates[k] > rate;
    }
    memory->flag = wrench_of(memory, bodies).flag;
    return changed || memory->flag != flag;
}

static void reals_of(const Memory *memory, double all[REALS])
{
    double bodies[INPUTS];
    const ${name}_wrench wrench = wrench_of(memory, bodies);
    memcpy(all, memory->input, sizeof memory->input);
    $outputs
}
$else
void $name(
    $parameters,
    double *load, double *stiffness);

static int settle(Memory *memory, int at_event)
{
    return 0;
}

static void reals_of(const Memory *memory, double all[REALS])
{
    memcpy(all, memory->input, sizeof memory->input);
    $name($given, &all[INPUTS], &all[INPUTS + 1]);
}
$end

typedef const unsigned int References[];
typedef const char *String;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error } Status;

typedef struct {
    void (*logger)(void *, String, Status, String, String, ...);
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void (*step_finished)(void *, Status);
    void *environment;
} Callbacks;

typedef struct {
    int new_discrete_states, terminate, nominals_changed, values_changed, next_event_defined;
    double next_event;
} EventInfo;

typedef struct {
    Memory memory;
    Callbacks callbacks;
    char *name;
} Instance;

static Status refuse(const Instance *c, String message)
{
    if (c->callbacks.logger != NULL)
        c->callbacks.logger(c->callbacks.environment, c->name, fmi2Error, "logStatusError", "%s",
                            message);
    return fmi2Error;
}

/* A function of the standard that has nothing to do, or none of what it is asked for. */
#define NOTHING(function, ...) \
    EXPORT Status NAME(function)(__VA_ARGS__) { return fmi2OK; }
#define NONE(function, what, ...) \
    EXPORT Status NAME(function)(Instance *c, __VA_ARGS__) \
    { return count == 0 ? fmi2OK : refuse(c, "there are no " what); }
#define REFUSED(function, message, ...) \
    EXPORT Status NAME(function)(Instance *c, __VA_ARGS__) { return refuse(c, message); }
#define NOT_PENDING(function, type) \
    EXPORT Status NAME(function)(Instance *c, int kind, type *value) \
    { refuse(c, "no step is pending"); return fmi2Discard; }

/* ---- Common functions ---- */

EXPORT String NAME(fmi2GetTypesPlatform)(void) { return "default"; }

EXPORT String NAME(fmi2GetVersion)(void) { return "2.0"; }

EXPORT Instance *NAME(fmi2Instantiate)(String name, int type, String guid, String resources,
                                       const Callbacks *callbacks, int visible, int logging)
{
    const size_t length = name == NULL ? 0 : strlen(name);
    Instance *c = (Instance *)calloc(1, sizeof *c + length + 1);
    if (c == NULL)
        return NULL;
    c->name = (char *)(c + 1);
    if (name != NULL)
        memcpy(c->name, name, length);
    if (callbacks != NULL)
        c->callbacks = *callbacks;
    if (guid == NULL || strcmp(guid, "$guid") != 0) {
        refuse(c, "the GUID is not that of this FMU: unpack it anew");
        free(c);
        return NULL;
    }
    start(&c->memory);
    return c;
}

EXPORT void NAME(fmi2FreeInstance)(Instance *c) { free(c); }

NOTHING(fmi2SetDebugLogging, Instance *c, int on, size_t count, const String categories[])
NOTHING(fmi2SetupExperiment, Instance *c, int given, double tolerance, double begin, int ends,
        double end)
NOTHING(fmi2EnterInitializationMode, Instance *c)
NOTHING(fmi2Terminate, Instance *c)

EXPORT Status NAME(fmi2ExitInitializationMode)(Instance *c)
{
    settle(&c->memory, 1);
    return fmi2OK;
}

EXPORT Status NAME(fmi2Reset)(Instance *c)
{
    start(&c->memory);
    return fmi2OK;
}

EXPORT Status NAME(fmi2GetReal)(Instance *c, References which, size_t count, double values[])
{
    double all[REALS];
    size_t k;
    reals_of(&c->memory, all);
    for (k = 0; k < count; k++) {
        if (which[k] >= REALS)
            return refuse(c, "there is no such real variable");
        values[k] = all[which[k]];
    }
    return fmi2OK;
}

EXPORT Status NAME(fmi2SetReal)(Instance *c, References which, size_t count, const double values[])
{
    size_t k;
    for (k = 0; k < count; k++) {
        if (which[k] >= INPUTS)
            return refuse(c, "only inputs and parameters can be set");
        c->memory.input[which[k]] = values[k];
        c->memory.ahead = 0.0;
    }
    return fmi2OK;
}

$if contacts
EXPORT Status NAME(fmi2GetInteger)(Instance *c, References which, size_t count, int values[])
{
    size_t k;
    for (k = 0; k < count; k++) {
        if (which[k] != 0)
            return refuse(c, "there is no such integer variable");
        values[k] = c->memory.flag;
    }
    return fmi2OK;
}
$else
NONE(fmi2GetInteger, "integers", References which, size_t count, int values[])
$end
NONE(fmi2SetInteger, "integers to set", References which, size_t count, const int values[])
NONE(fmi2GetBoolean, "booleans", References which, size_t count, int values[])
NONE(fmi2SetBoolean, "booleans", References which, size_t count, const int values[])
NONE(fmi2GetString, "strings", References which, size_t count, String values[])
NONE(fmi2SetString, "strings", References which, size_t count, const String values[])

/* Copy a state to where another is, or to a place of its own. */
static Status keep(const Instance *c, const void *from, void **state)
{
    if (*state == NULL)
        *state = malloc(sizeof(Memory));
    if (*state == NULL)
        return refuse(c, "there is no memory left");
    memcpy(*state, from, sizeof(Memory));
    return fmi2OK;
}

EXPORT Status NAME(fmi2GetFMUstate)(Instance *c, void **state)
{
    return keep(c, &c->memory, state);
}

EXPORT Status NAME(fmi2SetFMUstate)(Instance *c, void *state)
{
    if (state == NULL)
        return refuse(c, "there is no such state");
    memcpy(&c->memory, state, sizeof(Memory));
    return fmi2OK;
}

EXPORT Status NAME(fmi2FreeFMUstate)(Instance *c, void **state)
{
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT Status NAME(fmi2SerializedFMUstateSize)(Instance *c, void *state, size_t *size)
{
    *size = sizeof(Memory);
    return fmi2OK;
}

EXPORT Status NAME(fmi2SerializeFMUstate)(Instance *c, void *state, char bytes[], size_t size)
{
    if (size < sizeof(Memory))
        return refuse(c, "a state needs more room than that");
    memcpy(bytes, state, sizeof(Memory));
    return fmi2OK;
}

EXPORT Status NAME(fmi2DeSerializeFMUstate)(Instance *c, const char bytes[], size_t size,
                                            void **state)
{
    if (size != sizeof(Memory))
        return refuse(c, "these bytes are not a state of this FMU");
    return keep(c, bytes, state);
}

REFUSED(fmi2GetDirectionalDerivative, "there are no directional derivatives", References unknown,
        size_t unknowns, References known, size_t knowns, const double seed[], double result[])

/* ---- Model exchange ---- */

NOTHING(fmi2EnterEventMode, Instance *c)
NOTHING(fmi2EnterContinuousTimeMode, Instance *c)
NOTHING(fmi2SetTime, Instance *c, double time)
NONE(fmi2SetContinuousStates, "continuous states", const double x[], size_t count)
NONE(fmi2GetContinuousStates, "continuous states", double x[], size_t count)
NONE(fmi2GetDerivatives, "continuous states", double derivatives[], size_t count)
NONE(fmi2GetNominalsOfContinuousStates, "continuous states", double x[], size_t count)

EXPORT Status NAME(fmi2NewDiscreteStates)(Instance *c, EventInfo *info)
{
    settle(&c->memory, 1);
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

EXPORT Status NAME(fmi2CompletedIntegratorStep)(Instance *c, int no_going_back,
                                                int *enter_event_mode, int *terminate)
{
    *enter_event_mode = settle(&c->memory, 0);
    *terminate = 0;
    return fmi2OK;
}

EXPORT Status NAME(fmi2GetEventIndicators)(Instance *c, double indicators[], size_t count)
{
    $if contacts
    double bodies[INPUTS];
    const ${name}_wrench wrench = wrench_of(&c->memory, bodies);
    $end
    if (count != INDICATORS)
        return refuse(c, "there are fewer or more event indicators");
    $if contacts
    memcpy(indicators, $depths, INDICATORS * sizeof(double));
    $end
    return fmi2OK;
}

/* ---- Co-simulation ---- */

EXPORT Status NAME(fmi2DoStep)(Instance *c, double time, double step, int no_going_back)
{
    c->memory.ahead += step;
    settle(&c->memory, 0);
    return fmi2OK;
}

REFUSED(fmi2SetRealInputDerivatives, "the inputs have their velocities already", References which,
        size_t count, const int order[], const double values[])
REFUSED(fmi2GetRealOutputDerivatives, "the outputs come without derivatives", References which,
        size_t count, const int order[], double values[])

EXPORT Status NAME(fmi2CancelStep)(Instance *c) { return refuse(c, "no step is under way"); }

NOT_PENDING(fmi2GetStatus, Status)
NOT_PENDING(fmi2GetRealStatus, double)
NOT_PENDING(fmi2GetIntegerStatus, int)
NOT_PENDING(fmi2GetBooleanStatus, int)
NOT_PENDING(fmi2GetStringStatus, String)
