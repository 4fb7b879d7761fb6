//! Pictures without a display: bodies, instruments and loads, drawn by software into a PNG.
//!
//! A [`Picture`] collects what is to be seen, a [`Camera`] says from where, and [`Picture::render`] gives an [`Image`].
//! Positions are metres. The same input gives the same bytes. Visibility is sampled 4×4 times per pixel; what is seen
//! is shaded in linear light and written as sRGB.
//!
//! ```
//! use viscera::mesh::TetMesh;
//! use viscera_io::picture::{Body, Picture};
//!
//! let beam = TetMesh::box_grid([2, 2, 8], [0.1, 0.1, 0.4]).surface();
//! let image = Picture::new(160, 90).body(Body::new(&beam.nodes, &beam.triangles).wireframe()).render()?;
//! let mut bytes = Vec::new();
//! image.write_png(&mut bytes)?;
//! # Ok::<(), viscera_io::picture::PictureError>(())
//! ```

mod annotation;
mod body;
mod camera;
mod colour;
mod error;
mod facet;
mod ground;
mod normals;
mod occlusion;
mod png;
mod raster;
mod render;
mod scene;
mod shade;
mod solid;

pub use annotation::legend_labels;
pub use body::{Body, Field};
pub use camera::Camera;
pub use colour::{Colour, viridis};
pub use error::PictureError;
pub use png::Image;
pub use scene::Picture;
pub use shade::Finish;
pub use solid::{Solid, Tool};
