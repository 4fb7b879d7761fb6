//! A snapshot as bytes: whatever the model, the integrator and the cuts, a world that reads it goes on with the same bits; and
//! what is no snapshot of the world is told, never believed.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::instrument::{Cautery, Grasper};
use viscera::material::{LawFamily, LawVisitor, Tissue};
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::{ModelKind, ModelRecipe, Precision, TensorMass, TotalLagrangian};
use viscera::world::{Integrator, Snapshot, SnapshotError, Substep, World, WorldConfig};

use crate::support::{DENSITY, Vector, bits, in_both_precisions, side, stvk};

const SIZE: [f64; 3] = [0.04, 0.04, 0.16];

fn tets() -> VolumeMesh {
    TetMesh::box_grid([2, 2, 8], SIZE).into()
}

/// A bar that is pulled by a grasper from 20 ms on and burnt through from 30 ms to 120 ms.
fn operation<T: Precision>(mesh: VolumeMesh, recipe: Box<dyn ModelRecipe>, integrator: Integrator) -> World<T> {
    let hexahedra = matches!(mesh, VolumeMesh::Hex(_));
    let config = WorldConfig { gravity: [0.0, -0.5, 0.0], step: 5e-3, integrator };
    let mut world = World::new(config).unwrap();
    let body = Body::new(mesh, DENSITY).boxed_model(recipe).fix(side("z-min")).damping(2.0);
    let energy_momentum =
        matches!(integrator, Integrator::Implicit(settings) if settings.scheme == Scheme::EnergyMomentum);
    world.add(if hexahedra || energy_momentum { body } else { body.keep_volume(1e4) }).unwrap();
    let tip = Vector::new(0.02, 0.02, 0.16);
    let path = Curve::piecewise_linear(vec![(0.02, tip), (0.1, tip + Vector::new(0.0, 0.01, 0.02))]).unwrap();
    world.add_instrument(Grasper { path, radius: 0.025, close: 0.02, open: Some(0.12), ..Grasper::default() }).unwrap();
    let across = vec![(0.03, Vector::new(-0.01, -0.02, 0.07)), (0.12, Vector::new(0.05, 0.06, 0.09))];
    let path = Curve::piecewise_linear(across).unwrap();
    if !hexahedra {
        world.add_instrument(Cautery { path, radius: 0.02, on: (0.03, 0.12), ..Cautery::default() }).unwrap();
    }
    world
}

fn run<T: Precision>(world: &mut World<T>, steps: usize) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

/// Makes the world three times over: one runs through, one reads the bytes of the middle when it is new, and one when it has cut
/// further than that. All end with the same bits.
fn goes_on_with_the_same_bits<T: Precision>(name: &str, cuts: bool, make: impl Fn() -> World<T>) {
    let mut world = make();
    run(&mut world, 14);
    let bytes = world.snapshot().to_bytes();
    let middle = world.body(world.body_ids().next().unwrap()).state().removals.clone();
    assert_eq!(middle.cut_count() > 1, cuts, "{name}: the middle must lie within the cutting");
    run(&mut world, 14);
    let end = bits(&world);

    let mut new = make();
    let snapshot = new.read_snapshot(&bytes).unwrap();
    assert_eq!(snapshot.to_bytes(), bytes, "{name}: what was read is what was written");
    new.restore(&snapshot).unwrap();
    run(&mut new, 14);
    assert!(bits(&new) == end, "{name}: a new world went on otherwise");

    let snapshot = world.read_snapshot(&bytes).unwrap();
    world.restore(&snapshot).unwrap();
    run(&mut world, 14);
    assert!(bits(&world) == end, "{name}: a world that had cut further went on otherwise");
}

struct Example;

impl LawVisitor for Example {
    type Output = Tissue;

    fn visit<L: LawFamily>(self) -> Tissue {
        Tissue::uniform(L::example())
    }
}

fn every_model_goes_on_with_the_same_bits<T: Precision>(_: ()) {
    for kind in ModelKind::ALL.iter().filter(|kind| kind.info().no_cutting.is_none()) {
        let info = kind.info();
        for law in info.laws.first().into_iter().chain(info.laws.last()) {
            let explicit = Integrator::Explicit(Substep::Automatic);
            let recipe = || kind.recipe(law.visit(Example));
            let name = format!("{kind} of {law}");
            goes_on_with_the_same_bits(&name, true, || operation::<T>(tets(), recipe(), explicit));
            if info.hexahedra {
                let mesh = || HexMesh::box_grid([2, 2, 8], SIZE).into();
                goes_on_with_the_same_bits(&name, false, || operation::<T>(mesh(), recipe(), explicit));
            }
        }
    }
    let adaptive = || Box::new(TensorMass::new(stvk(5e3, 0.4)).adaptive(5e-3));
    let explicit = Integrator::default();
    goes_on_with_the_same_bits("adaptive", true, || operation::<T>(tets(), adaptive(), explicit));
}
in_both_precisions!(every_model_goes_on_with_the_same_bits, f32: (), f64: ());

