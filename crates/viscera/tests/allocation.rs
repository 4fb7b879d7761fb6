//! A step asks for no memory, whatever happens in it: the first picture and the ten-thousandth take the same time.

use allocation_counter::measure;
use viscera::body::{Body, Load, LoosePieces};
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Preconditioning};
use viscera::instrument::{Cautery, Grasper};
use viscera::material::{LawFamily, LawVisitor, LinearElastic, StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh};
use viscera::model::{Corotational, ModelKind, ModelRecipe, NodallyIntegrated, Precision, TensorMass};
use viscera::world::{Integrator, World, WorldConfig};

/// A beam under gravity and pressure that is grasped, pulled, burnt through, and loses the piece beyond the cut.
fn operation<T: Precision>(recipe: Box<dyn ModelRecipe>, hexahedra: bool, integrator: Integrator) -> World<T> {
    let (cells, size) = ([2, 2, 8], [0.04, 0.04, 0.16]);
    let body = if hexahedra {
        Body::new(HexMesh::box_grid(cells, size), 1000.0)
    } else {
        Body::new(TetMesh::box_grid(cells, size), 1000.0).keep_volume(1e4)
    };
    let body = body
        .boxed_model(recipe)
        .damping(2.0)
        .fix(Region::Named("z-min".into()))
        .load(Load::Pressure { region: Region::Named("x-max".into()), pressure: Curve::constant(20.0) })
        .load(Load::Traction { region: Region::Named("y-max".into()), traction: Curve::constant(Vec3::splat(5.0)) })
        .loose_pieces(LoosePieces::Drop);
    // Little gravity: a linear beam as soft as this would swing out of the cautery's way.
    let config = WorldConfig { gravity: [0.0, -0.5, 0.0], integrator, ..WorldConfig::default() };
    let mut world = World::new(config).unwrap();
    world.add(body).unwrap();
    let tip = Vec3::new(0.02, 0.02, 0.16);
    let pull = vec![(0.02, tip), (0.1, tip + Vec3::new(0.0, 0.01, 0.02))];
    let path = Curve::piecewise_linear(pull).unwrap();
    world.add_instrument(Grasper { path, radius: 0.025, close: 0.02, open: Some(0.12), ..Grasper::default() }).unwrap();
    let across = vec![(0.1, Vec3::new(-0.01, -0.02, 0.07)), (0.25, Vec3::new(0.05, 0.06, 0.09))];
    let path = Curve::piecewise_linear(across).unwrap();
    world.add_instrument(Cautery { path, radius: 0.02, on: (0.1, 0.25), ..Cautery::default() }).unwrap();
    world
}

/// Every model of the first and the last law that it computes, on every kind of cell that it knows, and adaptive tensor-mass.
fn every_recipe() -> Vec<(Box<dyn ModelRecipe>, bool)> {
    struct Example;
    impl LawVisitor for Example {
        type Output = Tissue;
        fn visit<L: LawFamily>(self) -> Tissue {
            Tissue::uniform(L::example())
        }
    }
    let mut recipes: Vec<(Box<dyn ModelRecipe>, bool)> = Vec::new();
    for kind in ModelKind::ALL {
        let info = kind.info();
        for law in info.laws.first().into_iter().chain(info.laws.last()) {
            recipes.push((kind.recipe(law.visit(Example)), false));
            if info.hexahedra {
                recipes.push((kind.recipe(law.visit(Example)), true));
            }
        }
    }
    let stvk = Tissue::uniform(StVenantKirchhoff::from_young_poisson(5e3, 0.4).unwrap());
    recipes.push((Box::new(TensorMass::new(stvk).adaptive(5e-3)), false));
    recipes
}

fn assert_no_step_allocates<T: Precision>(recipes: Vec<(Box<dyn ModelRecipe>, bool)>, integrator: Integrator) {
    for (recipe, hexahedra) in recipes {
        let name = format!("{} of {} in {}", recipe.kind(), recipe.tissue().kind(), T::NAME);
        let mut world = operation::<T>(recipe, hexahedra, integrator);
        let mut removed = 0;
        for step in 0..60 {
            let allocated = measure(|| removed += world.step().unwrap().removed_cells);
            assert_eq!(allocated.count_total, 0, "{name}, step {step}: {} bytes", allocated.bytes_total);
        }
        assert!(hexahedra || removed > 50, "{name}: it must have cut");
    }
}

#[test]
fn no_step_allocates_in_single_precision() {
    assert_no_step_allocates::<f32>(every_recipe(), Integrator::default());
}

#[test]
fn no_step_allocates_in_double_precision() {
    assert_no_step_allocates::<f64>(every_recipe(), Integrator::default());
}

/// The coarse matrices of a body that is being cut are made anew in every step, in memory that was there before the first one.
#[test]
fn no_step_with_multigrid_allocates() {
    let stvk = || Tissue::uniform(StVenantKirchhoff::from_young_poisson(5e3, 0.4).unwrap());
    let linear = || Tissue::uniform(LinearElastic::from_young_poisson(5e3, 0.4).unwrap());
    let recipes: Vec<(Box<dyn ModelRecipe>, bool)> = vec![
        (Box::new(TensorMass::new(stvk())), false),
        (Box::new(NodallyIntegrated::new(stvk())), false),
        (Box::new(Corotational::new(linear())), false),
        (Box::new(Corotational::new(linear())), true),
    ];
    let settings = Implicit { preconditioner: Preconditioning::Multigrid, ..Implicit::default() };
    assert_no_step_allocates::<f64>(recipes, Integrator::Implicit(settings));
}
