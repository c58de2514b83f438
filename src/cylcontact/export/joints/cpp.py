"""The C++ target: C++11, one header with a class."""

from __future__ import annotations

from cylcontact.export.joints.c import body_parts
from cylcontact.export.joints.element import Element
from cylcontact.export.render import filled
from cylcontact.mechanism.joint import ClearanceJoint

_USAGE = """\
#include "$stem.hpp":

  $name joint;                                         (without contact)
  $name::wrench wrench = joint.evaluate(bearing, pin); (changes nothing)
  joint.accept(bearing, pin);"""

_FRAME = """\
$comment

#ifndef CYLCONTACT_${capitals}_HPP
#define CYLCONTACT_${capitals}_HPP

#include <math.h>

class $name {
public:
    struct wrench {
        double force_bearing[2], moment_bearing;
        double force_pin[2], moment_pin;
        double penetration, penetration_rate;
        double normal_force, friction_force, tangential_velocity;
        double dissipated_power;
        int flag;
    };

    // The state; 0: not in contact.
    explicit $name(double impact_rate = 0.0) : impact_rate_(impact_rate) {}

    void start() { impact_rate_ = 0.0; }

    double state() const { return impact_rate_; }

    wrench evaluate(const double bearing[6], const double pin[6]) const
    {
        const double impact_rate = impact_rate_;
        $evaluate_constants
        $evaluate
        wrench result;
        $results
        return result;
    }

    void accept(const double bearing[6], const double pin[6])
    {
        const double impact_rate = impact_rate_;
        $accept_constants
        $accept
        impact_rate_ = next_rate;
    }

private:
    // The law: N/mm at a penetration in mm.
    static double law(double penetration)
    {
        $table
        if (penetration <= 0.0) {
            return 0.0;
        }
        $lookup
        $law_constants
        $law
        return f;
    }

    double impact_rate_;
};

#endif
"""


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, str]:
    """Return the text of the header, by file name."""
    element, stem = Element(joint), stem or joint.identifier
    names = {"name": joint.identifier, "stem": stem, "capitals": joint.identifier.upper()}
    comment = element.comment(filled(_USAGE, names), "//")
    parts = {**names, "comment": comment, **body_parts(element, "result.", "law")}
    return {f"{stem}.hpp": filled(_FRAME, parts)}
