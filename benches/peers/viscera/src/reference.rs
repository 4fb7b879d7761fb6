use viscera::body::Body;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{LinearElastic, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::mesh::Region;
use viscera::model::corotational::Tangent;
use viscera::model::{Corotational, ModelRecipe, NodallyIntegrated, TotalLagrangian};
use viscera::solver::Iterative;
use viscera::world::{World, WorldConfig};
use viscera_direct::Cholesky;
use viscera_peers_protocol::{Case, Failure, Mesh};

use crate::tetrahedra;

/// A law and an element whose equilibrium is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// St Venant–Kirchhoff in plain tetrahedra.
    StVenantKirchhoff,
    /// Stable neo-Hookean in plain tetrahedra.
    StableNeoHookean,
    /// Neo-Hookean with the logarithm of the volume, in plain tetrahedra.
    NeoHookean,
    /// Corotational tetrahedra.
    Corotational,
    /// Stable neo-Hookean, integrated at the nodes.
    NodallyIntegrated,
}

impl Reference {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::StVenantKirchhoff,
        Self::StableNeoHookean,
        Self::NeoHookean,
        Self::Corotational,
        Self::NodallyIntegrated,
    ];

    /// As drivers call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::StVenantKirchhoff => "st-venant-kirchhoff",
            Self::StableNeoHookean => "stable-neo-hookean",
            Self::NeoHookean => "neo-hookean",
            Self::Corotational => "corotational",
            Self::NodallyIntegrated => "nodally-integrated",
        }
    }

    fn recipe(self, case: &Case) -> Result<Box<dyn ModelRecipe>, Failure> {
        let (young, poisson) = (case.tissue.young, case.tissue.poisson);
        let stable = || StableNeoHookean::from_young_poisson(young, poisson).map(Tissue::uniform);
        Ok(match self {
            Self::StVenantKirchhoff => {
                Box::new(TotalLagrangian::new(Tissue::uniform(StVenantKirchhoff::from_young_poisson(young, poisson)?)))
            }
            Self::StableNeoHookean => Box::new(TotalLagrangian::new(stable()?)),
            Self::NeoHookean => {
                Box::new(TotalLagrangian::new(Tissue::uniform(NeoHookean::from_young_poisson(young, poisson)?)))
            }
            Self::Corotational => {
                let tissue = Tissue::uniform(LinearElastic::from_young_poisson(young, poisson)?);
                Box::new(Corotational::new(tissue).tangent(Tangent::Exact))
            }
            Self::NodallyIntegrated => Box::new(NodallyIntegrated::new(stable()?)),
        })
    }
}

/// Nodes from which on conjugate gradients solve a system sooner than a factorisation: a hundred times sooner for 18 000.
const MANY: usize = 10_000;
/// Where these stop. Newton's method asks for no more digits than it gains in an iteration.
const TOLERANCE: f64 = 1e-6;

/// Displacement of the tip [m] in equilibrium, in double precision.
///
/// # Errors
/// Where there is no equilibrium.
pub fn deflection(case: &Case, mesh: &Mesh, reference: Reference) -> Result<[f64; 3], Failure> {
    let mut world = World::<f64>::new(WorldConfig { gravity: case.beam.gravity, ..WorldConfig::default() })?;
    let body = Body::new(tetrahedra(mesh), case.tissue.density)
        .boxed_model(reference.recipe(case)?)
        .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0));
    let body = world.add(body)?;
    if mesh.nodes.len() < MANY {
        world.settle(body, &QuasiStatic::default(), &mut Cholesky::default())?;
    } else {
        world.settle(body, &QuasiStatic::default(), &mut Iterative::new(TOLERANCE))?;
    }
    let tip = mesh.tip(case);
    let now = world.body(body).positions()[tip].to_array();
    Ok(std::array::from_fn(|axis| now[axis] - mesh.nodes[tip][axis]))
}
