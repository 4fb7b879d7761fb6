//! A clamped beam of 40 × 4 × 2 m under its weight, linear: the validation of Nesme et al. (2005), section 5.
//!
//! Beam theory: w(x) = q x² (6l² − 4lx + x²)/(24 E I), and at the tip q l⁴/(8 E I), to which shear adds q l²/(2 κ G A)
//! (Timoshenko). With the paper's load the tip would sink by 471 m; the load here is a ten-thousandth of it.

use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};

use crate::plot::{Plot, Scale};
use crate::references::{CLAMPED_BEAM, Vector, list, number, numbers, read, vector, vectors};
use crate::report::{Table, brief, ratio};
use crate::setting::{Cells, Element, Settled, largest_difference, plane};
use crate::{Report, Size, ValidationError};

const WIDTH: f64 = 4.0;
const HEIGHT: f64 = 2.0;
const LENGTH: f64 = 40.0;
const INERTIA: f64 = WIDTH * HEIGHT * HEIGHT * HEIGHT / 12.0;

/// What was found.
pub struct FixedBeam {
    /// The beam on the reference's mesh and on finer ones.
    pub deflections: Vec<Deflection>,
    /// The tip against the length.
    pub lengths: Vec<Length>,
    references: serde_json::Value,
}

/// One beam.
pub struct Deflection {
    /// Poisson's ratio.
    pub poisson: f64,
    /// Cells, and whether they are integrated at the nodes.
    pub element: Element,
    /// Refinement of 40 × 4 × 2 cells.
    pub level: usize,
    /// Largest difference from the other programs on the same mesh, over the largest displacement.
    pub difference: Option<f64>,
    /// Deflection of the tip over the converged one.
    pub of_converged: f64,
    /// Centre line: place and deflection [m].
    pub line: Vec<(f64, f64)>,
}

/// Tips of beams of several lengths.
pub struct Length {
    /// Kind of cell.
    pub element: Element,
    /// Length and deflection [m].
    pub tips: Vec<(f64, f64)>,
}

/// The element's name in the reference case; none for those that it does not have.
fn reference(element: Element) -> Option<&'static str> {
    match (element.cells, element.nodal) {
        (Cells::Six, false) => Some("tet6"),
        (Cells::Ten, false) => Some("tet10_superposed"),
        (Cells::Hexahedra, false) => Some("hex8"),
        _ => None,
    }
}

fn settle(
    case: &serde_json::Value,
    element: Element,
    poisson: f64,
    cells: [usize; 3],
    length: f64,
) -> Result<Settled, ValidationError> {
    let kind = element.cells;
    let young = kind.share() * number(&case["material"]["E_Pa"]);
    let density = kind.share() * number(&case["material"]["density_kg_m3"]);
    let tissue = if element.nodal {
        // In one linear solve a quadratic law is a linear one.
        Tissue::uniform(StVenantKirchhoff::from_young_poisson(young, poisson)?)
    } else {
        Tissue::uniform(LinearElastic::from_young_poisson(young, poisson)?)
    };
    let body = element.body(kind.fill(cells, [length, WIDTH, HEIGHT]), density, tissue).fix(plane(0, 0.0));
    let gravity = vector(&case["loads"]["gravity_m_s2"]).to_array();
    Settled::new(body, gravity, &QuasiStatic { small_strain: true, ..QuasiStatic::default() })
}

/// # Errors
/// [`ValidationError`] where a solve fails.
pub fn study(size: Size) -> Result<FixedBeam, ValidationError> {
    let case = read(CLAMPED_BEAM);
    let levels = if size == Size::Full { 3 } else { 1 };
    let mut deflections = Vec::new();
    for expected in list(&case["reference"]["per_nu"]) {
        let poisson = number(&expected["nu"]);
        let converged = -vector(&expected["converged_hex27"]["tip_centre_u_m"]).z;
        for element in Element::ALL {
            for level in 1..=levels {
                let cells = [40 * level, 4 * level, 2 * level];
                let beam = settle(&case, element, poisson, cells, LENGTH)?;
                let line: Vec<(f64, f64)> = numbers(&case["reference"]["x_m"])
                    .into_iter()
                    .map(|x| (x, -beam.displacement_at(Vector::new(x, 0.5 * WIDTH, 0.5 * HEIGHT)).z))
                    .collect();
                let other = reference(element).filter(|_| level == 1);
                let other = other.map(|name| vectors(&expected[name]["nodal_displacement_m"]));
                deflections.push(Deflection {
                    poisson,
                    element,
                    level,
                    difference: other.map(|other| largest_difference(&beam.displacements(), &other)),
                    of_converged: line.last().map_or(0.0, |end| end.1) / converged,
                    line,
                });
            }
        }
    }
    let lengths: &[usize] = if size == Size::Full { &[10, 20, 40, 80] } else { &[10, 20] };
    let tips = |element: Element| {
        let tip = |&length: &usize| {
            let beam = settle(&case, element, 0.3, [length, 4, 2], length as f64)?;
            let place = Vector::new(length as f64, 0.5 * WIDTH, 0.5 * HEIGHT);
            Ok((length as f64, -beam.displacement_at(place).z))
        };
        let tips = lengths.iter().map(tip).collect::<Result<_, ValidationError>>()?;
        Ok(Length { element, tips })
    };
    let lengths = Element::ALL.into_iter().map(tips).collect::<Result<_, ValidationError>>()?;
    Ok(FixedBeam { deflections, lengths, references: case })
}

