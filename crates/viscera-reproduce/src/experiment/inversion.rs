//! Tissue that is turned inside out and let go: what comes back.

use viscera::body::Body;
use viscera::dynamics::implicit::Implicit;
use viscera::material::{LinearElastic, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::mesh::TetMesh;
use viscera::model::corotational::{Rotation, StrainDisplacement};
use viscera::model::{Corotational, MassSpring, ModelRecipe, ShapeMemory, StiffnessWarping, TotalLagrangian};
use viscera::world::{BodyId, Integrator, World, WorldConfig};
use viscera_validation::plot::{Plot, Scale};
use viscera_validation::setting::plane;
use viscera_validation::{Settings, Size, Table};

use super::Experiment;
use crate::deformed::{Deformed, Vector, camera, photograph};
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment =
    Experiment { name: "inversion", title: "Turned inside out", source: "N05, section 3: inverted elements", run };

const WIDTH: f64 = 0.05;
const LENGTH: f64 = 0.1;
const YOUNG: f64 = 10e3;
const POISSON: f64 = 0.3;
/// Damping [1/s]: what swings is at rest after three seconds.
const DAMPING: f64 = 12.0;
/// A node that is nearer than this to its place is back, of the length.
const BACK: f64 = 0.01;
/// What moves slower than this is at rest, in lengths a second.
const STILL: f64 = 0.01;

const NO_NUMBERS: &str = "no numbers";

type Recipe = fn() -> Result<Box<dyn ModelRecipe>, ReproduceError>;

fn linear() -> Result<Tissue, ReproduceError> {
    Ok(Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON)?))
}

/// What theory says of a bar that was turned inside out.
#[derive(Clone, Copy, PartialEq)]
enum Theory {
    /// It comes back.
    Back,
    /// It stays as it is.
    Stays,
    /// Nothing.
    Silent,
}

/// A model, and what to expect of it.
struct Candidate {
    name: &'static str,
    theory: Theory,
    why: &'static str,
    /// Name of the pictures of how it ends, where there are any.
    picture: Option<&'static str>,
    recipe: Recipe,
}

const fn candidate(
    name: &'static str,
    theory: Theory,
    why: &'static str,
    picture: Option<&'static str>,
    recipe: Recipe,
) -> Candidate {
    Candidate { name, theory, why, picture, recipe }
}

const SHAPE_MEMORY: &str = "discrete, shape memory";
const NET: &str = "discrete, mass–spring net";

