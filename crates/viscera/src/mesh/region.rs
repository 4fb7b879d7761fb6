/// A named part of a mesh, such as a physical group of Gmsh: nodes, cells and boundary faces that carry one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedRegion<const FACE: usize> {
    /// Nodes of everything in the region, ascending, each once.
    pub nodes: Vec<u32>,
    /// Cells, ascending, each once; empty for a group of faces, edges or points.
    pub cells: Vec<u32>,
    /// Faces as the file lists them; empty for a group of cells, edges or points.
    pub faces: Vec<[u32; FACE]>,
}

impl<const FACE: usize> NamedRegion<FACE> {
    /// Sorts nodes and cells and drops what is listed twice.
    pub fn normalize(&mut self) {
        self.nodes.sort_unstable();
        self.nodes.dedup();
        self.cells.sort_unstable();
        self.cells.dedup();
    }
}
