"""Objectives for measurements: the deviation of a law from them.

| objective | residual | for |
|---|---|---|
| rms-log-penetration | ln(δ_law(f)/δ) | noise proportional to δ |
| rms-log-load | ln(f_law(δ)/f) | noise proportional to f |
| rms-penetration | (δ_law(f) − δ)/σ, σ = 1 mm by default | constant noise, or σ |
| rms-load | (f_law(δ) − f)/σ, σ = 1 N/mm by default | constant noise, or σ |
| rms-standardised | V^(−½)·(δ_law(f) − δ), in standard deviations | a noise model (`noise_model`) |

Weights multiply the squares, scaled to a mean of 1. The last objective is that of a campaign with
a noise model, which its keys noise, group, drift and load_error choose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Measurements
from cylcontact.errors import InputError
from cylcontact.fitting.loss import Loss
from cylcontact.fitting.noise_model import FittedNoise
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.samples import Form, LawForm, law_form_of
from cylcontact.laws.law import ContactLaw, LawModel

__all__ = ["STANDARDISED", "MeasuredObjective", "laws_of", "measured", "objective_name"]

_LEAST_SQUARES = Loss()
_OBJECTIVES = ("rms-log-penetration", "rms-log-load", "rms-penetration", "rms-load")
STANDARDISED = "rms-standardised"


@dataclass(frozen=True, eq=False)
class MeasuredObjective:
    """The root mean square of the residuals of measurements, or of a robust loss of them.

    Attributes
    ----------
    data : Measurements
        N rows.
    name : str
        One of `_OBJECTIVES`.
    loss : Loss
        Plain least squares by default.
    noise : FittedNoise, optional
        For `STANDARDISED`; without one the residuals are in mm.
    """

    data: Measurements
    name: str
    loss: Loss = _LEAST_SQUARES
    noise: FittedNoise | None = None

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (N,)."""
        return self.data.columns["dR"]

    @property
    def of_load(self) -> bool:
        """Whether loads are compared at equal penetration."""
        return self.name.endswith("load")

    @property
    def is_log(self) -> bool:
        """Whether residuals are logarithms of a ratio."""
        return "log" in self.name

    @property
    def has_sigma(self) -> bool:
        """Whether the standard deviation of the noise is known."""
        if self.name == STANDARDISED:
            return self.noise is not None and self.noise.is_given
        return not self.is_log and self._sigma_name in self.data.columns

    @property
    def sigma(self) -> FloatArray:
        """The standard deviations in mm or N/mm, shape (N,); 1 if they are not known."""
        return self.data.columns.get(self._sigma_name, np.ones(len(self.data)))

    @property
    def bound(self) -> float:
        """No objective is below 0."""
        return 0.0

    def form(self, model: LawModel, candidates: FloatArray) -> Form:
        """Return the laws of P candidates."""
        return law_form_of(model, candidates)

    def values(self, form: Form) -> FloatArray:
        """Return the objective of P candidates, shape (P,); inf if undefined."""
        with np.errstate(over="ignore", invalid="ignore"):
            values = np.sqrt((self.residuals(form) ** 2).sum(axis=1))
        return np.where(np.isfinite(values), values, np.inf)

    def residuals(self, form: Form) -> FloatArray:
        """Return residuals whose squares add up to the objective's, shape (P, N)."""
        return as_floats(self.loss.residual(self.raw(form)) / np.sqrt(len(self.data)))

    def raw(self, form: Form) -> FloatArray:
        """Return the residuals with weights and σ, before the loss, shape (P, N)."""
        return np.array([self._of_law(law) for law in laws_of(form)])

    @property
    def observed(self) -> FloatArray:
        """The measured loads in N/mm or penetrations in mm, shape (N,)."""
        return self.data.load if self.of_load else self.data.penetration

    def differences(self, form: Form) -> FloatArray:
        """Return the predicted less the measured values in mm or N/mm, shape (P, N)."""
        predicted = np.array([self._predicted(law) for law in laws_of(form)])
        return as_floats(predicted - self.observed)

    def _of_law(self, law: ContactLaw | None) -> FloatArray:
        """Return the residuals of one law, shape (N,); NaN outside its domain."""
        predicted, observed = self._predicted(law), self.observed
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            difference = np.log(predicted / observed) if self.is_log else predicted - observed
            if self.noise is not None:
                return self.noise.whitening(as_floats(difference))
            return as_floats(difference * self._scale)

    def _predicted(self, law: ContactLaw | None) -> FloatArray:
        """Return what one law predicts, shape (N,); NaN outside its domain."""
        data = self.data
        if law is None:
            return np.full(len(data), np.nan)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            if self.of_load:
                return law.load(data.penetration, data.pair)
            return law.penetration(data.load, data.pair)

    @property
    def _scale(self) -> FloatArray:
        """The factor on the differences."""
        root = np.sqrt(self.data.weight)
        return as_floats(root if self.is_log else root / self.sigma)

    @property
    def _sigma_name(self) -> str:
        return "load_std" if self.of_load else "penetration_std"


def measured(problem: Problem) -> MeasuredObjective:
    """Return the objective of a problem on measurements."""
    if not isinstance(problem.objective, MeasuredObjective):
        raise TypeError("noise is that of measurements")
    return problem.objective


def laws_of(form: Form) -> tuple[ContactLaw | None, ...]:
    """Return the laws of candidates, which have to be a `LawForm`."""
    if not isinstance(form, LawForm):
        raise TypeError("measurements need laws")
    return form.laws


def objective_name(
    given: str | None, noise: str | None, data: Measurements, prefers_load: bool, source: str
) -> str:
    """Return the objective of a campaign without a noise model, or the default for its data.

    Parameters
    ----------
    given : str or None
        The one in the campaign.
    noise : {"constant", "proportional"} or None
        How the scatter grows, in place of an objective.
    data : Measurements
        The data.
    prefers_load : bool
        Whether the law is explicit in the load and its inverse is numerical.
    source : str
        The campaign's name in errors.

    Returns
    -------
    str
        One of `_OBJECTIVES`.

    Raises
    ------
    InputError
        If it is unknown, or not that of the standard deviations in the data.
    """
    sigmas = [q for q in ("load", "penetration") if f"{q}_std" in data.columns]
    if sigmas and "weight" in data.columns:
        raise InputError(
            source,
            "weight",
            None,
            f"conflicts with {sigmas[0]}_std, which implies the weights",
            "keep one of them",
        )
    if noise is not None:
        for key, value in (("objective", given), (f"{sigmas[0]}_std" if sigmas else "", sigmas)):
            if value:
                rule = f"conflicts with {key}, which says the same"
                raise InputError(source, "noise", noise, rule, "keep one of them")
        return "rms-penetration" if noise == "constant" else "rms-log-penetration"
    if given is None:
        quantity = "load" if prefers_load else "penetration"
        if (data.penetration <= 0).any() and not sigmas:
            return "rms-penetration"
        return f"rms-{sigmas[0]}" if sigmas else f"rms-log-{quantity}"
    if given not in _OBJECTIVES:
        raise InputError(
            source,
            "objective",
            given,
            "is not an objective for measurements",
            f"choose {', '.join(_OBJECTIVES)}",
        )
    if sigmas and given != f"rms-{sigmas[0]}":
        raise InputError(
            source,
            "objective",
            given,
            f"leaves the column {sigmas[0]}_std unused",
            f"choose rms-{sigmas[0]}, or list the column under ignore",
        )
    return given
