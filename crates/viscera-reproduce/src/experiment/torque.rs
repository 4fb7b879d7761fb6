//! Forces of an element that are computed with a strain-displacement matrix of the shape at rest may turn the element. Where, and what
//! comes of it.

use viscera::body::Body;
use viscera::material::{Lame, LinearElastic, Tissue, TransverseLinear};
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::corotational::{Rotation, StrainDisplacement};
use viscera::model::{Corotational, ModelRecipe, StiffnessWarping};
use viscera::world::{BodyId, World, WorldConfig};
use viscera_validation::plot::{Plot, Scale};
use viscera_validation::{Settings, Size, Table};

use super::Experiment;
use crate::deformed::{Deformed, Vector, camera, photograph};
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "torque",
    title: "The torque of an outdated B",
    source: "N05, section 3: strain-displacement matrix at rest or updated",
    run,
};

const WIDTH: f64 = 0.05;
const LENGTH: f64 = 0.2;
const YOUNG: f64 = 10e3;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 1000.0;

/// A way to compute the bar.
#[derive(Clone, Copy, PartialEq)]
struct Variant {
    name: &'static str,
    hexahedra: bool,
    fibres: bool,
    /// Nothing for stiffness warping by node.
    rotation: Option<Rotation>,
    strain: StrainDisplacement,
    /// Whether theory has a torque.
    turns: bool,
}

const fn variant(
    name: &'static str,
    [hexahedra, fibres, turns]: [bool; 3],
    rotation: Option<Rotation>,
    strain: StrainDisplacement,
) -> Variant {
    Variant { name, hexahedra, fibres, rotation, strain, turns }
}

const AT_REST: StrainDisplacement = StrainDisplacement::AtRest;
const UPDATED: StrainDisplacement = StrainDisplacement::Updated;
const VARIANTS: [Variant; 9] = [
    variant("polar, B at rest", [false, false, false], Some(Rotation::Polar), AT_REST),
    variant("SVD, B at rest", [false, false, false], Some(Rotation::Svd), AT_REST),
    variant("QR, B at rest", [false, false, true], Some(Rotation::Qr), AT_REST),
    variant("polar, B at rest, fibres", [false, true, true], Some(Rotation::Polar), AT_REST),
    variant("polar, B at rest, hexahedra", [true, false, true], Some(Rotation::Polar), AT_REST),
    variant("polar, B updated", [false, false, false], Some(Rotation::Polar), UPDATED),
    variant("QR, B updated", [false, false, false], Some(Rotation::Qr), UPDATED),
    variant("polar, B updated, fibres", [false, true, false], Some(Rotation::Polar), UPDATED),
    variant("stiffness warping by node", [false, false, true], None, AT_REST),
];

/// Variants whose ends are shown, and the names of the pictures: one without a torque and two that begin to spin.
const PICTURED: [(&str, &str); 3] =
    [("polar, B at rest", "polar"), ("QR, B at rest", "qr"), ("stiffness warping by node", "warping")];

impl Variant {
    fn world(&self, size: Size) -> Result<(World<f64>, BodyId), ReproduceError> {
        let across = if size == Size::Full { 4 } else { 2 };
        let (cells, extent) = ([across, across, 4 * across], [WIDTH, WIDTH, LENGTH]);
        let mesh: VolumeMesh = if self.hexahedra {
            HexMesh::box_grid(cells, extent).into()
        } else {
            TetMesh::box_grid(cells, extent).into()
        };
        let lame = Lame::from_young_poisson(YOUNG, POISSON)?;
        let tissue = if self.fibres {
            let along = Lame::new(5.0 * lame.lambda, 5.0 * lame.mu)?;
            Tissue::uniform(TransverseLinear::new(lame, [1.0, 1.0, 1.0], along)?)
        } else {
            Tissue::uniform(LinearElastic::new(lame))
        };
        let recipe: Box<dyn ModelRecipe> = match self.rotation {
            None => Box::new(StiffnessWarping::new(tissue)),
            Some(rotation) => Box::new(Corotational::new(tissue).rotation(rotation).strain_displacement(self.strain)),
        };
        let mut world = World::new(WorldConfig { gravity: [0.0; 3], step: 2e-3, ..WorldConfig::default() })?;
        let id = world.add(Body::new(mesh, DENSITY).boxed_model(recipe))?;
        world.body_mut(id).set_positions(out_of_shape);
        Ok((world, id))
    }
}

/// The bar, twisted by 1.5 rad, bent sideways by 15 % of its length, sheared and stretched.
fn out_of_shape(place: Vector) -> Vector {
    let along = place.z / LENGTH;
    let bend = 0.15 * LENGTH * along * along;
    let (sin, cos) = (1.5 * along).sin_cos();
    Vector::new(cos * place.x - sin * place.y + bend, sin * place.x + cos * place.y, 1.1 * place.z + 0.1 * place.x)
}

