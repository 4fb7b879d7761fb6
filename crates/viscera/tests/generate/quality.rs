use approx::assert_relative_eq;
use viscera::mesh::{HexMesh, Point, TetMesh, TetQuality};

/// A regular tetrahedron of edge a: V = a³/(6√2), dihedral arccos(1/3), altitude a√(2/3), radius ratio 1.
#[test]
fn a_regular_tetrahedron_has_the_textbook_measures() {
    let corners = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]].map(Point::from);
    let quality = TetQuality::of(corners);
    let edge = 8f64.sqrt();
    assert_relative_eq!(quality.volume, edge.powi(3) / (6.0 * 2f64.sqrt()), max_relative = 1e-14);
    assert_relative_eq!(quality.smallest_dihedral, (1.0f64 / 3.0).acos(), max_relative = 1e-14);
    assert_relative_eq!(quality.largest_dihedral, (1.0f64 / 3.0).acos(), max_relative = 1e-14);
    assert_relative_eq!(quality.smallest_altitude, edge * (2.0f64 / 3.0).sqrt(), max_relative = 1e-14);
    assert_relative_eq!(quality.radius_ratio, 1.0, max_relative = 1e-14);
    assert_relative_eq!(quality.shortest_edge, edge, max_relative = 1e-14);
}

/// The corner of a cube: three right dihedrals and three of arccos(1/√3); inner radius 1/(3+√3), outer √3/2.
#[test]
fn a_cube_corner_has_the_textbook_measures() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point::from);
    let quality = TetQuality::of(corners);
    assert_relative_eq!(quality.smallest_dihedral, (1.0 / 3f64.sqrt()).acos(), max_relative = 1e-14);
    assert_relative_eq!(quality.largest_dihedral.to_degrees(), 90.0, max_relative = 1e-14);
    let ratio = 3.0 / (3.0 + 3f64.sqrt()) / (3f64.sqrt() / 2.0);
    assert_relative_eq!(quality.radius_ratio, ratio, max_relative = 1e-14);
    assert_relative_eq!(quality.smallest_altitude, 1.0 / 3f64.sqrt(), max_relative = 1e-14);
    let [a, b, c, d] = corners;
    assert_relative_eq!(TetQuality::of([a, c, b, d]).radius_ratio, -ratio, max_relative = 1e-14);
    assert_eq!(TetQuality::of([a, b, c, (b + c) * 0.5]).radius_ratio, 0.0, "flat");
}

/// Kuhn's cut has dihedrals of 45°, 60° and 90° only: per cell 2, 1 and 3 of them.
#[test]
fn the_report_counts_angles_and_finds_the_worst_cell() {
    let mut mesh = TetMesh::box_grid([2, 2, 2], [1.0; 3]);
    let report = mesh.quality().unwrap();
    assert_relative_eq!(report.smallest_dihedral.smallest.to_degrees(), 45.0, max_relative = 1e-12);
    assert_relative_eq!(report.largest_dihedral.largest.to_degrees(), 90.0, max_relative = 1e-12);
    assert_eq!(report.dihedral_histogram.iter().sum::<usize>(), 6 * 48);
    assert_eq!(report.dihedral_histogram[4], 2 * 48);
    assert_relative_eq!(report.total_volume, 1.0, max_relative = 1e-12);

    mesh.nodes[26].z = 0.6;
    let report = mesh.quality().unwrap();
    assert!(mesh.cells[report.worst_cell].contains(&26), "the cells of the moved node are the worst");
    let text = report.to_string();
    assert!(text.starts_with("48 tetrahedra, 27 nodes, "), "{text}");
    assert!(text.contains(&format!("worst cell: {} ", report.worst_cell)), "{text}");
    assert!(TetMesh::default().quality().is_none());
}

/// A box has a scaled Jacobian of 1; sheared by s in x per z it is 1/√(1 + s²); turned inside out it is negative.
#[test]
fn the_scaled_jacobian_of_a_sheared_box_is_known() {
    let mut mesh = HexMesh::box_grid([1, 1, 2], [1.0, 2.0, 6.0]);
    assert_relative_eq!(mesh.scaled_jacobian(0), 1.0, max_relative = 1e-14);
    mesh.nodes.iter_mut().for_each(|node| node.x += 0.75 * node.z);
    assert_relative_eq!(mesh.scaled_jacobian(1), 0.8, max_relative = 1e-14);
    mesh.nodes[11].z = -9.0;
    let (spread, worst) = mesh.scaled_jacobians().unwrap();
    assert_eq!(worst, 1);
    assert!(spread.smallest < 0.0);
}
