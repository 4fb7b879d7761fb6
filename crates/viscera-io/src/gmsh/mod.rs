//! Gmsh's MSH files: versions 1, 2.0–2.2 and 4.1, as text and (2, 4.1) binary of either byte order.
//!
//! Source: Gmsh reference manual, "MSH file format" and "MSH file format version 1, 2, 4 (Legacy)".
//! Physical groups become named regions: volumes give cells, surfaces give faces, and all give nodes. A group without a
//! name in `$PhysicalNames` is called `physical-N`.

mod nodes;
mod version1;
mod version2;
mod version4;

use crate::assembly::Assembly;
use crate::cursor::Cursor;
use crate::{Imported, ParseError, Problem};

/// How the sections after the header are written.
struct Format {
    version: u32,
    binary: bool,
    /// Bytes of a `size_t` (version 4.1).
    word: usize,
}

/// Reads a MSH file. Coordinates stay in the file's unit.
///
/// # Errors
/// [`ParseError`] with the line (text) or byte (binary) of the first thing that is wrong.
pub fn parse(bytes: &[u8]) -> Result<Imported, ParseError> {
    let mut cursor = Cursor::new(bytes);
    loop {
        match cursor.word("$MeshFormat or $NOD")? {
            "$MeshFormat" => break,
            "$NOD" => return version1::parse(cursor),
            section if section.starts_with('$') => skip_section(&mut cursor, section)?,
            other => return Err(cursor.unexpected("$MeshFormat or $NOD", other)),
        }
    }
    let format = read_format(&mut cursor)?;
    let mut assembly = Assembly::default();
    match format.version {
        2 => version2::parse(cursor, &format, &mut assembly)?,
        _ => version4::parse(cursor, &format, &mut assembly)?,
    }
    assembly.finish()
}

fn read_format(cursor: &mut Cursor) -> Result<Format, ParseError> {
    let mut fields = cursor.fields("the version, file type and data size")?;
    let place = fields.place();
    let version = match fields.word()? {
        "2" | "2.0" | "2.1" | "2.2" => 2,
        "4.1" => 4,
        other => {
            return Err(Problem::Unsupported {
                what: format!("MSH version {}", crate::cursor::excerpt(other.as_bytes())),
                mend: "save the mesh as version 4.1 or 2.2 (in Gmsh: `gmsh in.msh -save -format msh22 -o out.msh`)",
            }
            .at(place));
        }
    };
    let binary = match fields.number::<u8>("0 for text or 1 for binary")? {
        0 => false,
        1 => true,
        other => return Err(cursor.unexpected("0 for text or 1 for binary", &other.to_string())),
    };
    let word = fields.number::<usize>("the data size, 8 or 4")?;
    fields.end()?;
    if word != 8 && !(version == 4 && word == 4) {
        return Err(Problem::Unsupported {
            what: format!("a data size of {word}"),
            mend: "save the mesh from a 64-bit Gmsh, or as text",
        }
        .at(place));
    }
    if binary {
        cursor.binary = true;
        match cursor.binary_i32("the number 1 that tells the byte order")? {
            1 => {}
            0x0100_0000 => cursor.big_endian = true,
            other => return Err(cursor.unexpected("the number 1 that tells the byte order", &other.to_string())),
        }
    }
    cursor.keyword("$EndMeshFormat")?;
    Ok(Format { version, binary, word })
}

/// The name of the next section, or nothing at the end of the file.
fn next_section<'a>(cursor: &mut Cursor<'a>) -> Result<Option<&'a str>, ParseError> {
    cursor.skip_blank();
    if cursor.rest().is_empty() {
        return Ok(None);
    }
    match cursor.word("a section")? {
        section if section.starts_with('$') => Ok(Some(section)),
        other => Err(cursor.unexpected("a section such as $Nodes or $Elements", other)),
    }
}

/// Goes behind the end of a section that holds no mesh.
fn skip_section(cursor: &mut Cursor, section: &str) -> Result<(), ParseError> {
    let end = format!("$End{}", &section[1..]);
    match cursor.skip_past(end.as_bytes()) {
        true => Ok(()),
        false => Err(Problem::Truncated { expected: "the end of a section ($End…)" }.at(cursor.here())),
    }
}

/// `$PhysicalNames`: dimension, tag and quoted name of every group.
fn read_names(cursor: &mut Cursor, assembly: &mut Assembly) -> Result<(), ParseError> {
    let count = cursor.number("the number of physical names")?;
    for _ in 0..cursor.bounded(count, 6, "physical names")? {
        let dimension = cursor.number("the dimension of a physical group")?;
        let tag = cursor.number::<i32>("the tag of a physical group")?.unsigned_abs();
        let line = String::from_utf8_lossy(cursor.line()).into_owned();
        let name =
            line.trim().strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).filter(|name| !name.is_empty());
        match name {
            Some(name) => assembly.name((dimension, tag), name.to_owned()),
            None => return Err(cursor.unexpected("the name of a physical group in quotes", &line)),
        }
    }
    cursor.keyword("$EndPhysicalNames")
}

fn parametric(cursor: &Cursor) -> ParseError {
    Problem::Unsupported {
        what: "a mesh with parametric nodes".to_owned(),
        mend: "save it without them (in Gmsh: Mesh.SaveParametric = 0)",
    }
    .at(cursor.here())
}
