"""Claims of some files of the bench, computed without the others, which may take long."""

from _cylcontact_bench.claims import (
    errata,
    section1,
    section2,
    section31,
    section33,
    section34,
    section34_differences,
)

from cylcontact.reports.claims import ClaimFunction

# Some that need neither a fit nor a mechanism.
STATICS = (section1, section2, errata, section31, section33, section34, section34_differences)


def claims_of(bench, *modules):
    """Return the claims of some files, by id."""
    functions = [
        value
        for module in modules
        for value in vars(module).values()
        if isinstance(value, ClaimFunction) and value.function.__module__ == module.__name__
    ]
    return {claim.id: claim for function in functions for claim in function(bench)}
