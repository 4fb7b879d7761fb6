//! A lobe is pulled and burnt off, with adaptive non-linearity.

use std::time::Instant;

use viscera::instrument::Capsule;
use viscera::math::Vec3;
use viscera::mesh::VolumeMesh;
use viscera_io::picture::{Body, Camera, Picture, Tool};
use viscera_scene::BuiltScene;
use viscera_session::library;
use viscera_validation::plot::{Plot, Scale};
use viscera_validation::{Settings, Size, Table};

use super::{CURVE, Experiment};
use crate::section::Photograph;
use crate::{Relation, ReproduceError, Section};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "resection",
    title: "A lobe that is burnt off",
    source: "RR, section 6: rate and non-linear vertices during a resection",
    run,
};

/// Young's modulus, and that along the fibres, which lie along the liver [kPa].
const YOUNG: f64 = 3.0;
const YOUNG_ALONG: f64 = 4.5;
/// κ of the force that keeps the volume [kPa].
const KEEP_VOLUME: f64 = 20.0;
/// Damping [1/s]: vertices that change from one law to the other feed energy in, which this takes out.
const DAMPING: f64 = 60.0;

/// A moment of the run.
struct Moment {
    time: f64,
    /// Cells that are left.
    cells: usize,
    /// Share of the vertices that follow the full law [%].
    non_linear: f64,
    /// Sub-steps per second of computing, since the moment before.
    rate: f64,
}

fn scene(size: Size) -> Result<BuiltScene<f64>, ReproduceError> {
    let mut scene = library::scene("liver-resection").expect("the scene is built in")?;
    scene.set("body.liver.mesh.edge", if size == Size::Full { "16 mm" } else { "26 mm" })?;
    let fibre = format!("{{ direction = [1, 0, 0], young = \"{YOUNG_ALONG} kPa\" }}");
    scene.set("body.liver.law.young", &format!("{YOUNG} kPa"))?;
    scene.set("body.liver.law.fibre", &fibre)?;
    let model = format!("{{ kind = \"tensor-mass\", adaptive = \"2 cm\", keep-volume = \"{KEEP_VOLUME} kPa\" }}");
    scene.set("body.liver.model", &model)?;
    scene.set("body.liver.damping", &format!("{DAMPING} 1/s"))?;
    scene.set("duration", "3 s")?;
    Ok(scene.build()?)
}

/// Volume at rest of the cells that are left [m³].
fn rest_of_what_is_left(built: &BuiltScene<f64>) -> f64 {
    let body = built.world.body(built.bodies["liver"]);
    let VolumeMesh::Tet(mesh) = body.mesh() else { return f64::NAN };
    let left = (0..mesh.cells.len()).filter(|&cell| !body.state().removed[cell]);
    left.map(|cell| mesh.cell_volume(cell)).sum()
}

fn photograph(built: &BuiltScene<f64>, camera: Camera, name: &str) -> Result<Photograph, ReproduceError> {
    let body = built.world.body(built.bodies["liver"]);
    let surface = body.surface();
    let triangles: Vec<[u32; 3]> = surface.iter().map(|triangle| triangle.nodes).collect();
    let bare: Vec<bool> = surface.iter().map(|triangle| triangle.cut).collect();
    let mut picture = Picture::new(720, 480).camera(camera);
    picture = picture.body(Body::new(body.positions(), &triangles).tissue().cut(&bare).wireframe());
    for &instrument in built.instruments.values() {
        for Capsule { from, to, radius, .. } in built.world.tool_capsules(instrument) {
            picture = picture.tool(Tool::capsule(from.to_array(), to.to_array(), radius));
        }
        let tip = built.world.observe_instrument(instrument).tip;
        picture = picture.tool(Tool::sphere(tip.to_array(), 0.004));
    }
    let caption = format!("{:.1} s: {} tetrahedra are left", built.world.time(), body.cell_count());
    Ok(Photograph { name: name.into(), caption, image: picture.render()? })
}

