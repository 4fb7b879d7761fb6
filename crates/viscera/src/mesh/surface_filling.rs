use std::fmt;

use super::groups::Groups;
use super::measure;
use super::surface_check::SurfaceReport;
use super::{SignedDistance, SurfaceError, SurfaceMesh, TetMesh, TetTopology, TriangleTree};

/// What became of a surface when it was filled with tetrahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct FillingReport {
    /// The surface itself: what was mended, what it encloses.
    pub surface: SurfaceReport,
    /// Edge of the lattice [m].
    pub edge: f64,
    /// Tetrahedra made.
    pub cells: usize,
    /// Volume of the tetrahedra [m³].
    pub volume: f64,
    /// Volume of the surface that the tetrahedra lack, as a part of it: creases cut off, curves cut short, thin parts lost.
    pub volume_lost: f64,
    /// Part of the area under which the solid is thinner than 1.5 edges, where cells cannot hold it.
    pub thin_area: f64,
    /// The edge [m] with which only a hundredth of the area would be thin; at most `edge`.
    pub sufficient_edge: f64,
    /// Parts of the mesh that no face connects.
    pub pieces: usize,
}

/// A solid needs this many edges across to be held by cells, however it lies in the lattice.
const EDGES_ACROSS: f64 = 1.5;
/// More than this part of the area thin is worth a word; a sharp crease is thin too, but has little area.
const THIN_AREA: f64 = 0.01;

impl TetMesh {
    /// Fills a closed triangle surface with tetrahedra of about `edge` [m], after mending what can be mended
    /// ([`SurfaceMesh::repaired`]), by [isosurface stuffing](Self::from_signed_distance).
    ///
    /// The skin of the mesh is new: its nodes lie on the surface, sharp creases are rounded off at the size of an edge.
    ///
    /// # Errors
    /// A surface with holes, with edges of more than two triangles, or with one side only; damaged indices; an edge that
    /// is not positive, too small for memory or too large for any cell ([`SurfaceError`]).
    pub fn from_surface(surface: &SurfaceMesh, edge: f64) -> Result<(Self, FillingReport), SurfaceError> {
        let (surface, report) = surface.repaired()?;
        report.require_closed()?;
        let tree = TriangleTree::new(&surface);
        let mesh = Self::from_signed_distance(&tree, edge)?;
        let thickness = Thickness::of(&surface, &tree);
        let filled = FillingReport {
            edge,
            cells: mesh.cells.len(),
            volume: mesh.volume(),
            volume_lost: 1.0 - mesh.volume() / report.volume,
            thin_area: thickness.share_below(EDGES_ACROSS * edge),
            sufficient_edge: edge.min(thickness.quantile(THIN_AREA) / EDGES_ACROSS),
            pieces: pieces(&mesh),
            surface: report,
        };
        Ok((mesh, filled))
    }
}

/// How thick a solid is under each triangle of its surface, measured straight inwards, the thinnest first.
struct Thickness {
    /// Thickness [m] and area [m²].
    samples: Vec<(f64, f64)>,
    area: f64,
}

impl Thickness {
    fn of(surface: &SurfaceMesh, tree: &TriangleTree) -> Self {
        let size = (tree.bounds().1 - tree.bounds().0).norm();
        let mut samples = Vec::with_capacity(surface.triangles.len());
        for triangle in &surface.triangles {
            let [a, b, c] = triangle.map(|node| surface.nodes[node as usize]);
            let normal = (b - a).cross(c - a);
            let Some(outwards) = normal.normalized() else { continue };
            // Start a little way in, so that the triangle does not meet itself.
            if let Some(thickness) = tree.first_hit((a + b + c) / 3.0, -outwards, 1e-9 * size) {
                samples.push((thickness, 0.5 * normal.norm()));
            }
        }
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        let area = samples.iter().map(|(_, area)| area).sum();
        Self { samples, area }
    }

    /// Part of the area where the solid is thinner than `limit` [m].
    fn share_below(&self, limit: f64) -> f64 {
        let thin: f64 = self.samples.iter().take_while(|(thickness, _)| *thickness < limit).map(|(_, area)| area).sum();
        if self.area > 0.0 { thin / self.area } else { 0.0 }
    }

    /// The thickness [m] below which lies a given part of the area.
    fn quantile(&self, share: f64) -> f64 {
        let mut below = 0.0;
        let reached = self.samples.iter().find(|(_, area)| {
            below += area;
            below > share * self.area
        });
        reached.map_or(f64::INFINITY, |(thickness, _)| *thickness)
    }
}

/// How many parts a mesh has that no face connects.
fn pieces(mesh: &TetMesh) -> usize {
    let mut groups = Groups::new(mesh.cells.len());
    let joined = TetTopology::new(mesh)
        .faces
        .iter()
        .filter_map(|face| face.cells.1.map(|second| (face.cells.0 as usize, second as usize)))
        .filter(|&(first, second)| groups.join(first, second))
        .count();
    mesh.cells.len() - joined
}

impl fmt::Display for FillingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.surface)?;
        let (edge, volume) = (measure::length(self.edge), measure::volume(self.volume));
        let (cells, lost) = (self.cells, 100.0 * self.volume_lost);
        writeln!(f, "{cells} tetrahedra of edge {edge}, {volume}, {lost:.2} % of the volume lost")?;
        if self.thin_area > THIN_AREA {
            writeln!(
                f,
                "{:.1} % of the surface covers parts thinner than {EDGES_ACROSS} edges, which may be lost or torn; an edge of {} would do",
                100.0 * self.thin_area,
                measure::length(self.sufficient_edge)
            )?;
        }
        let expected = self.surface.components - self.surface.cavities;
        if self.pieces > expected {
            writeln!(
                f,
                "the mesh fell into {} pieces where the surface has {expected}: a neck is thinner than the edge",
                self.pieces
            )?;
        }
        Ok(())
    }
}
