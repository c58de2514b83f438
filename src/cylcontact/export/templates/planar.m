
% At a fixed impact rate: the derivatives of [force_x force_y moment] of bearing and pin by
% [x y angle] of bearing and pin, 6 x 6, and by their rates; the derivative of the wrench along
% a direction of both bodies. And the energy that the contact stores.
joint.evaluate_jacobian = @(impact_rate, bearing, pin) blocks(evaluate_jacobian( ...
    state_of(impact_rate), bearing, pin, $jacobian, numbers, law));
joint.differentiate = @(impact_rate, bearing, pin, bearing_along, pin_along) differentiate( ...
    state_of(impact_rate), bearing, pin, bearing_along, pin_along, no_wrench(), numbers, law);
joint.elastic_energy = @(bearing, pin) elastic_energy(bearing, pin, numbers, law);
