"""Moduli of tissue as they were measured, each with its source: starting points, not properties of your patient."""

from __future__ import annotations

from dataclasses import dataclass

from ._viscera import Lame, Law, NeoHookean


@dataclass(frozen=True)
class Preset:
    """A tissue: small-strain stiffness and density, and where they come from."""

    name: str
    #: Young's modulus [Pa].
    young: float
    #: Poisson's ratio; soft tissue is nearly incompressible, and 0.49 is what elements bear that do not lock.
    poisson: float
    #: Density [kg/m³].
    density: float
    #: Publication, and what was measured in it.
    source: str

    def law(self, kind: type[Law] = NeoHookean) -> Law:
        """A law of λ and μ of this stiffness, neo-Hookean unless another class is given."""
        return kind(Lame.from_young_poisson(young=self.young, poisson=self.poisson))


TISSUES = {
    preset.name: preset
    for preset in (
        Preset(
            "liver", 6.27e3, 0.49, 1060.0,
            "Journal of Magnetic Resonance Imaging 39 (2014) 1: 41 healthy volunteers, shear stiffness 2.09 ± 0.22 kPa by magnetic "
            "resonance elastography in vivo; E = 3 μ",
        ),
        Preset(
            "breast-fat", 5.55e3, 0.49, 950.0,
            "Karakaş, Poçan, Medical Science Monitor 32 (2026) e952112: shear stiffness 1.85 ± 0.32 kPa by magnetic resonance "
            "elastography in vivo; E = 3 μ",
        ),
        Preset(
            "breast-gland", 8.85e3, 0.49, 1040.0,
            "Karakaş, Poçan, Medical Science Monitor 32 (2026) e952112: shear stiffness 2.95 ± 0.43 kPa by magnetic resonance "
            "elastography in vivo; E = 3 μ",
        ),
        Preset(
            "truth-cube", 14.9e3, 0.499, 1000.0,
            "Kerdok et al., Medical Image Analysis 7 (2003) 283: silicone rubber of the truth cube, E = 14.9 kPa, ν = 0.499",
        ),
    )
}
