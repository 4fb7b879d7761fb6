//! Runs the studies and writes what they found: a page, tables and plots for each.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use viscera_validation::{Settings, Size, StudyKind};

/// Compares Viscera with closed forms, other programs and measurements.
#[derive(Parser)]
#[command(name = "viscera-validation")]
struct Arguments {
    /// Which studies to run; all of them if none is named.
    #[arg(value_enum)]
    studies: Vec<StudyKind>,
    /// Where the pages go, a folder for each study.
    #[arg(long, default_value = "out/validation")]
    out: PathBuf,
    /// Small meshes: seconds in place of minutes, as in the tests.
    #[arg(long)]
    small: bool,
    /// The measured bead positions of the truth cube: the file `uniaxial_positions.csv` of Kerdok et al. (2003), which is published
    /// without a licence and therefore not part of this project.
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let settings = Settings { size: if arguments.small { Size::Small } else { Size::Full }, measured: arguments.data };
    let studies = if arguments.studies.is_empty() { StudyKind::ALL.to_vec() } else { arguments.studies };
    for study in studies {
        let written = study.run(&settings).and_then(|report| report.write(&arguments.out.join(study.name())));
        match written {
            Ok(page) => println!("{page}"),
            Err(error) => {
                eprintln!("error: {}: {error}", study.name());
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}
