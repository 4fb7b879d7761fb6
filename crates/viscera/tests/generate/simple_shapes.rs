use std::f64::consts::PI;

use approx::assert_relative_eq;
use viscera::mesh::{CubeCut, GenerateError, HexMesh, TetMesh, TetTopology, TubeDivisions};

use crate::proof::{area_vector, assert_conforming, order};

/// The first cells of a 4×4×16 box as an independent generator wrote them (Kuhn's cut, x fastest).
#[test]
fn a_box_of_six_lists_nodes_and_cells_in_the_documented_order() {
    let mesh = TetMesh::box_grid([4, 4, 16], [0.1, 0.1, 0.4]);
    assert_eq!((mesh.nodes.len(), mesh.cells.len()), (425, 1536));
    assert_eq!(mesh.cells[..3], [[0, 1, 6, 31], [0, 1, 31, 26], [0, 5, 31, 6]]);
    assert_eq!(mesh.nodes[424].to_array(), [0.1, 0.1, 0.4]);
    assert_relative_eq!(mesh.volume(), 0.004, max_relative = 1e-13);
    let hexahedra = HexMesh::box_grid([4, 4, 16], [0.1, 0.1, 0.4]);
    assert_eq!((hexahedra.nodes.len(), hexahedra.cells.len()), (425, 256));
    assert_eq!(hexahedra.cells[0], [0, 1, 6, 5, 25, 26, 31, 30]);
}

/// Five and six a cube fill the box once, without gap or overlap, also where the counts of cells are odd.
#[test]
fn five_and_six_tetrahedra_a_cube_match_across_faces() {
    for (cut, per_cube) in [(CubeCut::Five, 5), (CubeCut::Six, 6)] {
        let mesh = TetMesh::box_grid_cut([3, 2, 5], [0.3, 0.1, 0.7], cut);
        assert_eq!(mesh.cells.len(), 30 * per_cube);
        assert_eq!(assert_conforming(&mesh), 2, "{cut:?}: the surface of a box is a sphere");
        assert_relative_eq!(mesh.volume(), 0.3 * 0.1 * 0.7, max_relative = 1e-13);
    }
}

/// Ten a cube fill the box twice, every inner face still belongs to two cells, and a cube has no preferred direction:
/// the second moments of its cells are those of a body with cubic symmetry (all off-diagonal ones vanish).
#[test]
fn ten_tetrahedra_a_cube_fill_the_box_twice_and_prefer_no_direction() {
    let mesh = TetMesh::box_grid_cut([3, 2, 2], [0.3, 0.2, 0.2], CubeCut::Ten);
    assert_relative_eq!(mesh.volume(), 2.0 * 0.3 * 0.2 * 0.2, max_relative = 1e-13);
    let topology = TetTopology::new(&mesh);
    assert!(topology.overshared_faces.is_empty());
    let squares = 2 * (3 * 2 + 3 * 2 + 2 * 2);
    assert_eq!(topology.surface().count(), 4 * squares, "both cuts of a square side have two triangles");

    let moment = |cut, i: usize, j: usize| -> f64 {
        let cube = TetMesh::box_grid_cut([1, 1, 1], [1.0; 3], cut);
        (0..cube.cells.len())
            .flat_map(|cell| cube.corners(cell).map(|p| cube.cell_volume(cell) * (p[i] - 0.5) * (p[j] - 0.5)))
            .sum()
    };
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        assert!(moment(CubeCut::Ten, i, j).abs() < 1e-15);
        assert!(moment(CubeCut::Six, i, j) > 0.05, "Kuhn's cut leans to one diagonal");
    }
}

/// Each side of a box carries its whole area, facing outwards, and the nodes of that plane and no others.
#[test]
fn the_sides_of_a_box_are_named() {
    let size = [0.3, 0.1, 0.7];
    let mesh = TetMesh::box_grid([3, 2, 4], size);
    assert_eq!(mesh.regions.keys().collect::<Vec<_>>(), ["x-max", "x-min", "y-max", "y-min", "z-max", "z-min"]);
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        for (end, sign, place) in [("min", -1.0, 0.0), ("max", 1.0, size[axis])] {
            let side = &mesh.regions[&format!("{letter}-{end}")];
            let area = size[(axis + 1) % 3] * size[(axis + 2) % 3];
            assert_relative_eq!(area_vector(&mesh.nodes, &side.faces)[axis], sign * area, max_relative = 1e-13);
            let on_plane = (0..mesh.nodes.len() as u32).filter(|&node| mesh.nodes[node as usize][axis] == place);
            assert_eq!(side.nodes, on_plane.collect::<Vec<_>>());
        }
    }
    let hexahedra = HexMesh::box_grid([3, 2, 4], size);
    assert_eq!(hexahedra.regions["x-min"].faces.len(), 8);
    assert_eq!(hexahedra.regions["z-max"].nodes, mesh.regions["z-max"].nodes);
}

