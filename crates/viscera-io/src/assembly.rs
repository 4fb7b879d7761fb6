use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use viscera::mesh::{Mesh, NamedRegion, Point, SurfaceMesh};

use crate::cell_kind::{CellKind, Shape};
use crate::{Imported, ImportedMesh, Notice, ParseError, Place, Problem, grouped};

/// A physical group of Gmsh: dimension and tag.
pub(crate) type Group = (u8, u32);

/// The groups that a cell belongs to; [`GroupSet::NONE`] for most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct GroupSet(u32);

impl GroupSet {
    pub(crate) const NONE: Self = Self(0);
}

type Cells<const CORNERS: usize> = Vec<([u32; CORNERS], GroupSet)>;

/// What a reader gathers from a file of nodes and cells, before it is known what the file is.
#[derive(Default)]
pub(crate) struct Assembly {
    pub(crate) nodes: Vec<Point>,
    pub(crate) notices: Vec<Notice>,
    names: BTreeMap<Group, String>,
    sets: Vec<Vec<Group>>,
    set_of: BTreeMap<Vec<Group>, GroupSet>,
    tets: Cells<4>,
    hexes: Cells<8>,
    triangles: Cells<3>,
    quads: Cells<4>,
    /// Nodes of edges and points in groups.
    marks: Vec<(u32, GroupSet)>,
    others: BTreeMap<CellKind, usize>,
    fanned: usize,
}

