//! The triangles that tools touch: those of the surface as it is now.

use super::boundary::Boundary;

/// No place.
const NONE: u32 = u32::MAX;

/// The surface of a body that tools meet, kept up to date cut by cut: what a cut costs follows from the cells that it takes, not from the
/// mesh. The order of its triangles means nothing. Empty, and without memory, where no tool touches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Skin {
    triangles: Vec<[u32; 3]>,
    /// The face of each triangle.
    faces: Vec<u32>,
    /// Where the triangle of each face is.
    places: Vec<u32>,
    /// Faces of each cell, cell after cell, and where each cell begins.
    cell_faces: Vec<u32>,
    starts: Vec<u32>,
}

impl Skin {
    /// Corners, counter-clockwise seen from outside.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangles, and the number of the face of each, which tells them apart whatever their order.
    pub(crate) fn numbered(&self) -> (&[[u32; 3]], &[u32]) {
        (&self.triangles, &self.faces)
    }

    /// Asks for the memory of a skin of `boundary`, a mesh of so many cells, however it will be cut; nothing is allocated later.
    pub(super) fn reserve(&mut self, boundary: &Boundary, cells: usize) {
        let faces = boundary.faces.len();
        if self.places.len() == faces {
            return;
        }
        self.places = vec![NONE; faces];
        self.triangles.reserve(faces);
        self.faces.reserve(faces);
        self.starts = vec![0; cells + 1];
        let sides = || {
            let numbered = boundary.faces.iter().zip(0..);
            numbered.flat_map(|(face, number)| {
                [Some(face.cells.0), face.cells.1].into_iter().flatten().map(move |cell| (cell, number))
            })
        };
        sides().for_each(|(cell, _)| self.starts[cell as usize + 1] += 1);
        for cell in 0..cells {
            self.starts[cell + 1] += self.starts[cell];
        }
        self.cell_faces = vec![0; self.starts[cells] as usize];
        let mut next = self.starts.clone();
        for (cell, number) in sides() {
            let place = &mut next[cell as usize];
            self.cell_faces[*place as usize] = number;
            *place += 1;
        }
    }

    /// Lists all of the surface anew.
    pub(super) fn renew(&mut self, boundary: &Boundary, removed: &[bool]) {
        for face in 0..self.places.len() as u32 {
            self.update(boundary, removed, face);
        }
    }

    /// Brings up to date what lies around cells that were just removed.
    pub(super) fn cut(&mut self, boundary: &Boundary, removed: &[bool], cells: &[u32]) {
        if self.places.is_empty() {
            return;
        }
        for &cell in cells {
            for place in self.starts[cell as usize]..self.starts[cell as usize + 1] {
                self.update(boundary, removed, self.cell_faces[place as usize]);
            }
        }
    }

    fn update(&mut self, boundary: &Boundary, removed: &[bool], face: u32) {
        let place = self.places[face as usize];
        match boundary.triangle(face, removed) {
            Some(triangle) if place == NONE => {
                self.places[face as usize] = self.triangles.len() as u32;
                self.triangles.push(triangle.nodes);
                self.faces.push(face);
            }
            Some(triangle) => self.triangles[place as usize] = triangle.nodes,
            None if place == NONE => {}
            None => {
                self.triangles.swap_remove(place as usize);
                self.faces.swap_remove(place as usize);
                self.places[face as usize] = NONE;
                if let Some(&moved) = self.faces.get(place as usize) {
                    self.places[moved as usize] = place;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{HexMesh, TetMesh, VolumeMesh};

    #[test]
    fn a_skin_that_is_cut_cell_by_cell_is_the_surface() {
        for mesh in [
            VolumeMesh::from(TetMesh::box_grid([3, 2, 4], [1.0; 3])),
            VolumeMesh::from(HexMesh::box_grid([3, 2, 4], [1.0; 3])),
        ] {
            let (boundary, cells) = (Boundary::new(&mesh), mesh.cell_count());
            let (mut removed, mut skin) = (vec![false; cells], Skin::default());
            skin.reserve(&boundary, cells);
            skin.renew(&boundary, &removed);
            // 7 is coprime to both numbers of cells: every cell once, far from the one before.
            for turn in 0..cells {
                let cell = (turn * 7) % cells;
                assert!(!std::mem::replace(&mut removed[cell], true), "{cells} cells");
                skin.cut(&boundary, &removed, &[cell as u32]);
                let mut surface: Vec<_> = boundary.surface(&removed).map(|triangle| triangle.nodes).collect();
                let mut known = skin.triangles().to_vec();
                surface.sort_unstable();
                known.sort_unstable();
                assert_eq!(known, surface, "after {} cuts", turn + 1);
            }
            assert!(skin.triangles().is_empty());
        }
    }
}
