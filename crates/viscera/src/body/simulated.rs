use super::boundary::{Boundary, SurfaceTriangle};
use super::skin::Skin;
use super::supports::{filters, motions};
use super::{
    Actuators, Body, BodyError, BodyState, Driven, Drivers, Followers, Guides, LoadError, LoosePieces, ModelPlan,
    Models, MotionBackup, Muscles, NodalLoads, NodeMotion, PastState, Removals, StaticAnswer, StaticReport, Still,
};
use crate::constraint::{Constraints, KeptVolume};
use crate::contact::Contacts;
use crate::curve::Curve;
use crate::material::LawKind;
use crate::math::{Scalar, Vec3, large_pages};
use crate::mesh::{VolumeMesh, cells_of_nodes};
use crate::model::frequency::FrequencyBound;
use crate::model::precomputed::Supports;
use crate::model::{ModelKind, Precision, Scratch};
use crate::solver::Filter;

/// A body in a world: what never changes about it, its state, and memory to compute in.
pub struct SimulatedBody<T: Scalar> {
    /// Name by which messages call it.
    pub(crate) name: String,
    /// Rest shape.
    pub(crate) mesh: VolumeMesh,
    /// Diagonal of the box around it [m]: the size against which tolerances are relative.
    pub(crate) size: f64,
    /// Mass of a corner of each cell [kg].
    pub(crate) corner_masses: Vec<f64>,
    /// Rest volumes of the cells [m³].
    pub(crate) cell_volumes: Vec<f64>,
    /// What the models are built from.
    pub(crate) plan: ModelPlan,
    /// Tells the body apart from others, see [`fingerprint`].
    pub(crate) fingerprint: u32,
    pub(crate) model: ModelKind,
    pub(crate) law: LawKind,
    /// Damping rate γ_i/m_i [1/s].
    pub(crate) damping: T,
    /// α of Rayleigh's damping [s].
    pub(crate) stiffness_damping: T,
    pub(crate) rest: Vec<Vec3<T>>,
    pub(crate) prescribed: Vec<Curve<Vec3<f64>>>,
    pub(crate) guides: Guides,
    pub(crate) loads: NodalLoads<T>,
    pub(crate) muscles: Muscles<T>,
    pub(crate) actuators: Actuators<T>,
    pub(crate) constraints: Constraints,
    pub(crate) loose_pieces: LoosePieces,
    /// Cells at each node: those of node n are `cells_at_nodes.1[starts[n]..starts[n + 1]]`.
    pub(crate) cells_at_nodes: (Vec<u32>, Vec<u32>),
    pub(crate) boundary: Boundary,
    pub(crate) state: BodyState<T>,
    pub(crate) frequency: Box<dyn FrequencyBound<T>>,
    pub(crate) external_forces: Vec<Vec3<T>>,
    pub(crate) scratch: Scratch<T>,
    /// Whether the models are prepared for products at the positions and cells of the forces, if those are current.
    pub(crate) is_linearized: bool,
    /// Memory of explicit steps for the nodes that are driven, and for those that stay where they are.
    pub(crate) driven: Vec<Driven<T>>,
    pub(crate) still: Vec<Still<T>>,
    /// Whether nothing meets it between the sub-steps of an explicit step.
    pub(crate) is_left_alone: bool,
    pub(crate) backup: MotionBackup<T>,
    pub(crate) pieces: Vec<u32>,
    /// Triangles of the surface as it is now, for tools that touch it; none without such tools.
    pub(crate) skin: Skin,
    pub(crate) contacts: Contacts,
    /// How it answers, where it does not move in time.
    pub(crate) answer: Option<Box<StaticAnswer>>,
    /// What of it follows the rest.
    pub(crate) followers: Option<Box<Followers>>,
    /// How it came to rest the last time that an equilibrium was sought.
    pub(crate) static_report: Option<StaticReport>,
}

