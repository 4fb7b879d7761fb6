use viscera::material::{
    Fibre, Lame, LawFamily, LawKind, LinearElastic, MaterialError, NeoHookean, StVenantKirchhoff, StableNeoHookean,
    Tissue, TransverseLinear, TransverseStVenantKirchhoff,
};
use viscera::math::Vec3;
use viscera::mesh::{Point, VolumeMesh};

use super::csv;
use super::mesh::PlacedMesh;
use super::region::{Wanted, region};
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{BodyFile, FibreFile, LawFile, LawName, RegionFile};
use crate::quantity::Length;

/// The law of one cell.
#[derive(Clone, Copy)]
struct CellLaw {
    matrix: Lame,
    fibre: Option<Fibre>,
}

/// The tissue of a body: its law, and those of its parts where they lie.
pub(super) fn tissue(body: &BodyFile, placed: &PlacedMesh, site: &Site) -> Result<Tissue, SceneErrors> {
    let mut laws = laws(&body.law, placed, &site.key("law"))?;
    for (index, part) in body.part.iter().enumerate() {
        let site = site.key("part").key(index);
        let Some(law) = &part.law else { continue };
        if law.kind != body.law.kind {
            let message = "a part has another kind of law than its body";
            let help = "give both the same kind; parts may differ in stiffness and fibres";
            return Err(site.key("law").key("kind").error(message, help));
        }
        let of_part = self::laws(law, placed, &site.key("law"))?;
        if laws.len() == 1 {
            laws = vec![laws[0]; placed.mesh.cell_count()];
        }
        for cell in cells_of(&part.region, &placed.mesh, &site)? {
            laws[cell as usize] = of_part[if of_part.len() == 1 { 0 } else { cell as usize }];
        }
    }
    assemble(body.law.kind, &laws).map_err(|error| site.key("law").error(error, ""))
}

/// Density of every cell [kg/m³], where a part has one of its own.
pub(super) fn densities(body: &BodyFile, mesh: &VolumeMesh, site: &Site) -> Result<Option<Vec<f64>>, SceneErrors> {
    let mut densities = None;
    for (index, part) in body.part.iter().enumerate() {
        let Some(density) = part.density else { continue };
        let all = densities.get_or_insert_with(|| vec![body.density.0; mesh.cell_count()]);
        for cell in cells_of(&part.region, mesh, &site.key("part").key(index))? {
            all[cell as usize] = density.0;
        }
    }
    Ok(densities)
}

fn cells_of(file: &RegionFile, mesh: &VolumeMesh, part: &Site) -> Result<Vec<u32>, SceneErrors> {
    let site = part.key("region");
    region(file, Wanted::Cells, mesh, &site)?.cells(mesh).map_err(|error| site.error(error, ""))
}

/// One law for all cells, or one for each.
fn laws(law: &LawFile, placed: &PlacedMesh, site: &Site) -> Result<Vec<CellLaw>, SceneErrors> {
    let stiffness = (law.young, law.poisson, law.lambda, law.mu);
    let matrix = match stiffness {
        (Some(young), Some(poisson), ..) => Lame::from_young_poisson(young.0, poisson),
        (_, _, Some(lambda), Some(mu)) => Lame::new(lambda.0, mu.0),
        _ => return Err(site.error("the law has no stiffness", "give `young` and `poisson`, or `lambda` and `mu`")),
    };
    let matrix = matrix.map_err(|error| blame(&error, site))?;
    let Some(fibre) = &law.fibre else { return Ok(vec![CellLaw { matrix, fibre: None }]) };
    let site = site.key("fibre");
    if matches!(law.kind, LawName::NeoHookean | LawName::StableNeoHookean) {
        return Err(site.error("this law has no fibres", "take `st-venant-kirchhoff` or `linear`, or leave them out"));
    }
    let along = match (fibre.young, fibre.factor, fibre.lambda, fibre.mu) {
        (Some(young), ..) => Lame::from_young_poisson(young.0, matrix.poisson()),
        (_, Some(factor), ..) => Lame::new(factor * matrix.lambda, factor * matrix.mu),
        (.., Some(lambda), Some(mu)) => Lame::new(lambda.0, mu.0),
        _ => return Err(site.error("the fibres have no stiffness", "give `young`, `factor`, or `lambda` and `mu`")),
    };
    let along = along.map_err(|error| blame(&error, &site))?;
    let directions = directions(fibre, placed, &site)?;
    let law = |direction: Point| Fibre::new(direction.to_array(), along, matrix).map(Some);
    let laws = directions.into_iter().map(|direction| law(direction).map(|fibre| CellLaw { matrix, fibre }));
    laws.collect::<Result<_, _>>().map_err(|error| blame(&error, &site))
}

