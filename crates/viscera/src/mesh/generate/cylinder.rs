use std::f64::consts::TAU;

use super::super::TetMesh;
use super::GenerateError;
use super::extrusion::FlatMesh;

impl TetMesh {
    /// A solid cylinder of the given `radius` and `height` [m] around the z axis, its base centred on the origin.
    ///
    /// The discs are `rings` rings of near-equilateral triangles, ring `r` with 6 `r` nodes, so the edges are about
    /// `radius / rings` long; along the axis there are `layers`. A node lies exactly on the axis at every layer, node 0
    /// at the centre of the base and `layers * (1 + 3 rings (rings + 1))` at the centre of the top. Regions: "bottom",
    /// "top", "side". The volume is that of the prism over the inscribed polygon with 6 `rings` corners.
    ///
    /// # Errors
    /// [`GenerateError::Length`] for a radius or height that is not positive, [`GenerateError::Divisions`] for no ring
    /// or no layer.
    ///
    /// ```
    /// # use viscera::mesh::TetMesh;
    /// let mesh = TetMesh::cylinder(0.01, 0.1, 3, 20)?;
    /// assert_eq!(mesh.nodes[20 * 37].to_array(), [0.0, 0.0, 0.1]);
    /// # Ok::<(), viscera::mesh::GenerateError>(())
    /// ```
    pub fn cylinder(radius: f64, height: f64, rings: usize, layers: usize) -> Result<Self, GenerateError> {
        GenerateError::check_length("radius", radius)?;
        GenerateError::check_length("height", height)?;
        GenerateError::check_divisions("rings", rings, 1)?;
        GenerateError::check_divisions("layers", layers, 1)?;

        let disc = disc(radius, rings);
        let per_layer = disc.nodes.len() as u32;
        let first_outer = ring_start(rings);
        let mut mesh = disc.extrude(height, layers);
        mesh.name_sides(&[
            ("bottom", &|node| node < per_layer),
            ("top", &|node| node >= layers as u32 * per_layer),
            ("side", &|node| node % per_layer >= first_outer),
        ]);
        Ok(mesh)
    }
}

/// Number of the first node of a ring: the centre and the 6, 12, … nodes of the rings inside it come before.
fn ring_start(ring: usize) -> u32 {
    if ring == 0 { 0 } else { 1 + 3 * (ring * (ring - 1)) as u32 }
}

/// A disc as six sectors of triangles, each ring rounded from a hexagon to a circle.
fn disc(radius: f64, rings: usize) -> FlatMesh {
    let mut nodes = vec![[0.0, 0.0]];
    let mut triangles = Vec::with_capacity(6 * rings * rings);
    for ring in 1..=rings {
        let r = radius * ring as f64 / rings as f64;
        let around = 6 * ring;
        nodes.extend((0..around).map(|step| {
            let (sin, cos) = (TAU * step as f64 / around as f64).sin_cos();
            [r * cos, r * sin]
        }));
        let outer = |step: usize| ring_start(ring) + (step % around) as u32;
        let inner = |step: usize| ring_start(ring - 1) + if ring == 1 { 0 } else { (step % (around - 6)) as u32 };
        for sector in 0..6 {
            for step in 0..ring {
                let (far, near) = (sector * ring + step, sector * (ring - 1) + step);
                triangles.push([inner(near), outer(far), outer(far + 1)]);
                if step + 1 < ring {
                    triangles.push([inner(near), outer(far + 1), inner(near + 1)]);
                }
            }
        }
    }
    FlatMesh { nodes, triangles }
}