impl<T: Scalar> SimulatedBody<T> {
    pub(crate) fn new(body: Body) -> Result<Self, BodyError>
    where
        T: Precision,
    {
        let Body {
            name,
            mesh,
            density,
            model,
            keep_volume,
            damping,
            stiffness_damping,
            fixed,
            prescribed,
            guided,
            loads,
            muscles,
            actuators,
            exact_volumes,
            rigid,
            loose_pieces,
        } = body;
        let body = || name.clone();
        check_range(&name, "damping", damping, damping >= 0.0, "zero or positive [1/s]")?;
        let good = stiffness_damping >= 0.0;
        check_range(&name, "stiffness damping", stiffness_damping, good, "zero or positive [s]")?;
        check_density(&name, &density, mesh.cell_count())?;
        let recipe = model.ok_or_else(|| BodyError::NoModel { body: body() })?;
        let model_error = |source| BodyError::Model { body: body(), source };
        if keep_volume != 0.0 && matches!(mesh, VolumeMesh::Hex(_)) {
            return Err(BodyError::KeepVolumeOnHexahedra { body: body() });
        }
        let (guides, mut motions) = motions(&name, &mesh, &fixed, &prescribed, guided)?;
        let prescribed: Vec<_> = prescribed.into_iter().map(|(_, curve)| curve).collect();
        let filters = filters(&guides, &motions);
        let supports = Supports { mesh: &mesh, filters: &filters };
        let recipe = recipe.supported(&supports).map_err(model_error)?.unwrap_or(recipe);
        if let Some(condensation) = recipe.condensation() {
            condensation.followers().iter().for_each(|&node| motions[node as usize] = NodeMotion::Following);
        }
        let plan = ModelPlan { recipe, density, keep_volume };
        let Models { forces: models, frequency } = plan.build(&mesh).map_err(model_error)?;
        let region_error =
            |purpose| move |source| BodyError::Region { body: body(), purpose, source: Box::new(source) };
        let loads = NodalLoads::new(&loads, &mesh).map_err(|error| match error {
            LoadError::Region(purpose, source) => region_error(purpose)(source),
            LoadError::Radius(value) => {
                let (name, range) = ("attraction radius", "positive [m], around a place of finite coordinates");
                BodyError::OutOfRange { body: body(), name, value, range }
            }
        })?;

        let boundary = Boundary::new(&mesh);
        let muscles = Muscles::new(&name, muscles, &mesh, &boundary.faces)?;
        let actuators = Actuators::new(&name, actuators, &mesh)?;
        let (constraints, volumes) =
            super::constrained::constraints(&name, exact_volumes, rigid, &mesh, &boundary.faces, &motions)?;

        let cell_volumes = cell_volumes(&mesh);
        let density_of = |cell: usize| plan.density[if plan.density.len() == 1 { 0 } else { cell }];
        let corners = mesh.cell(0).len() as f64;
        let corner_masses: Vec<f64> =
            cell_volumes.iter().enumerate().map(|(cell, volume)| density_of(cell) * volume / corners).collect();
        let cells_at_nodes = match &mesh {
            VolumeMesh::Tet(mesh) => cells_of_nodes(mesh),
            VolumeMesh::Hex(mesh) => cells_of_nodes(mesh),
        };
        let state = initial_state(&name, &mesh, &corner_masses, motions, models, volumes)?;
        let (recipe, drivers) = (&plan.recipe, Drivers { prescribed: &prescribed, guides: &guides, loads: &loads });
        let responses = recipe.responses(&supports).map_err(model_error)?;
        let answer = responses.map(|found| StaticAnswer::new(found, recipe.tissue(), &supports, drivers, &state));
        let answer = answer.transpose().map_err(model_error)?.map(Box::new);
        let part = recipe.condensation().filter(|condensation| !condensation.boundary().is_empty()).cloned();
        let followers = part.map(|part| Followers::new(part, (recipe.tissue(), &mesh), drivers, &state));
        let followers = followers.transpose().map_err(model_error)?.map(Box::new);
        if answer.is_some() {
            let rests = "zero: the body rests at the end of every step";
            check_range(&name, "damping", damping, damping == 0.0, rests)?;
            check_range(&name, "stiffness damping", stiffness_damping, stiffness_damping == 0.0, rests)?;
        }
        if answer.is_some() || followers.is_some() {
            if !(constraints.is_empty() && muscles.is_empty() && actuators.is_empty()) {
                return Err(BodyError::LinearModel { body: body(), model: recipe.kind() });
            }
            let linear = "zero: what is pre-computed is linear";
            check_range(&name, "keep-volume", keep_volume, keep_volume == 0.0, linear)?;
        }
        Ok(Self {
            fingerprint: fingerprint(&plan, &mesh, &corner_masses),
            model: plan.recipe.kind(),
            law: plan.recipe.tissue().kind(),
            damping: T::from_f64(damping),
            stiffness_damping: T::from_f64(stiffness_damping),
            rest: state.positions.clone(),
            prescribed,
            external_forces: vec![Vec3::ZERO; mesh.nodes().len()],
            scratch: Scratch::for_models(mesh.nodes().len(), &state.models),
            is_linearized: false,
            driven: Vec::with_capacity(mesh.nodes().len()),
            still: Vec::with_capacity(mesh.nodes().len()),
            is_left_alone: false,
            backup: MotionBackup::new(&state),
            pieces: vec![0; 2 * mesh.nodes().len()],
            skin: Skin::default(),
            contacts: Contacts::default(),
            boundary,
            plan,
            name,
            size: mesh.size(),
            mesh,
            corner_masses,
            cell_volumes,
            guides,
            loads,
            muscles,
            actuators,
            constraints,
            loose_pieces,
            cells_at_nodes,
            state,
            frequency,
            answer,
            followers,
            static_report: None,
        })
    }

