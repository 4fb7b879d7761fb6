//! Files of other programs say what those programs meant.

use std::path::PathBuf;

use viscera::mesh::{Point, SurfaceMesh, TetMesh, VolumeMesh};
use viscera_io::{CellKind, Imported, ImportedMesh, Notice, Shape, read_mesh, read_volume};

fn sample(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn read(name: &str) -> Imported {
    read_mesh(sample(name), 1.0).unwrap_or_else(|error| panic!("{error}"))
}

fn read_tets(name: &str) -> (TetMesh, Vec<Notice>) {
    match read(name) {
        Imported { mesh: ImportedMesh::Tet(mesh), notices } => (mesh, notices),
        other => panic!("{name} should hold tetrahedra, not {other:?}"),
    }
}

fn read_surface(name: &str) -> (SurfaceMesh, Vec<Notice>) {
    match read(name) {
        Imported { mesh: ImportedMesh::Surface(mesh), notices } => (mesh, notices),
        other => panic!("{name} should hold a surface, not {other:?}"),
    }
}

const NAMED: [&str; 4] = ["bar-22-ascii.msh", "bar-22-binary.msh", "bar-41-ascii.msh", "bar-41-binary.msh"];

/// Gmsh writes one mesh in five ways and both byte orders; all are the same bar of 1 × 1 × 2 m.
#[test]
fn every_version_of_gmsh_gives_the_same_bar() {
    let (first, _) = read_tets(NAMED[0]);
    assert_eq!((first.nodes.len(), first.cells.len()), (14, 24));
    assert!((first.volume() - 2.0).abs() < 1e-14, "{}", first.volume());
    let (exact, _) = read_tets("bar-22-binary.msh");
    for name in NAMED.iter().chain(&["bar-22-big-endian.msh", "bar-41-big-endian.msh"]) {
        let (mesh, notices) = read_tets(name);
        assert_eq!((&mesh.cells, &mesh.regions), (&first.cells, &first.regions), "{name}");
        assert_eq!(notices, [], "{name}");
        // Gmsh prints 16 digits, one too few to bring back every bit.
        let nodes = if name.ends_with("ascii.msh") { &first.nodes } else { &exact.nodes };
        assert_eq!(&mesh.nodes, nodes, "{name}");
    }
    let (unnamed, _) = read_tets("bar-1-ascii.msh");
    assert_eq!((&unnamed.nodes, &unnamed.cells), (&first.nodes, &first.cells));
}

/// Physical groups become regions: volumes give cells, surfaces faces, curves nodes alone.
#[test]
fn physical_groups_become_regions() {
    let (mesh, _) = read_tets("bar-41-binary.msh");
    let names: Vec<&str> = mesh.regions.keys().map(String::as_str).collect();
    assert_eq!(names, ["all of it", "bottom", "edge", "physical-7", "tissue"]);
    for volume in ["tissue", "all of it"] {
        let region = &mesh.regions[volume];
        assert_eq!((region.cells.len(), region.faces.len(), region.nodes.len()), (24, 0, 14), "{volume}");
    }
    for (name, height) in [("bottom", 0.0), ("physical-7", 2.0)] {
        let region = &mesh.regions[name];
        assert_eq!((region.cells.len(), region.faces.len(), region.nodes.len()), (0, 4, 5), "{name}");
        assert!(region.nodes.iter().all(|&node| mesh.nodes[node as usize].z == height), "{name}");
    }
    let edge = &mesh.regions["edge"];
    assert_eq!((edge.cells.len(), edge.faces.len(), edge.nodes.len()), (0, 0, 2));
}

/// Version 1 has no names at all.
#[test]
fn groups_of_msh_1_are_named_by_number() {
    let (mesh, _) = read_tets("bar-1-ascii.msh");
    let names: Vec<&str> = mesh.regions.keys().map(String::as_str).collect();
    assert_eq!(names, ["physical-1", "physical-2", "physical-3", "physical-4", "physical-7"]);
    assert_eq!(mesh.regions["physical-2"].cells.len(), 24);
}

/// Unnamed groups of a volume and of its skin may have one number; fixing the skin must not fix the volume.
#[test]
fn equal_numbers_of_volume_and_surface_stay_two_regions() {
    let text =
        "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n2\n1 2 1 1 3 1 2 3\n2 4 1 1 4 1 2 3 4\n$ENDELM\n";
    let Ok(Imported { mesh: ImportedMesh::Tet(mesh), .. }) = viscera_io::gmsh::parse(text.as_bytes()) else { panic!() };
    assert_eq!(mesh.regions["physical-1"].cells, [0]);
    assert_eq!(mesh.regions["physical-1-surface"].faces, [[0, 1, 2]]);
    assert_eq!(mesh.regions["physical-1-surface"].nodes, [0, 1, 2]);
}

/// The patch meshes of the reference solver: 2 × 2 × 2 boxes with displaced nodes, all cells wound rightly.
#[test]
fn patch_meshes_pass_the_check_untouched() {
    for (name, cells) in [("A01_patch_linear_tet4.msh", 48), ("A02_patch_linear_hex8.msh", 8)] {
        let read = read_volume(sample(name), 1.0).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((read.mesh.nodes().len(), read.mesh.cell_count()), (27, cells), "{name}");
        assert!(read.report.is_clean(), "{}", read.report);
        assert_eq!(matches!(read.mesh, VolumeMesh::Hex(_)), cells == 8, "{name}");
    }
}

/// Text, base64, appended, compressed, either byte order, legacy 4.2 and 5.1: the same two tetrahedra.
#[test]
fn every_encoding_of_vtk_gives_the_same_mesh() {
    let nodes =
        [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 1.]].map(|[x, y, z]| Point::new(x, y, z));
    let expected = TetMesh::new(nodes.to_vec(), vec![[0, 1, 2, 3], [1, 2, 3, 4]]);
    for name in [
        "tets-4-ascii.vtk",
        "tets-4-binary.vtk",
        "tets-5-ascii.vtk",
        "tets-5-binary.vtk",
        "tets-vtk-5-binary.vtk",
        "tets-meshio-ascii.vtu",
        "tets-meshio-base64.vtu",
        "tets-meshio-zlib.vtu",
        "tets-vtk-ascii.vtu",
        "tets-vtk-base64.vtu",
        "tets-vtk-base64-zlib.vtu",
        "tets-vtk-appended-raw.vtu",
        "tets-vtk-appended-raw-zlib.vtu",
        "tets-vtk-appended-raw-big-endian.vtu",
        "tets-vtk-appended-base64.vtu",
        "tets-vtk-appended-base64-zlib.vtu",
    ] {
        let (mesh, notices) = read_tets(name);
        assert_eq!(mesh, expected, "{name}");
        let names = ["stiffness", "u"].map(str::to_owned);
        let told = matches!(&notices[..], [Notice::DataSkipped { names: told }] if names.iter().all(|name| told.contains(name)));
        assert!(told, "{name}: {notices:?}");
    }
}

