//! The same motion, told differently: turned, renumbered, or in millimetres.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::instrument::{Cautery, Grasper, Path};
use viscera::material::{Fibre, Lame, StVenantKirchhoff, Tissue, TransverseStVenantKirchhoff};
use viscera::math::Mat3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Precision, TensorMass};
use viscera::world::{World, WorldConfig};

use crate::support::{Vector, in_both_precisions};

/// How a scene is told.
#[derive(Clone)]
struct Telling {
    turn: Mat3<f64>,
    shift: Vector,
    /// Units of length in a metre.
    length: f64,
    /// New number of each node and, in order, the old number of each cell.
    renumbered: bool,
}

impl Telling {
    const PLAIN: Self = Self { turn: Mat3::IDENTITY, shift: Vector::ZERO, length: 1.0, renumbered: false };

    fn place(&self, x: Vector) -> Vector {
        (self.turn * x + self.shift) * self.length
    }

    fn direction(&self, v: Vector) -> Vector {
        self.turn * v * self.length
    }

    fn path(&self, points: &[(f64, [f64; 3])]) -> Path {
        let told = points.iter().map(|&(time, place)| (time, self.place(place.into())));
        Curve::piecewise_linear(told.collect()).unwrap()
    }

    fn node(&self, old: usize, nodes: usize) -> usize {
        // 37 has no factor in common with the number of nodes, 81.
        if self.renumbered { (old * 37 + 5) % nodes } else { old }
    }

    fn mesh(&self) -> TetMesh {
        let plain = TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]);
        let count = plain.nodes.len();
        let mut nodes = vec![Vector::ZERO; count];
        for (old, &node) in plain.nodes.iter().enumerate() {
            nodes[self.node(old, count)] = self.place(node);
        }
        let mut cells: Vec<[u32; 4]> =
            plain.cells.iter().map(|cell| cell.map(|node| self.node(node as usize, count) as u32)).collect();
        if self.renumbered {
            cells.reverse();
            cells.iter_mut().step_by(3).for_each(|cell| cell[..3].rotate_left(1));
        }
        TetMesh::new(nodes, cells)
    }
}

/// Displacements after 50 steps of an operation with gravity, fibres, pressure, a grasper and a cautery, in metres, in the
/// plain order and pose; and how many cells are left.
fn play<T: Precision>(telling: &Telling) -> (Vec<Vector>, usize) {
    // Pa = kg/(m s²), kg/m³
    let (pascal, density) = (1.0 / telling.length, 1000.0 / telling.length.powi(3));
    let gravity = telling.direction(Vector::new(0.0, -9.81, 0.0)).to_array();
    let mut world = World::<T>::new(WorldConfig { gravity, ..WorldConfig::default() }).unwrap();
    let lame = Lame::from_young_poisson(5e3 * pascal, 0.4).unwrap();
    let fibre = Fibre { direction: telling.turn * Vector::new(0.6, 0.0, 0.8), stiffness: 4e3 * pascal };
    let law = TransverseStVenantKirchhoff { matrix: StVenantKirchhoff::new(lame), fibre };
    let at = |place: [f64; 3]| telling.place(place.into()).to_array();
    let sphere = |place, radius: f64| Region::sphere(at(place), radius * telling.length);
    let bottom = Region::plane(at([0.0; 3]), (telling.turn * Vector::new(0.0, 0.0, 1.0)).to_array(), 0.0);
    let body = Body::new(telling.mesh(), density)
        .model(TensorMass::new(Tissue::uniform(law)))
        .keep_volume(1e4 * pascal)
        .damping(3.0)
        .fix(bottom)
        .load(Load::Pressure { region: sphere([0.0, 0.02, 0.08], 0.045), pressure: Curve::constant(60.0 * pascal) });
    let id = world.add(body).unwrap();
    let tip = [0.02, 0.02, 0.16];
    let path = telling.path(&[(0.02, tip), (0.2, [0.02, 0.035, 0.17])]);
    let radius = 0.023 * telling.length;
    world.add_instrument(Grasper { path, radius, close: 0.02, open: None, ..Grasper::default() }).unwrap();
    let path = telling.path(&[(0.05, [-0.02, 0.033, 0.11]), (0.2, [0.06, 0.033, 0.13])]);
    world
        .add_instrument(Cautery { path, radius: 0.006 * telling.length, on: (0.05, 0.2), ..Cautery::default() })
        .unwrap();
    for _ in 0..50 {
        world.step().unwrap();
    }
    let (body, plain) = (world.body(id), Telling::PLAIN.mesh());
    let count = plain.nodes.len();
    let displacement = |old: usize| {
        let now: Vector = body.positions()[telling.node(old, count)].cast();
        telling.turn.transpose() * (now / telling.length - telling.shift) - plain.nodes[old]
    };
    ((0..count).map(displacement).collect(), body.cell_count())
}

fn assert_same_motion<T: Precision>(telling: &Telling, tolerance: f64) {
    let ((plain, plain_cells), (told, told_cells)) = (play::<T>(&Telling::PLAIN), play::<T>(telling));
    assert!(plain_cells < 192, "the cautery must have cut");
    assert_eq!(plain_cells, told_cells);
    let largest = plain.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let error = plain.iter().zip(&told).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max) / largest;
    assert!(error < tolerance, "displacements differ by {error:.2e} of the largest, {largest:.3} m");
}

/// A turned and shifted scene moves alike, turned and shifted.
fn pose_does_not_matter<T: Precision>(tolerance: f64) {
    let axis = Vector::new(2.0, -1.0, 2.0) / 3.0;
    let (sin, cos) = 1.1_f64.sin_cos();
    let column = |e: Vector| e * cos + axis.cross(e) * sin + axis * (axis.dot(e) * (1.0 - cos));
    let [x, y, z] = Mat3::IDENTITY.columns;
    let turn = Mat3::from_columns(column(x), column(y), column(z));
    assert_same_motion::<T>(&Telling { turn, shift: Vector::new(1.0, -2.0, 0.5), ..Telling::PLAIN }, tolerance);
}
in_both_precisions!(pose_does_not_matter, f32: 2e-3, f64: 1e-9);

/// The numbers of nodes and cells are names only; sums are made in another order.
fn numbering_does_not_matter<T: Precision>(tolerance: f64) {
    assert_same_motion::<T>(&Telling { renumbered: true, ..Telling::PLAIN }, tolerance);
}
in_both_precisions!(numbering_does_not_matter, f32: 2e-3, f64: 1e-9);

/// Millimetres, kilograms and seconds tell the same motion: no length, mass or force is written into the code.
fn units_do_not_matter<T: Precision>(tolerance: f64) {
    assert_same_motion::<T>(&Telling { length: 1000.0, ..Telling::PLAIN }, tolerance);
}
in_both_precisions!(units_do_not_matter, f32: 2e-3, f64: 1e-9);
