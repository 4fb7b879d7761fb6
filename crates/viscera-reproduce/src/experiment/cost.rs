//! What a step of the non-linear tensor-mass model costs beside one of the linear model.

use viscera::body::Body;
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};
use viscera::mesh::{Region, TetMesh, TetTopology};
use viscera::model::{LinearTensorMass, ModelRecipe, TensorMass, TotalLagrangian};
use viscera_validation::step_cost::time_of_substep;
use viscera_validation::{Settings, Size, Table, brief};

use super::Experiment;
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cost",
    title: "What non-linearity costs",
    source: "RR, section 5: cost of the non-linear model",
    run,
};

/// Non-linear over linear, as published.
const PUBLISHED: f64 = 5.0;
const YOUNG: f64 = 5e3;
const POISSON: f64 = 0.4;

/// Numbers that a step reads from the tables: of the linear model a matrix on vertices and edges; of the non-linear one tensors,
/// vectors and scalars on vertices, edges, triangles and tetrahedra (RR, table 1).
fn numbers_read(mesh: &TetMesh) -> [usize; 2] {
    let topology = TetTopology::new(mesh);
    let (vertices, edges) = (mesh.nodes.len(), topology.edges.len());
    let (triangles, tetrahedra) = (topology.faces.len(), mesh.cells.len());
    let non_linear = vertices * (9 + 3 + 1) + edges * (9 + 4 * 3 + 5) + triangles * (3 * 3 + 9) + tetrahedra * 6;
    [9 * (vertices + edges), non_linear]
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let mesh = TetMesh::liver(0.3, if settings.size == Size::Full { 0.016 } else { 0.03 })?;
    let linear = || LinearElastic::from_young_poisson(YOUNG, POISSON).map(Tissue::uniform);
    let quadratic = || StVenantKirchhoff::from_young_poisson(YOUNG, POISSON).map(Tissue::uniform);
    let recipe = |number: usize| -> Result<Box<dyn ModelRecipe>, ReproduceError> {
        Ok(match number {
            0 => Box::new(LinearTensorMass::new(linear()?)),
            1 => Box::new(TensorMass::new(quadratic()?)),
            _ => Box::new(TotalLagrangian::new(quadratic()?)),
        })
    };
    let names = ["linear tensor-mass", "tensor-mass, St Venant–Kirchhoff", "total-Lagrangian, St Venant–Kirchhoff"];
    let mut times = [[0.0; 2]; 3];
    let mut table = Table::new(
        "times",
        &["model", "single precision [ms]", "over linear", "double precision [ms]", "over linear "],
    );
    for (number, name) in names.iter().enumerate() {
        let body = || -> Result<Body, ReproduceError> {
            let body = Body::new(mesh.clone(), 1060.0).boxed_model(recipe(number)?);
            Ok(body.fix(Region::Named("back".into())))
        };
        times[number] = [time_of_substep::<f32>(body()?)?, time_of_substep::<f64>(body()?)?];
        let ratio = |precision: usize| format!("{:.2}", times[number][precision] / times[0][precision]);
        table.push(vec![(*name).into(), brief(times[number][0]), ratio(0), brief(times[number][1]), ratio(1)]);
    }
    let [few, many] = numbers_read(&mesh);
    let of_numbers = many as f64 / few as f64;
    let of_time = times[1][1] / times[0][1];
    Ok(Section::new(
        "An explicit step of the non-linear tensor-mass model beside one of the linear model, on the same liver. The paper finds it \
         five times as costly.",
    )
    .setting("liver", format!("{} tetrahedra, {} vertices", mesh.cells.len(), mesh.nodes.len()))
    .setting("time", "of one explicit sub-step, one thread, the best of six")
    .compare(
        "time, non-linear over linear, double precision",
        "",
        [PUBLISHED, of_time],
        "Another machine: here the linear model is computed in vectors as well, and what counts is how much of the tables a \
         step reads from memory.",
    )
    .compare_words(
        "numbers read, non-linear over linear",
        ["not given", &brief(of_numbers)],
        "Counted from the tables of both models. The paper gives times alone; the tables, which do not depend on the machine, \
         explain them.",
    )
    .relation(Relation::near("numbers read, over the published ratio of times", of_numbers / PUBLISHED, 1.0, 0.35))
    .table("Time of a sub-step", table)
    .text(format!(
        "A step of the linear model reads {few} numbers, one of the non-linear model {many}. The last row computes the same forces \
         as the one above it straight from the law, without tables."
    )))
}
