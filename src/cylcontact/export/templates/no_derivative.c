
REFUSED(fmi2GetDirectionalDerivative, "a joint in space has no directional derivatives",
        References unknown, size_t unknowns, References known, size_t knowns, const double seed[],
        double result[])
