$comment
//
// To use it, include this file and link with -lm:
//
//   ${name}_state state;
//   ${name}_wrench wrench;
//   ${name}_start(&state);
//   ${name}_evaluate(&state, bearing, pin, &wrench);   (state is not changed)
//   ${name}_accept(&state, bearing, pin);

#ifndef CYLCONTACT_${capitals}_H
#define CYLCONTACT_${capitals}_H

#ifdef __cplusplus
extern "C" {
#endif

$records

void ${name}_start(${name}_state *state);
void ${name}_evaluate(const ${name}_state *state, const double bearing[$size],
    const double pin[$size], ${name}_wrench *wrench);
void ${name}_accept(${name}_state *state, const double bearing[$size], const double pin[$size]);

#ifdef __cplusplus
}
#endif

#endif
