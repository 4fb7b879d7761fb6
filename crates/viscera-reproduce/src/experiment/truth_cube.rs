//! The truth cube: silicone with beads inside, whose places were measured under compression.

use std::path::{Path, PathBuf};

use viscera::mesh::TetMesh;
use viscera_validation::truth_cube::{self, Row, TruthCube, Variant};
use viscera_validation::{Settings, Size};

use super::Experiment;
use crate::deformed::{Deformed, Vector, camera, photograph};
use crate::section::Photograph;
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "truth-cube",
    title: "The truth cube",
    source: "N05, section 5: 343 beads in a pressed cube of silicone (Kerdok et al. 2003)",
    run,
};

/// What the file of measured beads is called, where it was published and where it was copied.
const BEADS: [&str; 2] = ["uniaxial_positions.csv", "bead-positions.csv"];

/// The file of measured beads in a folder, or at the path itself; nothing where there is none.
pub fn beads_in(path: &Path) -> Option<PathBuf> {
    let inside = BEADS.map(|name| path.join(name));
    [path.to_owned()].into_iter().chain(inside).find(|file| file.is_file())
}

/// Edge of the cube [m].
const EDGE: f64 = 0.08;
const STRAINS: [f64; 3] = [5.0, 12.5, 18.25];
/// Mean distance of the beads from where they were measured, by a commercial program with large strains [% of 80 mm].
const PUBLISHED: [f64; 3] = [1.06, 1.45, 1.78];

const SHOWN: &str = "A cube of silicone with 343 beads inside is pressed by 5, 12.5 and 18.25 % between plates that it is glued to. \
                     How far are the computed beads from the measured ones? The plate's force tells the methods apart: it sees \
                     locking, to which the beads are blind.";

/// The cube under the largest strain by the tetrahedra that do not lock, and by those that do.
fn pictures(study: &TruthCube, cells: usize) -> Result<Vec<Photograph>, ReproduceError> {
    // All kinds of cells stand on the nodes of one grid.
    let mesh = TetMesh::box_grid([cells; 3], [EDGE; 3]);
    let rest = Deformed::new(&mesh, &vec![Vector::ZERO; mesh.nodes.len()]);
    let last = STRAINS.len() - 1;
    let find = |free: bool| {
        let of =
            |row: &&Row| row.state == last && row.variant.is_neo_hookean() && row.variant.is_free_of_locking() == free;
        let row = study.rows.iter().find(of)?;
        Some((row.variant.name(), Deformed::new(&mesh, &row.outcome.as_ref()?.moved)))
    };
    let mut pictures = Vec::new();
    let most = 1e3 * EDGE * 0.01 * STRAINS[last];
    let view = camera([&rest], [-0.5, 1.0, -0.4], [0.0, 0.0, 1.0]);
    for (name, free) in [("pressed", true), ("locked", false)] {
        let Some((variant, shape)) = find(free) else { continue };
        let caption = format!(
            "{variant}, pressed by {} %: coloured by the way of the silicone; at rest, translucent",
            STRAINS[last]
        );
        pictures.push(photograph(name, caption, view, [shape.ghost(), shape.body_by_distance(&rest, "way", most)])?);
    }
    Ok(pictures)
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let Some(measured) = settings.measured.as_deref() else {
        return Ok(Section::missing(
            SHOWN,
            "The measured beads are published without a licence and are no part of this program: give the folder that holds their \
             file with --data. Without it this experiment is not run; validation/results has the comparison with converged \
             solutions.",
        ));
    };
    let cells = if settings.size == Size::Full { 10 } else { 6 };
    let study = truth_cube::study_on(&[cells], &Variant::all(false), Some(measured))?;
    let pictures = pictures(&study, cells)?;
    let mut section = Section::new(SHOWN)
        .setting("cube", format!("80 mm, {cells} cells to an edge"))
        .setting("silicone", "E = 14.9 kPa, ν = 0.499")
        .setting("plates", "the lower face held, the upper one glued to a plate that goes its nominal way");
    for (state, (strain, published)) in STRAINS.iter().zip(PUBLISHED).enumerate() {
        let of = |row: &&Row| row.state == state && row.variant.is_neo_hookean() && row.variant.is_free_of_locking();
        let outcome = study.rows.iter().find(of).and_then(|row| row.outcome.as_ref());
        let mean = outcome.and_then(|found| found.from_measured).map_or(f64::NAN, |deviation| deviation.mean);
        let force = outcome.map_or(f64::NAN, |found| found.force);
        section = section
            .compare(
                format!("mean distance from the measured beads at {strain} %"),
                "% of 80 mm",
                [published, mean],
                "Tetrahedra integrated at the nodes, against a commercial program on a finer mesh; the beads were measured to \
                 about 0.8 % of the edge, which neither goes below.",
            )
            .relation(Relation::near(format!("mean distance at {strain} % [%]"), mean, published, 0.15))
            .relation(Relation::near(format!("force of the plate at {strain} %, over the converged one"), force, 1.0, 0.08));
    }
    Ok(section.pictures(pictures).study(&study.report(), |name| match name {
        "published" => "As published: mean / least / largest / σ in % of 80 mm".into(),
        _ => "Here".into(),
    }))
}
