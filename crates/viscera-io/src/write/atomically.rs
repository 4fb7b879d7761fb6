use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::WriteError;

/// Writes a file aside, in the same folder, and renames it when all of it is on the disk.
///
/// Whoever reads `path` meanwhile sees the old file or the new one. When `fill` fails, what was written is removed, and the
/// file that was there stays.
///
/// # Errors
/// [`WriteError::Unwritable`] with what `fill` or the system says.
pub fn write_atomically(
    path: impl AsRef<Path>,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    let aside = name_aside(path);
    let written = fill_aside(&aside, fill).and_then(|()| fs::rename(&aside, path));
    written.map_err(|source| {
        // It may never have been made; what matters is the first error.
        let _ = fs::remove_file(&aside);
        WriteError::Unwritable { path: path.to_owned(), source }
    })
}

fn fill_aside(aside: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(OpenOptions::new().write(true).create_new(true).open(aside)?);
    fill(&mut writer)?;
    writer.flush()?;
    writer.get_ref().sync_all()
}

/// A name that no other writer has: of this process by a count, of another by the number of the process.
fn name_aside(path: &Path) -> PathBuf {
    static WRITTEN: AtomicU64 = AtomicU64::new(0);
    let count = WRITTEN.fetch_add(1, Ordering::Relaxed);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}-{count}.partial", process::id()))
}
