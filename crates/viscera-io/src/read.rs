use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use viscera::mesh::{MeshReport, VolumeMesh};

use crate::cursor::excerpt;
use crate::{Imported, ImportedMesh, Notice, ParseError, ReadError, gmsh, obj, stl, vtk, vtu};

/// A volume that was read and has passed the check on the way in.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedVolume {
    /// The mesh [m].
    pub mesh: VolumeMesh,
    /// What of the file is not in the mesh, or is there in another form.
    pub notices: Vec<Notice>,
    /// What the check found and repaired.
    pub report: MeshReport,
}

/// Reads a mesh: Gmsh (MSH 1, 2.2, 4.1), VTK (.vtk, .vtu, .vtp), STL or OBJ, told by content first, by extension second.
///
/// `scale` is the length of the file's unit [m], 0.001 for a file in mm; positive.
///
/// # Errors
/// [`ReadError`], with the path, the place in the file and how to mend it.
pub fn read_mesh(path: impl AsRef<Path>, scale: f64) -> Result<Imported, ReadError> {
    let path = path.as_ref();
    if !(scale.is_finite() && scale > 0.0) {
        return Err(ReadError::Scale { scale });
    }
    let bytes = fs::read(path).map_err(|source| match source.kind() {
        ErrorKind::NotFound => ReadError::NoSuchFile { path: path.to_owned() },
        _ => ReadError::Unreadable { path: path.to_owned(), source },
    })?;
    read_mesh_bytes(path, &bytes, scale)
}

/// The same for a file whose bytes are at hand; `path` is what messages call it, and its extension tells the format where the
/// content does not.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_bytes(path: impl AsRef<Path>, bytes: &[u8], scale: f64) -> Result<Imported, ReadError> {
    let path = path.as_ref();
    if !(scale.is_finite() && scale > 0.0) {
        return Err(ReadError::Scale { scale });
    }
    let parse = parser_of_content(bytes)
        .or_else(|| parser_of_extension(path))
        .ok_or_else(|| ReadError::UnknownFormat { path: path.to_owned(), start: excerpt(bytes) })?;
    let mut imported = parse(bytes).map_err(|source| ReadError::Content { path: path.to_owned(), source })?;
    imported.mesh.scale(scale);
    Ok(imported)
}

/// Reads a mesh that must be a volume, and checks it.
///
/// # Errors
/// As [`read_mesh`]; [`ReadError::SurfaceOnly`] for a surface; [`ReadError::Mesh`] for a mesh that fails the check.
pub fn read_volume(path: impl AsRef<Path>, scale: f64) -> Result<ImportedVolume, ReadError> {
    let path = path.as_ref();
    checked_volume(path, read_mesh(path, scale)?)
}

/// The same for a file whose bytes are at hand, see [`read_mesh_bytes`].
///
/// # Errors
/// As [`read_volume`].
pub fn read_volume_bytes(path: impl AsRef<Path>, bytes: &[u8], scale: f64) -> Result<ImportedVolume, ReadError> {
    let path = path.as_ref();
    checked_volume(path, read_mesh_bytes(path, bytes, scale)?)
}

fn checked_volume(path: &Path, Imported { mesh, notices }: Imported) -> Result<ImportedVolume, ReadError> {
    let checked = match mesh {
        ImportedMesh::Tet(mesh) => mesh.checked().map(|(mesh, report)| (VolumeMesh::Tet(mesh), report)),
        ImportedMesh::Hex(mesh) => mesh.checked().map(|(mesh, report)| (VolumeMesh::Hex(mesh), report)),
        ImportedMesh::Surface(mesh) => {
            return Err(ReadError::SurfaceOnly { path: path.to_owned(), triangles: mesh.triangles.len() });
        }
    };
    let (mesh, report) = checked.map_err(|source| ReadError::Mesh { path: path.to_owned(), source })?;
    Ok(ImportedVolume { mesh, notices, report })
}

type Parser = fn(&[u8]) -> Result<Imported, ParseError>;

fn parser_of_content(bytes: &[u8]) -> Option<Parser> {
    let start = bytes.trim_ascii_start();
    if stl::has_binary_length(bytes) {
        Some(stl::parse)
    } else if start.starts_with(b"$") {
        Some(gmsh::parse)
    } else if start.starts_with(b"# vtk DataFile") {
        Some(vtk::parse)
    } else if start.starts_with(b"<?xml") || start.starts_with(b"<VTKFile") {
        Some(vtu::parse)
    } else if start.starts_with(b"solid") {
        Some(stl::parse)
    } else if looks_like_obj(bytes) {
        Some(obj::parse)
    } else {
        None
    }
}

/// OBJ has no mark of its own: its first statement is one of a few words.
fn looks_like_obj(bytes: &[u8]) -> bool {
    let first = bytes
        .split(|&byte| byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"));
    let word = first.and_then(|line| line.split(u8::is_ascii_whitespace).next());
    matches!(word, Some(b"v" | b"vn" | b"vt" | b"o" | b"g" | b"s" | b"mtllib"))
}

fn parser_of_extension(path: &Path) -> Option<Parser> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "msh" => Some(gmsh::parse),
        "vtk" => Some(vtk::parse),
        "vtu" | "vtp" => Some(vtu::parse),
        "stl" => Some(stl::parse),
        "obj" => Some(obj::parse),
        _ => None,
    }
}
