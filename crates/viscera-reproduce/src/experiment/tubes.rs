//! Tubes with fibres along them, held at both ends and pushed aside in the middle.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{Lame, Tissue, TransverseStVenantKirchhoff};
use viscera::mesh::{Region, TetMesh, TubeDivisions};
use viscera::model::TotalLagrangian;
use viscera_validation::setting::{Settled, plane};
use viscera_validation::{Settings, Size, Table};

use super::{Experiment, PICTURE};
use crate::deformed::{Deformed, Vector, camera, photograph};
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment =
    Experiment { name: "tubes", title: "Tubes with fibres", source: "RR, figure 6", run };

const INNER: f64 = 7e-3;
const OUTER: f64 = 11e-3;
const HEIGHT: f64 = 0.1;
const YOUNG: f64 = 10e3;
const POISSON: f64 = 0.4;
const FORCE: f64 = 0.12;

/// How many times as stiff the tubes are along as across.
const FACTORS: [f64; 3] = [1.0, 5.0, 10.0];
/// Mean deflections of the loaded nodes of the same tubes [mm], by Newton's method in another program (scikit-fem) on another mesh of
/// 1 675 tetrahedra.
const OTHER_PROGRAM: [f64; 3] = [7.745, 3.851, 3.237];

/// The nodes that are pushed: the middle third.
fn middle() -> Region {
    Region::cuboid([-1.0, -1.0, 0.33 * HEIGHT], [1.0, 1.0, 0.67 * HEIGHT])
}

/// A tube at rest under its load along x, with fibres along z, and the way of the middle [mm].
fn pushed(mesh: &TetMesh, factor: f64) -> Result<(Deformed, f64), ReproduceError> {
    let across = Lame::from_young_poisson(YOUNG, POISSON)?;
    let along = Lame::new(factor * across.lambda, factor * across.mu)?;
    let tissue = Tissue::uniform(TransverseStVenantKirchhoff::new(across, [0.0, 0.0, 1.0], along)?);
    let total = Curve::constant(Vector::new(FORCE, 0.0, 0.0));
    let body = Body::new(mesh.clone(), 1000.0)
        .model(TotalLagrangian::new(tissue))
        .fix(plane(2, 0.0))
        .fix(plane(2, HEIGHT))
        .load(Load::Force { region: middle(), total });
    let moved = Settled::new(body, [0.0; 3], &QuasiStatic::default())?.displacements();
    let loaded = middle().nodes(&mesh.clone().into())?;
    let way = loaded.iter().map(|&node| moved[node as usize].x).sum::<f64>() / loaded.len() as f64;
    Ok((Deformed::new(mesh, &moved), 1e3 * way))
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let divisions = match settings.size {
        Size::Full => TubeDivisions { around: 20, wall: 2, along: 36 },
        Size::Small => TubeDivisions { around: 12, wall: 1, along: 20 },
    };
    let mesh = TetMesh::tube(INNER, OUTER, HEIGHT, divisions)?;
    let tubes = FACTORS.map(|factor| pushed(&mesh, factor));
    let [isotropic, five, ten] = tubes;
    let tubes = [isotropic?, five?, ten?];
    let ways = [tubes[0].1, tubes[1].1, tubes[2].1];

    let mut table = Table::new(
        "deflections",
        &[
            "stiffness along / across",
            "way of the middle [mm]",
            "of the isotropic one",
            "in another program [mm]",
            "change of volume [%]",
        ],
    );
    for ((factor, (shape, way)), other) in FACTORS.iter().zip(&tubes).zip(OTHER_PROGRAM) {
        table.push(vec![
            factor.to_string(),
            format!("{way:.3}"),
            format!("{:.3}", way / ways[0]),
            format!("{other:.3}"),
            format!("{:.3}", 100.0 * shape.volume_variation()),
        ]);
    }

    let beside = |number: usize| tubes[number].0.clone().shifted(Vector::new(0.04 * number as f64, 0.0, 0.0));
    let row: Vec<Deformed> = (0..3).map(beside).collect();
    let view = camera(&row, [0.0, 1.0, -0.15], [0.0, 0.0, 1.0]);
    let bodies = row.iter().flat_map(|shape| [shape.ghost(), shape.body()]);
    let picture = photograph("tubes", "From left to right as stiff along as across, 5 times, 10 times", view, bodies)?;

    let why = "The paper shows the order: the stiffer the fibres, the less the tube bends.";
    let words = |way: f64| format!("{:.0} % of the isotropic way", 100.0 * way / ways[0]);
    Ok(Section::new(
        "Three tubes, held at both ends, are pushed aside by the same force on their middle third. They differ only in how much \
         stiffer they are along their fibres, which run along the tube: the stiffer the fibres, the less the tubes give way.",
    )
    .setting("tube", format!("radii 7 and 11 mm, height 10 cm, {} tetrahedra", mesh.cells.len()))
    .setting("tissue", format!("E = {} kPa, ν = {POISSON} across the fibres; λ and μ 1, 5 and 10 times that along them", YOUNG / 1e3))
    .setting("force", format!("{FORCE} N"))
    .compare_words("5 times as stiff along", [PICTURE, &words(ways[1])], why)
    .compare_words("10 times as stiff along", [PICTURE, &words(ways[2])], why)
    .relation(Relation::falls("the stiffer the fibres, the shorter the way [mm]", &ways))
    .relation(Relation::near("5 times, against the isotropic one, as another program has it", ways[1] / ways[0], OTHER_PROGRAM[1] / OTHER_PROGRAM[0], 0.06))
    .relation(Relation::near("10 times, against the isotropic one, as another program has it", ways[2] / ways[0], OTHER_PROGRAM[2] / OTHER_PROGRAM[0], 0.06))
    .pictures(vec![picture])
    .table("Way of the middle third, and the same from Newton's method in scikit-fem on another mesh of the same tube", table)
    .text("Linear tetrahedra are the stiffer the larger they are, and most where fibres are stiff: the two meshes differ by that."))
}
