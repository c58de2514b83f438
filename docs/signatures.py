"""griffe: show signatures and defaults as Python sees them."""

import inspect
import re
from importlib import import_module

import griffe

# The values of a parameter, as numpydoc writes them.
_CHOICES = re.compile(r"^( *\w+(?:, \w+)* : .*?)\{(.+?)\}", re.MULTILINE)


class Signatures(griffe.Extension):
    """Give each dataclass the parameters and defaults that Python sees.

    griffe takes the first of `{"a", "b"}` for the default of a parameter; `"a" or "b"` it shows as
    it is.
    """

    def on_object(self, *, obj, **_):
        """Write choices with "or" in place of braces."""
        if obj.docstring:
            obj.docstring.value = _CHOICES.sub(_with_or, obj.docstring.value)

    def on_package(self, *, pkg, **_):
        """Look at every class of the package once all is loaded."""
        for module in modules_in(pkg):
            for each in list(module.classes.values()):
                if not each.is_alias and any("dataclass" in str(d.value) for d in each.decorators):
                    set_signature(each)


def _with_or(found):
    """Return a parameter and its choices with "or" between them."""
    return found[1] + found[2].replace(", ", " or ")


def modules_in(package):
    """Yield the package and all modules in it."""
    yield package
    for module in package.modules.values():
        if not module.is_alias:
            yield from modules_in(module)


def set_signature(documented):
    """Replace the signature that griffe derives from the fields (`...`: a default without repr)."""
    if "__init__" in documented.members:
        return
    initialise = getattr(import_module(documented.module.path), documented.name).__init__
    parameters = griffe.Parameters()
    for each in inspect.signature(initialise).parameters.values():
        kind = griffe.ParameterKind[each.kind.name.lower()]
        default = None if each.default is inspect.Parameter.empty else repr(each.default)
        if default and "<" in default:
            default = "..."
        parameters.add(griffe.Parameter(each.name, kind=kind, default=default))
    documented.set_member("__init__", griffe.Function("__init__", parameters=parameters))
