$comment
//
$if guard
// C++11: load, stiffness, and evaluate for both, in a namespace.

#ifndef ${guard}_HPP
#define ${guard}_HPP
$else
// C99; link with -lm.
$end

#include <math.h>

$if guard
namespace $name {
$else
// The declarations, for a header of your own.
void $both(
    $parameters,
    double *load, double *stiffness);
double ${prefix}load(
    $parameters);
double ${prefix}stiffness(
    $parameters);
$end
$helpers

${inline}void $both(
    $parameters,
    double *load, double *stiffness)
{
    $constants
    $variables

    *load = penetration < 0.0 ? 0.0 : (double)NAN;
    *stiffness = *load;
    if (!($domain)) {
        return;
    }
    $at_pair
    $if ends
    if (!($ends)) {
        return;
    }
    $end
    $at_depth
    *load = penetration > 0.0 || f >= 0.0 ? f : 0.0;
    *stiffness = penetration > 0.0 || k >= 0.0 ? k : 0.0;
}

${inline}double ${prefix}load(
    $parameters)
{
    double f, k;
    $both($arguments, &f, &k);
    return f;
}

${inline}double ${prefix}stiffness(
    $parameters)
{
    double f, k;
    $both($arguments, &f, &k);
    return k;
}
$if guard

} // namespace $name

#endif
$end
