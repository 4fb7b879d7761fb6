use super::world::AnyWorld;
use crate::message::{Bytes, F32s, SurfaceMessage, U32s};

/// The surface of a body, with vertices whose numbers never change their meaning: a cut adds some at the end.
pub(crate) struct Surface {
    /// Grows with every change.
    pub(crate) epoch: u64,
    /// Node of each vertex.
    pub(crate) nodes: Vec<u32>,
    /// How many of the vertices were on the skin at rest.
    skin: usize,
    /// Vertex of each node, where it has one.
    vertices: Vec<Option<u32>>,
    triangles: Vec<u32>,
    cut: Vec<u8>,
    /// By which a change is told.
    removed_cells: usize,
}

impl Surface {
    /// The surface of a body that was not cut yet.
    pub(crate) fn new(world: &AnyWorld, body: usize) -> Self {
        let mut surface = Self {
            epoch: 0,
            nodes: Vec::new(),
            skin: 0,
            vertices: vec![None; world.rest(body).len()],
            triangles: Vec::new(),
            cut: Vec::new(),
            removed_cells: 0,
        };
        surface.read(world, body);
        surface.skin = surface.nodes.len();
        surface
    }

    /// Follows cuts, and gives whether there were any.
    fn follow(&mut self, world: &AnyWorld, body: usize) -> bool {
        let changed = world.removed_cells(body) != self.removed_cells;
        if changed {
            self.read(world, body);
        }
        changed
    }

    fn read(&mut self, world: &AnyWorld, body: usize) {
        self.epoch += 1;
        self.removed_cells = world.removed_cells(body);
        self.triangles.clear();
        self.cut.clear();
        for triangle in world.surface(body) {
            self.cut.push(u8::from(triangle.cut));
            for node in triangle.nodes {
                let next = self.nodes.len() as u32;
                let vertex = *self.vertices[node as usize].get_or_insert(next);
                if vertex == next {
                    self.nodes.push(node);
                }
                self.triangles.push(vertex);
            }
        }
    }

    pub(crate) fn message(&self, scene: u64, body: usize, world: &AnyWorld) -> SurfaceMessage {
        let rest = world.rest(body);
        SurfaceMessage {
            scene,
            body,
            epoch: self.epoch,
            vertices: self.nodes.len(),
            skin: self.skin,
            triangles: U32s(self.triangles.clone()),
            cut: Bytes(self.cut.clone()),
            rest: F32s(self.nodes.iter().flat_map(|&node| rest[node as usize].cast::<f32>().to_array()).collect()),
        }
    }
}

/// Follows the cuts of every body, and gives whether there were any.
pub(crate) fn follow(world: &AnyWorld, surfaces: &mut [Surface]) -> bool {
    surfaces.iter_mut().enumerate().fold(false, |changed, (body, surface)| surface.follow(world, body) | changed)
}
