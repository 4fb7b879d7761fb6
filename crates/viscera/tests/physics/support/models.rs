//! Every model of every law, on meshes without any regularity.

use viscera::material::{LawFamily, LawKind, LawVisitor, Tissue};
use viscera::math::Vec3;
use viscera::mesh::GaussRule;
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::{Claims, ForceModel, ModelKind, Precision, Scratch, TotalLagrangian};

use super::{Matrix, Random, Vector};

/// A model and what to call it in a message.
pub(crate) struct Named<T> {
    pub(crate) name: String,
    pub(crate) model: Box<dyn ForceModel<T>>,
    pub(crate) claims: Claims,
}

impl<T: Precision> Named<T> {
    /// The volume penalty, which is objective and has an energy.
    pub(crate) fn penalty(mesh: &TetMesh, kappa: f64) -> Self {
        let model = T::build_volume_penalty(mesh, kappa).unwrap();
        let claims = Claims { of_the_law: false, ..Claims::of_law(LawKind::StVenantKirchhoff) };
        Self { name: "volume penalty".into(), model, claims }
    }
}

/// Stiffness of the volume penalty in the suites [Pa]: that of ordinary tissue.
pub(crate) const KEEP_VOLUME: f64 = 8e3;

/// Asks a model for arrays of its own.
pub(crate) trait Evaluate<T> {
    fn forces(&self, x: &[Vec3<T>]) -> Vec<Vec3<T>>;
    fn product(&self, x: &[Vec3<T>], dx: &[Vec3<T>]) -> Vec<Vec3<T>>;
}

impl<T: Precision> Evaluate<T> for dyn ForceModel<T> + '_ {
    fn forces(&self, x: &[Vec3<T>]) -> Vec<Vec3<T>> {
        let mut out = vec![Vec3::ZERO; x.len()];
        self.add_forces(x, &mut Scratch::new(x.len()), &mut out);
        out
    }

    fn product(&self, x: &[Vec3<T>], dx: &[Vec3<T>]) -> Vec<Vec3<T>> {
        let mut out = vec![Vec3::ZERO; x.len()];
        self.add_product(x, dx, &mut Scratch::new(x.len()), &mut out);
        out
    }
}

/// The total-Lagrangian model that computes F and P(F) in so many words.
pub(crate) fn plain<T: Precision>(tissue: &Tissue, mesh: &VolumeMesh) -> Box<dyn ForceModel<T>> {
    T::build_model(&TotalLagrangian::new(tissue.clone()).plain(), mesh).unwrap()
}

/// Every model that can compute this tissue on this mesh, and the plain one.
pub(crate) fn models<T: Precision>(tissue: &Tissue, mesh: &VolumeMesh) -> Vec<Named<T>> {
    let hexahedra = matches!(mesh, VolumeMesh::Hex(_));
    let law = tissue.kind();
    let able = |kind: &ModelKind| kind.info().laws.contains(&law) && (kind.info().hexahedra || !hexahedra);
    let mut models: Vec<_> = ModelKind::ALL
        .iter()
        .copied()
        .filter(able)
        .map(|kind| Named {
            name: format!("{kind} of {law}"),
            model: T::build_model(kind.recipe(tissue.clone()).as_ref(), mesh).unwrap(),
            claims: kind.claims(law, hexahedra),
        })
        .collect();
    let claims = Claims::of_law(law);
    models.push(Named { name: format!("plain total-lagrangian of {law}"), model: plain(tissue, mesh), claims });
    if hexahedra {
        let model = T::build_model(&TotalLagrangian::new(tissue.clone()).gauss(GaussRule::Three), mesh).unwrap();
        models.push(Named { name: format!("total-lagrangian of {law}, 3×3×3 points"), model, claims });
    }
    models
}

/// The models that are another text of this tissue's law.
pub(crate) fn models_of_the_law<T: Precision>(tissue: &Tissue, mesh: &VolumeMesh) -> Vec<Named<T>> {
    models(tissue, mesh).into_iter().filter(|named| named.claims.of_the_law).collect()
}

/// Every model of every law, uniform, and the volume penalty.
pub(crate) fn models_and_penalty<T: Precision>(mesh: &VolumeMesh) -> Vec<Named<T>> {
    let mut all: Vec<_> = examples().iter().flat_map(|(tissue, _)| models(tissue, mesh)).collect();
    if let VolumeMesh::Tet(mesh) = mesh {
        all.push(Named::penalty(mesh, KEEP_VOLUME));
    }
    all
}

