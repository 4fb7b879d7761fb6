//! What a picture shows of one moment: a copy, because the camera can only be set when all moments are known.

use serde::{Deserialize, Serialize};
use viscera::body::NodeMotion;
use viscera::math::Scalar;
use viscera::mesh::Point;
use viscera_scene::BuiltScene;

/// All bodies and instruments at one moment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Moment {
    pub(super) step: u64,
    pub(super) time: f64,
    pub(super) skins: Vec<Skin>,
    pub(super) tools: Vec<ToolPose>,
    pub(super) cells: usize,
    pub(super) removed: usize,
}

/// The surface of a body.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Skin {
    pub(super) nodes: Vec<Point>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Which triangles a cut has laid open.
    pub(super) cut: Vec<bool>,
    /// Nodes of the surface that are fixed.
    pub(super) fixed: Vec<u32>,
}

/// An instrument, where it is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ToolPose {
    pub(super) kind: String,
    pub(super) tip: Point,
    pub(super) reach: f64,
    pub(super) active: bool,
    /// Its rigid parts, where it has some: rods by their ends, and their radius [m].
    pub(super) parts: Vec<(Point, Point, f64)>,
}

impl Moment {
    pub(super) fn of<T: Scalar>(built: &BuiltScene<T>, step: u64) -> Self {
        let world = &built.world;
        let time = world.time();
        let bodies = || built.bodies.values().map(|&id| world.body(id));
        let tools = built.instruments.values().map(|&id| ToolPose {
            kind: world.instrument(id).kind().to_owned(),
            tip: world.tool(id).pose.tip,
            reach: world.instrument(id).reach(),
            active: world.is_at_work(id),
            parts: world.tool_capsules(id).into_iter().map(|part| (part.from, part.to, part.radius)).collect(),
        });
        Self {
            step,
            time,
            tools: tools.collect(),
            cells: bodies().map(|body| body.cell_count()).sum(),
            removed: bodies().map(|body| body.state().removed_count).sum(),
            skins: bodies().map(Skin::of).collect(),
        }
    }

    /// The bounds of all that is seen; nothing where nothing is.
    pub(super) fn bounds(&self) -> Option<(Point, Point)> {
        let places = self.skins.iter().flat_map(Skin::places);
        places.fold(None, |bounds: Option<(Point, Point)>, place| {
            Some(bounds.map_or((place, place), |(low, high)| (low.min(place), high.max(place))))
        })
    }
}

impl Skin {
    fn of<T: Scalar>(body: &viscera::body::SimulatedBody<T>) -> Self {
        let surface = body.surface();
        let mut seen = vec![false; body.mesh().nodes().len()];
        surface.iter().flat_map(|triangle| triangle.nodes).for_each(|node| seen[node as usize] = true);
        let motions = &body.state().motions;
        let is_fixed = |node: &u32| seen[*node as usize] && motions[*node as usize] == NodeMotion::Fixed;
        Self {
            nodes: body.positions().iter().map(|place| place.cast()).collect(),
            triangles: surface.iter().map(|triangle| triangle.nodes).collect(),
            cut: surface.iter().map(|triangle| triangle.cut).collect(),
            fixed: (0..motions.len() as u32).filter(is_fixed).collect(),
        }
    }

    /// Places of the nodes that are seen.
    fn places(&self) -> impl Iterator<Item = Point> + '_ {
        self.triangles.iter().flatten().map(|&node| self.nodes[node as usize]).filter(|place| place.is_finite())
    }
}
