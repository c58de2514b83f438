$comment
//
// C99; link with -lm.

#include <math.h>

// The declarations, for a header of your own.
void $name(
    $parameters,
    double *load, double *stiffness);
double ${name}_load(
    $parameters);
double ${name}_stiffness(
    $parameters);
$helpers

void $name(
    $parameters,
    double *load, double *stiffness)
{
    $body
}

double ${name}_load(
    $parameters)
{
    double load, stiffness;
    $name($arguments, &load, &stiffness);
    return load;
}

double ${name}_stiffness(
    $parameters)
{
    double load, stiffness;
    $name($arguments, &load, &stiffness);
    return stiffness;
}