fn run(settings: &Settings) -> Result<Section, ReproduceError> {
    let mut built = scene(settings.size)?;
    let liver = built.bodies["liver"];
    let (cells, vertices) = (built.world.body(liver).cell_count(), built.world.body(liver).positions().len());
    let (low, high) = built.world.body(liver).mesh().bounds();
    let room = Vec3::new(0.03, 0.02, 0.0);
    let camera = Camera::framing(low - room, high + room).towards([-0.15, -0.35, -1.0]);

    let mut pictures = vec![photograph(&built, camera, "start")?];
    let mut moments = Vec::new();
    let (steps, rows) = (built.steps(), 30);
    let (mut substeps, mut seconds) = (0, 0.0);
    for step in 1..=steps {
        let start = Instant::now();
        substeps += built.world.step()?.substeps;
        seconds += start.elapsed().as_secs_f64();
        if step % (steps / rows) == 0 {
            let observed = built.world.observe(liver);
            moments.push(Moment {
                time: built.world.time(),
                cells: cells - observed.removed_cells,
                non_linear: 100.0 * observed.nonlinear_nodes as f64 / vertices as f64,
                rate: f64::from(std::mem::take(&mut substeps)) / std::mem::take(&mut seconds),
            });
        }
        if step == steps / 2 {
            pictures.push(photograph(&built, camera, "middle")?);
        }
    }
    pictures.push(photograph(&built, camera, "end")?);

    let mut table =
        Table::new("run", &["time [s]", "tetrahedra left", "non-linear vertices [%]", "sub-steps per second"]);
    for moment in &moments {
        table.push(vec![
            format!("{:.1}", moment.time),
            moment.cells.to_string(),
            format!("{:.1}", moment.non_linear),
            format!("{:.0}", moment.rate),
        ]);
    }
    let along = |of: &dyn Fn(&Moment) -> f64| moments.iter().map(|moment| (moment.time, of(moment))).collect();
    let mut shares =
        Plot::new("shares", "What is left, and what follows the full law", ["time [s]", "%"], Scale::Linear);
    shares.curve("tetrahedra left", along(&|moment| 100.0 * moment.cells as f64 / cells as f64));
    shares.curve("non-linear vertices", along(&|moment| moment.non_linear));
    let mut rate = Plot::new("rate", "Rate during the resection", ["time [s]", "sub-steps per second"], Scale::Linear);
    rate.curve("tensor-mass, threshold 2 cm", along(&|moment| moment.rate));

    let most = moments.iter().map(|moment| moment.non_linear).fold(0.0, f64::max);
    let cut: Vec<&Moment> = moments.iter().filter(|moment| moment.cells < cells).collect();
    let before = moments.iter().filter(|moment| moment.cells == cells);
    let rates = [before.map(|m| m.rate).collect::<Vec<_>>(), cut.iter().map(|m| m.rate).collect()];
    let [before, during] = rates.map(|rates| rates.iter().sum::<f64>() / rates.len() as f64);
    let end = moments.last().map_or(cells, |moment| moment.cells);
    let observed = built.world.observe(liver);
    Ok(Section::new(
        "A grasper pulls the left lobe of a liver and a cautery burns it off. Vertices that have moved by more than 2 cm follow the \
         full law; tetrahedra that are burnt take their tensors out of the tables.",
    )
    .setting("scene", "liver-resection with the model tensor-mass, adaptive at 2 cm; double precision, one thread")
    .setting("tissue", format!("E = {YOUNG} kPa, {YOUNG_ALONG} kPa along fibres from lobe to lobe, ν = 0.4"))
    .setting("force that keeps the volume", format!("κ = {KEEP_VOLUME} kPa"))
    .setting(
        "damping",
        format!(
            "{DAMPING} 1/s, where the scene itself has 3: vertices that change from one law to the other feed energy in, and \
             with 3 the liver runs away"
        ),
    )
    .setting("liver", format!("{cells} tetrahedra, {vertices} vertices"))
    .compare_words(
        "rate while cutting",
        [CURVE, &format!("{during:.0} sub-steps per second, {before:.0} before the first cut")],
        "Another organ and another machine: rates are reported, and held to nothing.",
    )
    .compare_words(
        "vertices in non-linear mode",
        [CURVE, &format!("up to {most:.0} %")],
        "Another pull: how many vertices go farther than 2 cm follows from it.",
    )
    .relation(Relation::at_least("part of the liver that is burnt away [%]", 100.0 * (cells - end) as f64 / cells as f64, 5.0))
    .relation(Relation::at_least("vertices that follow the full law, at most [%]", most, 1.0))
    .relation(Relation::at_most("and never all of them [%]", most, 80.0))
    .relation(Relation::at_most("cells that are inside out at the end [%]", 100.0 * observed.inverted_cells as f64 / end as f64, 1.0))
    .relation(Relation::near("mass that is left, of the volume that is left", observed.mass / (1060.0 * rest_of_what_is_left(&built)), 1.0, 1e-9))
    .pictures(pictures)
    .plot(shares)
    .plot(rate)
    .table("The run, every tenth of a second", table))
}
