//! Turned as a whole, tissue stores no energy and keeps its volume. Linear elasticity takes the turn for strain.
//!
//! A turn by θ about an axis is the displacement u = (R − I)X. Its linear strain is (cos θ − 1) across the axis, so that a body that
//! is merely turned stores V (cos θ − 1)² (2λ + 2μ). Where one end is turned and the rest is free, the linear rest of the bar takes the
//! skew part, u = sin θ a×X, whose volume is 1 + sin² θ of that at rest.

use std::f64::consts::FRAC_PI_2;

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{Lame, LinearElastic, StVenantKirchhoff, Tissue};
use viscera::mesh::{CubeCut, Region, TetMesh};
use viscera::model::corotational::Tangent;
use viscera::model::{Corotational, LinearTensorMass, ModelRecipe, TensorMass};
use viscera::world::{World, WorldConfig};
use viscera_validation::plot::{Plot, Scale};
use viscera_validation::setting::{Settled, plane};
use viscera_validation::{Settings, Size, Table, brief};

use super::{Experiment, PICTURE};
use crate::deformed::{Deformed, Vector, camera, photograph};
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "rotation",
    title: "A bar that is turned",
    source: "RR, section 2: global rotation of the linear model",
    run,
};

const WIDTH: f64 = 0.05;
const LENGTH: f64 = 0.2;
const YOUNG: f64 = 10e3;
const POISSON: f64 = 0.4;

#[derive(Clone, Copy, PartialEq)]
enum Law {
    Linear,
    NonLinear,
    Corotational,
}

impl Law {
    const ALL: [Self; 3] = [Self::Linear, Self::NonLinear, Self::Corotational];

    fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::NonLinear => "St Venant–Kirchhoff",
            Self::Corotational => "corotational",
        }
    }

    fn model(self) -> Result<Box<dyn ModelRecipe>, ReproduceError> {
        let linear = Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON)?);
        Ok(match self {
            Self::Linear => Box::new(LinearTensorMass::new(linear)),
            Self::NonLinear => {
                Box::new(TensorMass::new(Tissue::uniform(StVenantKirchhoff::from_young_poisson(YOUNG, POISSON)?)))
            }
            Self::Corotational => Box::new(Corotational::new(linear).tangent(Tangent::Exact)),
        })
    }
}

/// Turned by `angle` about y.
fn turned(place: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    Vector::new(cos * place.x + sin * place.z, place.y, cos * place.z - sin * place.x)
}

/// Cut alike on both sides of the middle: of six tetrahedra to a cube, all diagonals lean one way, and the squeezed end would turn the bar.
fn bar(size: Size) -> TetMesh {
    let across = if size == Size::Full { 4 } else { 2 };
    TetMesh::box_grid_cut([across, across, 4 * across], [WIDTH, WIDTH, LENGTH], CubeCut::Five)
}

/// The bar whose lower end is turned by `angle` about y while the rest is free, at rest.
fn led(mesh: &TetMesh, law: Law, angle: f64) -> Result<Deformed, ReproduceError> {
    let mut body = Body::new(mesh.clone(), 1000.0).boxed_model(law.model()?);
    for node in plane(2, 0.0).nodes(&mesh.clone().into())? {
        let place = mesh.nodes[node as usize];
        body = body.prescribe(Region::Nodes(vec![node]), Curve::constant(turned(place, angle) - place));
    }
    let settings = QuasiStatic { small_strain: law == Law::Linear, ..QuasiStatic::default() };
    Ok(Deformed::new(mesh, &Settled::new(body, [0.0; 3], &settings)?.displacements()))
}

