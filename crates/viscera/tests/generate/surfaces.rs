use approx::assert_relative_eq;
use viscera::mesh::{Point, SignedDistance, SurfaceError, SurfaceMesh, TetMesh, TriangleTree};

use crate::proof::{assert_conforming, order};
use crate::solids::{Sphere, Torus, box_surface, soup, together, torus_surface};

fn sphere_surface() -> SurfaceMesh {
    let mesh = TetMesh::from_signed_distance(&Sphere { radius: 0.05 }, 0.008).unwrap();
    mesh.surface()
}

/// The tree answers as the closed forms do; near the torus only the facets' chords differ, 0.4 % of the tube here.
#[test]
fn the_tree_of_a_torus_gives_the_distance_of_a_torus() {
    let torus = Torus { ring: 0.06, tube: 0.025 };
    let tree = TriangleTree::new(&torus_surface(&torus, 96, 48));
    for step in 0..2000 {
        let along = |factor: f64| 0.2 * ((f64::from(step) * factor).fract() - 0.5);
        let place = Point::new(along(0.754877666), along(0.569840291), 0.5 * along(0.362437));
        assert!((tree.distance(place) - torus.distance(place)).abs() < 0.005 * torus.tube);
    }
}

/// An STL file is a soup: every corner has a node of its own. It becomes a closed surface, then a mesh.
#[test]
fn a_soup_of_triangles_becomes_a_mesh() {
    let torus = Torus { ring: 0.06, tube: 0.025 };
    for (surface, edge, euler) in [
        (torus_surface(&torus, 60, 30), 0.006, 0),
        (sphere_surface(), 0.01, 2),
        (box_surface([3, 3, 3], [-0.02, 0.01, 0.5], [0.06, 0.05, 0.07]), 0.005, 2),
    ] {
        let (mesh, report) = TetMesh::from_surface(&soup(&surface), edge).unwrap();
        assert_eq!(assert_conforming(&mesh), euler);
        assert_eq!(report.surface.merged_nodes, 3 * surface.triangles.len() - report.surface.nodes);
        assert_relative_eq!(report.surface.volume, surface.enclosed_volume(), max_relative = 1e-6);
        assert!((0.0..0.04).contains(&report.volume_lost), "{report}");
        let quality = mesh.quality().unwrap();
        assert!(quality.smallest_dihedral.smallest.to_degrees() > 10.7, "{quality}");
        assert!(quality.largest_dihedral.largest.to_degrees() < 164.8, "{quality}");
    }
}

/// Sides, creases and corners that run through the lattice's nodes are met exactly.
#[test]
fn a_cube_on_the_lattice_is_met_exactly() {
    let surface = box_surface([2, 2, 2], [0.0; 3], [0.1; 3]);
    let (mesh, report) = TetMesh::from_surface(&surface, 0.02).unwrap();
    assert!(report.volume_lost.abs() < 1e-9, "{report}");
    assert_eq!(assert_conforming(&mesh), 2);
}

/// Askew in the lattice, creases are cut off at the size of an edge: O(edge²) of volume along their length.
#[test]
fn a_cube_askew_in_the_lattice_loses_its_creases() {
    let mut surface = box_surface([2, 2, 2], [0.0; 3], [0.1; 3]);
    for node in &mut surface.nodes {
        // A turn by arcsin 0.6 around z, then by arcsin 5/13 around x.
        let turned = Point::new(0.8 * node.x - 0.6 * node.y, 0.6 * node.x + 0.8 * node.y, node.z);
        *node =
            Point::new(turned.x, (12.0 * turned.y - 5.0 * turned.z) / 13.0, (5.0 * turned.y + 12.0 * turned.z) / 13.0);
    }
    let lost = |edge| {
        let (mesh, report) = TetMesh::from_surface(&surface, edge).unwrap();
        assert_eq!(assert_conforming(&mesh), 2);
        report.volume_lost
    };
    let (coarse, fine) = (lost(0.02), lost(0.01));
    assert!(coarse > 0.0 && coarse < 0.1, "{coarse}");
    // How much is lost depends on where the lattice meets the creases, so the order is rough.
    assert!((order(coarse, fine, 2.0) - 2.0).abs() < 0.5, "{coarse} {fine}");
}

