//! Plain elements of low order, which lock, beside the same elements of another program: they lock as much.

use super::{CORNER, Law, THICKNESS, panel, press};
use crate::references::{COOK, TRUTH_CUBE, Vector, list, number, read};
use crate::report::{Table, brief, ratio};
use crate::setting::Element;
use crate::{Report, Size, ValidationError};

/// An element that locks, here and elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Locked {
    /// "Cook's membrane" or "glued cube".
    pub body: &'static str,
    /// Which.
    pub element: Element,
    /// Of what law.
    pub law: Law,
    /// Cells to an edge.
    pub cells: usize,
    /// Strain, of what is pressed.
    pub strain: Option<f64>,
    /// The result over the converged one of the law.
    pub ratio: f64,
    /// How far it is from that of the other program, of the latter.
    pub difference: f64,
}

/// The element and the law that a case names.
fn named(case: &serde_json::Value) -> (Element, Law) {
    let [six, ten, hexahedra, ..] = Element::ALL;
    let element = match case["element"].as_str() {
        Some("tet6") => six,
        Some("tet10_superposed") => ten,
        _ => hexahedra,
    };
    (element, if case["model"] == "linear" { Law::Linear } else { Law::NeoHookean })
}

/// Every element of the references; the small study leaves out strains of the cube that say the same twice.
pub(super) fn study(size: Size) -> Result<Vec<Locked>, ValidationError> {
    let mut found = Vec::new();
    let case = read(COOK);
    for other in list(&case["locking_of_low_order_elements"]) {
        let (element, law) = named(other);
        let cells = number(&other["cells"]) as usize;
        let settled = panel(&case, element, cells, law)?;
        // The two faces of six tetrahedra to a cell are not alike.
        let behind = Vector::new(CORNER.x, CORNER.y, THICKNESS);
        let moved = 0.5 * [CORNER, behind].map(|corner| settled.displacement_at(corner).y).iter().sum::<f64>();
        let theirs = number(&other["A_top_right_m"][1]);
        let converged = if law == Law::Linear { "linear" } else { "neohooke" };
        let converged = number(&case["converged_reference"][converged]["A_top_right_m"][1]);
        let (ratio, difference) = (moved / converged, (moved / theirs - 1.0).abs());
        found.push(Locked { body: "Cook's membrane", element, law, cells, strain: None, ratio, difference });
    }
    let case = read(TRUTH_CUBE);
    let others = list(&case["locking_on_8x8x8"]);
    for other in others {
        let (element, law) = named(other);
        let strain = number(&other["strain"]);
        // Linear forces are in proportion, and the largest strain is the hardest of the rest.
        let extreme = others.iter().map(|other| number(&other["strain"])).fold(strain, |a, b| match law {
            Law::Linear => a.min(b),
            Law::NeoHookean => a.max(b),
        });
        if size == Size::Small && strain != extreme {
            continue;
        }
        let cells = 8;
        let force = press(&case, element, cells, law, strain)?;
        let theirs = number(&other["plate_force_z_N"]);
        // The other program gives its force over the converged one of the same law.
        let converged = theirs / number(&other["force_over_reference"]);
        let (ratio, difference) = (force / converged, (force / theirs - 1.0).abs());
        found.push(Locked { body: "glued cube", element, law, cells, strain: Some(strain), ratio, difference });
    }
    Ok(found)
}

/// The part of the page.
pub(super) fn tell(report: Report, found: &[Locked]) -> Report {
    let head = ["body", "element", "law", "cells to an edge", "strain", "over the converged result", "difference"];
    let mut table = Table::new("locked", &head);
    for &Locked { body, element, law, cells, strain, ratio: over, difference } in found {
        table.push(vec![
            body.into(),
            element.name(),
            if law == Law::Linear { "linear" } else { "neo-Hookean" }.into(),
            cells.to_string(),
            strain.map_or("–".into(), |strain| format!("{} %", brief(100.0 * strain))),
            ratio(over),
            brief(difference),
        ]);
    }
    report
        .text(
            "## As much as elsewhere\n\nPlain elements of the same meshes in another program, written in numpy for this comparison: \
             deflection of the membrane and force of the plate over the converged ones of the same law, and how far ours are from \
             those of the other program.",
        )
        .table(table)
}
