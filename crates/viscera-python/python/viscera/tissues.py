"""Tissues as they were measured, each number with its source: starting points, not properties of your patient."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ._viscera import Lame, Law, NeoHookean, TransverseStVenantKirchhoff, tissue_presets


@dataclass(frozen=True)
class Measured:
    """A number from the literature, in SI."""

    #: What a preset takes.
    value: float
    #: The least and the largest that the sources report.
    range: tuple[float, float]
    #: Publication, and what was measured in it.
    source: str
    #: Whose tissue it was.
    species: str
    #: In what state it was, and how it was measured.
    state: str
    #: How the value came here: "read" in the source, "cited" as others cite it, or "chosen".
    evidence: str
    #: Why the number is weak, where it is.
    weakness: str | None


@dataclass(frozen=True)
class Preset:
    """A tissue: small-strain stiffness and density, and where they come from. As the engine and scenes have it."""

    name: str
    #: What it is, for people.
    title: str
    #: Name of the law that fits it without fibres.
    kind: str
    #: Every number with its range, source, species, state and weakness: "young", "poisson", "density", "along".
    measured: dict[str, Measured]
    #: Where fibres run, where the tissue has some.
    course: str | None
    #: λ and μ [Pa] of the matrix between the fibres, and how many times larger they are along them.
    fibred: tuple[float, float, float] | None

    @property
    def young(self) -> float:
        """Young's modulus of small strains [Pa]; across the fibres, where there are some."""
        return self.measured["young"].value

    @property
    def along(self) -> float | None:
        """Young's modulus along the fibres [Pa], where there are some."""
        return self.measured["along"].value if "along" in self.measured else None

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""
        return self.measured["poisson"].value

    @property
    def density(self) -> float:
        """Density [kg/m³]."""
        return self.measured["density"].value

    @property
    def source(self) -> str:
        """Where Young's modulus comes from."""
        return self.measured["young"].source

    def law(self, kind: Callable[[Lame], Law] = NeoHookean) -> Law:
        """A law of λ and μ of this stiffness, neo-Hookean unless another class is given; without fibres."""
        return kind(Lame.from_young_poisson(young=self.young, poisson=self.poisson))

    def law_along(self, direction: Sequence[float]) -> Law:
        """St Venant–Kirchhoff tissue with its fibres along `direction`; ValueError where it has none."""
        if self.fibred is None:
            raise ValueError(f"{self.name} has no fibres: take law() for it")
        lambda_, mu, factor = self.fibred
        return TransverseStVenantKirchhoff(Lame(lambda_, mu), direction, Lame(factor * lambda_, factor * mu))


def _preset(entry: dict) -> Preset:
    def measured(number: dict) -> Measured:
        return Measured(**{**number, "range": tuple(number["range"])})

    numbers = {key: measured(entry[key]) for key in ("young", "poisson", "density")}
    fibre = entry["fibre"]
    if fibre is not None:
        numbers["along"] = measured(fibre["young"])
    course = None if fibre is None else fibre["course"]
    fibred = None if entry["fibred"] is None else tuple(entry["fibred"])
    return Preset(entry["name"], entry["title"], entry["law"], numbers, course, fibred)


#: Every tissue by name, as scenes have them.
TISSUES = {preset.name: preset for preset in map(_preset, json.loads(tissue_presets()))}