/// Squares and triangles, with corners merged: eight corners, twelve triangles, volume 1.
#[test]
fn every_format_of_surface_gives_the_same_cube() {
    for (name, split) in [
        ("cube.vtk", 6),
        ("cube-binary.vtk", 6),
        ("cube.vtp", 6),
        ("cube.obj", 6),
        ("cube-ascii.stl", 0),
        ("cube-binary.stl", 0),
    ] {
        let (mesh, notices) = read_surface(name);
        assert_eq!((mesh.nodes.len(), mesh.triangles.len()), (8, 12), "{name}");
        assert_eq!(mesh.enclosed_volume(), 1.0, "{name}");
        let squares = Notice::Split { kind: CellKind { shape: Shape::Quadrilateral, curved: false }, count: 6 };
        assert_eq!(notices.contains(&squares), split == 6, "{name}: {notices:?}");
    }
}

/// Curves and faces of no group are not part of the mesh, and the person is told.
#[test]
fn what_is_left_out_is_counted() {
    let text = "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n4\n1 1 0 1 2 1 2\n2 2 0 1 3 1 2 3\n3 4 0 1 4 1 2 3 4\n\
                4 7 0 1 5 1 2 3 4 1\n$ENDELM\n";
    let read = viscera_io::gmsh::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    let lines: Vec<String> = read.notices.iter().map(ToString::to_string).collect();
    assert_eq!(
        lines,
        [
            "1 edges are not part of the mesh",
            "1 triangles are not part of the mesh",
            "1 pyramids are left out, and the body has holes where they were; export it with one kind of first-order cell",
        ]
    );
}

