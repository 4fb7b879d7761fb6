//! The check of a mesh on its way in: what it repairs, what it reports, what it refuses.

use viscera::mesh::{HexMesh, MeshError, MeshReport, NamedRegion, Point, TetMesh};

fn points<const N: usize>(coordinates: [[f64; 3]; N]) -> Vec<Point> {
    coordinates.map(|[x, y, z]| Point::new(x, y, z)).to_vec()
}

/// Two tetrahedra that share the face (1, 2, 3).
fn two_tets() -> TetMesh {
    let nodes = points([[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 1.]]);
    TetMesh::new(nodes, vec![[0, 1, 2, 3], [1, 2, 3, 4]])
}

fn one_hex() -> HexMesh {
    let nodes = points([
        [0., 0., 0.],
        [1., 0., 0.],
        [1., 1., 0.],
        [0., 1., 0.],
        [0., 0., 1.],
        [1., 0., 1.],
        [1., 1., 1.],
        [0., 1., 1.],
    ]);
    HexMesh::new(nodes, vec![[0, 1, 2, 3, 4, 5, 6, 7]])
}

fn tet_report(mesh: TetMesh) -> MeshReport {
    mesh.checked().unwrap_or_else(|error| panic!("{error}")).1
}

fn refused(mesh: TetMesh) -> MeshError {
    mesh.checked().expect_err("this mesh is wrong")
}

/// A proper mesh comes back as it was: volume 1/6 + 1/3, one part.
#[test]
fn a_proper_mesh_is_left_alone() {
    let (mesh, report) = two_tets().checked().expect("a proper mesh");
    assert_eq!(mesh, two_tets());
    assert!(report.is_clean());
    assert_eq!(report.to_string(), "5 nodes, 2 cells, 0.500 m³");
    let (mesh, report) = one_hex().checked().expect("a proper mesh");
    assert_eq!(mesh, one_hex());
    assert!(report.is_clean());
    assert!((report.flattest_quality - 1.0).abs() < 1e-14, "a cube is regular: {}", report.flattest_quality);
    assert_eq!(report.to_string(), "8 nodes, 1 cells, 1.000 m³");
}

/// A regular tetrahedron has quality 1, whatever its size.
#[test]
fn quality_does_not_know_the_unit() {
    for size in [1e-6, 1.0, 1e6] {
        let corners = points([[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]]);
        let mesh = TetMesh::new(corners.into_iter().map(|corner| corner * size).collect(), vec![[0, 1, 2, 3]]);
        let report = tet_report(mesh);
        assert!((report.flattest_quality - 1.0).abs() < 1e-14, "{}", report.flattest_quality);
        assert!((report.volume / size.powi(3) / (8.0 / 3.0) - 1.0).abs() < 1e-14);
    }
}

/// A mirrored cell is turned, and the volume is what it was meant to be.
#[test]
fn mirrored_cells_are_turned_and_counted() {
    let mut mesh = two_tets();
    mesh.cells[1] = [1, 3, 2, 4];
    let (mesh, report) = mesh.checked().expect("a repaired mesh");
    assert_eq!(report.mirrored_cells, 1);
    assert!((mesh.volume() - 0.5).abs() < 1e-15);
    assert!(report.to_string().ends_with("\nrepaired: 1 cells were listed mirrored and were turned"));
    let mut mesh = one_hex();
    mesh.cells[0] = [4, 5, 6, 7, 0, 1, 2, 3];
    let (mesh, report) = mesh.checked().expect("a repaired mesh");
    assert_eq!(report.mirrored_cells, 1);
    assert!((report.volume - 1.0).abs() < 1e-14);
    assert!(mesh.checked().expect("a proper mesh").1.is_clean());
}

/// Nodes of no cell go, everything that names later nodes follows, and regions lose what went.
#[test]
fn isolated_nodes_are_removed_and_the_rest_renumbered() {
    let mut mesh = two_tets();
    mesh.nodes.insert(2, Point::new(7.0, 7.0, 7.0));
    mesh.cells = vec![[0, 1, 3, 4], [1, 3, 4, 5]];
    let skin = NamedRegion { nodes: vec![0, 1, 2, 5], cells: vec![], faces: vec![[0, 1, 2], [1, 5, 3]] };
    mesh.regions.insert("skin".into(), skin);
    let (mesh, report) = mesh.checked().expect("a repaired mesh");
    assert_eq!((&mesh.nodes, &mesh.cells), (&two_tets().nodes, &two_tets().cells));
    assert_eq!(mesh.regions["skin"], NamedRegion { nodes: vec![0, 1, 4], cells: vec![], faces: vec![[1, 4, 2]] });
    assert_eq!((report.isolated_nodes, report.region_entries_removed), (1, 2));
    let lines: Vec<String> = report.to_string().lines().skip(1).map(str::to_owned).collect();
    assert_eq!(
        lines,
        [
            "repaired: 1 nodes belong to no cell and were removed; later nodes moved up",
            "repaired: 2 nodes and faces of regions went with them",
        ]
    );
}

/// Two bodies that touch, but whose nodes were not merged: two parts, three nodes on three others.
#[test]
fn unmerged_nodes_and_separate_parts_are_reported() {
    let mut mesh = two_tets();
    mesh.nodes.extend(points([[1., 0., 0.], [0., 1., 0.], [0., 1e-12, 1.]]));
    mesh.cells[1] = [5, 6, 7, 4];
    let report = tet_report(mesh);
    assert_eq!((report.components, report.coincident_nodes), (2, 3));
    assert_eq!(report.first_coincidence, Some(([1, 5], Point::new(1.0, 0.0, 0.0))));
    let text = report.to_string();
    assert!(text.contains("\nwarning: the mesh is in 2 parts that share no node and will move apart"), "{text}");
    assert!(
        text.contains(
            "\nwarning: 3 nodes lie on another node (first: 1 and 5 at (1, 0, 0)); unless a cut is meant, merge them"
        ),
        "{text}"
    );
}

