//! `cargo bench -p viscera-benches`: forces, products, steps and cuts per element, in both precisions, at three sizes.
//!
//! `-- --quick` takes a quick look, `-- forces/tensor-mass` some of them. At the end stands one line for each, with the
//! share of the machine's own peak.

use std::cell::RefCell;
use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, SamplingMode};
use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, MatrixForm};
use viscera::executor::Executor;
use viscera::instrument::Probe;
use viscera::material::{
    Lame, LinearElastic, StVenantKirchhoff, StableNeoHookean, Tissue, TransverseStVenantKirchhoff,
};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::{
    Corotational, ForceModel, LinearTensorMass, ModelRecipe, NodallyIntegrated, Precision, Scratch, TensorMass,
    TotalLagrangian, VolumePenalty,
};
use viscera::solver::Stop;
use viscera::world::{Integrator, World, WorldConfig};
use viscera_benches::{Machine, Results, instruction_set};

/// Cells of the beam of 0.1×0.1×0.4 m along its axes: 1536, 12 288 and 98 304 tetrahedra.
const SIZES: [[usize; 3]; 3] = [[4, 4, 16], [8, 8, 32], [16, 16, 64]];
const BEAM: [f64; 3] = [0.1, 0.1, 0.4]; // m
/// A million tetrahedra, for what grows with the mesh.
const LARGE: [usize; 3] = [32, 32, 163];

/// Iterations of the conjugate gradient in an implicit step.
const ITERATIONS: u32 = 25;

/// What a measurement is to be compared with.
#[derive(Clone, Copy)]
enum Yardstick {
    /// Operations of one element against the peak of multiply-adds.
    Flops(f64),
    /// Bytes that one evaluation reads against the bandwidth.
    Bytes(f64),
    /// Nothing.
    None,
}

struct Suite<'a> {
    machine: Machine,
    group: RefCell<BenchmarkGroup<'a, WallTime>>,
    lines: RefCell<Vec<String>>,
    results: RefCell<Results>,
}

