//! Edges, faces, neighbours and surfaces of meshes.

use viscera::mesh::{HexMesh, MeshError, Point, TET_FACES, TetMesh, TetTopology, cells_of_nodes};

use crate::support::{assert_close, hex_mesh, tet_mesh};

/// V − E + F − C = 1 for a ball and 0 for a ring.
#[test]
fn euler_counts_hold_for_a_ball_and_a_ring() {
    let euler = |mesh: &TetMesh| {
        let topology = TetTopology::new(mesh);
        mesh.nodes.len() as i64 - topology.edges.len() as i64 + topology.faces.len() as i64 - mesh.cells.len() as i64
    };
    assert_eq!(euler(&tet_mesh([3, 4, 2])), 1);
    assert_eq!(euler(&TetMesh::cylinder(1.0, 2.0, 3, 4).unwrap()), 1);
    let divisions = viscera::mesh::TubeDivisions { around: 8, wall: 2, along: 3 };
    assert_eq!(euler(&TetMesh::tube(0.5, 1.0, 2.0, divisions).unwrap()), 0);
}

#[test]
fn faces_lie_between_the_cells_that_they_name() {
    let mesh = tet_mesh([3, 3, 3]);
    let topology = TetTopology::new(&mesh);
    assert!(topology.overshared_faces.is_empty());
    assert!(topology.edges.iter().all(|[from, to]| from < to));
    for cell in 0..mesh.cells.len() {
        for (side, across) in topology.neighbours(cell).into_iter().enumerate() {
            let face = topology.faces[topology.cell_faces[cell][side] as usize];
            let mut nodes = TET_FACES[side].map(|corner| mesh.cells[cell][corner]);
            let mut listed = face.nodes;
            nodes.sort_unstable();
            listed.sort_unstable();
            assert_eq!(nodes, listed);
            assert!(!nodes.contains(&mesh.cells[cell][side]), "face {side} is opposite to its corner");
            let Some(across) = across else {
                assert_eq!(face.cells, (cell as u32, None));
                continue;
            };
            assert!(topology.neighbours(across as usize).contains(&Some(cell as u32)), "neighbours know each other");
            assert!(listed.iter().all(|node| mesh.cells[across as usize].contains(node)));
        }
    }
}

/// By the divergence theorem an outward surface encloses the volume, with a positive sign.
#[test]
fn surfaces_point_outwards_and_enclose_the_volume() {
    let tets = tet_mesh([3, 2, 4]);
    assert_close(tets.surface().enclosed_volume(), tets.volume(), 1e-13, "tetrahedra");
    let cylinder = TetMesh::cylinder(0.03, 0.1, 3, 4).unwrap();
    assert_close(cylinder.surface().enclosed_volume(), cylinder.volume(), 1e-13, "cylinder");

    let hexes = HexMesh::box_grid([3, 2, 4], [0.3, 0.2, 0.4]);
    assert_close(hexes.surface().enclosed_volume(), 0.3 * 0.2 * 0.4, 1e-13, "hexahedra");
    assert_eq!(hexes.surface_quads().len(), 2 * (3 * 2 + 3 * 4 + 2 * 4));
    assert_eq!(hex_mesh([3, 2, 4]).surface_quads(), hexes.surface_quads());
}

/// Three tetrahedra on one triangle: the third is told, not lost.
#[test]
fn a_face_of_three_cells_is_reported() {
    let points =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 1.0, 1.0]];
    let mesh = TetMesh::new(points.map(Point::from).to_vec(), vec![[0, 1, 2, 3], [0, 2, 1, 4], [0, 1, 2, 5]]);
    let topology = TetTopology::new(&mesh);
    let shared = topology.cell_faces[0][3];
    assert_eq!(topology.faces[shared as usize].cells, (0, Some(1)));
    assert_eq!(topology.overshared_faces, vec![(shared, 2)]);
}

#[test]
fn every_node_knows_its_cells() {
    let mesh = tet_mesh([2, 2, 2]);
    let (starts, cells) = cells_of_nodes(&mesh);
    for node in 0..mesh.nodes.len() {
        let meeting = &cells[starts[node] as usize..starts[node + 1] as usize];
        let expected: Vec<u32> =
            (0..mesh.cells.len() as u32).filter(|&cell| mesh.cells[cell as usize].contains(&(node as u32))).collect();
        assert_eq!(meeting, expected);
    }
}

#[test]
fn damaged_meshes_name_the_first_offender() {
    let mut mesh = tet_mesh([1, 1, 1]);
    assert_eq!(mesh.check_indices(), Ok(()));
    mesh.cells[3][2] = 8;
    assert_eq!(mesh.check_indices(), Err(MeshError::MissingNode { cell: 3, node: 8, nodes: 8 }));
    mesh.nodes[5].y = f64::INFINITY;
    assert!(matches!(mesh.check_indices(), Err(MeshError::NotFinite { node: 5, .. })));
    assert_eq!(TetMesh::default().check_indices(), Err(MeshError::Empty));
}

#[test]
fn size_is_the_diagonal_and_a_mirrored_cell_has_negative_volume() {
    let mesh = TetMesh::box_grid([1, 1, 1], [0.3, 0.4, 1.2]);
    assert_close(mesh.size(), 1.3, 1e-15, "3, 4, 12 → 13");
    assert_close(mesh.volume(), 0.3 * 0.4 * 1.2, 1e-14, "volume");
    let mut mirrored = mesh.clone();
    mirrored.cells[0].swap(2, 3);
    assert_close(mirrored.cell_volume(0), -mesh.cell_volume(0), 1e-15, "mirrored");
    assert_eq!(TetMesh::default().size(), 0.0);
}