/// Three tetrahedra on one face overlap.
#[test]
fn faces_of_three_cells_are_reported() {
    let mut mesh = two_tets();
    mesh.nodes.push(Point::new(2.0, 2.0, 2.0));
    mesh.cells.push([1, 2, 3, 5]);
    let report = tet_report(mesh);
    assert_eq!(report.overshared_faces, 1);
    assert!(report.to_string().contains("\nwarning: 1 faces are shared by more than two cells; cells overlap there"));
}

/// A sliver can be simulated, badly; the person is told which cell it is.
#[test]
fn slivers_are_reported() {
    let mut mesh = two_tets();
    mesh.nodes[0] = Point::new(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0 - 1e-4);
    let report = tet_report(mesh);
    assert_eq!(report.flattest_cell, 0);
    assert!(report.to_string().contains("\nwarning: cell 0 is nearly flat (quality "), "{report}");
}

/// Flat to within rounding is flat, at any size and far from the origin, where coordinates are rounded more.
#[test]
fn cells_without_volume_are_refused_at_every_scale() {
    for (size, offset) in [(1e-6, 0.0), (1.0, 0.0), (1e6, 0.0), (1.0, 1e6)] {
        let mut mesh = two_tets();
        mesh.nodes[0] = Point::new(0.3, 0.3, 0.4 - 1e-13);
        for node in &mut mesh.nodes {
            *node = *node * size + Point::new(offset, offset, offset);
        }
        assert_eq!(refused(mesh), MeshError::Degenerate { cell: 0, corners: vec![0, 1, 2, 3] });
    }
}

/// All cells that are wrong are named, not the first alone.
#[test]
fn every_wrong_cell_is_named() {
    let mut mesh = two_tets();
    mesh.cells.extend([[3, 2, 1, 0], [0, 1, 1, 2], [4, 1, 3, 2]]);
    let error = refused(mesh);
    let MeshError::Several(errors) = &error else { panic!("{error}") };
    assert_eq!(
        errors[..],
        [
            MeshError::DuplicateCell { cell: 2, first: 0 },
            MeshError::DuplicateCell { cell: 4, first: 1 },
            MeshError::RepeatedNode { cell: 3, node: 1 },
        ]
    );
    assert_eq!(
        error.to_string(),
        "3 things are wrong with the mesh:\
         \n  cell 2 has the same corners as cell 0; remove one of them\
         \n  cell 4 has the same corners as cell 1; remove one of them\
         \n  cell 3 names node 1 twice, so it has no volume; remove the cell or re-export the mesh without merging nodes"
    );
}

/// A thousand wrong cells do not fill a screen.
#[test]
fn many_errors_are_cut_short() {
    let mut mesh = two_tets();
    mesh.cells.extend([[0, 1, 2, 3]; 30]);
    let text = refused(mesh).to_string();
    assert_eq!(text.lines().count(), 12);
    assert!(text.ends_with("\n  … and 20 more"), "{text}");
}

/// Corners in the order of a loop over x, y, z are not the order of Gmsh and VTK; the cell comes out twisted.
#[test]
fn hexahedra_in_lattice_order_are_refused() {
    let mut mesh = one_hex();
    mesh.cells[0] = [0, 1, 3, 2, 4, 5, 7, 6];
    let error = mesh.checked().expect_err("twisted");
    assert!(
        error
            .to_string()
            .starts_with("cell 0 is twisted (its corners [0, 1, 3, 2, 4, 5, 7, 6] give volume of both signs)"),
        "{error}"
    );
}

/// A hexahedron with one corner pushed in past flat still has volume everywhere an element looks.
#[test]
fn hexahedra_with_a_blunt_corner_are_accepted() {
    let mut mesh = one_hex();
    mesh.nodes[6] = Point::new(0.6, 0.6, 0.6);
    let report = mesh.checked().expect("a usable cell").1;
    assert!(report.flattest_quality > 0.0);
}

/// A hexahedron pressed flat has no volume.
#[test]
fn flat_hexahedra_are_refused() {
    let mut mesh = one_hex();
    mesh.nodes.iter_mut().for_each(|node| node.z = 0.0);
    assert!(matches!(mesh.checked(), Err(MeshError::Degenerate { cell: 0, .. })));
}

/// Numbers that nothing stands behind are found before they are used.
#[test]
fn missing_nodes_and_places_are_refused() {
    let mut mesh = two_tets();
    mesh.cells[1][2] = 5;
    assert_eq!(refused(mesh), MeshError::MissingNode { cell: 1, node: 5, nodes: 5 });
    let mut mesh = two_tets();
    mesh.nodes[3].y = f64::NAN;
    assert!(matches!(refused(mesh), MeshError::NotFinite { node: 3, .. }));
    let mut mesh = two_tets();
    mesh.regions.insert("far".into(), NamedRegion { nodes: vec![9], ..NamedRegion::default() });
    assert_eq!(
        refused(mesh).to_string(),
        "region `far` names node 9, which the mesh does not have; number its nodes anew"
    );
    let mut mesh = two_tets();
    mesh.regions.insert("far".into(), NamedRegion { cells: vec![2], ..NamedRegion::default() });
    assert_eq!(
        refused(mesh).to_string(),
        "region `far` names cell 2, which the mesh does not have; number its cells anew"
    );
    assert_eq!(refused(TetMesh::default()), MeshError::Empty);
}