    /// Name by which messages call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The rest shape.
    pub fn mesh(&self) -> &VolumeMesh {
        &self.mesh
    }

    /// The force model.
    pub fn model(&self) -> ModelKind {
        self.model
    }

    /// Name of the law.
    pub fn law(&self) -> &'static str {
        self.law.name()
    }

    /// The state: positions, velocities, forces, what is cut away.
    pub fn state(&self) -> &BodyState<T> {
        &self.state
    }

    /// How it came to rest in the last quasi-static step, or when it was settled: load steps and the residuals of each. None where no
    /// equilibrium was sought, or the last was not found.
    pub fn static_report(&self) -> Option<&StaticReport> {
        self.static_report.as_ref()
    }

    /// Positions of the nodes [m].
    pub fn positions(&self) -> &[Vec3<T>] {
        &self.state.positions
    }

    /// Velocities of the nodes [m/s].
    pub fn velocities(&self) -> &[Vec3<T>] {
        &self.state.velocities
    }

    /// The directions in which forces move a node.
    pub(crate) fn free_directions(&self, node: usize) -> Filter<T> {
        free_directions(&self.guides, self.state.motions[node])
    }

    /// Sets the velocities of the free nodes [m/s], for a body that starts in motion.
    pub fn set_velocities(&mut self, velocity: impl Fn(Vec3<f64>) -> Vec3<f64>) {
        for (node, motion) in self.state.motions.iter().enumerate() {
            let filter = free_directions(&self.guides, *motion);
            let wanted = velocity(self.state.positions[node].cast()).cast();
            self.state.velocities[node] = filter.merge(wanted, self.state.velocities[node]);
        }
        self.state.past.is_known = false;
    }

    /// Sets the positions of the free nodes [m], for a body that starts deformed.
    pub fn set_positions(&mut self, position: impl Fn(Vec3<f64>) -> Vec3<f64>) {
        for (node, motion) in self.state.motions.iter().enumerate() {
            let filter = free_directions(&self.guides, *motion);
            let wanted = position(self.state.positions[node].cast()).cast();
            self.state.positions[node] = filter.merge(wanted, self.state.positions[node]);
        }
        self.state.past.is_known = false;
        self.state.positions_changed();
    }

    /// Cells that are not removed.
    pub fn cell_count(&self) -> usize {
        self.mesh.cell_count() - self.state.removed_count
    }

    /// The current surface, cut faces included.
    pub fn surface(&self) -> Vec<SurfaceTriangle> {
        self.boundary.surface(&self.state.removed).collect()
    }

    /// The triangles of the current surface, and the cell behind each.
    pub(crate) fn surface_cells(&self) -> impl Iterator<Item = ([u32; 3], u32)> + '_ {
        let there = |cell: u32| !self.state.removed[cell as usize];
        self.boundary.faces.iter().filter_map(move |face| match face.cells {
            (first, second) if there(first) => (!second.is_some_and(there)).then_some((face.nodes, first)),
            (_, second) => second.filter(|&cell| there(cell)).map(|cell| (face.nodes, cell)),
        })
    }

    /// How far each node is burnt, from 0 to 1, which it is on the rim of a burnt cut.
    pub fn seared(&self) -> &[T] {
        &self.state.seared
    }

    /// Asks for the memory of `tools` tools; those that `touch` want to know the surface.
    pub(crate) fn reserve_contacts(&mut self, tools: usize, touch: bool) {
        let faces = if touch { self.boundary.faces.len() } else { 0 };
        let triangles = self.boundary.faces.iter().filter(|face| face.cells.1.is_none()).count().min(faces);
        self.contacts.reserve(tools, triangles, faces);
        if let Some(answer) = &mut self.answer {
            answer.pushes.reserve(triangles, answer.responses.handles().len());
        }
        self.state.tractions.reserve(triangles.saturating_sub(self.state.tractions.len()));
        self.backup.reserve_tractions(triangles);
        if touch {
            self.skin.reserve(&self.boundary, self.mesh.cell_count());
        }
        self.update_skin();
    }

    /// Lists the triangles that tools touch anew.
    pub(crate) fn update_skin(&mut self) {
        self.skin.renew(&self.boundary, &self.state.removed);
    }

    /// Brings them up to date with cells that were just removed.
    pub(crate) fn cut_skin(&mut self, cells: &[u32]) {
        self.skin.cut(&self.boundary, &self.state.removed, cells);
    }

    /// Asks for the memory of the state before the last step, for schemes over two steps, and for that of its backup.
    pub(crate) fn reserve_past(&mut self) {
        self.state.past.reserve(self.rest.len());
        self.backup = MotionBackup::new(&self.state);
    }

    /// Bound of ω_max² at the current positions [1/s²].
    pub(crate) fn squared_frequency(&mut self) -> f64 {
        if self.state.squared_frequency.is_none() {
            let of_tissue = self.frequency.squared_frequency(&self.state.positions, &mut self.scratch);
            self.bound_frequency(of_tissue);
        }
        self.state.squared_frequency.unwrap_or_default()
    }

    /// Keeps the bound for the current positions, of which the tissue's part is known.
    pub(crate) fn bound_frequency(&mut self, of_tissue: f64) {
        let mut sums = std::mem::take(&mut self.scratch.forces);
        let of_others = self.external_squared_frequency(&mut sums);
        self.scratch.forces = sums;
        self.state.squared_frequency = Some(of_tissue + of_others);
    }
}

