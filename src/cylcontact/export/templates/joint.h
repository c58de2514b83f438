$comment

#ifndef CYLCONTACT_${capitals}_H
#define CYLCONTACT_${capitals}_H

#ifdef __cplusplus
extern "C" {
#endif

$types

void ${name}_start(${name}_state *state);
void ${name}_evaluate(const ${name}_state *state, const double bearing[6], const double pin[6],
    ${name}_wrench *wrench);
void ${name}_accept(${name}_state *state, const double bearing[6], const double pin[6]);

#ifdef __cplusplus
}
#endif

#endif
