"""The campaign file for measurements."""

from __future__ import annotations

from pydantic import Field, model_validator

from cylcontact.fitting.campaign import TIES, GeneticSpec, ParameterSpec
from cylcontact.fitting.loss import LOSSES
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.pair import Contact
from cylcontact.spec import Spec, broken

__all__ = ["MeasuredSpec"]


class MeasuredSpec(Spec):
    """A campaign file that names a table of measurements."""

    data: str = Field(description="the path of a .csv or .parquet table, beside or above the file")
    contact: Contact = Field(description='"internal" or "external"')
    law: str = Field(description="the law to fit, or module:function for one of your own")
    objective: str | None = Field(None, description="an objective for measurements")
    loss: str = Field("linear", description=f"one of {', '.join(LOSSES)}")
    loss_scale: float | None = Field(
        None, gt=0, description="the residual beyond which a point counts less, a positive number"
    )
    seed: int = Field(20150101, ge=0, description="the seed, an integer of at least 0")
    starts: int = Field(12, ge=1, le=1000, description="the starts, an integer from 1 to 1000")
    constants: dict[str, float | str] = Field(
        {}, description="a table [constants] of values for all rows, e.g. dR_um = 50"
    )
    materials: str | None = Field(None, description="the path of a table of materials")
    ignore: tuple[str, ...] = Field((), strict=False, description="a list of columns to leave out")
    parameters: dict[str, ParameterSpec] = Field(
        {},
        description="tables [parameters.NAME] for parameters with other bounds, or fixed ones",
    )
    ties: dict[str, str] | None = Field(None, description=TIES)
    optimizer: str | None = Field(
        None, description=f"a search instead of several starts, one of {', '.join(OPTIMIZERS)}"
    )
    genetic: GeneticSpec = Field(
        GeneticSpec(), description="a table [genetic], the budget of an optimizer"
    )

    @model_validator(mode="after")
    def _check(self) -> MeasuredSpec:
        if self.loss not in LOSSES:
            raise broken("loss", self.loss, "is not a known loss", f"choose {', '.join(LOSSES)}")
        if self.optimizer not in (None, *OPTIMIZERS):
            raise broken(
                "optimizer",
                self.optimizer,
                "is not a known optimiser",
                f"choose {', '.join(OPTIMIZERS)}, or leave it out",
            )
        if self.loss == "linear" and self.loss_scale is not None:
            raise broken(
                "loss_scale",
                self.loss_scale,
                "is used only with a robust loss",
                "leave it out, or choose loss = soft_l1, huber or cauchy",
            )
        return self
