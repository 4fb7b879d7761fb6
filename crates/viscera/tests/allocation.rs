//! A step asks for no memory, whatever happens in it: the first picture and the ten-thousandth take the same time.

use allocation_counter::measure;
use viscera::body::{Actuator, ActuatorLine, Body, Load, LoosePieces, Muscle};
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Newton, Preconditioning};
use viscera::instrument::{Cautery, Grasper, Probe};
use viscera::material::{LawFamily, LawVisitor, LinearElastic, StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh};
use viscera::model::{
    Corotational, Hybrid, ModelKind, ModelRecipe, NodallyIntegrated, Precision, Precomputed, ShapeMemory, TensorMass,
};
use viscera::world::{Attachment, Integrator, World, WorldConfig};

/// A beam under gravity and pressure that is grasped, pulled, burnt through, and loses the piece beyond the cut.
fn operation<T: Precision>(recipe: Box<dyn ModelRecipe>, hexahedra: bool, integrator: Integrator) -> World<T> {
    let (cells, size) = ([2, 2, 8], [0.04, 0.04, 0.16]);
    let body = if hexahedra {
        Body::new(HexMesh::box_grid(cells, size), 1000.0)
    } else {
        // What is pre-computed is linear, and knows no such force.
        let kappa = if recipe.kind() == ModelKind::Hybrid { 0.0 } else { 1e4 };
        Body::new(TetMesh::box_grid(cells, size), 1000.0).keep_volume(kappa)
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
    if !hexahedra {
        world.add_instrument(Cautery { path, radius: 0.02, on: (0.1, 0.25), ..Cautery::default() }).unwrap();
    }
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
    for kind in ModelKind::ALL.iter().filter(|kind| kind.info().no_cutting.is_none()) {
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

/// A body that answers statically, to jaws and to a rod, and one of which a part moves and is burnt.
#[test]
fn no_step_of_precomputed_tissue_allocates() {
    let tissue = || Tissue::uniform(LinearElastic::from_young_poisson(5e3, 0.4).unwrap());
    let tip = Region::HalfSpace { point: Vec3::new(0.0, 0.0, 0.05), normal: Vec3::new(0.0, 0.0, 1.0) };
    for integrator in [Integrator::default(), Integrator::Implicit(Implicit::default())] {
        let hybrid: Box<dyn ModelRecipe> = Box::new(Hybrid::new(tissue()).dynamic(tip.clone()));
        assert_no_step_allocates::<f64>(vec![(hybrid, false)], integrator);

        let mut world =
            World::<f64>::new(WorldConfig { gravity: [0.0; 3], integrator, ..WorldConfig::default() }).unwrap();
        let mesh = TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]);
        let root = Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0);
        world.add(Body::new(mesh, 1000.0).model(Precomputed::new(tissue())).fix(root)).unwrap();
        let end = Vec3::new(0.02, 0.02, 0.16);
        let pull = vec![(0.02, end), (0.1, end + Vec3::new(0.0, 0.01, 0.02))];
        let path = Curve::piecewise_linear(pull).unwrap();
        world
            .add_instrument(Grasper { path, radius: 0.025, close: 0.02, open: Some(0.12), ..Grasper::default() })
            .unwrap();
        let push = vec![(0.0, Vec3::new(0.1, 0.02, 0.1)), (0.2, Vec3::new(0.03, 0.02, 0.1))];
        let path = Curve::piecewise_linear(push).unwrap();
        world.add_instrument(Probe { path, ..Probe::default() }).unwrap();
        let (mut removed, mut touched) = (0, 0);
        for step in 0..60 {
            let allocated = measure(|| removed += world.step().unwrap().removed_cells);
            assert_eq!(allocated.count_total, 0, "step {step}: {} bytes", allocated.bytes_total);
            let tools: Vec<_> = world.instrument_ids().collect();
            touched += world.observe_instrument(tools[1]).contacts;
        }
        assert!(removed == 0 && touched > 0, "the rod must have touched, and nothing is cut");
    }
}

/// The coarse matrices of a body that is being cut are made anew in every step, in memory that was there before the first one; but the
/// lattices are laid anew in the step after cells went.
#[test]
fn no_step_with_multigrid_allocates_but_after_a_cut() {
    let stvk = || Tissue::uniform(StVenantKirchhoff::from_young_poisson(5e3, 0.4).unwrap());
    let linear = || Tissue::uniform(LinearElastic::from_young_poisson(5e3, 0.4).unwrap());
    let recipes: Vec<(Box<dyn ModelRecipe>, bool)> = vec![
        (Box::new(TensorMass::new(stvk())), false),
        (Box::new(NodallyIntegrated::new(stvk())), false),
        (Box::new(Corotational::new(linear())), false),
        (Box::new(Corotational::new(linear())), true),
    ];
    let settings = Implicit { preconditioner: Preconditioning::Multigrid, ..Implicit::default() };
    for (recipe, hexahedra) in recipes {
        let mut world = operation::<f64>(recipe, hexahedra, Integrator::Implicit(settings));
        let (mut is_cut, mut removed) = (false, 0);
        for step in 0..60 {
            let mut gone = 0;
            let allocated = measure(|| gone = world.step().unwrap().removed_cells);
            assert!(is_cut || allocated.count_total == 0, "step {step}: {} bytes", allocated.bytes_total);
            is_cut = gone > 0;
            removed += gone;
        }
        assert!(hexahedra || removed > 50, "it must have cut");
    }
}