/// What a variant does to a bar that nothing holds.
struct Found {
    /// Sum of the internal forces, and their torque over length, of the size of the forces.
    force: f64,
    torque: f64,
    /// Angular momentum against time [s, g m²/s].
    momentum: Vec<(f64, f64)>,
    /// The bar when it is let go and in the end; nothing of hexahedra.
    shapes: Option<[Deformed; 2]>,
}

fn shape(world: &World<f64>, id: BodyId) -> Option<Deformed> {
    let body = world.body(id);
    let VolumeMesh::Tet(mesh) = body.mesh() else { return None };
    let ways: Vec<Vector> = body.positions().iter().zip(&mesh.nodes).map(|(&now, &rest)| now - rest).collect();
    Some(Deformed::new(mesh, &ways))
}

fn found(variant: &Variant, size: Size) -> Result<Found, ReproduceError> {
    let (mut world, id) = variant.world(size)?;
    let observed = world.observe(id);
    let forces: f64 = world.body(id).state().internal_forces.iter().map(|force| force.norm()).sum();
    let (force, torque) = (observed.net_internal_force.norm(), observed.net_internal_torque.norm());
    let start = shape(&world, id);
    let mut momentum = vec![(0.0, 0.0)];
    let steps = if size == Size::Full { 100 } else { 20 };
    for step in 1..=steps {
        // An updated B has no energy behind it, and may run away; the curve then ends.
        if world.step().is_err() {
            break;
        }
        if step % (steps / 10) == 0 {
            momentum.push((world.time(), 1e3 * world.observe(id).angular_momentum.norm()));
        }
    }
    let shapes = start.zip(shape(&world, id)).map(|(start, end)| [start, end]);
    Ok(Found { force: force / forces, torque: torque / (forces * LENGTH), momentum, shapes })
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let mut section = Section::new(
        "A bar that nothing holds is put out of shape. Its internal forces must neither push nor turn it. Computed by element they never push it. With B \
         of the shape at rest they turn it, as the paper says, but not always: not on isotropic tetrahedra whose rotation is the \
         polar one. Let go, a bar with a torque begins to spin by itself.",
    )
    .setting("bar", "5 × 5 × 20 cm, twisted by 1.5 rad, bent, sheared and stretched; nothing holds it")
    .setting("tissue", format!("E = {} kPa, ν = {POISSON}; with fibres 5 times as stiff along (1, 1, 1)", YOUNG / 1e3));
    let mut table = Table::new(
        "torques",
        &[
            "variant",
            "sum of the forces / their sizes",
            "torque / (sizes × length)",
            "angular momentum at the end [g m²/s]",
        ],
    );
    let mut plot = Plot::new(
        "momentum",
        "Angular momentum of a bar that nothing turns",
        ["time [s]", "angular momentum [g m²/s]"],
        Scale::Linear,
    );
    let mut pushed = 0.0_f64;
    let mut pictured = Vec::new();
    for variant in &VARIANTS {
        let Found { force, torque, momentum, shapes } = found(variant, settings.size)?;
        if let (Some((_, name)), Some(ends)) = (PICTURED.iter().find(|(pictured, _)| *pictured == variant.name), shapes)
        {
            pictured.push((*name, variant.name, ends));
        }
        // Each node turns its own forces: what two nodes do to each other is not opposite.
        if variant.rotation.is_some() {
            pushed = pushed.max(force);
        } else {
            section = section.relation(Relation::at_least("sum of the forces, stiffness warping by node", force, 1e-4));
        }
        let claim = format!("torque, {}", variant.name);
        section = section.relation(match variant.turns {
            true => Relation::at_least(claim, torque, 1e-5),
            false => Relation::at_most(claim, torque, 1e-12),
        });
        let end = momentum.last().map_or(0.0, |last| last.1);
        table.push(vec![variant.name.into(), format!("{force:.0e}"), format!("{torque:.1e}"), format!("{end:.1e}")]);
        plot.curve(variant.name, momentum);
    }
    let view = camera(pictured.iter().flat_map(|(_, _, shapes)| shapes), [-0.35, 1.0, -0.25], [0.0, 0.0, 1.0]);
    let mut pictures = Vec::new();
    if let Some((_, _, [start, _])) = pictured.first() {
        let caption = "When it is let go; the bar at rest, translucent";
        pictures.push(photograph("start", caption, view, [start.ghost(), start.body()])?);
    }
    for (name, variant, [_, end]) in &pictured {
        pictures.push(photograph(*name, format!("{variant}, in the end"), view, [end.ghost(), end.body()])?);
    }
    Ok(section
        .relation(Relation::at_most("sum of the forces, every variant by element", pushed, 1e-12))
        .compare_words(
            "torque of B at rest",
            ["always, so that B must be updated", "none for polar or SVD on isotropic tetrahedra"],
            "There F = R S with S and the stress of it sharing their axes, so that the stress is symmetric in the current shape; \
             fibres, QR and one rotation for a whole hexahedron break that.",
        )
        .compare_words("torque of B updated", ["none", "none"], "")
        .pictures(pictures)
        .plot(plot)
        .table("Forces of the bar when it is let go, and what comes of them", table))
}
