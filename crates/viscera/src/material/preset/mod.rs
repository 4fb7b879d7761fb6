//! Tissues as they were measured: starting points, not properties of a patient.
//!
//! A preset is a law, its numbers and a density, each number with the publication, the tissue and the state that it was
//! measured in. Most published moduli of one organ differ by a factor of three and more, with the species, the hours after
//! death, the rate and the strain: the range says how far they lie apart, and `weakness` says where little is known.

mod fibrous;
mod solid;

use serde::{Serialize, Serializer};

use super::{Fibre, Lame, LawFamily, LawKind, LawVisitor, MaterialError, Tissue};

/// How a number came here from its source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Evidence {
    /// The number stands in the abstract, a table or the text of the source, and was read there.
    Read,
    /// The number is as others cite it: the source itself was not consulted.
    Cited,
    /// The number was chosen, for the reason that is given.
    Chosen,
}

impl Evidence {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Read => "read in the source",
            Self::Cited => "as commonly cited; the source itself was not consulted",
            Self::Chosen => "chosen, for the reason given",
        }
    }
}

/// A number from the literature, in SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// What a preset takes.
    pub value: f64,
    /// The least and the largest that the sources report.
    pub range: (f64, f64),
    /// Authors, journal, volume, year, page; several where the range comes from several.
    pub source: &'static str,
    /// Whose tissue it was.
    pub species: &'static str,
    /// In what state it was, and how it was measured.
    pub state: &'static str,
    /// How the value came here; parts of a range may be worse known, and `source` says which.
    pub evidence: Evidence,
    /// Why the number is weak, where it is.
    pub weakness: Option<&'static str>,
}

/// Fibres of a tissue: where they run, and how stiff they make it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FibrePreset {
    /// Where they run, in anatomical words.
    pub course: &'static str,
    /// Young's modulus along them [Pa]: what a small stretch along the fibres meets, free to narrow.
    pub young: Measured,
}

/// A tissue by name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TissuePreset {
    /// Name in scenes.
    pub name: &'static str,
    /// What it is, for people.
    pub title: &'static str,
    /// The law that fits it without fibres; with fibres it is
    /// [`TransverseStVenantKirchhoff`](super::TransverseStVenantKirchhoff).
    #[serde(serialize_with = "by_name")]
    pub law: LawKind,
    /// Young's modulus of small strains [Pa]; across the fibres, where there are some.
    pub young: Measured,
    /// Poisson's ratio.
    pub poisson: Measured,
    /// Density [kg/m³].
    pub density: Measured,
    /// Fibres, where the tissue has a family of them.
    pub fibre: Option<FibrePreset>,
}

impl TissuePreset {
    /// Every tissue, organs first.
    pub const ALL: &'static [Self] = &[
        solid::LIVER,
        solid::KIDNEY,
        solid::SPLEEN,
        solid::BRAIN,
        solid::FAT,
        solid::BREAST_FAT,
        solid::BREAST_GLAND,
        fibrous::MUSCLE,
        fibrous::SKIN,
        fibrous::GALLBLADDER_WALL,
        fibrous::ARTERY,
        solid::TRUTH_CUBE,
    ];

    /// The tissue of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|preset| preset.name == name)
    }

    /// λ and μ of small strains [Pa], without fibres.
    ///
    /// # Errors
    /// As [`Lame::from_young_poisson`]; not for the tissues of [`TissuePreset::ALL`].
    pub fn lame(&self) -> Result<Lame, MaterialError> {
        Lame::from_young_poisson(self.young.value, self.poisson.value)
    }

    /// λ and μ of the matrix between the fibres [Pa], and the factor by which they are larger along the fibres, as scenes and
    /// [`Fibre::new`] count; none without fibres.
    ///
    /// Both moduli that are stated are those of a tension test, E_T across and E_L along the fibres. Fibres of the factor f add
    /// 2κ_a = (f − 1)(λ + 2μ) to Young's modulus E of the matrix along them; across them they hold the sides of the
    /// specimen, 1/E_T = (1 − ν²(1 − E/E_L))/E. So
    ///
    /// E = E_T (1 − ν²)/(1 − ν² E_T/E_L),   f = 1 + (E_L − E)/(λ + 2μ)
    ///
    /// and E is up to a fifth below E_T.
    ///
    /// # Errors
    /// As [`TissuePreset::lame`].
    pub fn matrix_and_factor(&self) -> Result<Option<(Lame, f64)>, MaterialError> {
        let Some(fibre) = self.fibre else { return Ok(None) };
        let (along, across, poisson) = (fibre.young.value, self.young.value, self.poisson.value);
        let held = poisson * poisson;
        let matrix = Lame::from_young_poisson(across * (1.0 - held) / (1.0 - held * across / along), poisson)?;
        Ok(Some((matrix, 1.0 + (along - matrix.young()) / (matrix.lambda + 2.0 * matrix.mu))))
    }

    /// The tissue without its fibres, the same everywhere.
    ///
    /// # Errors
    /// As [`TissuePreset::lame`].
    pub fn tissue(&self) -> Result<Tissue, MaterialError> {
        let lame = self.lame()?;
        Ok(self.law.visit(Uniform(&[lame.lambda, lame.mu])))
    }

    /// The tissue with its fibres along `direction` (any length but zero), the same everywhere; as
    /// [`tissue`](Self::tissue) where it has none.
    ///
    /// # Errors
    /// As [`TissuePreset::lame`] and [`Fibre::new`].
    pub fn tissue_along(&self, direction: [f64; 3]) -> Result<Tissue, MaterialError> {
        let Some((matrix, factor)) = self.matrix_and_factor()? else { return self.tissue() };
        let fibre = Fibre::new(direction, Lame::new(factor * matrix.lambda, factor * matrix.mu)?, matrix)?;
        let [x, y, z] = fibre.direction.to_array();
        let values = [matrix.lambda, matrix.mu, x, y, z, fibre.stiffness];
        Ok(LawKind::TransverseStVenantKirchhoff.visit(Uniform(&values)))
    }
}

/// A law goes by its name in scenes.
fn by_name<S: Serializer>(law: &LawKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(law.name())
}

/// A law of these parameter values everywhere.
struct Uniform<'a>(&'a [f64]);

impl LawVisitor for Uniform<'_> {
    type Output = Tissue;
    fn visit<L: LawFamily>(self) -> Tissue {
        Tissue::uniform(L::from_values(self.0))
    }
}

/// What tissue of water does where its volume was not measured.
const KEEPS_VOLUME: Measured = Measured {
    value: 0.49,
    range: (0.45, 0.4999),
    source: "Fung, Biomechanics: Mechanical Properties of Living Tissues, Springer 1993: soft tissue is mostly water",
    species: "mammals",
    state: "taken, not measured",
    evidence: Evidence::Chosen,
    weakness: Some("0.49 stands for a volume that is kept, as far as elements bear it that do not lock"),
};

/// The same for tissue of St Venant–Kirchhoff's law, which keeps the trace of the strain, not the volume.
const KEEPS_TRACE: Measured = Measured {
    value: 0.45,
    weakness: Some("taken below 0.49: under this law a larger ratio keeps the trace of the strain, not the volume"),
    ..KEEPS_VOLUME
};