impl Suite<'_> {
    /// Measures `round`, which handles `elements` elements and gives the time that counts, of which the best is told: whatever
    /// else the machine does makes a round only longer, and the peak beside it is the best of several runs as well.
    fn measure<T: Precision>(
        &self,
        name: &str,
        elements: usize,
        yardstick: Yardstick,
        mut round: impl FnMut() -> Duration,
    ) {
        let id = format!("{name}/{}/{elements}", T::NAME);
        let mut best = Duration::MAX;
        self.group.borrow_mut().bench_function(&id, |bencher| {
            bencher.iter_custom(|rounds| {
                let mut next = || {
                    let time = round();
                    best = best.min(time);
                    time
                };
                (0..rounds).map(|_| next()).sum()
            });
        });
        if best == Duration::MAX {
            return; // not asked for
        }
        let seconds = best.as_secs_f64();
        let share = match yardstick {
            Yardstick::Flops(each) => {
                let flops = each * elements as f64 / seconds;
                let share = 100.0 * flops / self.machine.flops::<T>();
                format!("{share:3.0} % of FMA peak ({:.1} GFLOP/s)", flops / 1e9)
            }
            Yardstick::Bytes(bytes) => {
                let share = 100.0 * bytes / seconds / self.machine.bandwidth;
                format!("{share:3.0} % of bandwidth ({:.1} GB/s)", bytes / seconds / 1e9)
            }
            Yardstick::None => String::new(),
        };
        self.results.borrow_mut().add(id.clone(), seconds / elements as f64, share.clone());
        let each = seconds * 1e9 / elements as f64;
        let threads = if id.contains("/threads-2/") { "2 threads" } else { "1 thread " };
        let line = format!("{id:<58} {each:8.2} ns/element   {share:<38} {threads}   {}", instruction_set());
        self.lines.borrow_mut().push(line);
    }

    fn forces<T: Precision>(&self, name: &str, model: &dyn ForceModel<T>, mesh: &VolumeMesh, flops: Option<f64>) {
        let x = stretched::<T>(mesh);
        let (mut scratch, mut out) = (Scratch::new(x.len()), vec![Vec3::ZERO; x.len()]);
        let yardstick = flops.map_or(Yardstick::Bytes(model.bytes() as f64), Yardstick::Flops);
        self.measure::<T>(&format!("forces/{name}"), mesh.cell_count(), yardstick, || {
            let begin = Instant::now();
            model.add_forces(black_box(&x), &mut scratch, black_box(&mut out));
            begin.elapsed()
        });
    }

    /// One sub-step of a beam that swings under gravity, all that belongs to it: forces, loads, motion, guard.
    fn substep<T: Precision>(
        &self,
        name: &str,
        mesh: &VolumeMesh,
        recipe: Box<dyn ModelRecipe>,
        flops: Option<f64>,
        executor: &Executor,
    ) {
        let mut world = World::<T>::new(WorldConfig { step: 1e-2, ..WorldConfig::default() }).unwrap();
        let held = Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0);
        world.add(Body::new(mesh.clone(), 1000.0).boxed_model(recipe).fix(held)).unwrap();
        let snapshot = world.snapshot();
        let yardstick = flops.map_or(Yardstick::None, Yardstick::Flops);
        self.measure::<T>(&on(executor, "substep", name), mesh.cell_count(), yardstick, || {
            let begin = Instant::now();
            let substeps = world.step_on(executor).unwrap().substeps;
            let elapsed = begin.elapsed();
            if world.time() > 0.05 {
                world.restore(&snapshot).unwrap();
            }
            elapsed / substeps
        });
    }

    /// One product with the stiffness, prepared for.
    fn product<T: Precision>(&self, name: &str, model: &dyn ForceModel<T>, mesh: &VolumeMesh, flops: Option<f64>) {
        let x = stretched::<T>(mesh);
        let mut scratch = Scratch::new(x.len());
        let (dx, mut out) = (x.clone(), vec![Vec3::ZERO; x.len()]);
        model.linearize(&x, &mut scratch);
        let yardstick = flops.map_or(Yardstick::None, Yardstick::Flops);
        self.measure::<T>(&format!("product/{name}"), mesh.cell_count(), yardstick, || {
            let begin = Instant::now();
            model.add_product(black_box(&x), black_box(&dx), &mut scratch, black_box(&mut out));
            begin.elapsed()
        });
    }

    /// One implicit step of a beam that swings under gravity, linearised, with 25 iterations of the conjugate gradient: the
    /// time per element and iteration, with all that belongs to a step in it.
    fn implicit<T: Precision>(
        &self,
        name: &str,
        mesh: &VolumeMesh,
        recipe: impl ModelRecipe + 'static,
        matrix: MatrixForm,
        executor: &Executor,
    ) {
        let settings = Implicit { linear: Stop::Iterations(ITERATIONS), matrix, ..Implicit::default() };
        let integrator = Integrator::Implicit(settings);
        let mut world = World::<T>::new(WorldConfig { step: 1e-2, integrator, ..WorldConfig::default() }).unwrap();
        let held = Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0);
        world.add(Body::new(mesh.clone(), 1000.0).model(recipe).fix(held)).unwrap();
        let snapshot = world.snapshot();
        self.measure::<T>(&on(executor, "implicit", name), mesh.cell_count(), Yardstick::None, || {
            let begin = Instant::now();
            world.step_on(executor).unwrap();
            let elapsed = begin.elapsed();
            if world.time() > 0.1 {
                world.restore(&snapshot).unwrap();
            }
            elapsed / ITERATIONS
        });
    }

    /// The implicit step matrix-free and assembled, and on hexahedra.
    fn implicit_forms<T: Precision>(
        &self,
        name: &str,
        tetrahedra: &VolumeMesh,
        hexahedra: &VolumeMesh,
        recipe: impl ModelRecipe + Clone + 'static,
    ) {
        let (one, two) = (Executor::serial(), Executor::threads(2).unwrap());
        self.implicit::<T>(name, tetrahedra, recipe.clone(), MatrixForm::Free, &one);
        self.implicit::<T>(name, tetrahedra, recipe.clone(), MatrixForm::Free, &two);
        self.implicit::<T>(&format!("{name}/assembled"), tetrahedra, recipe.clone(), MatrixForm::Assembled, &one);
        self.implicit::<T>(&format!("{name}/hexahedra"), hexahedra, recipe, MatrixForm::Free, &one);
    }

    /// Removes a lump of tetrahedra, one in fifty, as a cut does; the time per removed one.
    fn removal<T: Precision>(&self, name: &str, model: &dyn ForceModel<T>, mesh: &VolumeMesh) {
        let middle = Vec3::from(BEAM) * 0.5;
        let cells = nearest_cells(mesh, middle, mesh.cell_count() / 50);
        let id = format!("removal/{name}/of-{}", mesh.cell_count());
        self.measure::<T>(&id, cells.len(), Yardstick::None, || {
            let mut model = model.clone_box();
            let begin = Instant::now();
            model.remove(black_box(&cells));
            begin.elapsed()
        });
    }

    /// The same through a world with a tool near, and all that goes with a cut: masses, loads, the skin that the tool touches.
    fn removal_in_world<T: Precision>(&self, name: &str, mesh: &VolumeMesh, recipe: Box<dyn ModelRecipe>) {
        let mut world = World::<T>::new(WorldConfig::default()).unwrap();
        let body = world.add(Body::new(mesh.clone(), 1000.0).boxed_model(recipe)).unwrap();
        let path = Curve::constant(Vec3::new(0.2, 0.0, 0.0));
        world.add_instrument(Probe { path, ..Probe::default() }).unwrap();
        let snapshot = world.snapshot();
        let cells = nearest_cells(mesh, Vec3::from(BEAM) * 0.5, CUT);
        let id = format!("removal/{name}/in-world/of-{}", mesh.cell_count());
        self.measure::<T>(&id, cells.len(), Yardstick::None, || {
            world.restore(&snapshot).unwrap();
            let begin = Instant::now();
            world.remove_cells(body, black_box(&cells)).unwrap();
            begin.elapsed()
        });
    }
}