#[test]
fn a_hole_is_named_with_its_place() {
    let mut surface = box_surface([4, 4, 4], [0.0; 3], [0.1; 3]);
    let top = |node: &u32| surface.nodes[*node as usize].z == 0.1;
    let removed = surface.triangles.iter().position(|triangle| triangle.iter().all(top)).unwrap();
    let corners = surface.triangles.remove(removed).map(|node| surface.nodes[node as usize]);
    let near = (corners[0] + corners[1] + corners[2]) / 3.0;

    let report = surface.check().unwrap();
    assert_eq!((report.holes.len(), report.holes[0].nodes.len()), (1, 3));
    assert!((report.holes[0].near - near).norm() < 1e-12);
    assert_relative_eq!(report.holes[0].length, 0.05 + 0.025 * 2f64.sqrt(), max_relative = 1e-12);
    let error = TetMesh::from_surface(&surface, 0.02).unwrap_err().to_string();
    assert_eq!(
        error,
        format!(
            "the surface has 1 hole, the longest 85.36 mm around, with 3 edges, near ({:.4}, {:.4}, 0.1000) m; close it in the program that made the surface",
            near.x, near.y
        )
    );
    assert!(report.to_string().ends_with("not closed\n"), "{report}");
}

/// Two openings are two loops, the longer one first.
#[test]
fn every_hole_is_counted() {
    let mut surface = box_surface([4, 4, 4], [0.0; 3], [0.1; 3]);
    let nodes = surface.nodes.clone();
    let place = |node: &u32| nodes[*node as usize];
    surface.triangles.retain(|triangle| !triangle.iter().all(|node| place(node).z == 0.1));
    surface.triangles.remove(surface.triangles.iter().position(|t| t.iter().all(|n| place(n).z == 0.0)).unwrap());
    let report = surface.check().unwrap();
    let edges: Vec<_> = report.holes.iter().map(|hole| hole.nodes.len()).collect();
    assert_eq!(edges, [16, 3]);
    assert_relative_eq!(report.holes[0].length, 0.4, max_relative = 1e-12);
}

#[test]
fn flipped_facets_are_turned_and_counted() {
    let whole = sphere_surface();
    let mut surface = whole.clone();
    for triangle in [3, 17, 40] {
        surface.triangles[triangle].swap(0, 1);
    }
    let (repaired, report) = surface.repaired().unwrap();
    assert_eq!((report.flipped.clone(), report.inside_out), (vec![3, 17, 40], 0));
    assert_relative_eq!(repaired.enclosed_volume(), whole.enclosed_volume(), max_relative = 1e-12);
    assert!(report.to_string().contains("mended: 3 flipped facets, turned\n"), "{report}");

    surface.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    let (repaired, report) = surface.repaired().unwrap();
    assert_eq!((report.flipped, report.inside_out), (vec![3, 17, 40], 1));
    assert_relative_eq!(repaired.enclosed_volume(), whole.enclosed_volume(), max_relative = 1e-12);
}

#[test]
fn degenerate_and_duplicate_facets_are_dropped_and_counted() {
    let mut surface = box_surface([2, 2, 2], [0.0; 3], [0.1; 3]);
    let [a, b, c] = surface.triangles[5];
    surface.triangles.extend([[b, c, a], [a, a, b]]);
    let last = surface.triangles.len() as u32;
    let report = surface.check().unwrap();
    assert_eq!((report.duplicate, report.degenerate), (vec![last - 2], vec![last - 1]));
    assert!(TetMesh::from_surface(&surface, 0.02).is_ok());
}

/// Two boxes that touch along an edge: four triangles meet there.
#[test]
fn an_edge_of_four_triangles_is_refused() {
    let surface = together(&box_surface([1; 3], [0.0; 3], [0.1; 3]), &box_surface([1; 3], [0.1, 0.1, 0.0], [0.1; 3]));
    let error = TetMesh::from_surface(&surface, 0.02).unwrap_err();
    assert!(matches!(error, SurfaceError::NonManifoldEdges { count: 1, triangles: 4, .. }));
    assert_eq!(
        error.to_string(),
        "1 edge of the surface has more than two triangles, the first with 4 near (0.1000, 0.1000, 0.0500) m; remove inner walls, or separate the parts that touch along an edge"
    );
}