/// The directions in which forces move a node.
pub(crate) fn free_directions<T: Scalar>(guides: &Guides, motion: NodeMotion) -> Filter<T> {
    match motion {
        NodeMotion::Free => Filter::Free,
        NodeMotion::Guided(guide) => guides.filter(guide),
        _ => Filter::Held,
    }
}

fn check_range(body: &str, name: &'static str, value: f64, good: bool, range: &'static str) -> Result<(), BodyError> {
    if good && value.is_finite() {
        Ok(())
    } else {
        Err(BodyError::OutOfRange { body: body.into(), name, value, range })
    }
}

fn check_density(body: &str, density: &[f64], cells: usize) -> Result<(), BodyError> {
    for &value in density {
        check_range(body, "density", value, value > 0.0, "positive [kg/m³]")?;
    }
    if density.len() == 1 || density.len() == cells {
        Ok(())
    } else {
        Err(BodyError::WrongDensityCount { body: body.into(), given: density.len(), cells })
    }
}

/// A checksum of the rest shape, the masses, the law and the model: bodies that differ in one of these have, but for one in four
/// billion, others.
fn fingerprint(plan: &ModelPlan, mesh: &VolumeMesh, corner_masses: &[f64]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    let ModelPlan { recipe, keep_volume, .. } = plan;
    // How a recipe shows itself holds every setting and every modulus, down to the last digit.
    hasher.update(format!("{recipe:?}").as_bytes());
    let places = mesh.nodes().iter().flat_map(|node| node.to_array());
    for number in places.chain(corner_masses.iter().copied()).chain([*keep_volume]) {
        hasher.update(&number.to_bits().to_le_bytes());
    }
    for cell in 0..mesh.cell_count() {
        mesh.cell(cell).iter().for_each(|node| hasher.update(&node.to_le_bytes()));
    }
    hasher.finalize()
}

/// Rest volumes [m³].
fn cell_volumes(mesh: &VolumeMesh) -> Vec<f64> {
    match mesh {
        VolumeMesh::Tet(mesh) => (0..mesh.cells.len()).map(|cell| mesh.cell_volume(cell)).collect(),
        VolumeMesh::Hex(mesh) => (0..mesh.cells.len()).map(|cell| mesh.cell_volume(cell)).collect(),
    }
}

fn initial_state<T: Scalar>(
    body: &str,
    mesh: &VolumeMesh,
    corner_masses: &[f64],
    motions: Vec<NodeMotion>,
    models: Vec<Box<dyn crate::model::ForceModel<T>>>,
    volumes: Vec<KeptVolume>,
) -> Result<BodyState<T>, BodyError> {
    let nodes = mesh.nodes().len();
    let (mut masses, mut cells_at_node) = (vec![0.0; nodes], vec![0; nodes]);
    for (cell, &mass) in corner_masses.iter().enumerate() {
        for &node in mesh.cell(cell) {
            masses[node as usize] += mass;
            cells_at_node[node as usize] += 1;
        }
    }
    if let Some(node) = cells_at_node.iter().position(|&count| count == 0) {
        return Err(BodyError::IsolatedNode { body: body.into(), node });
    }
    Ok(BodyState {
        positions: large_pages::moved(mesh.nodes().iter().map(|node| node.cast()).collect()),
        velocities: large_pages::filled(nodes, Vec3::ZERO),
        internal_forces: large_pages::filled(nodes, Vec3::ZERO),
        motions,
        grips: vec![Vec3::ZERO; nodes],
        masses: large_pages::moved(masses.into_iter().map(T::from_f64).collect()),
        removed: vec![false; mesh.cell_count()],
        removed_count: 0,
        removals: Removals::for_cells(mesh.cell_count()),
        cells_at_node,
        models,
        forces_are_current: false,
        squared_frequency: None,
        past: PastState::default(),
        tractions: Vec::new(),
        volumes,
        heat: vec![T::ZERO; mesh.cell_count()],
        seared: vec![T::ZERO; nodes],
    })
}
