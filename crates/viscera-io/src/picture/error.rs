//! What makes a picture impossible.

/// Why no picture could be made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The image has no pixels, or more than a picture is for (16 384 a side).
    #[error("a picture of {width}×{height} pixels cannot be drawn; choose 1 to 16384 a side")]
    Size {
        /// Pixels per row asked for.
        width: usize,
        /// Rows asked for.
        height: usize,
    },
    /// Nothing has a finite place: the bodies are empty, or the simulation has diverged.
    #[error("nothing to frame: no node has a finite position; add a body, or check whether the simulation diverged")]
    NothingToFrame,
    /// A camera's bounds, direction or angle is not usable.
    #[error(
        "the camera's {what} is not usable; give finite bounds, a direction that is not zero and not along `up`, and an angle in (0°, 150°]"
    )]
    Camera {
        /// What is wrong with it.
        what: &'static str,
    },
    /// A triangle names a node that the body does not have.
    #[error("body {body}: triangle {triangle} names node {node}, but there are {nodes} nodes")]
    Node {
        /// Which body, in the order they were added.
        body: usize,
        /// Which of its triangles.
        triangle: usize,
        /// The node it names.
        node: u32,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A field, or the cut marks, must hold one value per node (or per triangle).
    #[error("body {body}: {what} has {found} values for {expected}; give one each")]
    Count {
        /// Which body, in the order they were added.
        body: usize,
        /// Which list.
        what: &'static str,
        /// Values needed.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// The image could not be written.
    #[error(
        "{path}: the picture cannot be written: {source}; check that the folder is there, may be written to and has room"
    )]
    Write {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The PNG encoder failed, almost always because its sink did.
    #[error("cannot encode the picture: {0}")]
    Encode(#[from] ::png::EncodingError),
}
