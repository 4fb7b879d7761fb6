//! Reads reference cases with their meshes, and brings bodies to rest.

use serde_json::Value;
use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::{QuasiStatic, StaticError, StaticReport};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::solver::Iterative;
use viscera::world::{BodyId, World, WorldConfig};

pub(crate) type Vector = Vec3<f64>;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/references");

fn text(file: &str) -> String {
    std::fs::read_to_string(format!("{FOLDER}/{file}")).unwrap()
}

pub(crate) fn read(case: &str) -> Value {
    serde_json::from_str(&text(&format!("{case}.json"))).unwrap()
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn vector(value: &Value) -> Vector {
    Vector::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

pub(crate) fn vectors(value: &Value) -> Vec<Vector> {
    value.as_array().unwrap().iter().map(vector).collect()
}

/// A mesh in Gmsh 2.2, text.
pub(crate) fn mesh(file: &str) -> VolumeMesh {
    let text = text(file);
    let section = |name: &'static str| {
        let lines = text.lines().skip_while(move |line| *line != name).skip(2);
        lines.take_while(|line| !line.starts_with('$')).map(|line| line.split_whitespace().collect::<Vec<_>>())
    };
    let nodes = section("$Nodes").map(|words| Vector::from([1, 2, 3].map(|i| words[i].parse().unwrap()))).collect();
    let (mut tets, mut hexes) = (Vec::new(), Vec::new());
    for words in section("$Elements") {
        let numbers: Vec<u32> = words.iter().map(|word| word.parse().unwrap()).collect();
        let corners: Vec<u32> = numbers[3 + numbers[2] as usize..].iter().map(|node| node - 1).collect();
        match numbers[1] {
            4 => tets.push(corners.try_into().unwrap()),
            5 => hexes.push(corners.try_into().unwrap()),
            _ => {}
        }
    }
    if hexes.is_empty() { TetMesh::new(nodes, tets).into() } else { HexMesh::new(nodes, hexes).into() }
}

/// The lower end, z = 0.
pub(crate) fn bottom() -> Region {
    Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0)
}

/// A dead force [N] shared by some nodes.
pub(crate) fn force(nodes: Vec<u32>, total: Vector) -> Load {
    Load::Force { region: Region::Nodes(nodes), total: Curve::constant(total) }
}

/// A world with one body.
pub(crate) fn world(body: Body, gravity: [f64; 3]) -> (World<f64>, BodyId) {
    let mut world = World::new(WorldConfig { gravity, ..WorldConfig::default() }).unwrap();
    let id = world.add(body).unwrap();
    (world, id)
}

/// Brings it to rest, far below the tolerance of the references.
pub(crate) fn settle(world: &mut World<f64>, id: BodyId) -> Result<StaticReport, StaticError> {
    let settings = QuasiStatic { tolerance: 1e-12, ..QuasiStatic::default() };
    world.settle(id, &settings, &mut Iterative::new(1e-13))
}

/// Displacements from rest.
pub(crate) fn displacements(world: &World<f64>, id: BodyId) -> Vec<Vector> {
    let body = world.body(id);
    body.positions().iter().zip(body.mesh().nodes()).map(|(&x, &rest)| x - rest).collect()
}

/// Fails unless the displacements agree to `tolerance`, relative to the largest.
#[track_caller]
pub(crate) fn assert_displaced(actual: &[Vector], expected: &[Vector], tolerance: f64, what: &str) {
    assert_eq!(actual.len(), expected.len());
    let largest = expected.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let error = actual.iter().zip(expected).map(|(&a, &e)| (a - e).norm()).fold(0.0, f64::max);
    assert!(error <= tolerance * largest, "{what}: off by {:.2e} of the largest displacement", error / largest);
}
