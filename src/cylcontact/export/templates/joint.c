// $name: what it is and how to call it stands in $stem.h.
//
// C99; link with -lm.

#include <math.h>

#include "$stem.h"

$functions
