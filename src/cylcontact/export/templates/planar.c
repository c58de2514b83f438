
void ${name}_evaluate_jacobian(const ${name}_state *state, const double bearing[6],
    const double pin[6], ${name}_jacobian *jacobian)
{
    evaluate_jacobian(state, bearing, pin, jacobian, &this_joint, &this_law);
}

void ${name}_differentiate(const ${name}_state *state, const double bearing[6],
    const double pin[6], const double bearing_along[6], const double pin_along[6],
    ${name}_wrench *derivative)
{
    differentiate(state, bearing, pin, bearing_along, pin_along, derivative, &this_joint,
        &this_law);
}

double ${name}_elastic_energy(const double bearing[6], const double pin[6])
{
    return elastic_energy(bearing, pin, &this_joint, &this_law);
}
