"""The loops of the how-to on exports: their restitution, by the order of joint and mass."""

import pytest

from cylcontact.export import export_joint
from cylcontact.mechanism import read_joint
from tests.support.doc_blocks import ROOT, blocks
from tests.support.export_runners import compile_with, run_program
from tests.support.programs import require_package, require_program

BLOCKS = blocks(ROOT / "docs/how-to/export.md")
(MAIN,) = (block.text for block in BLOCKS if block.title == "build/main.c")
(WITH_FMU,) = (block.text for block in BLOCKS if "FMU2Slave" in block.text)
# The two lines of the mass in each loop, by the order that a row of the page's tables names.
KICK, DRIFT = "pin[3] += dt * wrench.force_pin[0] / mass;", "pin[0] += dt * pin[3];"
EVALUATE = "wrist_pin_evaluate(&state, bearing, pin, &wrench);"
ACCEPT = "wrist_pin_accept(&state, bearing, pin);"
HALF = "pin[0] += dt * pin[3] + 0.5 * dt * dt * wrench.force_pin[0] / mass;"
IN_C = {
    "as above": ([EVALUATE, KICK, DRIFT, ACCEPT], 0.900, 0.900),
    "position first": ([DRIFT, ACCEPT, EVALUATE, KICK], 0.900, 0.900),
    "old velocity": ([EVALUATE, DRIFT, KICK, ACCEPT], 1.018, 0.928),
    "exact motion": ([EVALUATE, HALF, KICK, ACCEPT], 0.957, 0.914),
}
LINES = "    x += dt * v\n    v += dt * force / mass\n"
LATE = "    late, force = force, late\n"
WITH_FMPY = {
    "as above": (LINES, 0.900, 0.900),
    "velocity first": ("    v += dt * force / mass\n    x += dt * v\n", 0.796, 0.873),
    "exact motion": (f"    x += 0.5 * dt * dt * force / mass\n{LINES}", 0.846, 0.886),
    "late": (LATE + LINES, 1.020, 0.928),
}


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """A folder with the page's joint, exported."""
    folder = tmp_path_factory.mktemp("loops")
    (text,) = (block.text for block in BLOCKS if block.title == "build/joint.toml")
    (folder / "joint.toml").write_text(text, encoding="utf-8")
    require_program("gcc")
    joint = read_joint(folder / "joint.toml")
    for name, content in export_joint(joint, "c", "joint").items():
        (folder / name).write_text(content, encoding="ascii")
    compile_with("gcc", "-O2", "-c", folder / "joint.c", "-o", folder / "joint.o")
    for name, content in export_joint(joint, "fmu", "joint").items():
        (folder / name).write_bytes(content)
    return folder


@pytest.mark.parametrize("order", IN_C)
def test_the_loop_in_c(build, order):
    lines, *wanted = IN_C[order]
    before, middle, after = MAIN.partition(EVALUATE)
    assert middle
    text = before + " ".join(lines) + after.partition(ACCEPT)[2]
    for dt, restitution in zip((2e-6, 5e-7), wanted, strict=True):
        (build / "main.c").write_text(text.replace("dt = 2e-6", f"dt = {dt}"), encoding="ascii")
        compile_with("gcc", "-O2", build / "main.c", build / "joint.o", "-o", build / "run", "-lm")
        printed = float(run_program(build / "run").split()[-1])
        assert printed == pytest.approx(restitution, abs=1e-3)


@pytest.mark.parametrize("order", WITH_FMPY)
def test_the_loop_with_an_fmu(build, order):
    require_package("fmpy")
    lines, *wanted = WITH_FMPY[order]
    assert LINES in WITH_FMU
    text = WITH_FMU.replace(LINES, lines).replace("build/joint.fmu", str(build / "joint.fmu"))
    for dt, restitution in zip((2e-6, 5e-7), wanted, strict=True):
        names = {"late": 0.0}
        exec(text.replace("dt, t = 0.5, 0.4, 2e-6", f"dt, t = 0.5, 0.4, {dt}"), names)
        assert names["dt"] == dt
        assert -names["v"] / names["speed"] == pytest.approx(restitution, abs=1e-3)
