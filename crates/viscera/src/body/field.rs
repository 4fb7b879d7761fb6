//! Force fields: forces per rest volume of tissue, which a cut takes along with its cells.

use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{Point, Region, RegionError, VolumeMesh};

/// The rest volume that each node stands for [m³]: an equal share of every cell around it, as of the mass.
#[derive(Clone, Debug)]
pub(super) struct VolumeShares {
    /// One for each node of the mesh.
    volumes: Vec<f64>,
    /// A cell, its corner, and what of its volume belongs to that.
    corners: Vec<(u32, u32, f64)>,
}

impl VolumeShares {
    /// Shares of the cells of a region.
    pub(super) fn new(region: &Region, mesh: &VolumeMesh) -> Result<Self, RegionError> {
        let mut corners = Vec::new();
        for cell in region.cells(mesh)? {
            let nodes = mesh.cell(cell as usize);
            let volume = match mesh {
                VolumeMesh::Tet(mesh) => mesh.cell_volume(cell as usize),
                VolumeMesh::Hex(mesh) => mesh.cell_volume(cell as usize),
            };
            corners.extend(nodes.iter().map(|&node| (cell, node, volume / nodes.len() as f64)));
        }
        let mut shares = Self { volumes: vec![0.0; mesh.nodes().len()], corners };
        shares.update(&[]);
        Ok(shares)
    }

    /// Leaves out cells that are removed; those beyond the end of the list are there.
    pub(super) fn update(&mut self, removed: &[bool]) {
        self.volumes.fill(0.0);
        for &(cell, node, volume) in &self.corners {
            if !removed.get(cell as usize).copied().unwrap_or(false) {
                self.volumes[node as usize] += volume;
            }
        }
    }

    /// Nodes that stand for anything, and for how much [m³].
    pub(super) fn nodes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.volumes.iter().copied().enumerate().filter(|share| share.1 > 0.0)
    }
}

/// The field of a homogeneous ball that attracts: of strength 1 at its surface, falling by the square of the distance outside
/// and in proportion to it inside.
///
/// Its potential [m] is −R²/r outside and r²/2R − 3R/2 inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    centre: Point,
    /// R [m].
    radius: f64,
}

impl Ball {
    /// A ball around a place [m]; none for a radius that is not positive.
    pub(super) fn new(centre: [f64; 3], radius: f64) -> Option<Self> {
        let centre = Point::from(centre);
        (centre.is_finite() && radius.is_finite() && radius > 0.0).then_some(Self { centre, radius })
    }

    /// The field at `x` [1].
    pub(super) fn field<T: Scalar>(&self, x: Vec3<T>) -> Vec3<f64> {
        let r = x.cast::<f64>() - self.centre;
        -(r * self.per_distance(r.norm()))
    }

    /// Minus its derivative [1/m].
    pub(super) fn stiffness<T: Scalar>(&self, x: Vec3<T>) -> Mat3<f64> {
        let r = x.cast::<f64>() - self.centre;
        let distance = r.norm();
        let even = Mat3::diagonal(self.per_distance(distance));
        if distance <= self.radius {
            return even;
        }
        let along = r / distance;
        even - along.outer(along * (3.0 * self.per_distance(distance)))
    }

    /// Its steepest slope [1/m], just outside.
    pub(super) fn steepest(&self) -> f64 {
        2.0 / self.radius
    }

    fn per_distance(&self, distance: f64) -> f64 {
        let share = self.radius / distance.max(self.radius);
        share * share * share / self.radius
    }
}
