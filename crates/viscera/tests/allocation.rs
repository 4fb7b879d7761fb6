//! A step asks for no memory, whatever happens in it: the first picture and the ten-thousandth take the same time.

use allocation_counter::measure;
use viscera::body::{Body, Load, LoosePieces};
use viscera::curve::Curve;
use viscera::instrument::{Cautery, Grasper};
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh};
use viscera::model::{LinearTensorMass, ModelRecipe, Precision, TensorMass, TotalLagrangian};
use viscera::world::{World, WorldConfig};

/// A beam under gravity and pressure that is grasped, pulled, burnt through, and loses the piece beyond the cut.
fn operation<T: Precision>(recipe: Box<dyn ModelRecipe>, hexahedra: bool) -> World<T> {
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
    let config = WorldConfig { gravity: [0.0, -0.5, 0.0], ..WorldConfig::default() };
    let mut world = World::new(config).unwrap();
    world.add(body).unwrap();
    let tip = Vec3::new(0.02, 0.02, 0.16);
    let pull = vec![(0.02, tip), (0.1, tip + Vec3::new(0.0, 0.01, 0.02))];
    let path = Curve::piecewise_linear(pull).unwrap();
    world.add_instrument(Grasper { path, radius: 0.025, close: 0.02, open: Some(0.12) }).unwrap();
    let across = vec![(0.1, Vec3::new(-0.01, -0.02, 0.07)), (0.25, Vec3::new(0.05, 0.06, 0.09))];
    let path = Curve::piecewise_linear(across).unwrap();
    world.add_instrument(Cautery { path, radius: 0.02, on: (0.1, 0.25) }).unwrap();
    world
}

fn assert_no_step_allocates<T: Precision>() {
    let linear = Tissue::uniform(LinearElastic::from_young_poisson(5e3, 0.4).unwrap());
    let stvk = Tissue::uniform(StVenantKirchhoff::from_young_poisson(5e3, 0.4).unwrap());
    let recipes: [(Box<dyn ModelRecipe>, bool); 5] = [
        (Box::new(LinearTensorMass::new(linear)), false),
        (Box::new(TensorMass::new(stvk.clone())), false),
        (Box::new(TensorMass::new(stvk.clone()).adaptive(5e-3)), false),
        (Box::new(TotalLagrangian::new(stvk.clone())), false),
        (Box::new(TotalLagrangian::new(stvk)), true),
    ];
    for (recipe, hexahedra) in recipes {
        let name = format!("{} in {}", recipe.kind(), T::NAME);
        let mut world = operation::<T>(recipe, hexahedra);
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
    assert_no_step_allocates::<f32>();
}

#[test]
fn no_step_allocates_in_double_precision() {
    assert_no_step_allocates::<f64>();
}
