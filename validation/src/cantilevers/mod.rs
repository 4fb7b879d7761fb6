//! Large static deflection of a beam of 10 × 10 × 40 cm: node by node against three programs, and under refinement.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{Lame, LinearElastic, StVenantKirchhoff, Tissue, TransverseStVenantKirchhoff};
use viscera::mesh::Region;
use viscera::model::corotational::Tangent;
use viscera::model::{Corotational, NodallyIntegrated, TotalLagrangian};

use crate::plot::{Plot, Scale};
use crate::references::{CANTILEVERS, Vector, mesh, number, read, vector, vectors};
use crate::report::{Table, ratio};
use crate::setting::{Cells, Settled, largest_difference, plane};
use crate::{Report, Size, ValidationError};

/// What was found.
pub struct Cantilevers {
    /// The reference cases.
    pub cases: Vec<Case>,
    /// Kinds of elements on finer and finer meshes.
    pub refinements: Vec<Refinement>,
}

/// A reference case.
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// Largest difference over the largest displacement.
    pub difference: f64,
    /// What the case allows.
    pub tolerance: f64,
    /// Residuals of Newton's method, over the loads.
    pub residuals: Vec<f64>,
}

/// A kind of element on finer and finer meshes.
pub struct Refinement {
    /// Which.
    pub name: String,
    /// Cells across the beam, and the deflection of the middle of its end [m].
    pub tips: Vec<(usize, f64)>,
}

/// # Errors
/// [`ValidationError`] where a solve fails.
pub fn study(size: Size) -> Result<Cantilevers, ValidationError> {
    let cases = CANTILEVERS.into_iter().map(|(name, text)| case(name, text)).collect::<Result<_, _>>()?;
    let levels: &[usize] = if size == Size::Full { &[2, 4, 6, 8, 12] } else { &[2, 4] };
    let kinds = [
        ("6 tetrahedra", Cells::Six, false),
        ("hexahedra", Cells::Hexahedra, false),
        ("6 tetrahedra, integrated at the nodes", Cells::Six, true),
    ];
    let refine = |(name, cells, nodal): (&str, Cells, bool)| {
        let tip = |&level: &usize| Ok((level, tip(cells, nodal, level)?));
        Ok(Refinement { name: name.into(), tips: levels.iter().map(tip).collect::<Result<_, ValidationError>>()? })
    };
    Ok(Cantilevers { cases, refinements: kinds.into_iter().map(refine).collect::<Result<_, ValidationError>>()? })
}

fn case(name: &'static str, text: &str) -> Result<Case, ValidationError> {
    let data = read(text);
    let material = &data["material"];
    let lame = Lame::new(number(&material["lambda_Pa"]), number(&material["mu_Pa"]))?;
    let body = Body::new(mesh(data["mesh"]["file"].as_str().unwrap_or_default())?, number(&material["density_kg_m3"]))
        .fix(plane(2, 0.0));
    let mut body = match material["model"].as_str().unwrap_or_default() {
        "stvk" => body.model(TotalLagrangian::new(Tissue::uniform(StVenantKirchhoff::new(lame)))),
        "corotational" => {
            body.model(Corotational::new(Tissue::uniform(LinearElastic::new(lame))).tangent(Tangent::Exact))
        }
        _ => {
            let along = Lame::new(number(&material["lambdaL_Pa"]), number(&material["muL_Pa"]))?;
            let law = TransverseStVenantKirchhoff::new(lame, vector(&material["a0"]).to_array(), along)?;
            body.model(TotalLagrangian::new(Tissue::uniform(law)))
        }
    };
    let loads = &data["loads"];
    let mut gravity = [0.0; 3];
    if loads["gravity_m_s2"].is_array() {
        gravity = vector(&loads["gravity_m_s2"]).to_array();
    } else {
        for (node, total) in vectors(&loads["nodal_loads_N"]).into_iter().enumerate() {
            let region = Region::Nodes(vec![node as u32]);
            body = body.load(Load::Force { region, total: Curve::constant(total) });
        }
    }
    let settled = Settled::new(body, gravity, &QuasiStatic { tolerance: 1e-12, ..QuasiStatic::default() })?;
    let expected = vectors(&data["reference"]["nodal_displacement_m"]);
    Ok(Case {
        name,
        difference: largest_difference(&settled.displacements(), &expected),
        tolerance: number(&data["tolerance"]["relative"]),
        residuals: settled.report.steps.into_iter().flat_map(|step| step.residuals).collect(),
    })
}

/// Deflection of the middle of the end under a weight of 0.5 m/s² [m]; E = 10 kPa, ν = 0.3, as in B01.
fn tip(cells: Cells, nodal: bool, level: usize) -> Result<f64, ValidationError> {
    let size = [0.1, 0.1, 0.4];
    let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.3)?);
    let body = Body::new(cells.fill([level, level, 4 * level], size), 1000.0).fix(plane(2, 0.0));
    let body =
        if nodal { body.model(NodallyIntegrated::new(tissue)) } else { body.model(TotalLagrangian::new(tissue)) };
    let settled = Settled::new(body, [0.0, -0.5, 0.0], &QuasiStatic::default())?;
    Ok(-settled.displacement_at(Vector::new(0.05, 0.05, 0.4)).y)
}

impl Cantilevers {
    /// The page.
    pub fn report(&self) -> Report {
        let mut cases = Table::new("cases", &["case", "difference", "allowed", "Newton iterations", "last residual"]);
        for case in &self.cases {
            cases.push(vec![
                case.name.into(),
                format!("{:.1e}", case.difference),
                format!("{:.0e}", case.tolerance),
                case.residuals.len().saturating_sub(1).to_string(),
                case.residuals.last().map_or("–".into(), |residual| format!("{residual:.1e}")),
            ]);
        }
        let mut refined = Table::new("refinement", &["element", "cells across", "deflection of the tip [m]"]);
        let mut plot = Plot {
            name: "refinement",
            title: "Deflection of the tip under refinement".into(),
            x: "cells across the beam",
            y: "deflection [m]",
            scale: Scale::Linear,
            curves: Vec::new(),
        };
        for found in &self.refinements {
            for (level, tip) in &found.tips {
                refined.push(vec![found.name.clone(), level.to_string(), ratio(*tip)]);
            }
            plot.curve(found.name.clone(), found.tips.iter().map(|&(level, tip)| (level as f64, tip)).collect());
        }
        Report::new("Large static deflection")
            .text(
                "A beam of 10 × 10 × 40 cm, held at one end, under its weight or a force, solved by Newton's method over a \
                 sparse Cholesky factorisation. Differences are the largest over all nodes, relative to the largest \
                 displacement, from an own Newton solver in numpy, scikit-fem and CalculiX on the same mesh.",
            )
            .table(cases)
            .text(
                "E = 10 kPa, ν = 0.3, 0.5 m/s² across the beam, which is what St Venant–Kirchhoff tissue can bear: \
                 plain elements come from below, tetrahedra integrated at the nodes from above.",
            )
            .table(refined)
            .plot(plot)
    }
}
