$about
// C99; link with -lm.

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#ifdef __cplusplus
extern "C" {
#endif
double ${name}_load($heads);
double ${name}_stiffness($heads);
#ifdef __cplusplus
}
#endif

$types

$numbers

$helpers

$program

// Return the load in N/mm; NaN outside the law's domain.
double ${name}_load($heads)
{
    $constants_of_load
    $declared
    double result_of_law;

    if (penetration < 0.0)
        return 0.0;
    if (!($domain))
        return (double)NAN;
    $numbers_at
    if (!($inside))
        return (double)NAN;
    result_of_law = $load;
    // At first touch a formula may have no value, as ln 0.
    return penetration > 0.0 || result_of_law >= 0.0 ? result_of_law : 0.0;
}

// Return the stiffness in N/mm^2; NaN outside the law's domain.
double ${name}_stiffness($heads)
{
    $constants_of_stiffness
    $declared
    double result_of_law;

    if (penetration < 0.0)
        return 0.0;
    if (!($domain))
        return (double)NAN;
    $numbers_at
    if (!($inside))
        return (double)NAN;
    result_of_law = $stiffness;
    // At first touch a formula may have no value, as ln 0.
    return penetration > 0.0 || result_of_law >= 0.0 ? result_of_law : 0.0;
}
