$comment
//
// C++11: load, stiffness, and both by evaluate, in the namespace of this name.

#ifndef ${guard}_HPP
#define ${guard}_HPP

#include <math.h>

namespace $name {
$helpers

inline void evaluate(
    $parameters,
    double *load, double *stiffness)
{
    $body
}

inline double load(
    $parameters)
{
    double f, k;
    evaluate($arguments, &f, &k);
    return f;
}

inline double stiffness(
    $parameters)
{
    double f, k;
    evaluate($arguments, &f, &k);
    return k;
}

} // namespace $name

#endif
