use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where the files are that a scene names: meshes, curves, directions of fibres.
#[derive(Clone, PartialEq)]
pub enum Files {
    /// In this folder, or below it, or wherever an absolute path says.
    Folder(PathBuf),
    /// Among these, by the names that scenes give them: nothing else can be read.
    Memory(Arc<BTreeMap<String, Vec<u8>>>),
}

impl Files {
    /// No files at all.
    pub fn none() -> Self {
        Self::Memory(Arc::default())
    }

    /// Where a file is looked for.
    pub(crate) fn path(&self, file: &Path) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.join(file),
            Self::Memory(_) => file.to_owned(),
        }
    }

    /// What is in a file.
    pub(crate) fn read(&self, file: &Path) -> io::Result<Cow<'_, [u8]>> {
        match self {
            Self::Folder(folder) => std::fs::read(folder.join(file)).map(Cow::Owned),
            Self::Memory(files) => {
                let bytes = file.to_str().and_then(|name| files.get(name));
                let missing = || io::Error::new(io::ErrorKind::NotFound, "it did not come with the scene");
                bytes.map(|bytes| Cow::Borrowed(bytes.as_slice())).ok_or_else(missing)
            }
        }
    }
}

/// Names only: meshes are long.
impl fmt::Debug for Files {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(folder) => formatter.debug_tuple("Folder").field(folder).finish(),
            Self::Memory(files) => formatter.debug_set().entries(files.keys()).finish(),
        }
    }
}
