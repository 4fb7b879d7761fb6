use std::f64::consts::TAU;

use super::super::TetMesh;
use super::GenerateError;
use super::extrusion::FlatMesh;

/// Into how many pieces a tube is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TubeDivisions {
    /// Around the axis, 3 or more.
    pub around: usize,
    /// Through the wall, 1 or more.
    pub wall: usize,
    /// Along the axis, 1 or more.
    pub along: usize,
}

impl TetMesh {
    /// A tube between two radii, of the given `height` [m], around the z axis, its base in the plane z = 0.
    ///
    /// Node `(layer * (wall + 1) + shell) * around + step` lies at angle 2π `step / around`, on shell 0 inside to `wall`
    /// outside. Regions: "bottom", "top", "inner", "outer".
    ///
    /// # Errors
    /// [`GenerateError::Length`] for a length that is not positive, [`GenerateError::Wall`] where the inner radius is not
    /// the smaller one, [`GenerateError::Divisions`] for too few divisions.
    pub fn tube(
        inner_radius: f64,
        outer_radius: f64,
        height: f64,
        divisions: TubeDivisions,
    ) -> Result<Self, GenerateError> {
        let TubeDivisions { around, wall, along } = divisions;
        GenerateError::check_length("inner radius", inner_radius)?;
        GenerateError::check_length("outer radius", outer_radius)?;
        GenerateError::check_length("height", height)?;
        if inner_radius >= outer_radius {
            return Err(GenerateError::Wall { inner: inner_radius, outer: outer_radius });
        }
        GenerateError::check_divisions("around", around, 3)?;
        GenerateError::check_divisions("wall", wall, 1)?;
        GenerateError::check_divisions("along", along, 1)?;

        let annulus = annulus(inner_radius, outer_radius, around, wall);
        let per_layer = annulus.nodes.len() as u32;
        let (inner_end, outer_start) = (around as u32, (wall * around) as u32);
        let mut mesh = annulus.extrude(height, along);
        mesh.name_sides(&[
            ("bottom", &|node| node < per_layer),
            ("top", &|node| node >= along as u32 * per_layer),
            ("inner", &|node| node % per_layer < inner_end),
            ("outer", &|node| node % per_layer >= outer_start),
        ]);
        Ok(mesh)
    }
}

/// The cross-section: quadrilaterals between two circles, the diagonals of neighbours crossing like a herringbone.
fn annulus(inner: f64, outer: f64, around: usize, wall: usize) -> FlatMesh {
    let mut nodes = Vec::with_capacity(around * (wall + 1));
    for shell in 0..=wall {
        let r = inner + (outer - inner) * shell as f64 / wall as f64;
        nodes.extend((0..around).map(|step| {
            let (sin, cos) = (TAU * step as f64 / around as f64).sin_cos();
            [r * cos, r * sin]
        }));
    }
    let mut triangles = Vec::with_capacity(2 * around * wall);
    for shell in 0..wall {
        for step in 0..around {
            let node = |shell: usize, step: usize| (shell * around + step % around) as u32;
            let (a, b) = (node(shell, step), node(shell, step + 1));
            let (c, d) = (node(shell + 1, step + 1), node(shell + 1, step));
            let halves = if (shell + step) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            triangles.extend(halves);
        }
    }
    FlatMesh { nodes, triangles }
}