/// Bodies that are grown together, while jaws hold tied nodes: what ties need was asked for when they were made.
#[test]
fn no_step_of_attached_bodies_allocates() {
    let tissue = || Tissue::uniform(StVenantKirchhoff::from_young_poisson(5e3, 0.4).unwrap());
    let full = Implicit { newton: Newton::Full { relative: 1e-4, at_most: 30 }, ..Implicit::default() };
    for integrator in [Integrator::default(), Integrator::Implicit(Implicit::default()), Integrator::Implicit(full)] {
        let config = WorldConfig { gravity: [0.0, -0.5, 0.0], integrator, ..WorldConfig::default() };
        let mut world = World::<f32>::new(config).unwrap();
        let mut add = |cells, low: f64, fixed: bool| {
            let mut mesh = TetMesh::box_grid(cells, [0.04, 0.04, 0.08]);
            mesh.nodes.iter_mut().for_each(|node| node.z += low);
            let body = Body::new(mesh, 1000.0).model(TensorMass::new(tissue())).damping(2.0);
            world.add(if fixed { body.fix(Region::Named("z-min".into())) } else { body }).unwrap()
        };
        let (to, body) = (add([2, 2, 4], 0.0, true), add([3, 3, 5], 0.08, false));
        world.attach(Attachment { body, region: Region::Named("z-min".into()), to }).unwrap();
        let seam = Vec3::new(0.02, 0.04, 0.08);
        let path = Curve::piecewise_linear(vec![(0.05, seam), (0.2, seam + Vec3::splat(0.01))]).unwrap();
        let grasper = Grasper { path, radius: 0.015, close: 0.05, open: Some(0.15), ..Grasper::default() };
        let tool = world.add_instrument(grasper).unwrap();
        let mut held = 0;
        for step in 0..40 {
            let allocated = measure(|| assert!(world.step().is_ok()));
            assert_eq!(allocated.count_total, 0, "{integrator:?}, step {step}: {} bytes", allocated.bytes_total);
            held += world.tool(tool).held_nodes;
        }
        assert!(held > 0, "the jaws must have held some of the seam");
    }
}

/// Volumes that are kept, rigid parts, muscles, actuators and fields, while cells of them are cut away.
#[test]
fn no_step_with_constraints_allocates() {
    let linear = Tissue::uniform(LinearElastic::from_young_poisson(5e3, 0.4).unwrap());
    let side = |name: &str| Region::Named(name.into());
    let activation = Curve::piecewise_linear(vec![(0.0, 0.0), (0.2, 1.0)]).unwrap();
    let muscle = Muscle { region: side("y-min"), stiffness: 5.0, contraction: 0.3, activation };
    let line = ActuatorLine::Between { from: side("z-min"), to: side("z-max") };
    let one = || Curve::constant(1.0);
    let actuator = Actuator { line, stiffness: 20.0, length: one(), tension: one() };
    let line = ActuatorLine::Along { region: Region::All, direction: [0.0, 1.0, 1.0] };
    let fibres = Actuator { line, stiffness: 500.0, length: one(), tension: one() };
    let body = Body::new(TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]), 1000.0)
        .model(ShapeMemory::new(linear))
        .damping(2.0)
        .fix(side("z-min"))
        .rigid(side("z-max"))
        .muscle(muscle)
        .actuator(actuator)
        .actuator(fibres)
        .load(Load::BodyForce { region: Region::All, per_volume: Curve::constant(Vec3::new(0.0, 100.0, 0.0)) })
        .load(Load::Attraction {
            region: Region::All,
            centre: [0.0; 3],
            radius: 0.1,
            per_volume: Curve::constant(50.0),
        })
        .keep_volume_exactly("whole", Region::All)
        .keep_volume_exactly("half", Region::cuboid([-1.0; 3], [1.0, 1.0, 0.08]));
    let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
    let id = world.add(body).unwrap();
    for step in 0..40 {
        let allocated = measure(|| assert!(world.step().is_ok()));
        assert_eq!(allocated.count_total, 0, "step {step}: {} bytes", allocated.bytes_total);
        let cells = [4 * step, 4 * step + 1];
        let allocated = measure(|| assert!(world.remove_cells(id, &cells).is_ok()));
        assert_eq!(allocated.count_total, 0, "cut {step}: {} bytes", allocated.bytes_total);
    }
}
