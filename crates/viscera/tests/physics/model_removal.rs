//! A removed cell leaves nothing behind: after thousands of removals a body equals one that was built without those cells.

use viscera::material::LawKind;
use viscera::mesh::{HexMesh, Mesh, TetMesh, VolumeMesh};

use crate::support::{
    Evaluate, KEEP_VOLUME, Named, Random, Vector, deformed, hex_mesh, largest, models, near, tet_mesh, uneven,
};

/// A mesh of the cells that are left; nodes keep their numbers.
fn remaining<const C: usize, const F: usize>(mesh: &Mesh<C, F>, left: &[bool]) -> Mesh<C, F> {
    let cells = mesh.cells.iter().zip(left).filter(|&(_, &left)| left).map(|(&cell, _)| cell).collect();
    Mesh::new(mesh.nodes.clone(), cells)
}

/// Which cells are left, and whether all nodes of the removed ones are without cells now.
struct Cut {
    left: Vec<bool>,
    random: Random,
}

impl Cut {
    /// A batch of up to 60 cells: some removed before, one named twice.
    fn batch(&mut self) -> Vec<u32> {
        let mut batch: Vec<u32> =
            (0..1 + self.random.below(60)).map(|_| self.random.below(self.left.len()) as u32).collect();
        batch.push(batch[0]);
        batch.iter().for_each(|&cell| self.left[cell as usize] = false);
        batch
    }

    fn count(&self) -> usize {
        self.left.iter().filter(|&&left| left).count()
    }
}

fn cut_down(mesh: &VolumeMesh, checkpoints: &[usize], build: impl Fn(&VolumeMesh, &[bool]) -> Vec<Named<f64>>) {
    let cells = mesh.cell_count();
    let mut cut = Cut { left: vec![true; cells], random: Random::new(91) };
    let mut models = build(mesh, &cut.left);
    let mut random = Random::new(92);
    let x = deformed(mesh, random.deformation(0.3), Vector::ZERO, 0.003, &mut random);
    let dx = random.vectors(x.len(), 1.0);
    for &checkpoint in checkpoints {
        while cut.count() > checkpoint {
            let batch = cut.batch();
            models.iter_mut().for_each(|named| named.model.remove(&batch));
        }
        let rest: VolumeMesh = match mesh {
            VolumeMesh::Tet(mesh) => remaining(mesh, &cut.left).into(),
            VolumeMesh::Hex(mesh) => remaining(mesh, &cut.left).into(),
        };
        let mut used = vec![false; x.len()];
        (0..rest.cell_count()).flat_map(|cell| rest.cell(cell)).for_each(|&node| used[node as usize] = true);
        for (named, fresh) in models.iter().zip(build(&rest, &cut.left)) {
            let what = format!("{} with {} of {cells} cells left", named.name, cut.count());
            for (actual, expected) in [
                (named.model.forces(&x), fresh.model.forces(&x)),
                (named.model.product(&x, &dx), fresh.model.product(&x, &dx)),
            ] {
                assert!(near(&actual, &expected, 1e-12, largest(&expected)), "{what}");
                let nothing = (0..x.len()).filter(|&node| !used[node]).all(|node| actual[node] == Vector::ZERO);
                assert!(nothing, "{what}: a node without cells feels a force");
            }
            let (energy, expected) = (named.model.energy(&x), fresh.model.energy(&x));
            assert!((energy - expected).abs() <= 1e-12 * expected.abs(), "{what}: energy {energy}, not {expected}");
        }
    }

    // the rest of it, and everything once more
    let all: Vec<u32> = (0..cells as u32).collect();
    for named in &mut models {
        named.model.remove(&all);
        named.model.remove(&all);
        assert!(named.model.forces(&x).iter().all(|&force| force == Vector::ZERO), "{}", named.name);
        assert!(named.model.product(&x, &dx).iter().all(|&force| force == Vector::ZERO), "{}", named.name);
        assert_eq!(named.model.energy(&x), 0.0, "{}", named.name);
    }
}

/// Models of every law on the cells that are left, with moduli that vary from cell to cell of the whole mesh.
fn of_every_law(mesh: &VolumeMesh, left: &[bool]) -> Vec<Named<f64>> {
    let mut all = Vec::new();
    for &kind in LawKind::ALL {
        let whole = uneven(kind, left.len(), &mut Random::new(93));
        let kept = (0..left.len()).filter(|&cell| left[cell]).map(|cell| whole.values(cell));
        all.extend(models(&crate::support::of_values(kind, kept), mesh));
    }
    if let VolumeMesh::Tet(mesh) = mesh {
        all.push(Named::penalty(mesh, KEEP_VOLUME));
    }
    all
}

#[test]
fn tetrahedra_removed_by_the_thousand_leave_nothing_behind() {
    let mesh: TetMesh = tet_mesh([8, 8, 8]);
    cut_down(&mesh.into(), &[2000, 700, 100, 5], of_every_law);
}

#[test]
fn hexahedra_removed_by_the_hundred_leave_nothing_behind() {
    let mesh: HexMesh = hex_mesh([7, 7, 7]);
    cut_down(&mesh.into(), &[200, 50, 4], of_every_law);
}

/// A copy is a snapshot: cutting one does not cut the other.
#[test]
fn a_copy_keeps_the_cells_that_the_original_loses() {
    let mesh = VolumeMesh::from(tet_mesh([2, 2, 2]));
    let mut random = Random::new(94);
    let x = deformed(&mesh, random.deformation(0.3), Vector::ZERO, 0.005, &mut random);
    for mut named in of_every_law(&mesh, &vec![true; mesh.cell_count()]) {
        let (copy, before) = (named.model.clone_box(), named.model.forces(&x));
        named.model.remove(&[0, 5, 17]);
        assert_eq!(copy.forces(&x), before, "{}", named.name);
        assert!(named.model.forces(&x) != before, "{}", named.name);
    }
}
