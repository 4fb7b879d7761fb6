//! Explicit steps of a body that nothing meets on the way go through the nodes once a sub-step.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::material::{Lame, LinearElastic, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::{Corotational, ModelRecipe, TensorMass, TotalLagrangian};
use viscera::world::{World, WorldConfig};

/// A bar with damping, held, led along a curve and guided, that keeps its volume or not.
fn bar(mesh: &VolumeMesh, recipe: Box<dyn ModelRecipe>, keep_volume: f64) -> Body {
    let end = Region::plane([0.0, 0.0, 0.4], [0.0, 0.0, 1.0], 0.0);
    let way = |time: f64| Vec3::new(0.01, 0.0, 0.02) * time;
    Body::new(mesh.clone(), 1000.0)
        .boxed_model(recipe)
        .keep_volume(keep_volume)
        .damping(3.0)
        .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0))
        .prescribe(end, Curve::piecewise_linear(vec![(0.0, way(0.0)), (1.0, way(1.0))]).unwrap())
        .slide(Region::cuboid([0.0, 0.0, 0.1], [0.01, 0.1, 0.3]), [0.6, 0.8, 0.0])
}

#[test]
fn strides_have_the_bits_of_drifts_and_kicks() {
    let tetrahedra = VolumeMesh::from(TetMesh::box_grid([3, 3, 12], [0.1, 0.1, 0.4]));
    let hexahedra = VolumeMesh::from(HexMesh::box_grid([3, 3, 12], [0.1, 0.1, 0.4]));
    let lame = Lame::from_young_poisson(1e4, 0.4).unwrap();
    let direct =
        || -> Box<dyn ModelRecipe> { Box::new(TotalLagrangian::new(Tissue::uniform(StableNeoHookean::new(lame)))) };
    let turned = || -> Box<dyn ModelRecipe> { Box::new(Corotational::new(Tissue::uniform(LinearElastic::new(lame)))) };
    let stored =
        || -> Box<dyn ModelRecipe> { Box::new(TensorMass::new(Tissue::uniform(StVenantKirchhoff::new(lame)))) };
    for (what, mesh, recipe, keep_volume) in [
        ("one model that sums on copies", &tetrahedra, &direct as &dyn Fn() -> Box<dyn ModelRecipe>, 0.0),
        ("two models", &tetrahedra, &direct, 1e4),
        ("a corotational model", &tetrahedra, &turned, 0.0),
        ("a model without copies", &tetrahedra, &stored, 0.0),
        ("hexahedra", &hexahedra, &direct, 0.0),
    ] {
        let run = |loaded: bool| {
            let mut world = World::<f32>::new(WorldConfig { step: 0.02, ..WorldConfig::default() }).unwrap();
            let body = bar(mesh, recipe(), keep_volume);
            // A load may change within a step: forces are asked for in the middle of each sub-step.
            let region = Region::cuboid([-1.0; 3], [1.0; 3]);
            let nothing = Load::Force { region, total: Curve::constant(Vec3::ZERO) };
            let id = world.add(if loaded { body.load(nothing) } else { body }).unwrap();
            let substeps: u32 = (0..10).map(|_| world.step().unwrap().substeps).sum();
            assert!(substeps > 20, "{what}: {substeps} sub-steps show nothing");
            (world.body(id).positions().to_vec(), world.body(id).velocities().to_vec())
        };
        assert!(run(false) == run(true), "{what}");
    }
}
