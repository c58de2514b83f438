$about
// C99; link with -lm.

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#ifdef __cplusplus
extern "C" {
#endif
$heads
#ifdef __cplusplus
}
#endif

$types

$constants

$helpers

$program
