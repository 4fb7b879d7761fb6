//! Results out: VTU and PVD for ParaView, MSH 2.2, and CSV. Every file is written aside and then renamed.

mod atomically;
mod csv;
mod error;
mod field;
mod msh;
mod pvd;
mod vtu;

pub use atomically::write_atomically;
pub use csv::{Table, csv_text, write_csv};
pub use error::WriteError;
pub use field::{Field, Values};
pub use msh::{write_hex_msh, write_tet_msh};
pub use pvd::TimeSeries;
pub use vtu::{Cells, Encoding, Grid, vtu_bytes, write_vtu};
