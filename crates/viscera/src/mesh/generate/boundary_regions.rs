use super::super::{HexMesh, Mesh, TetMesh, TetTopology};

/// Names the boundary faces: each goes to the first of `sides` that holds all its nodes.
fn name_faces<const CORNERS: usize, const FACE: usize>(
    mesh: &mut Mesh<CORNERS, FACE>,
    faces: Vec<[u32; FACE]>,
    sides: &[(&str, &dyn Fn(u32) -> bool)],
) {
    for face in faces {
        let Some((name, _)) = sides.iter().find(|(_, holds)| face.iter().all(|&node| holds(node))) else { continue };
        let region = mesh.regions.entry((*name).to_owned()).or_default();
        region.nodes.extend(face);
        region.faces.push(face);
    }
    mesh.regions.values_mut().for_each(|region| region.normalize());
}

impl TetMesh {
    /// Adds one named region per side: the boundary triangles of which a side holds all three nodes.
    pub(super) fn name_sides(&mut self, sides: &[(&str, &dyn Fn(u32) -> bool)]) {
        let faces = TetTopology::new(self).surface().collect();
        name_faces(self, faces, sides);
    }
}

impl HexMesh {
    /// Adds one named region per side: the boundary quadrilaterals of which a side holds all four nodes.
    pub(super) fn name_sides(&mut self, sides: &[(&str, &dyn Fn(u32) -> bool)]) {
        let faces = self.surface_quads();
        name_faces(self, faces, sides);
    }
}
