$comment
//
// To use it, include this file:
//
//   $name joint;                                         (without contact)
//   $name::wrench wrench = joint.evaluate(bearing, pin); (changes nothing)
//   joint.accept(bearing, pin);

#ifndef CYLCONTACT_${capitals}_HPP
#define CYLCONTACT_${capitals}_HPP

#include <math.h>

namespace cylcontact_$name {

$records

$functions

} // namespace cylcontact_$name

class $name {
public:
    typedef cylcontact_$name::${name}_wrench wrench;

    $if several
    $name() { start(); }

    // The impact rates; 0: not in contact.
    double *state() { return state_.impact_rate; }
    $else
    // The state; 0: not in contact.
    explicit $name(double impact_rate = 0.0) { state_.impact_rate = impact_rate; }

    double state() const { return state_.impact_rate; }
    $end

    void start() { ${name}_start(&state_); }

    wrench evaluate(const double bearing[$size], const double pin[$size]) const
    {
        wrench result;
        ${name}_evaluate(&state_, bearing, pin, &result);
        return result;
    }

    void accept(const double bearing[$size], const double pin[$size])
    {
        ${name}_accept(&state_, bearing, pin);
    }

private:
    cylcontact_$name::${name}_state state_;
};

#endif
