//! What can be typed behind `viscera mesh`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use viscera_scene::file::LengthUnit;

use crate::units::{length, length_unit};

#[derive(Debug, Subcommand)]
pub(crate) enum MeshCommand {
    /// Say what a mesh file holds: cells, size, regions, quality, parts.
    Info(MeshSource),
    /// Check a mesh; ends with exit code 1 when it cannot be simulated.
    Check(MeshSource),
    /// Convert a mesh to VTU or MSH 2.2, chosen by the ending.
    Convert {
        #[command(flatten)]
        source: MeshSource,
        /// Number nodes and cells anew, neighbours near one another, where that is better: meshes whose numbers are all over the body step slower.
        #[arg(long)]
        reorder: bool,
        /// The file to write (.vtu or .msh), in metres.
        out: PathBuf,
    },
    /// Make a mesh from measures.
    Generate {
        #[command(subcommand)]
        shape: ShapeCommand,
        /// The file to write (.vtu or .msh).
        #[arg(long, value_name = "FILE", global = true, default_value = "mesh.msh")]
        out: PathBuf,
    },
    /// Fill a closed surface (STL, OBJ, VTK) with tetrahedra.
    Tetrahedralize {
        #[command(flatten)]
        source: MeshSource,
        /// Edge length of the tetrahedra, such as "8 mm".
        #[arg(long, value_name = "LENGTH", value_parser = length)]
        edge: f64,
        /// The file to write (.vtu or .msh).
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
}

/// A mesh file, and the length of its unit.
#[derive(Debug, Args)]
pub(crate) struct MeshSource {
    /// Gmsh (.msh 1, 2.2, 4.1), VTK (.vtk, .vtu, .vtp), STL or OBJ.
    pub(crate) file: PathBuf,
    /// The unit of its coordinates: m, cm, mm, um or in.
    #[arg(long, default_value = "m", value_parser = length_unit)]
    pub(crate) unit: LengthUnit,
    /// A factor on its coordinates, besides the unit.
    #[arg(long, default_value_t = 1.0)]
    pub(crate) scale: f64,
}

#[derive(Debug, Subcommand)]
pub(crate) enum ShapeCommand {
    /// A box from the origin, with the regions x-min to z-max.
    Box {
        /// Its sides along x, y and z.
        #[arg(long, num_args = 3, value_names = ["X", "Y", "Z"], value_parser = length, required = true)]
        size: Vec<f64>,
        /// How many cubes along each side.
        #[arg(long, num_args = 3, value_names = ["NX", "NY", "NZ"], value_parser = clap::value_parser!(u32).range(1..), required = true)]
        cells: Vec<u32>,
        /// What becomes of a cube.
        #[arg(long, value_enum, default_value_t = CubeParts::Six)]
        cut: CubeParts,
    },
    /// A solid cylinder along z, with the regions bottom, top and side.
    Cylinder {
        #[arg(long, value_parser = length)]
        radius: f64,
        #[arg(long, value_parser = length)]
        height: f64,
        /// Edge length of the tetrahedra, about.
        #[arg(long, value_parser = length)]
        edge: f64,
    },
    /// A tube along z, with the regions bottom, top, inner and outer.
    Tube {
        #[arg(long, value_parser = length)]
        inner_radius: f64,
        #[arg(long, value_parser = length)]
        outer_radius: f64,
        #[arg(long, value_parser = length)]
        height: f64,
        /// Edge length of the tetrahedra, about.
        #[arg(long, value_parser = length)]
        edge: f64,
    },
    /// An organ like a liver, with the regions back, underside, left-lobe, right-lobe and left-lobe-edge.
    Liver {
        /// Length from lobe to lobe.
        #[arg(long, value_parser = length, default_value = "30 cm")]
        length: f64,
        /// Edge length of the tetrahedra, about.
        #[arg(long, value_parser = length, required_unless_present = "cells", conflicts_with = "cells")]
        edge: Option<f64>,
        /// How many tetrahedra, about, in place of the edge.
        #[arg(long)]
        cells: Option<usize>,
    },
    /// A trunk, with the regions abdomen, thorax, diaphragm, pelvis, spine, belly and ribs-1, ribs-2, …
    Trunk {
        /// Height from the pelvis to the shoulders.
        #[arg(long, value_parser = length, default_value = "45 cm")]
        height: f64,
        /// Edge length of the tetrahedra, about.
        #[arg(long, value_parser = length)]
        edge: f64,
    },
}

/// What becomes of a cube of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CubeParts {
    /// Five tetrahedra, mirrored from cube to cube.
    Five,
    /// Six tetrahedra around a diagonal.
    Six,
    /// It stays one hexahedron.
    One,
}
