use std::path::PathBuf;

/// Why a file could not be written. The file that was there before, if any, is as it was.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system does not let it be written.
    #[error("{}: the file cannot be written: {source}; check that the folder is there, may be written to and has room", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A field has another number of values than there are nodes or cells.
    #[error("field `{field}` has {found} values, but {expected} are needed ({components} for each of {places} {what})")]
    FieldLength {
        /// Name of the field.
        field: String,
        /// Nodes or cells.
        what: &'static str,
        /// How many nodes or cells.
        places: usize,
        /// Values for each.
        components: usize,
        /// How many values there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A cell names a node that has no position.
    #[error("cell {cell} names node {node}, but there are only {nodes} positions; write the cells of the same mesh")]
    MissingNode {
        /// Cell, from 0.
        cell: usize,
        /// The node, from 0.
        node: u32,
        /// How many positions there are.
        nodes: usize,
    },
    /// A region names a node or a cell that the mesh does not have.
    #[error("region `{region}` names {what} {number}, which the mesh does not have; number its nodes and cells anew")]
    Region {
        /// Name of the region.
        region: String,
        /// Node or cell.
        what: &'static str,
        /// Its number, from 0.
        number: u32,
    },
    /// A name that the format cannot hold.
    #[error("the name {name:?} cannot be written, because it is empty or has quotes or line breaks; choose another")]
    Name {
        /// The name.
        name: String,
    },
    /// A row has more or fewer values than the header has columns.
    #[error("row {row} has {found} values, but the header has {expected} columns")]
    RowLength {
        /// Row, from 0.
        row: usize,
        /// Columns of the header.
        expected: usize,
        /// Values of the row.
        found: usize,
    },
    /// A collection of a time series and its files have no folder in common, so it cannot point to them.
    #[error("{} does not lie in the folder of {}, so the collection cannot point to it; write both into one folder", file.display(), collection.display())]
    OutsideFolder {
        /// The file of one moment.
        file: PathBuf,
        /// The collection.
        collection: PathBuf,
    },
}
