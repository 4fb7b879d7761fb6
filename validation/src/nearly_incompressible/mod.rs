//! Cook's membrane and a pressed cube at ν = 0.4999 and 0.499: which elements lock, and which do not.

mod locked;

use serde_json::Value;
use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{LinearElastic, NeoHookean, Tissue};
use viscera::mesh::{Region, VolumeMesh};

pub use self::locked::Locked;
use crate::plot::{Plot, Scale};
use crate::references::{COOK, TRUTH_CUBE, Vector, list, number, read};
use crate::report::{Table, ratio};
use crate::setting::{Element, Settled, plane};
use crate::{Report, Size, ValidationError};

/// What was found.
pub struct NearlyIncompressible {
    /// Cook's membrane: deflection of the corner over the converged one.
    pub cook: Vec<Convergence>,
    /// The glued cube under 5 %: force of the plate over the converged one.
    pub cube: Vec<Convergence>,
    /// What locks, beside the same elements of another program.
    pub locked: Vec<Locked>,
}

/// A kind of element on finer and finer meshes.
pub struct Convergence {
    /// Which.
    pub element: Element,
    /// Cells to an edge, and the result over the converged one.
    pub ratios: Vec<(usize, f64)>,
}

/// The laws of the references.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// Of small strains.
    Linear,
    /// Of large ones.
    NeoHookean,
}

impl Law {
    /// A body of the element, of the material of a case.
    fn body(self, element: Element, mesh: VolumeMesh, material: &Value) -> Result<Body, ValidationError> {
        let (young, poisson) = (element.cells.share() * number(&material["E_Pa"]), number(&material["nu"]));
        let tissue = match self {
            Self::Linear => Tissue::uniform(LinearElastic::from_young_poisson(young, poisson)?),
            Self::NeoHookean => Tissue::uniform(NeoHookean::from_young_poisson(young, poisson)?),
        };
        Ok(element.body(mesh, 1000.0, tissue))
    }
}

/// # Errors
/// [`ValidationError`] where a solve fails.
pub fn study(size: Size) -> Result<NearlyIncompressible, ValidationError> {
    let full = size == Size::Full;
    let cook_levels: &[usize] = if full { &[4, 8, 16, 32] } else { &[8, 16] };
    let cube_levels: &[usize] = if full { &[4, 6, 8, 10, 12] } else { &[4, 6] };
    let over = |levels: &[usize], element: Element, result: fn(Element, usize) -> Result<f64, ValidationError>| {
        let one = |&level: &usize| Ok((level, result(element, level)?));
        Ok(Convergence { element, ratios: levels.iter().map(one).collect::<Result<_, ValidationError>>()? })
    };
    let every = |levels: &[usize], result| {
        Element::ALL.into_iter().map(|element| over(levels, element, result)).collect::<Result<_, ValidationError>>()
    };
    Ok(NearlyIncompressible {
        cook: every(cook_levels, cook)?,
        cube: every(cube_levels, cube)?,
        locked: locked::study(size)?,
    })
}

/// Cook's panel, neo-Hookean: the corner's way over the converged one.
fn cook(element: Element, cells: usize) -> Result<f64, ValidationError> {
    let case = read(COOK);
    let settled = panel(&case, element, cells, Law::NeoHookean)?;
    let expected = number(&case["converged_reference"]["neohooke"]["A_top_right_m"][1]);
    Ok(settled.displacement_at(CORNER).y / expected)
}

/// The upper right corner of the panel, on one of its faces.
const CORNER: Vector = Vector::new(0.048, 0.06, 0.0);
/// Its thickness [m].
const THICKNESS: f64 = 0.004;

