/*
 * A clearance joint for fmi2.c, behind its header and JOINT(name), GUID, RATE_FLOOR and TOUCH.
 *
 * The inputs are the positions and velocities of the two bodies, the outputs the wrench that follows
 * from them. The one event indicator is the penetration. The impact rate is the only memory. It
 * changes in `settle`: at events and completed integrator steps in model exchange, at the end of
 * each step in co-simulation. During a communication step the bodies go on at the velocities that
 * were set, so the outputs after it are those at its end.
 */
#include <string.h>

/* Value references as in modelDescription.xml: inputs, outputs, and what is local. */
enum { INPUTS = 12, REALS = 25, INDICATORS = 1 };

/* All that a saved state of the FMU holds. */
typedef struct {
    double input[INPUTS]; /* bearing, then pin: x, y, angle, v_x, v_y, spin */
    double ahead;         /* the time that the bodies have gone on since */
    JOINT(state) contact;
    int flag; /* as of the last event or step: a discrete variable */
} Memory;

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

static void reals_of(const Memory *memory, double all[REALS])
{
    JOINT(wrench) wrench;
    wrench_of(memory, &wrench);
    memcpy(all, memory->input, sizeof memory->input);
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
    all[24] = memory->contact.impact_rate;
}

static int integer_of(const Memory *memory, unsigned int which, int *value)
{
    *value = memory->flag;
    return which == 0;
}

static void indicators_of(const Memory *memory, double *indicators)
{
    JOINT(wrench) wrench;
    wrench_of(memory, &wrench);
    indicators[0] = wrench.penetration;
}