fn every_integrator_goes_on_with_the_same_bits<T: Precision>(_: ()) {
    let schemes = [Scheme::BackwardEuler, Scheme::AVERAGE_ACCELERATION, Scheme::Bdf2];
    let linearised = schemes.map(|scheme| Implicit { scheme, ..Implicit::default() });
    // In single precision rounding ends Newton's method early enough at 1e-4.
    let newton = viscera::dynamics::implicit::Newton::Full { relative: 1e-4, at_most: 30 };
    let full = [Scheme::BackwardEuler, Scheme::EnergyMomentum];
    let full = full.map(|scheme| Implicit { newton, ..Implicit::accurate(scheme) });
    let implicit = linearised.into_iter().chain(full).map(Integrator::Implicit);
    for integrator in implicit.chain([Integrator::Explicit(Substep::Fixed(2e-4))]) {
        let recipe = || Box::new(TotalLagrangian::new(stvk(5e3, 0.4)));
        let name = format!("{integrator:?}");
        goes_on_with_the_same_bits(&name, true, || operation::<T>(tets(), recipe(), integrator));
    }
}
in_both_precisions!(every_integrator_goes_on_with_the_same_bits, f32: (), f64: ());

fn cube<T: Precision>(young: f64) -> World<T> {
    let mut world = World::new(WorldConfig::default()).unwrap();
    let mesh = TetMesh::box_grid([1, 1, 1], [0.1; 3]);
    world.add(Body::new(mesh, DENSITY).model(TotalLagrangian::new(stvk(young, 0.4))).fix(side("y-max"))).unwrap();
    world.step().unwrap();
    world
}

fn refusal<T: Precision>(result: Result<Snapshot<T>, SnapshotError>) -> SnapshotError {
    result.err().expect("it is refused")
}

/// Every byte that is changed and every byte that is missing is noticed.
#[test]
fn damage_is_noticed_wherever_it_is() {
    let world = cube::<f64>(5e3);
    let bytes = world.snapshot().to_bytes();
    for place in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[place] ^= 1 << (place % 8);
        let told = refusal(world.read_snapshot(&flipped));
        let expected =
            if place < 8 { SnapshotError::NotASnapshot } else { SnapshotError::Damaged { length: bytes.len() } };
        assert_eq!(told, expected, "byte {place}");
        let told = refusal(world.read_snapshot(&bytes[..place]));
        assert_eq!(
            told,
            if place < 8 { SnapshotError::NotASnapshot } else { SnapshotError::Damaged { length: place } }
        );
    }
}

/// Softer tissue, the other precision and another number of things are told apart, though all have as many nodes.
#[test]
fn snapshots_of_other_worlds_are_told_apart() {
    let world = cube::<f64>(5e3);
    let bytes = world.snapshot().to_bytes();
    assert!(matches!(refusal(cube::<f64>(5.001e3).read_snapshot(&bytes)), SnapshotError::Foreign { .. }));
    let other = refusal(cube::<f32>(5e3).read_snapshot(&bytes));
    assert_eq!(other, SnapshotError::OtherPrecision { found: 64, wanted: 32 });
    let empty = World::<f64>::new(WorldConfig::default()).unwrap();
    assert!(refusal(empty.read_snapshot(&bytes)).to_string().contains("it has 1 bodies and 0 instruments"));
}

/// A checksum tells who wrote the bytes, not that they make sense: another format, and numbers that lead nowhere, with a checksum
/// that fits.
#[test]
fn bytes_with_a_checksum_that_fits_are_not_believed_either() {
    let world = cube::<f64>(5e3);
    let bytes = world.snapshot().to_bytes();
    let signed = |mut content: Vec<u8>| {
        let checksum = crc32fast::hash(&content);
        content.extend(checksum.to_le_bytes());
        content
    };
    let content = &bytes[..bytes.len() - 4];
    let mut newer = content.to_vec();
    newer[8] = 9;
    assert_eq!(refusal(world.read_snapshot(&signed(newer))), SnapshotError::OtherVersion { found: 9, known: 5 });
    for length in 11..content.len() {
        refusal(world.read_snapshot(&signed(content[..length].to_vec())));
    }
    // Whatever a byte is changed to, reading ends with a snapshot or an error.
    for place in 11..content.len() {
        for value in [0, 1, 2, 127, 255] {
            let mut changed = content.to_vec();
            changed[place] = value;
            let mut world = cube::<f64>(5e3);
            if let Ok(snapshot) = world.read_snapshot(&signed(changed)) {
                world.restore(&snapshot).unwrap();
                // Numbers may be anything; a step that they make impossible is an error and no panic.
                let _ = world.step();
            }
        }
    }
}
