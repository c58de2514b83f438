"""What the export of laws, joints and parameters refuses: one line each, and no file."""

from functools import partial
from pathlib import Path

import pytest

from cylcontact import InputError, laws
from cylcontact.export import contact_parameters, export, export_joint
from cylcontact.files.spec import read_toml
from cylcontact.mechanism import joint_from
from tests.support.spatial_cases import joint_for
from tests.support.spec_files import changed

ROOT = Path(__file__).parents[2]
OWN_LAWS = ROOT / "tests/support"
INTERNAL = ROOT / "fitting/results/internal.json"
DATA = read_toml(ROOT / "datasets/joint.toml")
JOINT = ("--joint", ROOT / "datasets/joint.toml")
RADII = ("--pin", "207 GPa, 0.3", "--hole", "70 GPa, 0.33", "--Ri", 10, "--Rj", 9.95)
REFUSED = [
    (("hertz", "--to", "c"), "neither a law that can be exported nor a fit result"),
    (("johnson", "--to", "rust"), "'rust': is not a known target"),
    (("explicit", "--to", "c"), "--contact: is missing, and the explicit law has other coef"),
    ((INTERNAL, "--contact", "external", "--to", "c"), "contradicts --contact external"),
    (("liu", "--contact", "external", "--to", "c"), "the law 'liu' is for a pin in a hole"),
    (("conformal", "--to", "c"), "on the radius in a housing; give them, e.g. --material"),
    (("conformal", "--contact", "external", "--to", "c"), "is for a pin in a hole"),
    (("johnson", *RADII, "--R-o", 20, "--to", "c"), "takes no housing; choose conformal"),
    (("johnson", "--Ri", 10, "--to", "c"), "--Ri = 10.0: is for conformal contact or a joint"),
    (("conformal", *RADII, "--R-o", 9, "--to", "c"), "R_o = 9.0: must be larger than the hole"),
    (("own_laws:untranslatable", "--to", "c"), "`np.tanh(penetration)`: cannot be written in"),
    (("own_laws:double", "--to", "c"), "`double`: cannot be written in another language: it is"),
    (("own_laws:cased", "--to", "c"), "`K, k`: cannot be written in another language"),
    (("own_laws:awkward", "--to", "c"), "`γ`: cannot be written in another language"),
    # Joints.
    ((*JOINT, "--to", "c"), "export: --out: is missing for a joint; name the file, e.g. -o wri"),
    ((*JOINT, "--to", "c", "-o", "x.f90"), "x.f90: is not a .c; name the output so that it is"),
    ((*JOINT, "--to", "json", "-o", "x.json"), "--to = 'json': is not a known target; choose c,"),
    ((*JOINT, "--to", "matlab", "-o", "2pins.m"), "'2pins': cannot be called by its name"),
    ((*JOINT, "--to", "c", "-o", "pün.c"), "--out = 'pün': is not plain text; name the file"),
    (("explicit", *JOINT, "--to", "c"), "RESULT|LAW = 'explicit': is in the file of the joint al"),
    # Parameters.
    ((*JOINT, "--to", "adams"), "--range: is missing for adams; give total forces in N"),
    ((*JOINT, "--to", "adams", "--range", "9:1"), "'9:1' must be two positive numbers, the "),
    ((*JOINT, "--to", "drake", "--range", "0:1"), "'0:1' must be two positive numbers"),
    ((*JOINT, "--to", "drake", "--range", "1:inf"), "'1:inf' must be two positive numbers"),
    ((*JOINT, "--to", "mujoco", "--range", "1:9", "--mass", "0"), "--mass = 0.0: must be posit"),
    (("liu", *JOINT, "--to", "adams", "--range", "1:9"), "RESULT|LAW = 'liu': is in the file of"),
    ((*JOINT, "--to", "adams", "--range", "1:9", "--Ri", 9), "--Ri = 9.0: is in the file of the"),
    ((*JOINT, "--to", "c", "--range", "1:9"), "is for a code's own contact; leave it out"),
]  # fmt: skip


@pytest.mark.parametrize(("arguments", "message"), REFUSED)
def test_the_command_refuses_in_one_line(run, monkeypatch, tmp_path, arguments, message):
    monkeypatch.chdir(OWN_LAWS if "own_laws" in str(arguments[0]) else tmp_path)
    code, said, errors = run("export", *arguments)
    assert (code, said, errors.count("\n")) == (2, "", 1)
    assert message in errors
    assert not list(tmp_path.iterdir())


def joint(**changes):
    return joint_from(changed(DATA, changes))


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (partial(export, laws.Conformal(laws.Housing(20.0)), None, "c"), "give those of the fit"),
        (partial(export, laws.Johnson(datum=5.0), None, "c"), "is for a plane, which has no dR"),
        (lambda: export_joint(joint(name="Arms_of"), "fortran"), "'Arms_of': is taken by somethi"),
        (lambda: export_joint(joint(name="evaluate"), "matlab"), "'evaluate': is taken by somethi"),
        *((partial(export_joint, joint_for(name=name), "fortran"), f"'{name}': is taken by somet")
          for name in ("press", "Move", "law")),
        (lambda: contact_parameters(joint(law="johnson"), "adams", 100, 1e6),
         "goes beyond the law 'johnson', which ends at"),
        (lambda: contact_parameters(joint(), "adams", 9, 1), "is no range of force"),
    ],
)  # fmt: skip
def test_the_functions_refuse_too(ask, message):
    with pytest.raises(InputError) as caught:
        ask()
    assert message in str(caught.value)