/// The example tissue of every law, with whether the law is objective.
pub(crate) fn examples() -> Vec<(Tissue, bool)> {
    struct Example;
    impl LawVisitor for Example {
        type Output = (Tissue, bool);
        fn visit<L: LawFamily>(self) -> (Tissue, bool) {
            (Tissue::uniform(L::example()), L::OBJECTIVE)
        }
    }
    LawKind::ALL.iter().map(|kind| kind.visit(Example)).collect()
}

/// A tissue of this law with these parameter values, cell after cell.
pub(crate) fn of_values<'a>(kind: LawKind, values: impl Iterator<Item = &'a [f64]>) -> Tissue {
    struct OfValues<I>(I);
    impl<'a, I: Iterator<Item = &'a [f64]>> LawVisitor for OfValues<I> {
        type Output = Tissue;
        fn visit<L: LawFamily>(self) -> Tissue {
            Tissue::per_cell(&self.0.map(L::from_values).collect::<Vec<_>>()).unwrap()
        }
    }
    kind.visit(OfValues(values))
}

/// A tissue of this law whose moduli vary from cell to cell, between half and one and a half times the example's.
pub(crate) fn uneven(kind: LawKind, cells: usize, random: &mut Random) -> Tissue {
    struct Uneven<'a>(usize, &'a mut Random);
    impl LawVisitor for Uneven<'_> {
        type Output = Tissue;
        fn visit<L: LawFamily>(self) -> Tissue {
            let vary = |_| {
                let factor = 1.0 + 0.5 * self.1.signed();
                let scaled = L::PARAMETERS.iter().zip(L::example().values());
                let values: Vec<f64> =
                    scaled.map(|(p, value)| if p.unit == "Pa" { value * factor } else { value }).collect();
                L::from_values(&values)
            };
            Tissue::per_cell(&(0..self.0).map(vary).collect::<Vec<L>>()).unwrap()
        }
    }
    kind.visit(Uneven(cells, random))
}

/// Tetrahedra over a box of 12×10×8 cm whose nodes were moved at random by up to a tenth of a cell.
pub(crate) fn tet_mesh(cells: [usize; 3]) -> TetMesh {
    let mut mesh = TetMesh::box_grid(cells, SIZE);
    unsettle(&mut mesh.nodes, cells);
    mesh
}

/// Hexahedra over the same box, moved alike.
pub(crate) fn hex_mesh(cells: [usize; 3]) -> HexMesh {
    let mut mesh = HexMesh::box_grid(cells, SIZE);
    unsettle(&mut mesh.nodes, cells);
    mesh
}

const SIZE: [f64; 3] = [0.12, 0.10, 0.08];

fn unsettle(nodes: &mut [Vector], cells: [usize; 3]) {
    let mut random = Random::new(7);
    let spacing = [0, 1, 2].map(|axis| SIZE[axis] / cells[axis] as f64).into_iter().fold(f64::MAX, f64::min);
    nodes.iter_mut().for_each(|node| *node += random.vector() * (0.1 * spacing));
}

/// The rest positions under x = F X + c, every node then moved at random by up to `noise` [m].
pub(crate) fn deformed(mesh: &VolumeMesh, f: Matrix, c: Vector, noise: f64, random: &mut Random) -> Vec<Vector> {
    mesh.nodes().iter().map(|&node| f * node + c + random.vector() * noise).collect()
}

/// By how much a model multiplies roundings: tensor-mass sums powers of the displacement up to the third, which are
/// (|u|/h)³ times as large as what is left of them where the body moves as a whole; 1 for models that see differences only.
pub(crate) fn amplification(name: &str, mesh: &VolumeMesh, x: &[Vector]) -> f64 {
    if !name.contains("tensor-mass") {
        return 1.0;
    }
    let rest = mesh.nodes();
    let furthest = x.iter().zip(rest).map(|(&x, &rest)| (x - rest).norm()).fold(0.0, f64::max);
    let edge = |cell: usize| (rest[mesh.cell(cell)[0] as usize] - rest[mesh.cell(cell)[1] as usize]).norm();
    let shortest = (0..mesh.cell_count()).map(edge).fold(f64::MAX, f64::min);
    (1.0 + furthest / shortest).powi(3)
}

/// The nodes that lie on no boundary face.
pub(crate) fn inner_nodes(mesh: &VolumeMesh) -> Vec<usize> {
    let surface = match mesh {
        VolumeMesh::Tet(mesh) => mesh.surface(),
        VolumeMesh::Hex(mesh) => mesh.surface(),
    };
    let outer: std::collections::BTreeSet<u32> = surface.triangles.into_iter().flatten().collect();
    (0..mesh.nodes().len()).filter(|&node| !outer.contains(&(node as u32))).collect()
}
