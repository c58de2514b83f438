"""The paper's coefficients come back: once more with numpy and scipy alone, sample by sample."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from cylcontact.fitting import read_result

pytestmark = pytest.mark.slow


ROOT = Path(__file__).resolve().parents[2]
SPACED = {"linear": np.linspace, "log": np.geomspace}
PUBLISHED = {"internal": (0.965, 1.51), "external": (0.39, 0.85)}
SEARCHED = {"internal": ("a", "Y_log_scale"), "external": ("a", "b")}


def samples(contact, points=20, spacing=None, E_end=None):
    """Return E* in MPa, ΔR in mm, load in N/mm and Johnson's penetration at every sample."""
    E_end = E_end or {"internal": 1000e3, "external": 10000e3}[contact]
    dR_ends = {"internal": (0.05, 10.0), "external": (5.0, 500.0)}[contact]
    spacing = (
        spacing or {"internal": "linear log linear", "external": "linear linear linear"}[contact]
    )
    ends = ((20.7e3, E_end), dR_ends, (10.0, 1000.0))
    axes = [SPACED[how](*end, points) for how, end in zip(spacing.split(), ends, strict=True)]
    ratios = np.linspace(0.1, 0.5, 5)
    E, dR, f, nu = (axis.ravel() for axis in np.meshgrid(*axes, ratios, indexing="ij"))
    E_star = E / (2 * (1 - nu**2))
    inside = f <= 4 * np.pi / np.e**2 * E_star * dR
    E_star, dR, f = E_star[inside], dR[inside], f[inside]
    return E_star, dR, f, f / (np.pi * E_star) * (np.log(4 * np.pi * E_star * dR / f) - 1)


def residuals(contact, x, sampled):
    """Return ln(δ/δ_Johnson) of the numbers searched; a third one for external contact is n."""
    E_star, dR, f, johnson = sampled
    if contact == "internal":
        a, b = x[0], x[0] / 10
        logarithmic = x[1] * np.log(1000 * dR) ** (-x[1] / 10)
        Y = np.where(dR < 0.34954, logarithmic, x[1] / 100 * dR + 1 + x[1] / 10)
        n = Y * dR**-0.005
    else:
        a, b, n = (*x, 1.094)[:3]
    return np.log((f * dR / ((a * dR + b) * E_star)) ** (1 / n) / johnson)


def searched_again(contact, start, sampled):
    """Return the coefficients at the least sum of squares, by scipy from a start."""
    solution = least_squares(
        lambda x: residuals(contact, x, sampled), start, xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    return solution.x


@pytest.mark.parametrize(
    ("contact", "rms"), [("internal", (0.1169, 0.1180)), ("external", (0.0507, 0.0509))]
)
def test_the_published_coefficients_come_back(contact, rms):
    result = read_result(ROOT / f"fitting/results/recovered-{contact}.json")
    actual = [result.coefficients[name] for name in SEARCHED[contact]]
    assert actual == pytest.approx(PUBLISHED[contact], rel=0.006)
    sampled = samples(contact)

    def rms_of(x):
        return np.sqrt(np.mean(residuals(contact, x, sampled) ** 2))

    assert rms_of(actual) == pytest.approx(result.objective.value, rel=1e-10)
    assert rms_of(PUBLISHED[contact]) == pytest.approx(result.published.objective, rel=1e-10)
    assert result.objective.value == pytest.approx(rms[0], abs=5e-5)
    assert result.published.objective == pytest.approx(rms[1], abs=5e-5)
    again = searched_again(contact, PUBLISHED[contact], sampled)
    assert rms_of(again) >= result.objective.value * (1 - 1e-9)
    assert again == pytest.approx(actual, rel=1e-5)
