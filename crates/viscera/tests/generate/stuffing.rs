use std::f64::consts::PI;

use approx::assert_relative_eq;
use viscera::mesh::{GenerateError, Liver, Point, SignedDistance, TetMesh};

use crate::proof::{assert_conforming, order};
use crate::solids::{Sphere, Torus};

/// Labelle & Shewchuk 2007: all dihedral angles of a stuffed solid lie between 10.7° and 164.8°.
fn assert_angles(mesh: &TetMesh) {
    let quality = mesh.quality().unwrap();
    assert_eq!(quality.inverted, 0);
    assert!(quality.smallest_dihedral.smallest.to_degrees() > 10.7, "{quality}");
    assert!(quality.largest_dihedral.largest.to_degrees() < 164.8, "{quality}");
}

/// Flat facets between nodes on a curved skin leave out a volume of O(edge²).
#[test]
fn the_volume_of_a_sphere_converges_with_second_order() {
    let sphere = Sphere { radius: 0.05 };
    let exact = 4.0 / 3.0 * PI * 0.05f64.powi(3);
    let error = |edge| {
        let mesh = TetMesh::from_signed_distance(&sphere, edge).unwrap();
        assert_eq!(assert_conforming(&mesh), 2);
        assert_angles(&mesh);
        (exact - mesh.volume()) / exact
    };
    let (coarse, fine) = (error(0.0125), error(0.00625));
    assert!(coarse < 0.04, "{coarse}");
    // The lattice meets the skin at other places on every level: the order varies by a few tenths.
    assert!((order(coarse, fine, 2.0) - 2.0).abs() < 0.3, "{coarse} {fine}");
}

/// The skin of a stuffed torus has the torus' topology, and its volume is 2π² R r² up to O(edge²).
#[test]
fn a_torus_keeps_its_hole() {
    let torus = Torus { ring: 0.06, tube: 0.025 };
    let error = |edge| {
        let mesh = TetMesh::from_signed_distance(&torus, edge).unwrap();
        assert_eq!(assert_conforming(&mesh), 0);
        assert_angles(&mesh);
        (torus.volume() - mesh.volume()) / torus.volume()
    };
    let (coarse, fine) = (error(0.01), error(0.005));
    assert!((order(coarse, fine, 2.0) - 2.0).abs() < 0.3, "{coarse} {fine}");
}

/// Nodes of the skin lie on the skin, not on a linear guess of it.
#[test]
fn the_nodes_of_the_skin_lie_on_it() {
    let sphere = Sphere { radius: 0.05 };
    let mesh = TetMesh::from_signed_distance(&sphere, 0.01).unwrap();
    for &node in mesh.surface().triangles.iter().flatten() {
        // The root is sought to a billionth of an edge.
        assert!(sphere.distance(mesh.nodes[node as usize]).abs() < 2e-9 * 0.01);
    }
}

/// The organ: one closed skin without handles, good angles at every fineness, and cells from a few thousand up.
#[test]
fn a_liver_is_one_smooth_closed_body() {
    for edge in [0.018, 0.014, 0.01] {
        let mesh = TetMesh::liver(0.3, edge).unwrap();
        assert_eq!(assert_conforming(&mesh), 2, "edge {edge}");
        assert_angles(&mesh);
    }
    let mesh = TetMesh::liver(0.3, 0.01).unwrap();
    let (low, high) = mesh.bounds();
    assert_relative_eq!(high.x - low.x, 0.3, max_relative = 0.03);
    // The finest level measured (149 130 cells) holds 1.98 litres; a large grown-up's liver about that.
    assert_relative_eq!(mesh.volume(), 1.98e-3, max_relative = 0.02);
}