const MODELS: [Candidate; 10] = [
    candidate(
        "corotational, polar",
        Theory::Back,
        "The rotation of an inverted cell is a rotation all the same: the axis of the smallest stretch is flipped, and the stretch along it is \
         negative, which its stress resists.",
        None,
        || Ok(Box::new(Corotational::new(linear()?))),
    ),
    candidate(
        "corotational, QR",
        Theory::Back,
        "The third axis is the cross product of the other two, right-handed in every cell.",
        None,
        || Ok(Box::new(Corotational::new(linear()?).rotation(Rotation::Qr))),
    ),
    candidate(
        "corotational, SVD",
        Theory::Back,
        "As the polar one: the smallest singular value takes the sign of the volume.",
        None,
        || Ok(Box::new(Corotational::new(linear()?).rotation(Rotation::Svd))),
    ),
    candidate(
        "corotational, polar, B updated",
        Theory::Silent,
        "Its strain is I − S⁻¹ with S = RᵀF: infinite in a flat cell, which an inverted one has to pass through, and never above 1 in a \
         long one, which is hardly drawn back. Nor are its forces the gradient of an energy that could fall to that of rest.",
        Some("b-updated"),
        || Ok(Box::new(Corotational::new(linear()?).strain_displacement(StrainDisplacement::Updated))),
    ),
    candidate(
        "stiffness warping",
        Theory::Silent,
        "Each node has a rotation, right-handed as the polar one of cells.",
        None,
        || Ok(Box::new(StiffnessWarping::new(linear()?))),
    ),
    candidate(
        "St Venant–Kirchhoff",
        Theory::Stays,
        "Its strain ½(FᵀF − I) is that of the mirror image: inside out is as good as at rest.",
        Some("st-venant-kirchhoff"),
        || Ok(Box::new(TotalLagrangian::new(Tissue::uniform(StVenantKirchhoff::from_young_poisson(YOUNG, POISSON)?)))),
    ),
    candidate(
        "neo-Hookean",
        Theory::Silent,
        "Inverted cells are driven back, steeply: below three tenths of its volume the energy of a cell goes on along a parabola. What may \
         hold the bar is another equilibrium, folded over.",
        None,
        || Ok(Box::new(TotalLagrangian::new(Tissue::uniform(NeoHookean::from_young_poisson(YOUNG, POISSON)?)))),
    ),
    candidate(
        "stable neo-Hookean",
        Theory::Back,
        "Inverted cells are driven back, by an energy that nowhere is steep.",
        None,
        || Ok(Box::new(TotalLagrangian::new(Tissue::uniform(StableNeoHookean::from_young_poisson(YOUNG, POISSON)?)))),
    ),
    candidate(
        SHAPE_MEMORY,
        Theory::Back,
        "A node's place is on the side of its neighbours on which it was at rest, and the neighbours have their shape, turned by a rotation that is \
         right-handed inside out as well.",
        Some("shape-memory"),
        || Ok(Box::new(ShapeMemory::new(linear()?))),
    ),
    candidate(
        NET,
        Theory::Stays,
        "Lengths are all that springs know, and those of the mirror image are the same.",
        Some("net"),
        || Ok(Box::new(MassSpring::new(linear()?))),
    ),
];

/// From where the bar is let go.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    /// Pushed through its foot: the mirror image, shorter.
    Mirrored,
    /// Every node at a place of no meaning within the bar.
    Scattered,
    /// Bent and sheared, with no cell inverted.
    Bent,
}

impl Start {
    fn place(self, rest: Vector) -> Vector {
        match self {
            Self::Mirrored => Vector::new(rest.x, rest.y, -0.6 * rest.z),
            Self::Scattered => {
                // The digits of a sine far behind the point have no order.
                let share = |seed: f64| {
                    let mixed = (rest.x * 127.1 + rest.y * 311.7 + rest.z * 74.7 + seed).sin() * 43_758.545;
                    mixed - mixed.floor()
                };
                Vector::new(WIDTH * share(0.0), WIDTH * share(1.0), LENGTH * share(2.0))
            }
            Self::Bent => Vector::new(rest.x + 2.0 * rest.z * rest.z, rest.y + 0.1 * rest.z, rest.z),
        }
    }
}

fn mesh(size: Size) -> TetMesh {
    let across = if size == Size::Full { 4 } else { 2 };
    TetMesh::box_grid([across, across, 2 * across], [WIDTH, WIDTH, LENGTH])
}

fn world(size: Size, recipe: Recipe, start: Start) -> Result<(World<f64>, BodyId), ReproduceError> {
    let config = WorldConfig { gravity: [0.0; 3], step: 0.01, integrator: Integrator::Implicit(Implicit::default()) };
    let mut world = World::new(config)?;
    let id = world.add(Body::new(mesh(size), 1000.0).boxed_model(recipe()?).damping(DAMPING).fix(plane(2, 0.0)))?;
    world.body_mut(id).set_positions(|rest| start.place(rest));
    Ok((world, id))
}

/// What became of a bar.
struct Outcome {
    /// Inverted cells against time [s, %].
    inverted: Vec<(f64, f64)>,
    /// Largest distance of a node from its place in the end, of the length.
    away: f64,
    /// The fastest node in the end, in lengths a second.
    fastest: f64,
    /// The end.
    shape: Deformed,
    /// Why a step was refused, where one was.
    refused: Option<String>,
}

