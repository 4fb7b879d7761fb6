/// Why a shape cannot be meshed with the measures given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GenerateError {
    /// A length is zero, negative or not a number.
    #[error("{name} is {value} m; give a positive length")]
    Length {
        /// Which measure, such as "radius".
        name: &'static str,
        /// Its value [m].
        value: f64,
    },
    /// A tube whose wall has no thickness.
    #[error(
        "the inner radius {inner} m is not smaller than the outer radius {outer} m; a tube needs a wall between them"
    )]
    Wall {
        /// Inner radius [m].
        inner: f64,
        /// Outer radius [m].
        outer: f64,
    },
    /// Too few divisions for the shape to close around or to have any cell.
    #[error("{name} is {value}; it must be {least} or more")]
    Divisions {
        /// Which number of divisions, such as "around".
        name: &'static str,
        /// Its value.
        value: usize,
        /// The smallest that works.
        least: usize,
    },
    /// The edge length asks for more cells than node numbers can count and memory can hold.
    #[error("an edge of {edge} m would make about {cells:.1e} cells; choose an edge of {smallest_edge:.2e} m or more")]
    TooFine {
        /// Edge length asked for [m].
        edge: f64,
        /// How many cells that would make, roughly.
        cells: f64,
        /// The smallest edge that is accepted for this shape [m].
        smallest_edge: f64,
    },
    /// The solid is thinner than the lattice everywhere, or its bounds lie beside it.
    #[error("no cell of edge {edge} m lies inside the solid; choose a smaller edge")]
    NothingInside {
        /// Edge length asked for [m].
        edge: f64,
    },
}

impl GenerateError {
    /// Accepts a positive, finite length and refuses any other.
    pub(in crate::mesh) fn check_length(name: &'static str, value: f64) -> Result<(), Self> {
        if value.is_finite() && value > 0.0 { Ok(()) } else { Err(Self::Length { name, value }) }
    }

    /// Accepts `least` divisions or more.
    pub(in crate::mesh) fn check_divisions(name: &'static str, value: usize, least: usize) -> Result<(), Self> {
        if value >= least { Ok(()) } else { Err(Self::Divisions { name, value, least }) }
    }
}
