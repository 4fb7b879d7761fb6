//! Natural frequencies of a clamped beam, and what motion keeps: energy, momentum, the path of a point.

use faer::{Mat, Side};
use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, Newton, Scheme};
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};
use viscera::mesh::VolumeMesh;
use viscera::model::{ModelRecipe, NodallyIntegrated, Precision, Scratch, TotalLagrangian};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, World, WorldConfig};

use crate::references::{FREE_FLIGHT, MODES, RELEASE, Vector, list, mesh, number, numbers, read, vector, vectors};
use crate::report::{Table, brief};
use crate::setting::plane;
use crate::{Report, Size, ValidationError};

const DENSITY: f64 = 1000.0;
const YOUNG: f64 = 10e3;
const POISSON: f64 = 0.3;

/// What was found.
pub struct Frequencies {
    /// The spectra.
    pub spectra: Vec<Spectrum>,
    /// The beam let go from a stretch, by several schemes.
    pub releases: Vec<Release>,
    /// The beam in free flight, by several schemes.
    pub flights: Vec<Flight>,
}

/// The first frequencies of a kind of element, lumped masses.
pub struct Spectrum {
    /// Kind of element.
    pub name: &'static str,
    /// Frequencies [Hz], rising.
    pub frequencies: Vec<f64>,
    /// Those of another program for the same mesh.
    pub expected: Option<Vec<f64>>,
    /// Highest angular frequency [1/s], and what the engine takes it for.
    pub highest: f64,
    /// The bound from which stable steps follow [1/s].
    pub bound: f64,
}

impl Spectrum {
    /// Largest relative difference from the other program.
    pub fn difference(&self) -> Option<f64> {
        let expected = self.expected.as_ref()?;
        let apart = self.frequencies.iter().zip(expected).map(|(found, expected)| (found / expected - 1.0).abs());
        Some(apart.fold(0.0, f64::max))
    }
}

/// A scheme and a step.
pub struct Release {
    /// The scheme.
    pub name: &'static str,
    /// The step [s].
    pub step: f64,
    /// Largest deviation of the energy over its initial value.
    pub energy: f64,
    /// Whether the energy ever rose by more than rounding.
    pub rises: bool,
    /// Largest distance of the tip from the reference, over its first 62.5 ms [m].
    pub tip: f64,
}

/// A scheme in free flight.
pub struct Flight {
    /// The scheme.
    pub name: &'static str,
    /// Relative error of momentum, of angular momentum and of energy.
    pub errors: [f64; 3],
}

/// # Errors
/// [`ValidationError`] where a step fails.
pub fn study(size: Size) -> Result<Frequencies, ValidationError> {
    let case = read(MODES);
    let expected = |name: &str| numbers(&case["reference"][name]["first_12_frequencies_Hz"]);
    let tets = mesh("beam_s_tet4.msh")?;
    let spectra = vec![
        spectrum("tetrahedra", &tets, &TotalLagrangian::new(linear()?), Some(expected("tet4_lumped")))?,
        spectrum(
            "hexahedra",
            &mesh("beam_s_hex8.msh")?,
            &TotalLagrangian::new(linear()?),
            Some(expected("hex8_lumped")),
        )?,
        spectrum("tetrahedra, integrated at the nodes", &tets, &NodallyIntegrated::new(quadratic()?), None)?,
    ];
    // Parts of 12.5 ms, at the ends of which the reference has the tip.
    let parts: &[u32] = if size == Size::Full { &[7, 14, 28] } else { &[14] };
    let mut releases = Vec::new();
    for &part in parts {
        for (name, scheme) in schemes() {
            releases.push(release(name, scheme, 0.0125 / f64::from(part))?);
        }
    }
    let flights = schemes().into_iter().map(|(name, scheme)| flight(name, scheme)).collect::<Result<_, _>>()?;
    Ok(Frequencies { spectra, releases, flights })
}

fn linear() -> Result<Tissue, ValidationError> {
    Ok(Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON)?))
}

fn quadratic() -> Result<Tissue, ValidationError> {
    Ok(Tissue::uniform(StVenantKirchhoff::from_young_poisson(YOUNG, POISSON)?))
}