impl Outcome {
    fn still_inverted(&self) -> f64 {
        self.inverted.last().map_or(f64::NAN, |last| last.1)
    }

    fn words(&self) -> String {
        match &self.refused {
            Some(_) => "a step was refused".into(),
            None if self.away < BACK && self.still_inverted() == 0.0 => "back".into(),
            None if self.still_inverted() > 0.0 => {
                format!("{:.1} % of the cells stay inside out", self.still_inverted())
            }
            None => {
                let how = if self.fastest > STILL { "still moving" } else { "at rest in another shape" };
                format!("not back: {:.0} % of the length away, {how}", 100.0 * self.away)
            }
        }
    }
}

fn let_go(size: Size, recipe: Recipe, start: Start) -> Result<Outcome, ReproduceError> {
    let (mut world, id) = world(size, recipe, start)?;
    let steps = 300;
    let cells = world.body(id).cell_count() as f64;
    let (mut inverted, mut refused) = (Vec::new(), None);
    let percent = |world: &mut World<f64>| 100.0 * world.observe(id).inverted_cells as f64 / cells;
    inverted.push((0.0, percent(&mut world)));
    for step in 1..=steps {
        if let Err(error) = world.step() {
            refused = Some(error.to_string());
            break;
        }
        if step <= 50 || step % 10 == 0 {
            inverted.push((world.time(), percent(&mut world)));
        }
    }
    let away = world.observe(id).max_displacement / LENGTH;
    let body = world.body(id);
    let fastest = body.velocities().iter().map(|velocity| velocity.norm()).fold(0.0, f64::max) / LENGTH;
    let mesh = mesh(size);
    let ways: Vec<Vector> = body.positions().iter().zip(&mesh.nodes).map(|(&now, &rest)| now - rest).collect();
    Ok(Outcome { inverted, away, fastest, shape: Deformed::new(&mesh, &ways), refused })
}

