$comment

#ifndef CYLCONTACT_${capitals}_HPP
#define CYLCONTACT_${capitals}_HPP

#include <math.h>

namespace cylcontact_$name {

$types

$functions

} // namespace cylcontact_$name

class $name {
public:
    typedef cylcontact_$name::${name}_wrench wrench;

    // The state; 0: not in contact.
    explicit $name(double impact_rate = 0.0) { state_.impact_rate = impact_rate; }

    void start() { ${name}_start(&state_); }

    double state() const { return state_.impact_rate; }

    wrench evaluate(const double bearing[6], const double pin[6]) const
    {
        wrench result;
        ${name}_evaluate(&state_, bearing, pin, &result);
        return result;
    }

    void accept(const double bearing[6], const double pin[6])
    {
        ${name}_accept(&state_, bearing, pin);
    }

private:
    cylcontact_$name::${name}_state state_;
};

#endif
