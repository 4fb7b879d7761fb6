//! The ways in which the cube is computed.

use viscera::body::Body;
use viscera::material::{LinearElastic, NeoHookean, StVenantKirchhoff, Tissue};
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement};
use viscera::model::{Corotational, ModelRecipe, NodallyIntegrated, StiffnessWarping, TotalLagrangian};

use super::{DENSITY, EDGE};
use crate::ValidationError;
use crate::setting::Cells;

/// A kind of cell with a model, and how its equilibrium is found.
#[derive(Clone, Debug)]
pub struct Variant {
    pub(super) cells: Cells,
    pub(super) kind: Kind,
}

#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// One linear solve.
    SmallStrain { nodal: bool },
    /// Neo-Hookean, by Newton's method.
    NeoHookean { nodal: bool },
    /// Most of them have no energy, and come to rest by implicit steps.
    Corotational { rotation: Rotation, strain: StrainDisplacement, volume: IntegrationVolume },
    /// By implicit steps too.
    StiffnessWarping,
}

impl Variant {
    /// All of them, or those that a test has time for.
    pub fn all(full: bool) -> Vec<Self> {
        let variant = |cells, kind| Self { cells, kind };
        let mut variants = Vec::new();
        for nodal in [false, true] {
            for kind in [Kind::SmallStrain { nodal }, Kind::NeoHookean { nodal }] {
                variants.push(variant(Cells::Ten, kind.clone()));
                if !nodal {
                    variants.push(variant(Cells::Hexahedra, kind));
                }
            }
        }
        let corotational =
            |cells, rotation, strain, volume| variant(cells, Kind::Corotational { rotation, strain, volume });
        let strains = [StrainDisplacement::AtRest, StrainDisplacement::Updated];
        for rotation in [Rotation::Polar, Rotation::Qr, Rotation::Svd] {
            for strain in strains {
                for volume in [IntegrationVolume::Initial, IntegrationVolume::Current] {
                    variants.push(corotational(Cells::Ten, rotation, strain, volume));
                }
                if rotation != Rotation::Svd {
                    variants.push(corotational(Cells::Hexahedra, rotation, strain, IntegrationVolume::Initial));
                }
            }
        }
        variants.push(variant(Cells::Ten, Kind::StiffnessWarping));
        if !full {
            let is_first = |kind: &Kind| {
                let polar_at_rest = (Rotation::Polar, StrainDisplacement::AtRest, IntegrationVolume::Initial);
                match *kind {
                    Kind::Corotational { rotation, strain, volume } => (rotation, strain, volume) == polar_at_rest,
                    Kind::StiffnessWarping => false,
                    _ => true,
                }
            };
            variants.retain(|variant| is_first(&variant.kind));
        }
        variants
    }

    /// What the table calls it.
    pub fn name(&self) -> String {
        let how = match &self.kind {
            Kind::SmallStrain { nodal: false } => "small strain".into(),
            Kind::SmallStrain { nodal: true } => "small strain, integrated at the nodes".into(),
            Kind::NeoHookean { nodal: false } => "neo-Hookean".into(),
            Kind::NeoHookean { nodal: true } => "neo-Hookean, integrated at the nodes".into(),
            Kind::Corotational { rotation, strain, volume } => {
                let rotation = match rotation {
                    Rotation::Polar => "polar",
                    Rotation::Qr => "QR",
                    Rotation::Svd => "SVD",
                };
                let strain = match strain {
                    StrainDisplacement::AtRest => "B at rest",
                    StrainDisplacement::Updated => "B updated",
                };
                let volume = match volume {
                    IntegrationVolume::Initial => "initial V",
                    IntegrationVolume::Current => "current V",
                };
                format!("corotational, {rotation}, {strain}, {volume}")
            }
            Kind::StiffnessWarping => "stiffness warping".into(),
        };
        format!("{}, {how}", self.cells.name())
    }

    /// Whether volumes are kept around nodes, so that nothing locks.
    pub fn is_free_of_locking(&self) -> bool {
        matches!(self.kind, Kind::SmallStrain { nodal: true } | Kind::NeoHookean { nodal: true })
    }

    /// Whether it knows large strains.
    pub fn is_neo_hookean(&self) -> bool {
        matches!(self.kind, Kind::NeoHookean { .. })
    }

    /// The converged reference that its force is compared with. Linear tissue in turning cells has none of its own.
    pub(super) fn converged_law(&self) -> &'static str {
        match self.kind {
            Kind::SmallStrain { .. } => "glued_linear",
            Kind::NeoHookean { .. } | Kind::Corotational { .. } | Kind::StiffnessWarping => "glued_neohooke",
        }
    }

    /// The cube of `cells` cells to an edge, free.
    pub(super) fn body(&self, cells: usize, young: f64, poisson: f64) -> Result<Body, ValidationError> {
        let share = self.cells.share();
        let linear = || LinearElastic::from_young_poisson(share * young, poisson).map(Tissue::uniform);
        let recipe: Box<dyn ModelRecipe> = match &self.kind {
            Kind::SmallStrain { nodal: false } => Box::new(TotalLagrangian::new(linear()?)),
            // In one linear solve a quadratic law is a linear one.
            Kind::SmallStrain { nodal: true } => {
                let law = StVenantKirchhoff::from_young_poisson(share * young, poisson)?;
                Box::new(NodallyIntegrated::new(Tissue::uniform(law)))
            }
            Kind::NeoHookean { nodal } => {
                let tissue = Tissue::uniform(NeoHookean::from_young_poisson(share * young, poisson)?);
                if *nodal { Box::new(NodallyIntegrated::new(tissue)) } else { Box::new(TotalLagrangian::new(tissue)) }
            }
            Kind::Corotational { rotation, strain, volume } => {
                let recipe = Corotational::new(linear()?).rotation(*rotation);
                Box::new(recipe.strain_displacement(*strain).volume(*volume))
            }
            Kind::StiffnessWarping => Box::new(StiffnessWarping::new(linear()?)),
        };
        let mesh = self.cells.fill([cells; 3], [EDGE; 3]);
        Ok(Body::new(mesh, share * DENSITY).boxed_model(recipe))
    }
}
