use viscera::math::Scalar;
use viscera::mesh::{TetQuality, VolumeMesh};
use viscera::model::Precision;
use viscera_scene::BuiltScene;

/// What the stable step of explicit integration hangs on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limit {
    pub(super) body: String,
    pub(super) cell: usize,
    /// The longest stable step as the body was at last [s].
    pub(super) stable_step: f64,
    /// Smallest height of the cell at rest [m], of tetrahedra.
    pub(super) height: Option<f64>,
    /// The middle one of all cells [m].
    pub(super) median_height: Option<f64>,
    /// The longest edge of the cell over that at rest.
    pub(super) stretch: f64,
}

impl Limit {
    /// The cell that sets the step of the whole scene; none where nothing vibrates.
    pub(super) fn of<T: Precision>(built: &BuiltScene<T>) -> Option<Self> {
        let body = |id| built.world.body(id);
        let (name, &id) =
            built.bodies.iter().min_by(|(_, a), (_, b)| body(**a).stable_step().total_cmp(&body(**b).stable_step()))?;
        let body = body(id);
        let cell = body.stiffest_cell()?;
        let heights = match body.mesh() {
            VolumeMesh::Tet(mesh) => {
                let height = |cell: usize| TetQuality::of(mesh.corners(cell)).smallest_altitude;
                let mut all: Vec<f64> = (0..mesh.cells.len()).map(height).collect();
                all.sort_by(f64::total_cmp);
                Some((height(cell), all[all.len() / 2]))
            }
            VolumeMesh::Hex(_) => None,
        };
        Some(Self {
            body: name.clone(),
            cell,
            stable_step: body.stable_step(),
            height: heights.map(|(own, _)| own),
            median_height: heights.map(|(_, median)| median),
            stretch: stretch(body, cell),
        })
    }
}

fn stretch<T: Scalar>(body: &viscera::body::SimulatedBody<T>, cell: usize) -> f64 {
    let corners = body.mesh().cell(cell);
    let rest = |node: u32| body.mesh().nodes()[node as usize];
    let now = |node: u32| body.positions()[node as usize].cast::<f64>();
    let pairs = corners.iter().enumerate().flat_map(|(i, &a)| corners[..i].iter().map(move |&b| (a, b)));
    pairs.map(|(a, b)| (now(a) - now(b)).norm() / (rest(a) - rest(b)).norm()).fold(0.0, f64::max)
}