/// Cook's panel, (0, 0), (48, 44), (48, 60), (0, 44) mm, in plane strain, pulled up at its end.
fn panel(case: &Value, element: Element, cells: usize, law: Law) -> Result<Settled, ValidationError> {
    let skew = |node: &mut Vector| {
        let (x, y) = (node.x, node.y);
        *node = Vector::new(0.048 * x, 0.044 * x + y * (0.044 * (1.0 - x) + 0.016 * x), THICKNESS * node.z);
    };
    let mut mesh = element.cells.fill([cells, cells, 1], [1.0; 3]);
    match &mut mesh {
        VolumeMesh::Tet(mesh) => mesh.nodes.iter_mut().for_each(skew),
        VolumeMesh::Hex(mesh) => mesh.nodes.iter_mut().for_each(skew),
    }
    // Superposed cells show each face of the end twice.
    let shear = element.cells.share() * number(&case["loads"]["shear_traction_y_Pa"]);
    let traction = Curve::constant(Vector::new(0.0, shear, 0.0));
    let body = law
        .body(element, mesh, &case["material"])?
        .fix(plane(0, 0.0))
        .slide(Region::All, [0.0, 0.0, 1.0])
        .load(Load::Traction { region: plane(0, 0.048), traction });
    let small_strain = law == Law::Linear;
    Settled::new(body, [0.0; 3], &QuasiStatic { tolerance: 1e-9, small_strain, ..QuasiStatic::default() })
}

/// The glued cube, neo-Hookean, pressed by 5 %: force over the converged one.
fn cube(element: Element, cells: usize) -> Result<f64, ValidationError> {
    let case = read(TRUTH_CUBE);
    let expected = &list(&case["converged_reference"]["glued_neohooke"])[0];
    let force = press(&case, element, cells, Law::NeoHookean, number(&expected["strain"]))?;
    Ok(force / number(&expected["plate_force_z_N"]))
}

/// The cube of 80 mm glued between plates, pressed by a strain: force of the plate [N].
fn press(case: &Value, element: Element, cells: usize, law: Law, strain: f64) -> Result<f64, ValidationError> {
    const EDGE: f64 = 0.08;
    // Linear forces are in proportion, and a short way turns no cell inside out.
    let share = if law == Law::Linear { 1e-3 } else { 1.0 };
    let push = Vector::new(0.0, 0.0, -share * strain * EDGE);
    let mesh = element.cells.fill([cells; 3], [EDGE; 3]);
    let body =
        law.body(element, mesh, &case["material"])?.fix(plane(2, 0.0)).prescribe(plane(2, EDGE), Curve::constant(push));
    let small_strain = law == Law::Linear;
    let settings = QuasiStatic { tolerance: 1e-8, small_strain, ..QuasiStatic::default() };
    Ok(plate_force(&Settled::new(body, [0.0; 3], &settings)?, EDGE) / share)
}

/// Force along z [N] by which the plate at the height `top` holds a body.
pub(crate) fn plate_force(settled: &Settled, top: f64) -> f64 {
    let body = settled.world.body(settled.id);
    let forces = &body.state().internal_forces;
    let nodes = body.mesh().nodes().iter().zip(forces);
    nodes.filter(|(rest, _)| rest.z > top * (1.0 - 1e-9)).map(|(_, force)| force.z).sum()
}

impl NearlyIncompressible {
    /// The page.
    pub fn report(&self) -> Report {
        let mut report = Report::new("Nearly incompressible tissue").text(
            "Neo-Hookean tissue; reference: mixed elements of second and third order (dolfinx). Plain elements of low order \
             keep the volume of every cell, and have then hardly any way left to deform: they lock. Tetrahedra integrated \
             at the nodes keep the volume around every node, of which there are five to ten times fewer.",
        );
        for (name, title, unit, found) in [
            ("cook", "Cook's membrane, ν = 0.4999: deflection over the converged one", "cells to an edge", &self.cook),
            (
                "cube",
                "A glued cube, ν = 0.499, pressed by 5 %: force over the converged one",
                "cells to an edge",
                &self.cube,
            ),
        ] {
            let mut table = Table::new(name, &["element", "cells to an edge", "over the converged result"]);
            let mut plot =
                Plot { name, title: title.into(), x: unit, y: "ratio", scale: Scale::Logarithmic, curves: Vec::new() };
            for Convergence { element, ratios } in found {
                ratios
                    .iter()
                    .for_each(|&(cells, value)| table.push(vec![element.name(), cells.to_string(), ratio(value)]));
                plot.curve(element.name(), ratios.iter().map(|&(cells, value)| (cells as f64, value)).collect());
            }
            let (first, last) = (found[0].ratios[0].0, found[0].ratios[found[0].ratios.len() - 1].0);
            plot.reference("converged", vec![(first as f64, 1.0), (last as f64, 1.0)]);
            report = report.text(format!("## {title}")).table(table).plot(plot);
        }
        locked::tell(report, &self.locked)
    }
}
