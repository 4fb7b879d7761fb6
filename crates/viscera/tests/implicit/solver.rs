//! The modified conjugate gradient on small matrices.

use viscera::executor::Executor;
use viscera::math::Mat3;
use viscera::mesh::{TetMesh, VolumeMesh};
use viscera::model::BlockSink;
use viscera::solver::{
    BlockJacobi, BlockMatrix, ConjugateGradient, Ending, Filter, FilteredNodes, LinearOperator, Problem, SolveReport,
    Stop,
};

use super::support::Vector;

/// A chain along the mesh's pattern: 4 I on the diagonal, −c I next to it; with c small enough it is positive definite.
fn matrix(coupling: f64) -> (BlockMatrix<f64>, usize) {
    let mesh = VolumeMesh::from(TetMesh::box_grid([2, 1, 1], [2.0, 1.0, 1.0]));
    let nodes = mesh.nodes().len();
    let mut matrix = BlockMatrix::new(&mesh, 1);
    for node in 0..nodes as u32 {
        let own = Mat3::diagonal(4.0) + Vector::new(1.0, 0.5, -0.2).outer(Vector::new(1.0, 0.5, -0.2));
        matrix.add(node, node, own);
    }
    for cell in 0..mesh.cell_count() {
        for &a in mesh.cell(cell) {
            for &b in mesh.cell(cell).iter().filter(|&&b| b != a) {
                matrix.add(a, b, Mat3::diagonal(-coupling));
            }
        }
    }
    (matrix, nodes)
}

struct Case {
    rhs: Vec<Vector>,
    filters: Vec<Filter<f64>>,
    prescribed: Vec<Vector>,
}

fn case(nodes: usize) -> Case {
    let wave = |node: usize, phase: f64| ((node * node) as f64 + phase).sin();
    let vector = |node: usize| Vector::new(wave(node, 0.1), wave(node, 0.7), wave(node, 2.3));
    let p = Vector::new(0.6, 0.0, 0.8);
    let q = Vector::new(0.0, 1.0, 0.0);
    let filters = [Filter::Free, Filter::Plane(p), Filter::Line(p, q), Filter::Held];
    Case {
        rhs: (0..nodes).map(vector).collect(),
        filters: (0..nodes).map(|node| filters[node % 4]).collect(),
        prescribed: (0..nodes).map(|node| vector(node + 50)).collect(),
    }
}

fn solve(matrix: &mut BlockMatrix<f64>, case: &Case, stop: Stop) -> (Vec<Vector>, SolveReport, Vec<f64>) {
    let nodes = case.rhs.len();
    let mut preconditioner = BlockJacobi::new(nodes);
    for node in 0..nodes {
        preconditioner.add(node as u32, node as u32, matrix.block(node, node));
    }
    let filtered_nodes = FilteredNodes::of(&case.filters);
    let filtered = filtered_nodes.with(&case.filters);
    preconditioner.invert(&vec![0.0; nodes], filtered, &Executor::serial());
    let masses = vec![1.0; nodes];
    let Case { rhs, prescribed, .. } = case;
    let problem = Problem { rhs, filtered, prescribed, masses: &masses, executor: &Executor::serial() };
    let mut solver = ConjugateGradient::new(nodes, stop.at_most());
    let mut x = vec![Vector::new(0.3, -0.2, 0.1); nodes];
    let report = solver.solve(matrix, &mut preconditioner, &problem, stop, &mut x);
    (x, report, solver.history().to_vec())
}

/// S (b − A x) = 0 and (I − S) x = (I − S) z, for all four kinds of filters.
#[test]
fn filtered_equations_hold_and_prescribed_parts_stay() {
    let (mut matrix, nodes) = matrix(0.1);
    let case = case(nodes);
    let (x, report, history) = solve(&mut matrix, &case, Stop::Tolerance { relative: 1e-13, at_most: 200 });
    assert_eq!(report.ending, Ending::Converged);
    assert_eq!(history.len(), report.iterations as usize + 1);
    assert_eq!(history.last(), Some(&report.residual));
    let mut product = vec![Vector::ZERO; nodes];
    matrix.apply(&x, &mut product);
    for node in 0..nodes {
        let filter = case.filters[node];
        let left = filter.apply(case.rhs[node] - product[node]);
        assert!(left.norm() < 1e-11, "node {node}: {left:?}");
        let strayed = (x[node] - case.prescribed[node]) - filter.apply(x[node] - case.prescribed[node]);
        assert!(strayed.norm() < 1e-14, "node {node}: {strayed:?}");
    }
}

/// No more iterations than unknowns, and exactly as many as were asked for.
#[test]
fn iterations_are_as_many_as_allowed() {
    let (mut matrix, nodes) = matrix(0.1);
    let case = case(nodes);
    let (_, report, _) = solve(&mut matrix, &case, Stop::Tolerance { relative: 1e-10, at_most: 200 });
    assert!(report.iterations as usize <= 3 * nodes, "{report:?}");
    let (_, report, history) = solve(&mut matrix, &case, Stop::Iterations(4));
    assert_eq!((report.iterations, report.ending), (4, Ending::Exhausted));
    assert!(history.windows(2).all(|pair| pair[1] < pair[0]), "{history:?}");
}

/// A matrix that is not positive definite ends the solve, at a finite place with the prescribed parts in it.
#[test]
fn negative_curvature_ends_the_solve() {
    let (mut matrix, nodes) = matrix(3.0);
    let case = case(nodes);
    let (x, report, _) = solve(&mut matrix, &case, Stop::Tolerance { relative: 1e-10, at_most: 200 });
    assert_eq!(report.ending, Ending::NegativeCurvature);
    assert!(x.iter().all(|x| x.norm() < 1e3), "{x:?}");
    for node in (0..nodes).filter(|node| case.filters[*node] == Filter::Held) {
        assert_eq!(x[node], case.prescribed[node]);
    }
}

/// The blocks of two nodes that share a cell, and no others, are in the pattern.
#[test]
fn the_pattern_is_that_of_the_cells() {
    let mesh = TetMesh::box_grid([1, 1, 2], [1.0, 1.0, 2.0]);
    let matrix = BlockMatrix::<f64>::new(&VolumeMesh::from(mesh.clone()), 1);
    for row in 0..mesh.nodes.len() as u32 {
        let columns: Vec<u32> = matrix.row(row as usize).map(|(column, _)| column).collect();
        let expected: Vec<u32> = (0..mesh.nodes.len() as u32)
            .filter(|&other| mesh.cells.iter().any(|cell| cell.contains(&row) && cell.contains(&other)))
            .collect();
        assert_eq!(columns, expected);
    }
}