/// The lobes share out the cells; "back" faces backwards, the grasped edge is the tip of the thin lobe.
#[test]
fn the_parts_of_a_liver_are_named() {
    let mesh = TetMesh::liver(0.3, 0.012).unwrap();
    let names: Vec<_> = mesh.regions.keys().map(String::as_str).collect();
    assert_eq!(names, ["back", "left-lobe", "left-lobe-edge", "right-lobe", "underside"]);
    let volume =
        |name: &str| -> f64 { mesh.regions[name].cells.iter().map(|&cell| mesh.cell_volume(cell as usize)).sum() };
    assert_relative_eq!(volume("right-lobe") + volume("left-lobe"), mesh.volume(), max_relative = 1e-12);
    assert!(volume("right-lobe") > 2.0 * volume("left-lobe"), "the right lobe is the large one");
    let area = |name: &str| crate::proof::area_vector(&mesh.nodes, &mesh.regions[name].faces);
    assert!(area("back").z < -1e-3 && area("underside").y < -1e-2);
    assert!(mesh.regions["left-lobe-edge"].nodes.iter().all(|&node| mesh.nodes[node as usize].x > 0.1));
    assert!(mesh.regions["left-lobe-edge"].faces.len() > 20);
}

/// At these edges the two sides of the fissure used to be warped onto the same nodes, so that the skin touched itself
/// along an edge (the first two) or in a node (the third).
#[test]
fn the_skin_never_touches_itself() {
    for edge in [0.008 * 1.05f64.powi(7), 0.008 * 1.05f64.powi(15), 0.008 * 1.05f64.powi(20)] {
        let mesh = TetMesh::liver(0.3, edge).unwrap();
        let skin = mesh.surface().check().unwrap();
        assert!(skin.require_closed().is_ok(), "{skin}");
        assert_eq!((skin.components, skin.non_manifold_nodes.len()), (1, 0), "{skin}");
        assert_eq!(assert_conforming(&mesh), 2);
        assert_angles(&mesh);
    }
}

/// Same solid, same edge, same bits; and twice the solid with twice the edge is twice the mesh.
#[test]
fn a_mesh_depends_on_the_solid_and_on_its_scale_only() {
    let mesh = TetMesh::liver(0.3, 0.015).unwrap();
    assert_eq!(mesh, TetMesh::liver(0.3, 0.015).unwrap());
    let twice = TetMesh::liver(0.6, 0.03).unwrap();
    assert_eq!(mesh.cells, twice.cells);
    assert!(mesh.nodes.iter().zip(&twice.nodes).all(|(&a, &b)| (a * 2.0 - b).norm() < 1e-12));
}

/// The edge for a wanted number of cells makes that number within 2 %.
#[test]
fn the_number_of_cells_can_be_asked_for() {
    let liver = Liver::new(0.3).unwrap();
    for wanted in [2_000, 6_000] {
        let edge = TetMesh::edge_for_cells(&liver, wanted).unwrap();
        let made = TetMesh::from_signed_distance(&liver, edge).unwrap().cells.len();
        assert!(made.abs_diff(wanted) < wanted / 50, "{made} for {wanted}");
    }
}

#[test]
fn edges_that_make_no_mesh_are_refused_in_words() {
    let sphere = Sphere { radius: 0.05 };
    let says = |edge| TetMesh::from_signed_distance(&sphere, edge).unwrap_err().to_string();
    assert_eq!(says(0.0), "edge is 0 m; give a positive length");
    assert!(says(1e-6).contains("choose an edge of"), "{}", says(1e-6));
    let Err(GenerateError::TooFine { smallest_edge, .. }) = TetMesh::from_signed_distance(&sphere, 1e-6) else {
        panic!()
    };
    assert!((1e-4..1e-3).contains(&smallest_edge), "{smallest_edge}");
    let beside = Beside;
    assert_eq!(
        TetMesh::from_signed_distance(&beside, 0.1).unwrap_err().to_string(),
        "no cell of edge 0.1 m lies inside the solid; choose a smaller edge"
    );
}

/// A solid that is outside everywhere.
struct Beside;

impl SignedDistance for Beside {
    fn distance(&self, _: Point) -> f64 {
        1.0
    }

    fn bounds(&self) -> (Point, Point) {
        (Point::ZERO, Point::splat(1.0))
    }
}