impl Length {
    /// The power of the length by which the deflection grows, between the two longest beams: 4 by theory.
    pub fn power(&self) -> f64 {
        let [.., a, b] = self.tips.as_slice() else { return f64::NAN };
        (b.1 / a.1).ln() / (b.0 / a.0).ln()
    }
}

impl FixedBeam {
    /// The page.
    pub fn report(&self) -> Report {
        let case = &self.references;
        let mut table = Table::new(
            "deflection",
            &["nu", "element", "cells", "tip / beam theory", "tip / converged", "difference from other programs"],
        );
        for found in &self.deflections {
            let theory = -numbers(&case["reference"]["euler_bernoulli_uz_m"]).last().copied().unwrap_or(f64::NAN);
            table.push(vec![
                found.poisson.to_string(),
                found.element.name(),
                format!("{} × {} × {}", 40 * found.level, 4 * found.level, 2 * found.level),
                ratio(found.line.last().map_or(f64::NAN, |end| end.1) / theory),
                ratio(found.of_converged),
                found.difference.map_or("–".into(), |difference| format!("{difference:.1e}")),
            ]);
        }
        let mut along = Plot {
            name: "deflection",
            title: "Deflection along the beam, ν = 0.3, coarsest mesh".into(),
            x: "distance from the wall [m]",
            y: "deflection [m]",
            scale: Scale::Logarithmic,
            curves: Vec::new(),
        };
        for found in self.deflections.iter().filter(|found| found.poisson == 0.3 && found.level == 1) {
            along.curve(found.element.name(), found.line[1..].to_vec());
        }
        let x = numbers(&case["reference"]["x_m"]);
        let theory = numbers(&case["reference"]["euler_bernoulli_uz_m"]);
        along.reference("beam theory", x.into_iter().zip(theory).skip(1).map(|(x, w)| (x, -w)).collect());

        let mut powers = Table::new("length", &["element", "power of the length"]);
        let mut tips = Plot {
            name: "length",
            title: "Deflection of the tip against the length, ν = 0.3".into(),
            x: "length [m]",
            y: "deflection [m]",
            scale: Scale::Logarithmic,
            curves: Vec::new(),
        };
        let load = number(&case["reference"]["q_N_per_m"]);
        let young = number(&case["material"]["E_Pa"]);
        for found in &self.lengths {
            powers.push(vec![found.element.name(), brief(found.power())]);
            tips.curve(found.element.name(), found.tips.clone());
        }
        let beam = |&(length, _): &(f64, f64)| (length, load * length.powi(4) / (8.0 * young * INERTIA));
        tips.reference("q l⁴ / 8 E I", self.lengths[0].tips.iter().map(beam).collect());

        Report::new("A clamped beam under its weight")
            .text(
                "40 × 4 × 2 m, E = 20 kPa, one end held, linear statics (Nesme et al. 2005). The same element on the same \
                 mesh is compared node by node with three programs (own code in numpy, scikit-fem, CalculiX); the deflection \
                 with beam theory and with quadratic hexahedra. Plain elements are too stiff in bending, the more so the \
                 nearer ν is to ½. Integrated at the nodes they are too soft, whatever ν is: two cells over the height are \
                 few, with six of them 5 % are left. The two kinds hold the truth between them.",
            )
            .table(table)
            .plot(along)
            .text("By beam theory the tip sinks as the fourth power of the length.")
            .table(powers)
            .plot(tips)
    }
}
