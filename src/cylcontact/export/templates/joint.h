$comment
//
// To use it, include this file, in C or C++, and link with -lm:
//
//   ${name}_state state;
//   ${name}_wrench wrench;
//   ${name}_start(&state);
//   ${name}_evaluate(&state, bearing, pin, &wrench$more);   (state is not changed)
//   ${name}_accept(&state, bearing, pin);

#ifndef CYLCONTACT_${capitals}_H
#define CYLCONTACT_${capitals}_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    $state; // 0: not in contact
} ${name}_state;

typedef struct {
    $wrench
} ${name}_wrench;

$records

void ${name}_start(${name}_state *state);
$heads

#ifdef __cplusplus
}
#endif

#endif
