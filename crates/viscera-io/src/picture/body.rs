//! A body to be drawn: nodes, surface, and how it looks.

use viscera::math::Vec3;

use super::{Colour, Finish, PictureError};

/// A value per node, shown by colour, with its legend.
#[derive(Clone, Debug)]
pub struct Field {
    pub(super) values: Vec<f64>,
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) range: [f64; 2],
}

impl Field {
    /// `values`, one per node, in `unit`; the colours span the finite values.
    pub fn new(name: &str, unit: &str, values: &[f64]) -> Self {
        let finite = values.iter().copied().filter(|v| v.is_finite());
        let range = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        let range = if range[0] <= range[1] { range } else { [0.0, 1.0] };
        Self { values: values.to_vec(), name: name.into(), unit: unit.into(), range }
    }

    /// The values at the ends of the colour map; set them to compare pictures of a series.
    pub fn range(mut self, low: f64, high: f64) -> Self {
        if low.is_finite() && high.is_finite() {
            self.range = [low, high];
        }
        self
    }

    /// Place of `value` in the range, 0..1.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        let span = self.range[1] - self.range[0];
        if span != 0.0 { (value - self.range[0]) / span } else { value * 0.0 + 0.5 }
    }
}

/// A surface with a look.
#[derive(Clone, Debug)]
pub struct Body {
    pub(super) nodes: Vec<Vec3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) colour: Colour,
    pub(super) finish: Finish,
    pub(super) field: Option<Field>,
    pub(super) cut: Vec<bool>,
    pub(super) fixed: Vec<u32>,
    pub(super) wireframe: bool,
    pub(super) ghost: bool,
    pub(super) crease: f64,
}

impl Body {
    /// The surface `triangles` (counter-clockwise seen from outside) over `nodes` \[m\]. Inner nodes may be among them.
    pub fn new(nodes: &[Vec3<f64>], triangles: &[[u32; 3]]) -> Self {
        Self {
            nodes: nodes.to_vec(),
            triangles: triangles.to_vec(),
            colour: Colour::PLAIN,
            finish: Finish::Matte,
            field: None,
            cut: Vec::new(),
            fixed: Vec::new(),
            wireframe: false,
            ghost: false,
            crease: 40.0,
        }
    }

    /// The base colour.
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = colour;
        self
    }
    /// How the surface answers light; matte unless said.
    pub fn finish(mut self, finish: Finish) -> Self {
        self.finish = finish;
        self
    }
    /// Liver: red-brown and wet, and smooth up to 65°, so that a coarse mesh still looks grown.
    pub fn tissue(self) -> Self {
        self.colour(Colour::LIVER).finish(Finish::Wet).crease(65.0)
    }
    /// Colours by a value per node, with a legend. Drawn matte, so that the colours can be read.
    pub fn field(mut self, field: Field) -> Self {
        self.finish = Finish::Matte;
        self.field = Some(field);
        self
    }
    /// Marks the triangles that a cut has laid bare, one flag per triangle: they are drawn raw-red.
    pub fn cut(mut self, bare: &[bool]) -> Self {
        self.cut = bare.to_vec();
        self
    }
    /// Marks nodes that are held, by small dots.
    pub fn fixed(mut self, nodes: &[u32]) -> Self {
        self.fixed = nodes.to_vec();
        self
    }
    /// Draws the edges of the surface that can be seen.
    pub fn wireframe(mut self) -> Self {
        self.wireframe = true;
        self
    }
    /// Draws it translucent, as a rest shape behind a deformed one; it casts no shadow.
    pub fn ghost(mut self) -> Self {
        self.ghost = true;
        self
    }
    /// Edges sharper than this angle (degrees, default 40) stay sharp, flatter ones are smoothed.
    pub fn crease(mut self, degrees: f64) -> Self {
        self.crease = degrees;
        self
    }

    pub(super) fn check(&self, body: usize) -> Result<(), PictureError> {
        let nodes = self.nodes.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&node) = corners.iter().find(|&&node| node as usize >= nodes) {
                return Err(PictureError::Node { body, triangle, node, nodes });
            }
        }
        let count = |what, expected, found| match found == expected {
            true => Ok(()),
            false => Err(PictureError::Count { body, what, expected, found }),
        };
        if let Some(field) = &self.field {
            count("the field", nodes, field.values.len())?;
        }
        if !self.cut.is_empty() {
            count("the list of cut triangles", self.triangles.len(), self.cut.len())?;
        }
        Ok(())
    }
}