/// Frequencies of M⁻½ K M⁻½ with the wall at z = 0 taken out, dense.
fn spectrum(
    name: &'static str,
    mesh: &VolumeMesh,
    recipe: &dyn ModelRecipe,
    expected: Option<Vec<f64>>,
) -> Result<Spectrum, ValidationError> {
    let model = f64::build_model(recipe, mesh)?;
    let bound = f64::build_frequency_bound(recipe, mesh, &[DENSITY], 0.0)?;
    let rest = mesh.nodes();
    // Masses are those of a body of any model.
    let mut world = world(1.0, Some(Scheme::BackwardEuler))?;
    let id = world.add(Body::new(mesh.clone(), DENSITY).model(TotalLagrangian::new(linear()?)))?;
    let masses = &world.body(id).state().masses;
    let free: Vec<usize> = (0..rest.len()).filter(|&node| rest[node].z > 0.0).collect();
    let mut scratch = Scratch::new(rest.len());
    model.linearize(rest, &mut scratch);
    let mut matrix = Mat::<f64>::zeros(3 * free.len(), 3 * free.len());
    let (mut along, mut force) = (vec![Vector::ZERO; rest.len()], vec![Vector::ZERO; rest.len()]);
    for (column, &node) in free.iter().enumerate() {
        for axis in 0..3 {
            along[node][axis] = 1.0;
            force.fill(Vector::ZERO);
            model.add_product(rest, &along, &mut scratch, &mut force);
            along[node][axis] = 0.0;
            for (row, &other) in free.iter().enumerate() {
                let scale = (masses[node] * masses[other]).sqrt();
                for component in 0..3 {
                    matrix[(3 * row + component, 3 * column + axis)] = force[other][component] / scale;
                }
            }
        }
    }
    let squares = matrix.self_adjoint_eigenvalues(Side::Lower).expect("a symmetric matrix has eigenvalues");
    let hertz = |square: &f64| square.max(0.0).sqrt() / (2.0 * std::f64::consts::PI);
    Ok(Spectrum {
        name,
        frequencies: squares.iter().take(12).map(hertz).collect(),
        expected,
        highest: squares.last().copied().unwrap_or(0.0).sqrt(),
        bound: bound.squared_frequency(rest, &mut scratch).sqrt(),
    })
}

/// The schemes, solved in full.
fn schemes() -> [(&'static str, Option<Scheme>); 5] {
    [
        ("central differences", None),
        ("energy–momentum", Some(Scheme::EnergyMomentum)),
        ("Newmark, ¼ and ½", Some(Scheme::AVERAGE_ACCELERATION)),
        ("BDF2", Some(Scheme::Bdf2)),
        ("backward Euler", Some(Scheme::BackwardEuler)),
    ]
}

fn world(step: f64, scheme: Option<Scheme>) -> Result<World<f64>, ValidationError> {
    let integrator = match scheme {
        None => Integrator::Explicit(Substep::Fixed(step)),
        Some(scheme) => Integrator::Implicit(Implicit {
            newton: Newton::Full { relative: 1e-10, at_most: 60 },
            linear: Stop::Tolerance { relative: 1e-6, at_most: 1000 },
            ..Implicit::accurate(scheme)
        }),
    };
    Ok(World::new(WorldConfig { gravity: [0.0; 3], step, integrator })?)
}

fn beam() -> Result<Body, ValidationError> {
    Ok(Body::new(mesh("beam_s_tet4.msh")?, DENSITY).model(TotalLagrangian::new(quadratic()?)))
}

/// Case E03.
fn release(name: &'static str, scheme: Option<Scheme>, step: f64) -> Result<Release, ValidationError> {
    let case = read(RELEASE);
    let reference = &case["reference"];
    let node = reference["tip_node_0based"].as_u64().unwrap_or(0) as usize;
    let tips = vectors(&reference["tip_displacement_m"]);
    let times = numbers(&reference["time_s"]);
    let initial = number(&case["initial"]["energy_J"]);
    let mut world = world(step, scheme)?;
    let id = world.add(beam()?.fix(plane(2, 0.0)))?;
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1.15 * x.z));
    let rest = world.body(id).mesh().nodes()[node];
    let mut found = Release { name, step, energy: 0.0, rises: false, tip: 0.0 };
    let mut before = initial;
    while world.time() < times[times.len() - 1] - 0.5 * step {
        world.step()?;
        let seen = world.observe(id);
        let energy = seen.kinetic_energy + seen.elastic_energy;
        found.energy = found.energy.max((energy / initial - 1.0).abs());
        found.rises |= energy > before + 1e-9 * initial;
        before = energy;
        // The reference has the tip every 12.5 ms; later the motion is that of many modes out of step.
        let moment = times[..5].iter().position(|&time| (time - world.time()).abs() < 1e-3 * step);
        if let Some(moment) = moment {
            found.tip = found.tip.max((world.body(id).positions()[node] - rest - tips[moment]).norm());
        }
    }
    Ok(found)
}

