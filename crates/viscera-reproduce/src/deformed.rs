//! Tissue out of shape: its volume, and how it looks.

use viscera::math::{Mat3, Vec3};
use viscera::mesh::TetMesh;
use viscera_io::picture::{Body, Camera, Colour, Field, Picture, PictureError};

use crate::section::Photograph;

pub(crate) type Vector = Vec3<f64>;

/// Size of a picture in the report, in pixels.
const PIXELS: [usize; 2] = [720, 480];

/// A mesh whose nodes are elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct Deformed {
    mesh: TetMesh,
    places: Vec<Vector>,
}

impl Deformed {
    /// The mesh with its nodes displaced [m].
    pub(crate) fn new(mesh: &TetMesh, displacements: &[Vector]) -> Self {
        let places = mesh.nodes.iter().zip(displacements).map(|(&rest, &u)| rest + u).collect();
        Self { mesh: mesh.clone(), places }
    }

    /// Places of the nodes [m].
    pub(crate) fn places(&self) -> &[Vector] {
        &self.places
    }

    fn volume_of(&self, cell: usize) -> f64 {
        let [a, b, c, d] = self.mesh.cells[cell].map(|node| self.places[node as usize]);
        Mat3::from_columns(b - a, c - a, d - a).determinant() / 6.0
    }

    /// (V − V0)/V0.
    pub(crate) fn volume_variation(&self) -> f64 {
        self.volume_variation_above(f64::NEG_INFINITY)
    }

    /// The same of the cells whose corners all rest at this height or above [m].
    pub(crate) fn volume_variation_above(&self, height: f64) -> f64 {
        let is_above = |cell: &usize| self.mesh.corners(*cell).iter().all(|corner| corner.z >= height);
        let volumes =
            (0..self.mesh.cells.len()).filter(is_above).map(|cell| [self.volume_of(cell), self.mesh.cell_volume(cell)]);
        let [now, rest] = volumes.fold([0.0; 2], |sum, volumes| [sum[0] + volumes[0], sum[1] + volumes[1]]);
        now / rest - 1.0
    }

    /// Change of volume around each node [%].
    fn swelling(&self) -> Vec<f64> {
        let mut volumes = vec![[0.0; 2]; self.places.len()];
        for (cell, corners) in self.mesh.cells.iter().enumerate() {
            for &node in corners {
                volumes[node as usize][0] += self.volume_of(cell);
                volumes[node as usize][1] += self.mesh.cell_volume(cell);
            }
        }
        volumes.into_iter().map(|[now, rest]| 100.0 * (now / rest - 1.0)).collect()
    }

    /// The same shape elsewhere, to stand beside others.
    pub(crate) fn shifted(mut self, by: Vector) -> Self {
        for place in self.mesh.nodes.iter_mut().chain(&mut self.places) {
            *place += by;
        }
        self
    }

    /// How it looks, with its edges.
    pub(crate) fn body(&self) -> Body {
        Body::new(&self.places, &self.mesh.surface().triangles).wireframe()
    }

    /// The same, coloured by the change of volume from `-percent` to `percent`.
    pub(crate) fn body_by_swelling(&self, percent: f64) -> Body {
        self.body().field(Field::new("change of volume", "%", &self.swelling()).range(-percent, percent))
    }

    /// The same, coloured by how far each node is from where it is in another shape [mm], up to `most`.
    pub(crate) fn body_by_distance(&self, other: &Self, name: &str, most: f64) -> Body {
        let apart: Vec<f64> = self.places.iter().zip(&other.places).map(|(&a, &b)| 1e3 * (a - b).norm()).collect();
        self.body().field(Field::new(name, "mm", &apart).range(0.0, most))
    }

    /// The shape at rest, translucent.
    pub(crate) fn ghost(&self) -> Body {
        Body::new(&self.mesh.nodes, &self.mesh.surface().triangles).colour(Colour::PLAIN).ghost()
    }

    /// Lowest and highest coordinates, at rest and now.
    pub(crate) fn bounds(&self) -> (Vector, Vector) {
        let all = self.mesh.nodes.iter().chain(&self.places);
        let start = (Vector::splat(f64::INFINITY), Vector::splat(f64::NEG_INFINITY));
        all.fold(start, |(low, high), &place| (low.min(place), high.max(place)))
    }
}

/// A camera that sees all of these, looking along `look` with `up` upwards.
pub(crate) fn camera<'a>(shapes: impl IntoIterator<Item = &'a Deformed>, look: [f64; 3], up: [f64; 3]) -> Camera {
    let all = shapes.into_iter().map(Deformed::bounds);
    let bounds = all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
    let (low, high) = bounds.unwrap_or((Vector::ZERO, Vector::splat(1.0)));
    Camera::framing(low, high).towards(look).up(up)
}

/// A picture of bodies.
pub(crate) fn photograph(
    name: impl Into<String>,
    caption: impl Into<String>,
    camera: Camera,
    bodies: impl IntoIterator<Item = Body>,
) -> Result<Photograph, PictureError> {
    let empty = Picture::new(PIXELS[0], PIXELS[1]).camera(camera);
    let image = bodies.into_iter().fold(empty, Picture::body).render()?;
    Ok(Photograph { name: name.into(), caption: caption.into(), image })
}
