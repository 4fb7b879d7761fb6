//! What must not matter: where the body is and how it is turned, how its nodes and cells are numbered, the unit of length,
//! and the precision, up to its own rounding.

use viscera::material::{LawFamily, LawVisitor, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Mesh, TetMesh, VolumeMesh};
use viscera::model::Precision;

use crate::support::{
    Evaluate, KEEP_VOLUME, Named, Random, Vector, assert_close, assert_near, deformed, examples, hex_mesh, largest,
    models, models_and_penalty, near, tet_mesh,
};

fn meshes() -> [VolumeMesh; 2] {
    [tet_mesh([3, 2, 2]).into(), hex_mesh([3, 2, 2]).into()]
}

#[test]
fn moving_and_turning_the_body_moves_and_turns_its_forces() {
    for mesh in meshes() {
        let mut random = Random::new(61);
        let x = deformed(&mesh, random.deformation(0.4), Vector::ZERO, 0.005, &mut random);
        let (turn, shift) = (random.rotation(), random.vector());
        for named in models_and_penalty::<f64>(&mesh) {
            let (forces, energy) = (named.model.forces(&x), named.model.energy(&x));
            let shifted: Vec<_> = x.iter().map(|&x| x + shift).collect();
            assert_near(&named.model.forces(&shifted), &forces, 1e-12, &named.name);
            assert_close(named.model.energy(&shifted), energy, 1e-12, &named.name);
            if named.claims.objective {
                let turned: Vec<_> = x.iter().map(|&x| turn * x + shift).collect();
                let expected: Vec<_> = forces.iter().map(|&force| turn * force).collect();
                assert_near(&named.model.forces(&turned), &expected, 1e-12, &named.name);
                assert_close(named.model.energy(&turned), energy, 1e-12, &named.name);
            }
        }
    }
}

/// A mesh whose node `i` is called `new_name[i]`, with its cells in another order.
fn renumbered<const C: usize, const F: usize>(mesh: &Mesh<C, F>, new_name: &[usize], order: &[usize]) -> Mesh<C, F> {
    let mut nodes = mesh.nodes.clone();
    new_name.iter().enumerate().for_each(|(old, &new)| nodes[new] = mesh.nodes[old]);
    let cells = order.iter().map(|&cell| mesh.cells[cell].map(|node| new_name[node as usize] as u32)).collect();
    Mesh::new(nodes, cells)
}

/// Tetrahedra also list their corners from another one on: even permutations keep the orientation.
#[test]
fn numbering_nodes_cells_and_corners_otherwise_changes_no_force() {
    for mesh in meshes() {
        let mut random = Random::new(62);
        let x = deformed(&mesh, random.deformation(0.4), Vector::ZERO, 0.005, &mut random);
        let new_name = random.permutation(x.len());
        let order = random.permutation(mesh.cell_count());
        let other: VolumeMesh = match &mesh {
            VolumeMesh::Tet(mesh) => {
                let mut other: TetMesh = renumbered(mesh, &new_name, &order);
                for corners in &mut other.cells {
                    let [a, b, c, d] = *corners;
                    *corners = [[a, b, c, d], [b, a, d, c], [c, a, b, d], [d, c, b, a]][random.below(4)];
                }
                other.into()
            }
            VolumeMesh::Hex(mesh) => renumbered(mesh, &new_name, &order).into(),
        };
        let permuted = |values: &[Vector]| {
            let mut out = values.to_vec();
            new_name.iter().enumerate().for_each(|(old, &new)| out[new] = values[old]);
            out
        };
        let y = permuted(&x);
        let dx = random.vectors(x.len(), 1.0);
        for (named, again) in models_and_penalty::<f64>(&mesh).into_iter().zip(models_and_penalty(&other)) {
            let (forces, product) = (named.model.forces(&x), named.model.product(&x, &dx));
            assert_near(&again.model.forces(&y), &permuted(&forces), 1e-13, &named.name);
            assert_near(&again.model.product(&y, &permuted(&dx)), &permuted(&product), 1e-13, &named.name);
            assert_close(again.model.energy(&y), named.model.energy(&x), 1e-12, &named.name);
        }
    }
}

fn scale(mesh: &mut VolumeMesh, factor: f64) {
    let nodes = match mesh {
        VolumeMesh::Tet(mesh) => &mut mesh.nodes,
        VolumeMesh::Hex(mesh) => &mut mesh.nodes,
    };
    nodes.iter_mut().for_each(|node| *node = *node * factor);
}

/// A body 2^k times as large has 4^k times the forces and products, here down to 1e-55 m and up to 1e53 m: no number in between leaves
/// the range.
#[test]
fn bodies_of_any_size_have_the_forces_and_products_of_their_shape() {
    let mut others = Vec::new();
    for mesh in meshes() {
        let mut random = Random::new(64);
        let x = deformed(&mesh, random.deformation(0.4), Vector::ZERO, 0.005, &mut random);
        let dx = random.vectors(x.len(), 0.01);
        let usual = models_and_penalty::<f64>(&mesh);
        for power in [-180, 180] {
            let size = 2f64.powi(power);
            let scaled = |places: &[Vector]| places.iter().map(|&place| place * size).collect::<Vec<_>>();
            let back = |forces: Vec<Vector>| forces.into_iter().map(|force| force / size / size).collect::<Vec<_>>();
            let mut other = mesh.clone();
            scale(&mut other, size);
            let (x_there, dx_there) = (scaled(&x), scaled(&dx));
            for (usual, named) in usual.iter().zip(models_and_penalty::<f64>(&other)) {
                let (forces, product) = (usual.model.forces(&x), usual.model.product(&x, &dx));
                let same = near(&back(named.model.forces(&x_there)), &forces, 1e-12, largest(&forces))
                    && near(&back(named.model.product(&x_there, &dx_there)), &product, 1e-12, largest(&product));
                if !same {
                    others.push(format!("{}, times 2^{power}", named.name));
                }
            }
        }
    }
    assert!(others.is_empty(), "{others:#?}");
}