/// The energy of the free bar turned by `angle` as a whole [J].
fn energy(mesh: &TetMesh, law: Law, angle: f64) -> Result<f64, ReproduceError> {
    let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], ..WorldConfig::default() })?;
    let id = world.add(Body::new(mesh.clone(), 1000.0).boxed_model(law.model()?))?;
    world.body_mut(id).set_positions(|place| turned(place, angle));
    Ok(world.observe(id).elastic_energy)
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let mesh = bar(settings.size);
    let lame = Lame::from_young_poisson(YOUNG, POISSON)?;
    let angles = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0];

    let mut growth = Table::new(
        "growth",
        &["angle [°]", "linear [%]", "its far half [%]", "St Venant–Kirchhoff [%]", "corotational [%]"],
    );
    let mut plot = Plot::new(
        "growth",
        "Change of volume of a bar whose end is turned",
        ["angle [°]", "change of volume [%]"],
        Scale::Linear,
    );
    let mut shapes = Vec::new();
    for law in Law::ALL {
        let shape = |&degrees: &f64| led(&mesh, law, degrees.to_radians());
        shapes.push(angles.iter().map(shape).collect::<Result<Vec<_>, _>>()?);
    }
    let percent = |law: usize, step: usize| 100.0 * shapes[law][step].volume_variation();
    let far = |step: usize| 100.0 * shapes[0][step].volume_variation_above(0.5 * LENGTH);
    // Rounding below zero is no shrinking.
    let hundredths = |value: f64| format!("{:.2}", (100.0 * value).round() / 100.0 + 0.0);
    for (step, degrees) in angles.iter().enumerate() {
        let row = [percent(0, step), far(step), percent(1, step), percent(2, step)].map(hundredths);
        growth.push([degrees.to_string()].into_iter().chain(row).collect());
    }
    for (number, law) in Law::ALL.iter().enumerate() {
        plot.curve(law.name(), angles.iter().enumerate().map(|(step, &a)| (a, percent(number, step))).collect());
    }
    plot.curve("linear, far half", angles.iter().enumerate().map(|(step, &a)| (a, far(step))).collect());
    plot.reference("100 % sin² θ", angles.iter().map(|&a| (a, 100.0 * a.to_radians().sin().powi(2))).collect());

    let exact = mesh.volume() * 2.0 * (lame.lambda + lame.mu);
    let energies = Law::ALL.map(|law| energy(&mesh, law, FRAC_PI_2));
    let [linear, non_linear, corotational] = energies;
    let (linear, non_linear, corotational) = (linear?, non_linear?, corotational?);

    let last = angles.len() - 1;
    let ends = [0, 1, 2].map(|law| &shapes[law][last]);
    let view = camera(ends, [-0.35, 1.0, -0.25], [0.0, 0.0, 1.0]);
    let mut pictures = Vec::new();
    for (law, shape) in Law::ALL.iter().zip(ends) {
        let caption = format!("{}: the end turned by 90°, and the bar at rest", law.name());
        let name = law.name().to_lowercase().replace([' ', '–'], "-");
        pictures.push(photograph(name, caption, view, [shape.ghost(), shape.body_by_swelling(100.0)])?);
    }
    let [of_linear, of_non_linear, of_corotational] = [0, 1, 2].map(|law| percent(law, last));
    let off_theory = (1..angles.len()).map(|step| (far(step) / 100.0 - angles[step].to_radians().sin().powi(2)).abs());

    Ok(Section::new(
        "A bar is turned by up to 90°, once by its lower end and once as a whole. The non-linear law and the corotational model \
         follow without strain. The linear law takes the turn for strain: the bar swells, and turned as a whole it stores energy.",
    )
    .setting("bar", format!("{} × {} × {} cm, {} tetrahedra", 5, 5, 20, mesh.cells.len()))
    .setting("tissue", format!("E = {} kPa, ν = {POISSON}", YOUNG / 1e3))
    .setting("turn", "about an axis across the bar; the nodes of the lower end are led, the others free")
    .compare_words(
        "the linear bar, turned by 90°",
        [PICTURE, &format!("grows by {of_linear:.0} %, its far half by {:.0} %", far(last))],
        "In theory the far half doubles; the end that is led is squeezed to nothing along x.",
    )
    .compare_words(
        "the non-linear bar, turned by 90°",
        [PICTURE, &format!("keeps its volume to {:.0e} %", of_non_linear.abs())],
        "",
    )
    .relation(Relation::near("turned as a whole, the linear bar stores 2 (λ + μ) V", linear / exact, 1.0, 1e-9))
    .relation(Relation::at_most("turned as a whole, the non-linear bar stores nothing of that", non_linear / exact, 1e-20))
    .relation(Relation::at_most("nor does the corotational one", corotational.abs() / exact, 1e-12))
    .relation(Relation::at_most(
        "turned by its end, the far half of the linear bar grows by sin² θ: largest difference",
        off_theory.fold(0.0, f64::max),
        2e-3,
    ))
    .relation(Relation::at_least("and the whole bar by most of that at 90° [%]", of_linear, 80.0))
    .relation(Relation::at_most("the non-linear bar keeps its volume [%]", of_non_linear.abs(), 1e-6))
    .relation(Relation::at_most("so does the corotational one [%]", of_corotational.abs(), 1e-6))
    .plot(plot)
    .pictures(pictures)
    .table("Change of volume of the bar whose end is turned", growth)
    .text(format!(
        "Turned by 90° as a whole the linear bar stores {} J, St Venant–Kirchhoff's {:.0e} J.",
        brief(linear),
        non_linear
    )))
}