impl Assembly {
    /// Adds a node; `number` is the file's own, for messages.
    pub(crate) fn node(
        &mut self,
        number: u64,
        position: [f64; 3],
        place: impl FnOnce() -> Place,
    ) -> Result<u32, ParseError> {
        if !position.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(Problem::NotFinite { node: number, position }.at(place()));
        }
        let index = u32::try_from(self.nodes.len()).map_err(|_| Problem::TooLarge { what: "nodes" }.at(place()))?;
        self.nodes.push(Point::new(position[0], position[1], position[2]));
        Ok(index)
    }

    pub(crate) fn name(&mut self, group: Group, name: String) {
        self.names.insert(group, name);
    }

    /// The set with these groups.
    pub(crate) fn set(&mut self, mut groups: Vec<Group>) -> GroupSet {
        groups.sort_unstable();
        groups.dedup();
        if groups.is_empty() {
            return GroupSet::NONE;
        }
        *self.set_of.entry(groups).or_insert_with_key(|groups| {
            self.sets.push(groups.clone());
            GroupSet(self.sets.len() as u32)
        })
    }

    /// Adds a cell. The corners are those of its kind; a polygon may have any number.
    pub(crate) fn cell(&mut self, kind: CellKind, corners: &[u32], set: GroupSet) {
        match (kind.shape, corners) {
            _ if kind.curved => self.other(kind),
            (Shape::Tetrahedron, &[a, b, c, d]) => self.tets.push(([a, b, c, d], set)),
            (Shape::Hexahedron, &[a, b, c, d, e, f, g, h]) => self.hexes.push(([a, b, c, d, e, f, g, h], set)),
            (Shape::Triangle | Shape::Polygon, &[a, b, c]) => self.triangles.push(([a, b, c], set)),
            (Shape::Quadrilateral | Shape::Polygon, &[a, b, c, d]) => self.quads.push(([a, b, c, d], set)),
            (Shape::Polygon, &[first, ref rest @ ..]) if rest.len() > 3 => {
                self.fanned += 1;
                self.triangles.extend(rest.windows(2).map(|pair| ([first, pair[0], pair[1]], set)));
            }
            (Shape::Edge | Shape::Point, _) if set != GroupSet::NONE => {
                self.marks.extend(corners.iter().map(|&node| (node, set)));
            }
            _ => self.other(kind),
        }
    }

    fn other(&mut self, kind: CellKind) {
        *self.others.entry(kind).or_default() += 1;
    }

    /// Makes the mesh: a volume where there is one, otherwise a surface.
    pub(crate) fn finish(mut self) -> Result<Imported, ParseError> {
        match (self.tets.len(), self.hexes.len(), self.triangles.len() + self.quads.len()) {
            (0, 0, 0) => Err(Problem::NoCells { held: self.held() }.at(Place::File)),
            (0, 0, _) => self.finish_surface(),
            (_, 0, _) => {
                let cells = std::mem::take(&mut self.tets);
                let faces = std::mem::take(&mut self.triangles);
                self.skip(Shape::Quadrilateral.straight(), self.quads.len());
                self.finish_volume(cells, faces, Shape::Triangle, ImportedMesh::Tet)
            }
            (0, _, _) => {
                let cells = std::mem::take(&mut self.hexes);
                let faces = std::mem::take(&mut self.quads);
                self.skip(Shape::Triangle.straight(), self.triangles.len());
                self.finish_volume(cells, faces, Shape::Quadrilateral, ImportedMesh::Hex)
            }
            (tetrahedra, hexahedra, _) => Err(Problem::MixedCells { tetrahedra, hexahedra }.at(Place::File)),
        }
    }

    /// What the file holds, in words, when it holds nothing of use.
    fn held(&self) -> String {
        let mut held = vec![format!("{} nodes", grouped(self.nodes.len()))];
        held.extend(self.others.iter().map(|(kind, &count)| format!("{} {kind}", grouped(count))));
        format!("it holds {}", held.join(", "))
    }

    fn skip(&mut self, kind: CellKind, count: usize) {
        if count > 0 {
            *self.others.entry(kind).or_default() += count;
        }
    }

    fn finish_volume<const CORNERS: usize, const FACE: usize>(
        mut self,
        cells: Cells<CORNERS>,
        faces: Cells<FACE>,
        face: Shape,
        wrap: impl FnOnce(Mesh<CORNERS, FACE>) -> ImportedMesh,
    ) -> Result<Imported, ParseError> {
        let (cells, cell_sets) = unique(cells);
        let (faces, face_sets) = unique(faces);
        let names = self.group_names();
        let mut regions: BTreeMap<String, NamedRegion<FACE>> = BTreeMap::new();
        let mut each_region = |set: GroupSet, enter: &mut dyn FnMut(&mut NamedRegion<FACE>)| {
            for group in self.sets.get((set.0 as usize).wrapping_sub(1)).into_iter().flatten() {
                enter(regions.entry(names[group].clone()).or_default());
            }
        };
        for (cell, set) in cell_sets {
            each_region(set, &mut |region| {
                region.cells.push(cell);
                region.nodes.extend(cells[cell as usize]);
            });
        }
        let mut grouped_faces = vec![false; faces.len()];
        for (number, set) in face_sets {
            grouped_faces[number as usize] = set != GroupSet::NONE;
            each_region(set, &mut |region| {
                region.faces.push(faces[number as usize]);
                region.nodes.extend(faces[number as usize]);
            });
        }
        // Faces of the other shape, edges and points of a group still tell which nodes are in it.
        let triangles = self.triangles.iter().flat_map(|&(corners, set)| corners.map(|node| (node, set)));
        let quads = self.quads.iter().flat_map(|&(corners, set)| corners.map(|node| (node, set)));
        for (node, set) in triangles.chain(quads).chain(self.marks.iter().copied()) {
            each_region(set, &mut |region| region.nodes.push(node));
        }
        regions.values_mut().for_each(NamedRegion::normalize);
        for name in self.names.values().filter(|&name| !regions.contains_key(name)) {
            self.notices.push(Notice::EmptyGroup { name: name.clone() });
        }
        self.skip(face.straight(), grouped_faces.iter().filter(|&&grouped| !grouped).count());
        self.tell_of_others(true);
        Ok(Imported { mesh: wrap(Mesh { nodes: self.nodes, cells, regions }), notices: self.notices })
    }

    fn finish_surface(mut self) -> Result<Imported, ParseError> {
        let names: BTreeSet<String> = self.group_names().into_values().collect();
        if !names.is_empty() {
            self.notices.push(Notice::GroupsSkipped { names: names.into_iter().collect() });
        }
        let (mut triangles, _) = unique(std::mem::take(&mut self.triangles));
        let (quads, _) = unique(std::mem::take(&mut self.quads));
        for (shape, count) in [(Shape::Quadrilateral, quads.len()), (Shape::Polygon, self.fanned)] {
            if count > 0 {
                self.notices.push(Notice::Split { kind: shape.straight(), count });
            }
        }
        triangles.extend(quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]));
        let before = triangles.len();
        triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        if triangles.len() < before {
            self.notices.push(Notice::Collapsed { count: before - triangles.len() });
        }
        self.tell_of_others(false);
        if triangles.is_empty() {
            return Err(Problem::NoCells { held: format!("{} collapsed triangles", grouped(before)) }.at(Place::File));
        }
        Ok(Imported {
            mesh: ImportedMesh::Surface(SurfaceMesh { nodes: self.nodes, triangles }),
            notices: self.notices,
        })
    }

    fn tell_of_others(&mut self, in_volume: bool) {
        self.notices.extend(self.others.iter().map(|(&kind, &count)| Notice::Skipped {
            kind,
            count,
            leaves_holes: in_volume && kind.shape.dimension() == 3,
        }));
    }

    /// A name for every group that has cells. Unnamed groups of different dimension may carry one tag: the highest
    /// dimension is `physical-N`, the others say what they are.
    fn group_names(&self) -> BTreeMap<Group, String> {
        let groups: BTreeSet<Group> = self.sets.iter().flatten().copied().collect();
        let unnamed: BTreeSet<Group> = groups.iter().copied().filter(|group| !self.names.contains_key(group)).collect();
        groups
            .iter()
            .map(|group @ &(dimension, tag)| {
                let higher = unnamed.iter().any(|&(other, same)| same == tag && other > dimension);
                let suffix =
                    if higher { ["-points", "-curves", "-surface", ""][usize::from(dimension.min(3))] } else { "" };
                (*group, self.names.get(group).cloned().unwrap_or_else(|| format!("physical-{tag}{suffix}")))
            })
            .collect()
    }
}

/// Cells, each once, and the group sets that they are in. Gmsh lists a cell of two groups twice, once for each; a cell that
/// is listed twice for one group stays twice, for the check of the mesh to find.
fn unique<const CORNERS: usize>(listed: Cells<CORNERS>) -> (Vec<[u32; CORNERS]>, Vec<(u32, GroupSet)>) {
    let sets: HashSet<GroupSet> = listed.iter().map(|&(_, set)| set).collect();
    let mut cells: Vec<[u32; CORNERS]> = Vec::with_capacity(listed.len());
    let mut members = Vec::with_capacity(listed.len());
    let mut first = HashMap::new();
    let mut seen = HashSet::new();
    for (corners, set) in listed {
        let again = sets.len() > 1 && set != GroupSet::NONE && seen.insert((corners, set));
        match first.get(&corners) {
            Some(&cell) if again => members.push((cell, set)),
            _ => {
                let cell = cells.len() as u32;
                if again {
                    first.insert(corners, cell);
                }
                cells.push(corners);
                members.push((cell, set));
            }
        }
    }
    (cells, members)
}