/// The same law in newtons and millimetres: every modulus is a millionth.
fn in_millimetres(tissue: &Tissue) -> Tissue {
    struct Convert<'a>(&'a [f64]);
    impl LawVisitor for Convert<'_> {
        type Output = Tissue;
        fn visit<L: LawFamily>(self) -> Tissue {
            let factor = |unit: &str| match unit {
                "Pa" => 1e-6,
                "" => 1.0,
                _ => panic!("{}: how does {unit} change with the unit of length?", L::NAME),
            };
            let values: Vec<_> = L::PARAMETERS.iter().zip(self.0).map(|(p, value)| value * factor(p.unit)).collect();
            Tissue::uniform(L::from_values(&values))
        }
    }
    tissue.kind().visit(Convert(tissue.values(0)))
}

/// Forces in newtons are the same, energies are a thousand times as many N mm, in both precisions.
fn millimetres_instead_of_metres<T: Precision>() {
    let roundings = T::EPSILON.to_f64() / f64::EPSILON;
    let thousand = T::from_f64(1e3);
    for mut mesh in meshes() {
        let mut random = Random::new(63);
        let x = deformed(&mesh, random.deformation(0.4), Vector::ZERO, 0.005, &mut random);
        let x: Vec<Vec3<T>> = x.iter().map(|x| x.cast()).collect();
        let metres: Vec<_> = examples().iter().flat_map(|(tissue, _)| models::<T>(tissue, &mesh)).collect();
        let penalty = |mesh: &VolumeMesh, kappa: f64| match mesh {
            VolumeMesh::Tet(mesh) => vec![Named::<T>::penalty(mesh, kappa)],
            VolumeMesh::Hex(_) => vec![],
        };
        let penalty_in_metres = penalty(&mesh, KEEP_VOLUME);
        scale(&mut mesh, 1e3);
        let millimetres: Vec<_> =
            examples().iter().flat_map(|(tissue, _)| models::<T>(&in_millimetres(tissue), &mesh)).collect();
        let y: Vec<_> = x.iter().map(|&x| x * thousand).collect();
        let pairs = metres.into_iter().zip(millimetres);
        for (m, mm) in pairs.chain(penalty_in_metres.into_iter().zip(penalty(&mesh, KEEP_VOLUME * 1e-6))) {
            assert_near(&mm.model.forces(&y), &m.model.forces(&x), 1e-13 * roundings, &m.name);
            assert_close(mm.model.energy(&y), 1e3 * m.model.energy(&x), 1e-13 * roundings, &m.name);
        }
    }
}

#[test]
fn millimetres_instead_of_metres_change_nothing_in_double_precision() {
    millimetres_instead_of_metres::<f64>();
}

#[test]
fn millimetres_instead_of_metres_change_nothing_in_single_precision() {
    millimetres_instead_of_metres::<f32>();
}

/// Positions are rounded before both precisions see them, so what is left is the arithmetic: a rounding of a coordinate is
/// ε times size / cell ≈ 5 of a strain, here against strains of a tenth and a cubic law: some hundred roundings.
#[test]
fn single_precision_agrees_with_double() {
    for mesh in meshes() {
        let mut random = Random::new(64);
        let x = deformed(&mesh, random.deformation(0.3), Vector::ZERO, 0.003, &mut random);
        let single: Vec<Vec3<f32>> = x.iter().map(|x| x.cast()).collect();
        let x: Vec<Vector> = single.iter().map(|x| x.cast()).collect();
        let dx: Vec<Vec3<f32>> = random.vectors(x.len(), 1.0).iter().map(|dx| dx.cast()).collect();
        let exact_dx: Vec<Vector> = dx.iter().map(|dx| dx.cast()).collect();
        for (play, exact) in models_and_penalty::<f32>(&mesh).into_iter().zip(models_and_penalty::<f64>(&mesh)) {
            let tolerance = 100.0 * f64::from(f32::EPSILON);
            assert_near(&play.model.forces(&single), &exact.model.forces(&x), tolerance, &play.name);
            let product = exact.model.product(&x, &exact_dx);
            assert_near(&play.model.product(&single, &dx), &product, tolerance, &play.name);
            assert_close(play.model.energy(&single), exact.model.energy(&x), tolerance, &play.name);
        }
    }
}

/// A body at rest hardly trembles in single precision: no more than rounding its coordinates explains.
#[test]
fn rest_in_single_precision_trembles_no_more_than_its_coordinates() {
    for mesh in meshes() {
        let x: Vec<Vec3<f32>> = mesh.nodes().iter().map(|x| x.cast()).collect();
        for (play, exact) in models_and_penalty::<f32>(&mesh).into_iter().zip(models_and_penalty::<f64>(&mesh)) {
            let everywhere = Random::new(65).vectors(x.len(), 1.0);
            let stiffness = largest(&exact.model.product(mesh.nodes(), &everywhere));
            let bound = 8.0 * f64::from(f32::EPSILON) * mesh.size() * stiffness.max(KEEP_VOLUME * mesh.size());
            let tremble = largest(&play.model.forces(&x));
            assert!(tremble <= bound, "{}: {tremble:e} above {bound:e}", play.name);
        }
    }
}
