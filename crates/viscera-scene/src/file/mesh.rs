use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::{Angle, Length};

/// Where a body's mesh comes from: a `file` with a volume mesh, a closed `surface` that is filled with tetrahedra, or a
/// shape to `generate`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "mesh")]
pub enum MeshFile {
    /// A volume mesh.
    #[serde(rename_all = "kebab-case")]
    File(VolumeFile),
    /// A closed surface, filled with tetrahedra.
    Surface(SurfaceFile),
    /// A shape made from its measures.
    Generate(GenerateFile),
}

/// A volume mesh from a file.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "mesh from a file")]
pub struct VolumeFile {
    /// Mesh of tetrahedra or hexahedra (Gmsh, VTK, VTU), from the scene file's folder.
    pub file: PathBuf,
    /// Unit in which the file gives its coordinates; by default metres.
    #[serde(default)]
    pub unit: LengthUnit,
    /// Factor on the coordinates, besides the unit.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
}

/// A closed surface from a file.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "mesh from a surface")]
pub struct SurfaceFile {
    /// Closed surface (STL, OBJ, VTK), from the scene file's folder.
    pub surface: PathBuf,
    /// Edge length of the tetrahedra [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub edge: Length,
    /// Unit in which the file gives its coordinates; by default metres.
    #[serde(default)]
    pub unit: LengthUnit,
    /// Factor on the coordinates, besides the unit.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

/// The unit of a file's coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
pub enum LengthUnit {
    /// Metres.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetres, as in most medical images.
    #[serde(rename = "mm")]
    Millimetre,
    /// Micrometres.
    #[serde(rename = "um")]
    Micrometre,
    /// International inches of 25.4 mm.
    #[serde(rename = "in")]
    Inch,
}

impl LengthUnit {
    /// Factor to metres.
    pub fn in_metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 1e-2,
            Self::Millimetre => 1e-3,
            Self::Micrometre => 1e-6,
            Self::Inch => 0.0254,
        }
    }
}

/// A shape made from its measures.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "generate", rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(title = "generated mesh")]
pub enum GenerateFile {
    /// A box from the origin, with the groups "x-min", "x-max", … "z-max".
    Box {
        /// Lengths of its sides [m].
        size: [Length; 3],
        /// How many cubes along each side.
        #[schemars(inner(range(min = 1)))]
        cells: [u32; 3],
        /// "tetrahedra" (the default) or "hexahedra".
        #[serde(default)]
        shape: CellShape,
        /// Into how many tetrahedra a cube is cut: "five" or "six" (the default).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        cut: Option<CutFile>,
    },
    /// A solid cylinder that stands on the origin along z, with the groups "bottom", "top", "side". A node lies at the
    /// centre of its top.
    Cylinder {
        /// Radius [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// Height [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        height: Length,
        /// Edge length of the tetrahedra [m], about.
        #[schemars(extend("exclusiveMinimum" = 0))]
        edge: Length,
    },
    /// A tube that stands on the origin along z, with the groups "bottom", "top", "inner", "outer".
    #[serde(rename_all = "kebab-case")]
    Tube {
        /// Radius of the hollow [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        inner_radius: Length,
        /// Radius of the outside [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        outer_radius: Length,
        /// Height [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        height: Length,
        /// Edge length of the tetrahedra [m], about.
        #[schemars(extend("exclusiveMinimum" = 0))]
        edge: Length,
    },
    /// An organ like a liver with two lobes, around the origin: x along its length (right lobe at negative x), y up, z front.
    Liver {
        /// Length from lobe to lobe [m]; an adult's is about 30 cm.
        #[schemars(extend("exclusiveMinimum" = 0))]
        length: Length,
        /// Edge length of the tetrahedra [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        edge: Length,
    },
    /// An upright trunk, a cylinder of elliptic cross-section that stands on the origin along z, the front at positive y; with the
    /// groups of cells "abdomen" and "thorax", and of nodes "diaphragm" (the dome between them), "pelvis", "spine", "belly",
    /// "ribs-1", "ribs-2" and so on.
    Trunk {
        /// Height from the pelvis to the shoulders [m]; an adult's is about 45 cm.
        #[schemars(extend("exclusiveMinimum" = 0))]
        height: Length,
        /// Edge length of the tetrahedra [m], about.
        #[schemars(extend("exclusiveMinimum" = 0))]
        edge: Length,
    },
}

/// The shape of a box's cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CellShape {
    /// Four corners.
    #[default]
    Tetrahedra,
    /// Eight corners.
    Hexahedra,
}

/// Into how many tetrahedra a cube is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CutFile {
    /// Five, mirrored from cube to cube.
    Five,
    /// Six around one diagonal.
    Six,
}

/// Where a body stands: it is turned about the origin first, then moved.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "place")]
pub struct PlaceFile {
    /// How far it is moved [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translate: Option<[Length; 3]>,
    /// How it is turned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotate: Option<RotateFile>,
}

/// A turn about an axis through the origin, by the right-hand rule.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "rotation")]
pub struct RotateFile {
    /// The axis; any length.
    pub axis: [f64; 3],
    /// The angle [rad].
    pub angle: Angle,
}