/// Places after a few steps from a bend in which no cell is inverted.
fn swung(size: Size, rotation: Rotation) -> Result<Vec<Vector>, ReproduceError> {
    let recipe: Recipe = match rotation {
        Rotation::Polar => MODELS[0].recipe,
        Rotation::Qr => MODELS[1].recipe,
        Rotation::Svd => MODELS[2].recipe,
    };
    let (mut world, id) = world(size, recipe, Start::Bent)?;
    for _ in 0..10 {
        world.step()?;
    }
    Ok(world.body(id).positions().to_vec())
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let size = settings.size;
    let mesh = mesh(size);
    let mut table = Table::new("outcomes", &["model", "mirrored", "scattered"]);
    let mut plot = Plot::new(
        "inverted",
        "Inverted cells of a bar that was pushed through its foot, in the first half second",
        ["time [s]", "inverted cells [%]"],
        Scale::Linear,
    );
    let mut section = Section::new(
        "A bar is pushed through its own foot, so that every cell is inside out, and let go; then once more from a heap in which every \
         node is at a random place. Rotations by polar decomposition, QR and SVD bring the bar back. St Venant–Kirchhoff's law \
         and a net of springs cannot tell a cell from its mirror image and leave it inside out. Shape memory brings back \
         what the net leaves.",
    )
    .setting("bar", format!("5 × 5 × 10 cm, {} tetrahedra, held at its foot", mesh.cells.len()))
    .setting("tissue", format!("E = {} kPa, ν = {POISSON}, damping {DAMPING} 1/s", YOUNG / 1e3))
    .setting("steps", "linearised backward Euler, 10 ms, double precision");
    let mut ends = Vec::new();
    let mut still = Vec::new();
    for Candidate { name, theory, why, picture, recipe } in MODELS {
        let [mirrored, scattered] = [Start::Mirrored, Start::Scattered].map(|start| let_go(size, recipe, start));
        let (mirrored, scattered) = (mirrored?, scattered?);
        table.push(vec![name.into(), mirrored.words(), scattered.words()]);
        let found = format!("mirrored: {}; scattered: {}", mirrored.words(), scattered.words());
        section = section.compare_words(name, [NO_NUMBERS, &found], why);
        section = match theory {
            Theory::Back => section.relation(Relation::at_most(
                format!("{name}: mirrored, it comes back [of the length]"),
                mirrored.away,
                BACK,
            )),
            Theory::Stays => section.relation(Relation::at_least(
                format!("{name}: mirrored, it stays inside out [% of the cells]"),
                mirrored.still_inverted(),
                50.0,
            )),
            Theory::Silent => section,
        };
        still.push((name, [mirrored.still_inverted(), scattered.still_inverted()]));
        for (start, outcome) in [("mirrored", &mirrored), ("scattered", &scattered)] {
            if let Some(picture) = picture {
                ends.push((
                    format!("{picture}-{start}"),
                    format!("{name}, {start}: {}", outcome.words()),
                    outcome.shape.clone(),
                ));
            }
        }
        if mirrored.refused.is_none() {
            plot.curve(name, mirrored.inverted.into_iter().filter(|point| point.0 < 0.505).collect());
        }
    }
    let inverted = |name: &str| still.iter().find(|(other, _)| *other == name).map_or([f64::NAN; 2], |found| found.1);
    let ([memory, memory_scattered], [net, net_scattered]) = (inverted(SHAPE_MEMORY), inverted(NET));
    let [polar, qr, svd] = [Rotation::Polar, Rotation::Qr, Rotation::Svd].map(|rotation| swung(size, rotation));
    let (polar, qr, svd) = (polar?, qr?, svd?);
    let apart = |other: &[Vector]| polar.iter().zip(other).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max) / LENGTH;

    let mut pictures = Vec::new();
    let shapes = [
        ("mirrored", "Pushed through its foot", Start::Mirrored),
        ("scattered", "Every node at a random place", Start::Scattered),
    ]
    .map(|(name, caption, start)| {
        // What is held stays.
        let moved = |&rest: &Vector| if rest.z > 0.0 { start.place(rest) - rest } else { Vector::ZERO };
        (name, caption, Deformed::new(&mesh, &mesh.nodes.iter().map(moved).collect::<Vec<_>>()))
    });
    let view = camera(shapes.iter().map(|(_, _, shape)| shape), [-0.35, 1.0, -0.25], [0.0, 0.0, 1.0]);
    for (name, caption, shape) in &shapes {
        pictures.push(photograph(
            *name,
            format!("{caption}; the bar at rest, translucent"),
            view,
            [shape.ghost(), shape.body()],
        )?);
    }
    // What rests in another shape is framed with the rest; what ran away would make all of them small.
    let near = |shape: &Deformed| {
        shape.bounds().1.max(-shape.bounds().0).to_array().into_iter().fold(0.0, f64::max) < 3.0 * LENGTH
    };
    let view = camera(
        ends.iter().map(|(_, _, shape)| shape).filter(|shape| near(shape)),
        [-0.35, 1.0, -0.25],
        [0.0, 0.0, 1.0],
    );
    let ends =
        ends.into_iter().map(|(name, caption, shape)| photograph(name, caption, view, [shape.ghost(), shape.body()]));
    let ends = ends.collect::<Result<Vec<_>, _>>()?;
    Ok(section
        .relation(Relation::at_most(
            "mirrored, far fewer cells stay inside out with shape memory than in the net: a third of them [%]",
            memory,
            net / 3.0,
        ))
        .relation(Relation::at_most("and fewer when scattered [%]", memory_scattered, net_scattered))
        .relation(Relation::at_most("polar and SVD agree where no cell is inverted [of the length]", apart(&svd), 1e-6))
        .relation(Relation::at_most("QR is near them there [of the length]", apart(&qr), 0.05))
        .pictures(pictures)
        .plot(plot)
        .table("Three seconds after it was let go", table)
        .text("How some of them end:")
        .pictures(ends))
}