/// Case E02.
fn flight(name: &'static str, scheme: Option<Scheme>) -> Result<Flight, ValidationError> {
    let case = read(FREE_FLIGHT);
    let mut world = world(2e-3, scheme)?;
    let id = world.add(beam()?)?;
    let (spin, centre) = (Vector::new(3.0, 1.0, -2.0), Vector::new(0.05, 0.05, 0.2));
    world.body_mut(id).set_velocities(|x| Vector::new(0.4, 0.2, 1.0) + spin.cross(x - centre));
    let energy = |world: &mut World<f64>| {
        let seen = world.observe(id);
        seen.kinetic_energy + seen.elastic_energy
    };
    let initial = energy(&mut world);
    let mut worst: f64 = 0.0;
    for _ in 0..250 {
        world.step()?;
        worst = worst.max((energy(&mut world) / initial - 1.0).abs());
    }
    let seen = world.observe(id);
    let invariants = &case["initial"]["invariants"];
    let away = |found: Vector, exact: Vector| (found - exact).norm() / exact.norm();
    let momentum = away(seen.momentum, vector(&invariants["linear_momentum"]));
    let angular = away(seen.angular_momentum, vector(&invariants["angular_momentum_about_origin"]));
    Ok(Flight { name, errors: [momentum, angular, worst] })
}

impl Frequencies {
    /// The page.
    pub fn report(&self) -> Report {
        let mut spectra = Table::new(
            "frequencies",
            &["element", "first six [Hz]", "difference of twelve", "highest [1/s]", "bound of it [1/s]"],
        );
        for found in &self.spectra {
            let first: Vec<String> = found.frequencies.iter().take(6).map(|f| format!("{f:.4}")).collect();
            spectra.push(vec![
                found.name.into(),
                first.join(" · "),
                found.difference().map_or("–".into(), |difference| format!("{difference:.1e}")),
                brief(found.highest),
                brief(found.bound),
            ]);
        }
        let mut releases =
            Table::new("release", &["scheme", "step [ms]", "energy error", "energy rises", "error of the tip [mm]"]);
        for found in &self.releases {
            releases.push(vec![
                found.name.into(),
                brief(1e3 * found.step),
                format!("{:.1e}", found.energy),
                if found.rises { "yes" } else { "no" }.into(),
                brief(1e3 * found.tip),
            ]);
        }
        let mut flights = Table::new("flight", &["scheme", "momentum", "angular momentum", "energy"]);
        for found in &self.flights {
            let errors = found.errors.map(|error| format!("{error:.1e}"));
            flights.push([&[found.name.to_owned()][..], &errors].concat());
        }
        let theory = number(&read(MODES)["reference"]["euler_bernoulli_first_bending_Hz"]);
        let listed = read(RELEASE);
        let verlet: Vec<String> = list(&listed["reference"]["velocity_verlet_for_comparison"])
            .iter()
            .map(|row| {
                format!("{:.1e} at {} ms", number(&row["max_rel_energy_deviation"]), brief(1e3 * number(&row["dt_s"])))
            })
            .collect();
        Report::new("Natural frequencies, and what motion keeps")
            .text(format!(
                "A beam of 10 × 10 × 40 cm, E = 10 kPa, ν = 0.3, 1000 kg/m³, held at one end, lumped masses. Differences \
                 are from scipy and CalculiX on the same mesh. By beam theory the first bending mode has {theory:.4} Hz. \
                 The bound is what stable steps are computed from."
            ))
            .table(spectra)
            .text(format!(
                "The same beam of St Venant–Kirchhoff tissue, let go from a stretch of 15 %, for 0.25 s; the tip is \
                 compared over the first 62.5 ms with a trajectory to 1e-10 m. Another velocity Verlet keeps energy to {}.",
                verlet.join(", ")
            ))
            .table(releases)
            .text("Thrown and turning, 250 steps of 2 ms: relative errors.")
            .table(flights)
    }
}
