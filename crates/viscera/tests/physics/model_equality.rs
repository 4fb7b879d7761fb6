//! Different texts of the same mathematics: every model of a law equals the plain total-Lagrangian one.

use viscera::material::{Lame, LawKind, Tissue, TransverseLinear, TransverseStVenantKirchhoff};
use viscera::math::{Mat3, Vec3};
use viscera::mesh::{CubeCut, TetMesh, VolumeMesh};

use crate::support::{
    Evaluate, Matrix, Random, Vector, amplification, assert_close, assert_near, deformed, hex_mesh, models,
    models_of_the_law, plain, tet_mesh, uneven,
};

/// The 3×3×3 rule is another quadrature, not another text of this one.
fn same_mathematics(tissue: &Tissue, mesh: &VolumeMesh, x: &[Vector], dx: &[Vector]) {
    let reference = plain::<f64>(tissue, mesh);
    let (forces, product, energy) = (reference.forces(x), reference.product(x, dx), reference.energy(x));
    for named in models_of_the_law::<f64>(tissue, mesh).into_iter().filter(|named| !named.name.ends_with("points")) {
        assert_near(&named.model.forces(x), &forces, 1e-10, &named.name);
        assert_near(&named.model.product(x, dx), &product, 1e-10, &named.name);
        // terms of the fourth degree nearly cancel where the body turns, and leave the square of a small strain
        let tolerance = 1e-10_f64.max(1e-12 * amplification(&named.name, mesh, x).powf(4.0 / 3.0));
        assert_close(named.model.energy(x), energy, tolerance, &named.name);
    }
}

fn meshes() -> [VolumeMesh; 4] {
    [
        tet_mesh([3, 3, 2]).into(),
        hex_mesh([3, 2, 2]).into(),
        TetMesh::cylinder(0.04, 0.1, 3, 3).unwrap().into(),
        // two superposed cuts: a triangle may have more than two cells
        TetMesh::box_grid_cut([2, 2, 2], [0.1, 0.1, 0.1], CubeCut::Ten).into(),
    ]
}

/// One law everywhere and one for each cell; small and large strains, a half turn, everything mirrored.
#[test]
fn every_model_of_a_law_computes_the_same() {
    let mirror = Mat3::from_columns(Vec3::new(-1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
    for mesh in meshes() {
        let mut random = Random::new(71);
        for &kind in LawKind::ALL {
            let tissue = uneven(kind, mesh.cell_count(), &mut random);
            for (f, noise) in [
                (random.deformation(0.05), 1e-3),
                (random.deformation(0.5), 0.01),
                (random.rotation(), 2e-3),
                (mirror, 5e-3),
                (Matrix::IDENTITY, 0.05),
            ] {
                let x = deformed(&mesh, f, random.vector() * 0.1, noise, &mut random);
                let dx = random.vectors(x.len(), 1.0);
                same_mathematics(&tissue, &mesh, &x, &dx);
            }
        }
    }
}

/// Fibres that run another way in every cell, some softer than the matrix.
#[test]
fn fibres_may_run_another_way_in_every_cell() {
    let mesh = VolumeMesh::from(tet_mesh([3, 2, 2]));
    let mut random = Random::new(72);
    let across = Lame::from_young_poisson(6e3, 0.45).unwrap();
    let mut fibre = || {
        let along = Lame::from_young_poisson(6e3 * (1.3 + 0.5 * random.signed()), 0.45).unwrap();
        (random.vector().to_array(), along)
    };
    let fibres: Vec<_> = (0..mesh.cell_count()).map(|_| fibre()).collect();
    let large = fibres.iter().map(|&(a0, along)| TransverseStVenantKirchhoff::new(across, a0, along));
    let small = fibres.iter().map(|&(a0, along)| TransverseLinear::new(across, a0, along));
    let x = deformed(&mesh, random.deformation(0.3), Vector::ZERO, 0.005, &mut random);
    let dx = random.vectors(x.len(), 1.0);
    let tissue = Tissue::per_cell(&large.collect::<Result<Vec<_>, _>>().unwrap()).unwrap();
    same_mathematics(&tissue, &mesh, &x, &dx);
    let tissue = Tissue::per_cell(&small.collect::<Result<Vec<_>, _>>().unwrap()).unwrap();
    same_mathematics(&tissue, &mesh, &x, &dx);
}

/// A tissue whose cells happen to have the same law is the uniform tissue, bit for bit.
#[test]
fn the_same_law_in_every_cell_is_the_uniform_tissue() {
    let mesh = VolumeMesh::from(tet_mesh([2, 2, 2]));
    let mut random = Random::new(73);
    let x = deformed(&mesh, random.deformation(0.3), Vector::ZERO, 0.005, &mut random);
    let law = viscera::material::StVenantKirchhoff::from_young_poisson(4e3, 0.4).unwrap();
    let (uniform, each) = (Tissue::uniform(law), Tissue::per_cell(&vec![law; mesh.cell_count()]).unwrap());
    for (one, many) in models::<f64>(&uniform, &mesh).into_iter().zip(models::<f64>(&each, &mesh)) {
        assert_eq!(one.model.forces(&x), many.model.forces(&x), "{}", one.name);
    }
}