/// Two boxes that touch in a corner: harmless, reported.
#[test]
fn a_shared_corner_is_reported_and_filled() {
    let surface = together(&box_surface([1; 3], [0.0; 3], [0.1; 3]), &box_surface([1; 3], [0.1; 3], [0.1; 3]));
    let (_, report) = TetMesh::from_surface(&surface, 0.02).unwrap();
    assert_eq!((report.surface.non_manifold_nodes.len(), report.surface.components), (1, 2));
}

/// A box inside a box is a cavity whichever way it faces; one beside it is a second body.
#[test]
fn a_component_inside_another_is_a_cavity() {
    let outer = box_surface([2; 3], [0.0; 3], [0.1; 3]);
    let inner = box_surface([1; 3], [0.03; 3], [0.04; 3]);
    let (_, report) = TetMesh::from_surface(&together(&outer, &inner), 0.01).unwrap();
    assert_eq!((report.surface.components, report.surface.cavities, report.pieces), (2, 1, 1));
    assert_relative_eq!(report.surface.volume, 1e-3 - 6.4e-5, max_relative = 1e-12);
    let beside = box_surface([1; 3], [0.15, 0.0, 0.0], [0.04; 3]);
    let (_, report) = TetMesh::from_surface(&together(&outer, &beside), 0.01).unwrap();
    assert_eq!((report.surface.components, report.surface.cavities, report.pieces), (2, 0, 2));
}

/// A plate thinner than the lattice is lost in part: the report says so and names an edge that keeps it.
#[test]
fn a_thin_plate_is_reported_with_the_edge_that_would_do() {
    let plate = box_surface([8, 8, 1], [0.0; 3], [0.1, 0.1, 0.004]);
    let (_, report) = TetMesh::from_surface(&plate, 0.006).unwrap();
    assert!(report.thin_area > 0.9, "{report}");
    assert_relative_eq!(report.sufficient_edge, 0.004 / 1.5, max_relative = 1e-9);
    assert!(report.to_string().contains("an edge of 2.667 mm would do"), "{report}");
    let (_, sufficient) = TetMesh::from_surface(&plate, report.sufficient_edge).unwrap();
    assert!(sufficient.volume_lost < 0.2 * report.volume_lost.max(0.2), "{report}{sufficient}");
    assert_eq!(sufficient.pieces, 1);
}

/// A Möbius band closed to a Klein bottle would have one side; the band itself has a hole and one side.
#[test]
fn a_surface_with_one_side_is_recognised() {
    let around = 24;
    let mut band = SurfaceMesh::default();
    for i in 0..around {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(around);
        for side in [-0.3, 0.3] {
            let r = 1.0 + side * (0.5 * angle).cos();
            band.nodes.push(Point::new(r * angle.cos(), r * angle.sin(), side * (0.5 * angle).sin()));
        }
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 < around { (2 * i + 2, 2 * i + 3) } else { (1, 0) };
        band.triangles.extend([[a, c, b], [b, c, d]].map(|triangle| triangle.map(|node| node as u32)));
    }
    let report = band.check().unwrap();
    assert!(report.one_sided.is_some());
    assert_eq!(report.holes.len(), 1, "the border of a Möbius band is one loop");
}

#[test]
fn damaged_surfaces_are_refused_in_words() {
    let says = |surface: &SurfaceMesh| TetMesh::from_surface(surface, 0.01).unwrap_err().to_string();
    let mut surface = box_surface([1; 3], [0.0; 3], [0.1; 3]);
    assert_eq!(says(&SurfaceMesh::default()), SurfaceError::Empty.to_string());
    surface.triangles[4][1] = 99;
    assert!(says(&surface).starts_with("triangle 4 names node 99, but the surface has only 8 nodes"));
    surface.triangles[4][1] = 0;
    surface.nodes[3].y = f64::NAN;
    assert!(says(&surface).starts_with("node 3 of the surface is not at a finite place"));
}