/// The error at the key that it is about, where that key is in the file.
fn blame(error: &MaterialError, site: &Site) -> SceneErrors {
    match error {
        MaterialError::OutOfRange { name, .. } => site.key(name).error(error, ""),
        MaterialError::NoDirection { .. } => site.key("direction").error(error, ""),
        MaterialError::WrongCount { .. } => site.error(error, ""),
    }
}

/// Directions of the fibres: one for all cells, or one for each.
fn directions(fibre: &FibreFile, placed: &PlacedMesh, site: &Site) -> Result<Vec<Point>, SceneErrors> {
    let mesh = &placed.mesh;
    if let Some(direction) = fibre.direction {
        return Ok(vec![direction.into()]);
    }
    if let Some(points) = &fibre.along {
        return along(points, mesh, &site.key("along"));
    }
    let Some(file) = &fibre.file else {
        return Err(site.error("the fibres have no direction", "give `direction`, `along` or `file`"));
    };
    let site = site.key("file");
    let rows = csv::read(&site, file, &[None; 3])?;
    if rows.len() != mesh.cell_count() {
        let message = format!("the file has {} directions, and the mesh has {} cells", rows.len(), mesh.cell_count());
        return Err(site.error(message, "give one row x, y, z for each cell, in the order of the mesh file"));
    }
    Ok(rows.iter().map(|row| placed.turn * Vec3::new(row[0], row[1], row[2])).collect())
}

/// In each cell, the direction of the stretch of the curve that is nearest to the cell's centre.
fn along(points: &[[Length; 3]], mesh: &VolumeMesh, site: &Site) -> Result<Vec<Point>, SceneErrors> {
    let points: Vec<Point> = points.iter().map(|point| point.map(|length| length.0).into()).collect();
    if let Some(index) = points.windows(2).position(|pair| pair[0] == pair[1]) {
        let message = format!("points {index} and {} of the curve are one place", index + 1);
        return Err(site.key(index + 1).error(message, "leave one of them out"));
    }
    let nearest = |centre: Point| {
        let distance = |pair: &[Point]| {
            let along = pair[1] - pair[0];
            let share = ((centre - pair[0]).dot(along) / along.squared_norm()).clamp(0.0, 1.0);
            (centre - (pair[0] + along * share)).squared_norm()
        };
        points
            .windows(2)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .map_or(Vec3::ZERO, |pair| pair[1] - pair[0])
    };
    let centre = |cell: usize| {
        let corners = mesh.cell(cell);
        corners.iter().fold(Vec3::ZERO, |sum, &node| sum + mesh.nodes()[node as usize]) / corners.len() as f64
    };
    Ok((0..mesh.cell_count()).map(|cell| nearest(centre(cell))).collect())
}

/// Puts the laws into the form that the engine has for them: with fibres everywhere as soon as there are some anywhere.
fn assemble(kind: LawName, laws: &[CellLaw]) -> Result<Tissue, MaterialError> {
    let has_fibres = laws.iter().any(|law| law.fibre.is_some());
    let none = Fibre { direction: Vec3::new(1.0, 0.0, 0.0), stiffness: 0.0 };
    let fibre = |law: &CellLaw| law.fibre.unwrap_or(none);
    match (kind, has_fibres) {
        (LawName::Linear, false) => in_cells(laws, |law| LinearElastic::new(law.matrix)),
        (LawName::StVenantKirchhoff, false) => in_cells(laws, |law| StVenantKirchhoff::new(law.matrix)),
        (LawName::NeoHookean, _) => in_cells(laws, |law| NeoHookean::new(law.matrix)),
        (LawName::StableNeoHookean, _) => in_cells(laws, |law| StableNeoHookean::new(law.matrix)),
        (LawName::Linear, true) => {
            in_cells(laws, |law| TransverseLinear { matrix: LinearElastic::new(law.matrix), fibre: fibre(law) })
        }
        (LawName::StVenantKirchhoff, true) => in_cells(laws, |law| TransverseStVenantKirchhoff {
            matrix: StVenantKirchhoff::new(law.matrix),
            fibre: fibre(law),
        }),
    }
}

fn in_cells<L>(laws: &[CellLaw], form: impl Fn(&CellLaw) -> L) -> Result<Tissue, MaterialError>
where
    L: LawFamily + Into<LawKind>,
{
    match laws {
        [law] => Ok(Tissue::uniform(form(law))),
        laws => Tissue::per_cell(&laws.iter().map(form).collect::<Vec<L>>()),
    }
}
