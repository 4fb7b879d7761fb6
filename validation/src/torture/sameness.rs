//! The same motion told differently: in millimetres, turned, renumbered.

use viscera::dynamics::implicit::{Implicit, Newton, Scheme};
use viscera::math::Mat3;
use viscera::mesh::{HexMesh, Mesh, Region, TetMesh, VolumeMesh};
use viscera::solver::Stop;
use viscera::world::{Integrator, World, WorldConfig};

use super::combination::{Combination, Method, Stiffness};
use super::random::Random;
use crate::references::Vector;
use crate::{Size, ValidationError};

/// Length of a step [s], and how many are made.
const STEP: f64 = 0.01;
const STEPS: u32 = 20;
/// How long the bar bends [s].
pub(super) const TIME: f64 = STEP * STEPS as f64;

/// Turns that are tried.
pub(super) fn turns(size: Size) -> usize {
    if size == Size::Full { 12 } else { 2 }
}

/// Largest differences of a motion told differently from the plain one, of the largest displacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Sameness {
    /// The force model of a law on a kind of cells.
    pub combination: Combination,
    /// The integrator.
    pub method: &'static str,
    /// In millimetres.
    pub units: f64,
    /// Turned and shifted, the worst of some; nothing where the law takes turning for strain.
    pub turned: Option<f64>,
    /// Nodes and cells in random order.
    pub renumbered: f64,
    /// The largest displacement, of the size.
    pub displacement: f64,
}

impl Sameness {
    /// What sums in another order may leave, of the largest displacement: a thousand roundings, carried along by some hundred
    /// sub-steps, or by equations that are solved to 1e-11. Fifty were found.
    pub fn tolerance(&self) -> f64 {
        1e-12
    }
}

/// How a scene is told.
struct Telling {
    turn: Mat3<f64>,
    shift: Vector,
    /// Units of length in a metre.
    length: f64,
    /// New numbers of the nodes, and old numbers of the cells.
    order: Option<(Vec<u32>, Vec<u32>)>,
}

impl Telling {
    const PLAIN: Self = Self { turn: Mat3::IDENTITY, shift: Vector::ZERO, length: 1.0, order: None };

    fn place(&self, x: Vector) -> Vector {
        (self.turn * x + self.shift) * self.length
    }

    fn node(&self, old: usize) -> usize {
        self.order.as_ref().map_or(old, |(nodes, _)| nodes[old] as usize)
    }

    fn mesh<const CORNERS: usize, const FACE: usize>(&self, plain: &Mesh<CORNERS, FACE>) -> Mesh<CORNERS, FACE> {
        let mut nodes = vec![Vector::ZERO; plain.nodes.len()];
        for (old, &node) in plain.nodes.iter().enumerate() {
            nodes[self.node(old)] = self.place(node);
        }
        let cell = |old: usize| plain.cells[old].map(|node| self.node(node as usize) as u32);
        let cells = match &self.order {
            Some((_, cells)) => cells.iter().map(|&old| cell(old as usize)).collect(),
            None => (0..plain.cells.len()).map(cell).collect(),
        };
        Mesh::new(nodes, cells)
    }
}

/// The integrators that are compared, solved so far that what is left of equations is below what is compared.
fn methods() -> [(&'static str, Integrator); 3] {
    let linear = Stop::Tolerance { relative: 1e-13, at_most: 1000 };
    let of = |newton| {
        Integrator::Implicit(Implicit { scheme: Scheme::BackwardEuler, newton, linear, ..Implicit::default() })
    };
    [
        ("explicit", Method::EXPLICIT.integrator),
        ("backward Euler, linearised", of(Newton::Linearised)),
        ("backward Euler, full Newton", of(Newton::Full { relative: 1e-11, at_most: 100 })),
    ]
}

/// Tells a bending bar in every way.
pub(super) fn attempt(combination: Combination, size: Size) -> Result<Vec<Sameness>, ValidationError> {
    let mut found = Vec::new();
    for (name, integrator) in methods() {
        let plain = play(combination, integrator, &Telling::PLAIN, size)?;
        let largest = plain.iter().map(|u| u.norm()).fold(0.0, f64::max);
        let differs = |telling: &Telling| -> Result<f64, ValidationError> {
            let told = play(combination, integrator, telling, size)?;
            Ok(plain.iter().zip(&told).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max) / largest)
        };
        let mut random = Random::new(5);
        let units = differs(&Telling { length: 1000.0, ..Telling::PLAIN })?;
        let mut turned = None;
        if combination.claims().objective {
            for _ in 0..turns(size) {
                let telling = Telling { turn: random.rotation(), shift: random.vector(), ..Telling::PLAIN };
                turned = Some(differs(&telling)?.max(turned.unwrap_or(0.0)));
            }
        }
        let mesh = bar(combination, size);
        let order = Some((random.permutation(mesh.nodes().len()), random.permutation(mesh.cell_count())));
        let renumbered = differs(&Telling { order, ..Telling::PLAIN })?;
        let displacement = largest / mesh.size();
        found.push(Sameness { combination, method: name, units, turned, renumbered, displacement });
    }
    Ok(found)
}

fn bar(combination: Combination, size: Size) -> VolumeMesh {
    let across = if size == Size::Full { [2, 2, 6] } else { [1, 1, 3] };
    combination.cells.fill(across, [0.05, 0.05, 0.15])
}

/// Displacements after some bending under its own weight, told back in metres and in the plain pose and order.
fn play(
    combination: Combination,
    integrator: Integrator,
    telling: &Telling,
    size: Size,
) -> Result<Vec<Vector>, ValidationError> {
    let plain = bar(combination, size);
    let mesh: VolumeMesh = match &plain {
        VolumeMesh::Tet(mesh) => TetMesh::into(telling.mesh(mesh)),
        VolumeMesh::Hex(mesh) => HexMesh::into(telling.mesh(mesh)),
    };
    let length = telling.length;
    let stiffness = Stiffness { young: Stiffness::SOFT.young / length, ..Stiffness::SOFT };
    let gravity = (telling.turn * Vector::new(0.0, -9.81, 0.0) * length).to_array();
    let root = Region::plane(
        telling.place(Vector::ZERO).to_array(),
        (telling.turn * Vector::new(0.0, 0.0, 1.0)).to_array(),
        1e-9 * length,
    );
    let body = combination.turned_body(mesh, stiffness, 1000.0 / length.powi(3), &telling.turn)?.damping(3.0).fix(root);
    let mut world = World::<f64>::new(WorldConfig { gravity, step: STEP, integrator })?;
    let id = world.add(body)?;
    for _ in 0..STEPS {
        world.step()?;
    }
    let now = world.body(id).positions();
    let back =
        |old: usize| telling.turn.transpose() * (now[telling.node(old)] / length - telling.shift) - plain.nodes()[old];
    Ok((0..plain.nodes().len()).map(back).collect())
}