/// Cells that a cautery takes at once.
const CUT: usize = 20;

/// The cells nearest to a place.
fn nearest_cells(mesh: &VolumeMesh, place: Vec3<f64>, count: usize) -> Vec<u32> {
    let distance = |&cell: &u32| (mesh.nodes()[mesh.cell(cell as usize)[0] as usize] - place).squared_norm();
    let mut cells: Vec<u32> = (0..mesh.cell_count() as u32).collect();
    cells.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    cells.truncate(count);
    cells
}

/// What is measured, and whether on two threads.
fn on(executor: &Executor, what: &str, name: &str) -> String {
    if executor.thread_count() == 1 { format!("{what}/{name}") } else { format!("{what}/{name}/threads-2") }
}

/// A smooth deformation in which every term of every law counts.
fn stretched<T: Precision>(mesh: &VolumeMesh) -> Vec<Vec3<T>> {
    let bend = |x: &Vec3<f64>| Vec3::new(x.x + 0.2 * x.z * x.z, 0.98 * x.y, 1.05 * x.z).cast();
    mesh.nodes().iter().map(bend).collect()
}

fn suite<T: Precision>(suite: &Suite<'_>) {
    let lame = Lame::from_young_poisson(5e3, 0.4).unwrap();
    let longitudinal = Lame::from_young_poisson(12e3, 0.4).unwrap();
    let linear = || Tissue::uniform(LinearElastic::new(lame));
    let stvk = || Tissue::uniform(StVenantKirchhoff::new(lame));
    let stable = || Tissue::uniform(StableNeoHookean::new(lame));
    let fibred = || Tissue::uniform(TransverseStVenantKirchhoff::new(lame, [0.0, 0.0, 1.0], longitudinal).unwrap());

    let (one, two) = (Executor::serial(), Executor::threads(2).unwrap());
    let large = VolumeMesh::from(TetMesh::box_grid(LARGE, BEAM));
    suite.substep::<T>(
        "total-lagrangian/st-venant-kirchhoff",
        &large,
        Box::new(TotalLagrangian::new(stvk())),
        Some(200.0),
        &one,
    );
    drop(large);
    for cells in SIZES {
        let tetrahedra = TetMesh::box_grid(cells, BEAM);
        let mesh = VolumeMesh::from(tetrahedra.clone());
        // Half of the nodes of the deformed beam lie farther from their rest than this.
        let mut moved: Vec<f64> =
            stretched::<f64>(&mesh).iter().zip(mesh.nodes()).map(|(x, rest)| (*x - *rest).norm()).collect();
        moved.sort_by(f64::total_cmp);
        let threshold = moved[moved.len() / 2];

        let models: [(&str, Box<dyn ModelRecipe>, Option<f64>); 7] = [
            ("linear-tensor-mass", Box::new(LinearTensorMass::new(linear())), None),
            ("tensor-mass", Box::new(TensorMass::new(stvk())), None),
            ("tensor-mass-half-linear", Box::new(TensorMass::new(stvk()).adaptive(threshold)), None),
            // Multiplications and additions of the metric forms, which shares are told for; along orthogonal edges the first takes 132.
            ("total-lagrangian/st-venant-kirchhoff", Box::new(TotalLagrangian::new(stvk())), Some(200.0)),
            ("total-lagrangian/transverse", Box::new(TotalLagrangian::new(fibred())), None),
            ("total-lagrangian/stable-neo-hookean", Box::new(TotalLagrangian::new(stable())), Some(125.0)),
            ("nodally-integrated/stable-neo-hookean", Box::new(NodallyIntegrated::new(stable())), None),
        ];
        for (name, recipe, flops) in models {
            let model = T::build_model(recipe.as_ref(), &mesh).unwrap();
            suite.forces(name, model.as_ref(), &mesh, flops);
            suite.removal(name, model.as_ref(), &mesh);
            suite.substep::<T>(name, &mesh, recipe, flops, &one);
        }
        suite.removal_in_world::<T>("total-lagrangian", &mesh, Box::new(TotalLagrangian::new(stable())));
        let direct = Box::new(TotalLagrangian::new(stvk()));
        suite.substep::<T>("total-lagrangian/st-venant-kirchhoff", &mesh, direct, Some(200.0), &two);
        let penalty = VolumePenalty::<T>::new(&tetrahedra, 1e4).unwrap();
        suite.forces("volume-penalty", &penalty, &mesh, None);
        suite.removal("volume-penalty", &penalty, &mesh);

        let hexahedra = VolumeMesh::from(HexMesh::box_grid(cells, BEAM));
        let turned = Corotational::new(linear());
        // Multiplications and additions of the rotated-gradient form.
        let products = [("corotational", &mesh, Some(129.0)), ("corotational/hexahedra", &hexahedra, None)];
        for (name, mesh, flops) in products {
            let model = T::build_model(&turned, mesh).unwrap();
            suite.forces::<T>(name, model.as_ref(), mesh, None);
            suite.product::<T>(name, model.as_ref(), mesh, flops);
        }
        if cells != SIZES[0] {
            suite.implicit_forms::<T>("corotational", &mesh, &hexahedra, turned);
            let direct = TotalLagrangian::new(stvk());
            suite.implicit_forms::<T>("total-lagrangian/st-venant-kirchhoff", &mesh, &hexahedra, direct);
        }
        let model = T::build_model(&TotalLagrangian::new(stvk()), &hexahedra).unwrap();
        suite.forces::<T>("total-lagrangian/hexahedra", model.as_ref(), &hexahedra, None);
    }
}

fn main() {
    let machine = Machine::measure();
    let mut criterion = Criterion::default()
        .without_plots()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(700))
        .sample_size(20)
        .configure_from_args();
    let mut group = criterion.benchmark_group("engine");
    group.sampling_mode(SamplingMode::Flat);
    let benches = Suite { machine, group: RefCell::new(group), lines: RefCell::default(), results: RefCell::default() };
    suite::<f32>(&benches);
    suite::<f64>(&benches);
    benches.group.into_inner().finish();

    println!(
        "\nmachine, 1 thread, {}: {:.1} GFLOP/s in f32, {:.1} GFLOP/s in f64 (FMA), {:.1} GB/s read in order",
        instruction_set(),
        machine.flops_f32 / 1e9,
        machine.flops_f64 / 1e9,
        machine.bandwidth / 1e9
    );
    for line in benches.lines.into_inner() {
        println!("{line}");
    }
    println!("\nwhat is asked for, and what was measured");
    for line in benches.results.into_inner().bars() {
        println!("{line}");
    }
}
