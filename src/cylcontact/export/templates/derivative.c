
EXPORT Status NAME(fmi2GetDirectionalDerivative)(Instance *c, References unknown, size_t unknowns,
                                                 References known, size_t knowns,
                                                 const double seed[], double result[])
{
    const Memory *const memory = &c->memory;
    double bodies[INPUTS], along[INPUTS] = {0.0};
    ${name}_wrench slope;
    size_t k;
    for (k = 0; k < knowns; k++) {
        if (known[k] >= INPUTS)
            return refuse(c, "derivatives are by the inputs");
        along[known[k]] += seed[k];
    }
    for (k = 0; k < unknowns; k++)
        if (unknown[k] < INPUTS || unknown[k] >= INPUTS + OUTPUTS)
            return refuse(c, "derivatives are those of the outputs");
    wrench_of(memory, bodies);
    /* A velocity moves its position on as well. */
    ahead(along, memory->ahead[0]);
    ahead(along + SIZE, memory->ahead[1]);
    differentiate(&memory->contact, bodies, bodies + SIZE, along, along + SIZE, &slope,
                  &memory->joint, &memory->law);
    for (k = 0; k < unknowns; k++)
        result[k] = ((const double *)&slope)[unknown[k] - INPUTS];
    return fmi2OK;
}
