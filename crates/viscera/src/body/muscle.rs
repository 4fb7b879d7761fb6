use super::BodyError;
use crate::curve::Curve;
use crate::math::{Scalar, Vec3};
use crate::mesh::{Face, Region, RegionError, VolumeMesh};

/// A membrane of muscle in a body or on it: all faces of the mesh whose nodes lie in the region.
///
/// Springs along the edges of its triangles, k_e = Σ_t S A_t/L² (van Gelder 1998, in the plane; Poisson's ratio 1/3), whose rest
/// length is L (1 − c a): held where it is, a sheet whose edges point in all directions alike pulls with 3/2 S c a per metre in
/// every direction. Explicit steps only.
#[derive(Clone, Debug, PartialEq)]
pub struct Muscle {
    /// The nodes.
    pub region: Region,
    /// Stiffness S [N/m, > 0]: Young's modulus times thickness.
    pub stiffness: f64,
    /// c: the share of their length by which the edges shorten at full activation [≥ 0, < 1].
    pub contraction: f64,
    /// a: activation along time [s], from 0 to 1.
    pub activation: Curve<f64>,
}

/// The muscles of a body, their regions resolved.
#[derive(Clone, Debug)]
pub(crate) struct Muscles<T> {
    membranes: Vec<Membrane<T>>,
}

#[derive(Clone, Debug)]
struct Membrane<T> {
    triangles: Vec<Triangle<T>>,
    contraction: f64,
    activation: Curve<f64>,
}

/// A triangle, and the springs along its edges, each opposite to the corner of its number.
#[derive(Clone, Copy, Debug)]
struct Triangle<T> {
    nodes: [u32; 3],
    cells: (u32, Option<u32>),
    /// L [m].
    lengths: [T; 3],
    /// S A/L² [N/m].
    stiffness: [T; 3],
}

impl<T: Scalar> Muscles<T> {
    /// The muscles of a body with these faces, some of which may be halves of quadrilaterals.
    pub(crate) fn new(body: &str, muscles: Vec<Muscle>, mesh: &VolumeMesh, faces: &[Face]) -> Result<Self, BodyError> {
        let membrane = |muscle: Muscle| {
            let out = |name, value, range| Err(BodyError::OutOfRange { body: body.into(), name, value, range });
            let Muscle { region, stiffness, contraction, activation } = muscle;
            if !(stiffness.is_finite() && stiffness > 0.0) {
                return out("muscle stiffness", stiffness, "positive [N/m]");
            }
            if !(0.0..1.0).contains(&contraction) {
                return out("muscle contraction", contraction, "zero or positive, and less than 1");
            }
            if let Some(&(_, value)) = activation.points().iter().find(|(_, value)| !(0.0..=1.0).contains(value)) {
                return out("muscle activation", value, "between 0 and 1");
            }
            let region_error =
                |source| BodyError::Region { body: body.into(), purpose: "a muscle", source: Box::new(source) };
            let mut inside = vec![false; mesh.nodes().len()];
            region.nodes(mesh).map_err(region_error)?.into_iter().for_each(|node| inside[node as usize] = true);
            let own = faces.iter().filter(|face| face.nodes.iter().all(|&node| inside[node as usize]));
            let triangles: Vec<_> = own.map(|face| Triangle::new(face, mesh, stiffness)).collect();
            if triangles.is_empty() {
                return Err(region_error(RegionError::NoFaces { region: region.describe() }));
            }
            Ok(Membrane { triangles, contraction, activation })
        };
        Ok(Self { membranes: muscles.into_iter().map(membrane).collect::<Result<_, _>>()? })
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.membranes.is_empty()
    }

    /// Adds the forces on nodes at `x` [m] at `time` [s] to `out` [N].
    pub(crate) fn add(&self, time: f64, x: &[Vec3<T>], removed: &[bool], out: &mut [Vec3<T>]) {
        for membrane in &self.membranes {
            let rest = T::from_f64(1.0 - membrane.contraction * membrane.activation.at(time));
            for triangle in membrane.triangles.iter().filter(|triangle| triangle.is_there(removed)) {
                for corner in 0..3 {
                    let [a, b] = [1, 2].map(|step| triangle.nodes[(corner + step) % 3] as usize);
                    let along = x[b] - x[a];
                    let length = along.norm();
                    if length > T::ZERO {
                        let stretch = length - triangle.lengths[corner] * rest;
                        let force = along * (triangle.stiffness[corner] * stretch / length);
                        out[a] += force;
                        out[b] += -force;
                    }
                }
            }
        }
    }

    /// What the springs add to the bound of ω² [1/s²], `sums` being nodal memory: twice the stiffness at a node over its mass.
    /// No spring is stiffer in any direction, whatever its stretch and activation.
    pub(crate) fn squared_frequency(&self, masses: &[T], removed: &[bool], sums: &mut [[T; 4]]) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        sums.iter_mut().for_each(|row| row[0] = T::ZERO);
        let triangles = self.membranes.iter().flat_map(|membrane| &membrane.triangles);
        for triangle in triangles.filter(|triangle| triangle.is_there(removed)) {
            for corner in 0..3 {
                for end in [1, 2].map(|step| triangle.nodes[(corner + step) % 3] as usize) {
                    sums[end][0] += triangle.stiffness[corner];
                }
            }
        }
        let of_node = |(row, mass): (&[T; 4], &T)| 2.0 * row[0].to_f64() / mass.to_f64();
        sums.iter().zip(masses).filter(|(row, _)| row[0] > T::ZERO).map(of_node).fold(0.0, f64::max)
    }
}

impl<T: Scalar> Triangle<T> {
    fn new(face: &Face, mesh: &VolumeMesh, stiffness: f64) -> Self {
        let [a, b, c] = face.nodes.map(|node| mesh.nodes()[node as usize]);
        let area = 0.5 * (b - a).cross(c - a).norm();
        let lengths = [c - b, a - c, b - a].map(|edge| edge.norm());
        Self {
            nodes: face.nodes,
            cells: face.cells,
            lengths: lengths.map(T::from_f64),
            stiffness: lengths.map(|length| T::from_f64(stiffness * area / (length * length))),
        }
    }

    /// Whether a cell beside it is left.
    fn is_there(&self, removed: &[bool]) -> bool {
        let there = |cell: u32| !removed[cell as usize];
        there(self.cells.0) || self.cells.1.is_some_and(there)
    }
}