/// A file in millimetres becomes metres.
#[test]
fn scale_is_the_length_of_the_file_s_unit() {
    let Ok(Imported { mesh: ImportedMesh::Tet(mesh), .. }) = read_mesh(sample("bar-22-ascii.msh"), 0.001) else {
        panic!()
    };
    assert!((mesh.volume() / 2e-9 - 1.0).abs() < 1e-14);
    assert_eq!(mesh.bounds().1, Point::new(0.001, 0.001, 0.002));
}

/// Content decides before the extension: an OBJ that somebody called .stl is still an OBJ.
#[test]
fn content_tells_the_format_before_the_extension() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("misnamed.stl");
    std::fs::copy(sample("cube.obj"), &path).expect("a copy");
    let Ok(Imported { mesh: ImportedMesh::Surface(mesh), .. }) = read_mesh(&path, 1.0) else { panic!() };
    assert_eq!(mesh.triangles.len(), 12);
}

/// Some programs start binary STL files with `solid`, which is the mark of text.
#[test]
fn binary_stl_that_starts_like_text_is_read() {
    let mut bytes = std::fs::read(sample("cube-binary.stl")).expect("the sample");
    bytes[..6].copy_from_slice(b"solid ");
    let Ok(Imported { mesh: ImportedMesh::Surface(mesh), .. }) = viscera_io::stl::parse(&bytes) else { panic!() };
    assert_eq!((mesh.nodes.len(), mesh.triangles.len()), (8, 12));
}

/// Faces of OBJ count from the end with negative numbers, have texture and normal numbers, and any number of corners.
#[test]
fn faces_of_obj_come_in_many_ways() {
    let text = "# a house\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0.5 2 0 0.1 0.2 0.3\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1 5//1\nf -5/1 -4/2/3 -3\nl 1 2\n";
    let read = viscera_io::obj::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    let ImportedMesh::Surface(mesh) = &read.mesh else { panic!() };
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 2]]);
    let lines: Vec<String> = read.notices.iter().map(ToString::to_string).collect();
    assert_eq!(lines, ["1 polygons were split into triangles", "1 edges are not part of the mesh"]);
}

/// VTK's voxels and strips list their corners in an order of their own; turned into ours, none is mirrored.
#[test]
fn voxels_and_strips_are_put_into_our_order() {
    let voxel = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1\n\
                 CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n11\n";
    let Ok(Imported { mesh: ImportedMesh::Hex(mesh), .. }) = viscera_io::vtk::parse(voxel.as_bytes()) else { panic!() };
    assert!(mesh.checked().expect("a cube").1.is_clean());
    let strip = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n";
    let Ok(Imported { mesh: ImportedMesh::Surface(mesh), .. }) = viscera_io::vtk::parse(strip.as_bytes()) else {
        panic!()
    };
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
}

/// A surface has no regions, and a name may stand for nothing: both are told.
#[test]
fn groups_that_get_lost_are_told() {
    let mesh = |cell: &str| {
        let head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"skin\"\n3 2 \"nothing\"\n$EndPhysicalNames\n";
        let nodes = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
        let text = format!("{head}{nodes}$Elements\n2\n1 2 2 1 1 1 2 3\n{cell}\n$EndElements\n");
        let read = viscera_io::gmsh::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
        read.notices.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(mesh("2 2 2 1 1 1 3 4"), ["a surface has no regions; these groups are not kept: skin"]);
    assert_eq!(mesh("2 4 2 0 1 1 2 3 4"), ["the group `nothing` is named, but nothing belongs to it"]);
}

/// Pieces of a parallel run count their nodes from 0 each.
#[test]
fn pieces_are_put_behind_each_other() {
    let piece = "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1\
                 </DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 3</DataArray><DataArray type=\"Int32\" \
                 Name=\"offsets\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\">10</DataArray></Cells></Piece>";
    let text = format!("<VTKFile><UnstructuredGrid>{piece}{piece}</UnstructuredGrid></VTKFile>");
    let Ok(Imported { mesh: ImportedMesh::Tet(mesh), .. }) = viscera_io::vtu::parse(text.as_bytes()) else { panic!() };
    assert_eq!(mesh.cells, [[0, 1, 2, 3], [4, 5, 6, 7]]);
    assert_eq!(mesh.checked().expect("two bodies").1.coincident_nodes, 4);
}
