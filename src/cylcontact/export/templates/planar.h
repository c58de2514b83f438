
// Derivatives of force x, force y and moment of bearing and pin, row by row, by x, y and angle
// of bearing and pin, and by their rates, at a fixed impact rate.
typedef struct {
    double by_position[36];
    double by_velocity[36];
} ${name}_jacobian;

void ${name}_evaluate_jacobian(const ${name}_state *state, const double bearing[6],
    const double pin[6], ${name}_jacobian *jacobian);
// The derivative of every number of the wrench along a direction of both bodies; its flag is 0.
void ${name}_differentiate(const ${name}_state *state, const double bearing[6],
    const double pin[6], const double bearing_along[6], const double pin_along[6],
    ${name}_wrench *derivative);
// The energy that the contact stores.
double ${name}_elastic_energy(const double bearing[6], const double pin[6]);