/// Inscribed polygons fall short of the circle by O(edge²): π r² h is met with second order.
#[test]
fn the_volume_of_a_cylinder_converges_with_second_order() {
    let exact = PI * 0.01f64.powi(2) * 0.1;
    let error = |rings| {
        let mesh = TetMesh::cylinder(0.01, 0.1, rings, 4 * rings).unwrap();
        assert_eq!(assert_conforming(&mesh), 2);
        assert_eq!(mesh.cells.len(), 18 * rings * rings * 4 * rings);
        exact - mesh.volume()
    };
    let (coarse, fine) = (error(3), error(6));
    assert!((order(coarse, fine, 2.0) - 2.0).abs() < 0.01, "{coarse} {fine}");
}

/// Force tests pull at the centre of the top, so a node must lie there exactly.
#[test]
fn a_cylinder_has_a_node_at_the_centre_of_its_top() {
    for (rings, layers) in [(1, 1), (3, 7), (4, 10)] {
        let mesh = TetMesh::cylinder(0.02, 0.05, rings, layers).unwrap();
        let centre = layers * (1 + 3 * rings * (rings + 1));
        assert_eq!(mesh.nodes[centre].to_array(), [0.0, 0.0, 0.05]);
        assert!(mesh.regions["top"].nodes.contains(&(centre as u32)));
    }
}

/// The named sides of cylinder and tube make up the whole surface, and the flat ones have the area of the cross-section.
#[test]
fn the_sides_of_cylinder_and_tube_cover_the_surface() {
    let divisions = TubeDivisions { around: 24, wall: 2, along: 9 };
    let tube = TetMesh::tube(0.007, 0.011, 0.1, divisions).unwrap();
    let cylinder = TetMesh::cylinder(0.011, 0.1, 4, 9).unwrap();
    for (mesh, sides) in [(&tube, vec!["bottom", "inner", "outer", "top"]), (&cylinder, vec!["bottom", "side", "top"])]
    {
        assert_eq!(mesh.regions.keys().collect::<Vec<_>>(), sides);
        let named: usize = mesh.regions.values().map(|side| side.faces.len()).sum();
        assert_eq!(named, mesh.surface().triangles.len());
        let section = mesh.volume() / 0.1;
        assert_relative_eq!(area_vector(&mesh.nodes, &mesh.regions["top"].faces).z, section, max_relative = 1e-12);
        assert_relative_eq!(area_vector(&mesh.nodes, &mesh.regions["bottom"].faces).z, -section, max_relative = 1e-12);
    }
}

/// A tube's surface is a torus; its volume is that of regular polygons, ½ n sin(2π/n) (R² − r²) h, exactly.
#[test]
fn a_tube_is_a_ring_between_two_polygons() {
    for around in [3, 5, 24] {
        let mesh = TetMesh::tube(0.007, 0.011, 0.1, TubeDivisions { around, wall: 2, along: 5 }).unwrap();
        assert_eq!(assert_conforming(&mesh), 0);
        let section = around as f64 / 2.0 * (2.0 * PI / around as f64).sin() * (0.011f64.powi(2) - 0.007f64.powi(2));
        assert_relative_eq!(mesh.volume(), section * 0.1, max_relative = 1e-12);
    }
}

#[test]
fn impossible_measures_are_refused_in_words() {
    let says = |result: Result<TetMesh, GenerateError>| result.unwrap_err().to_string();
    assert_eq!(says(TetMesh::cylinder(-0.01, 0.1, 3, 3)), "radius is -0.01 m; give a positive length");
    assert_eq!(says(TetMesh::cylinder(0.01, f64::NAN, 3, 3)), "height is NaN m; give a positive length");
    assert_eq!(says(TetMesh::cylinder(0.01, 0.1, 0, 3)), "rings is 0; it must be 1 or more");
    let divisions = TubeDivisions { around: 2, wall: 1, along: 1 };
    assert_eq!(says(TetMesh::tube(0.01, 0.02, 0.1, divisions)), "around is 2; it must be 3 or more");
    assert_eq!(
        says(TetMesh::tube(0.02, 0.02, 0.1, divisions)),
        "the inner radius 0.02 m is not smaller than the outer radius 0.02 m; a tube needs a wall between them"
    );
    assert!(TetMesh::box_grid([0, 1, 1], [1.0; 3]).check_indices().is_err(), "an empty box is an empty mesh");
}
