//! `viscera mesh`, on meshes of other programs and on those that it makes.

use viscera_io::write::write_tet_msh;
use viscera_io::{ImportedMesh, read_mesh};

use crate::{Desk, plain_and_tangled, sample};

fn text(path: &std::path::Path) -> &str {
    path.to_str().expect("UTF-8")
}

#[test]
fn info_tells_regions_quality_and_parts_of_a_mesh_by_gmsh() {
    Desk::new()
        .viscera(&["mesh", "info", text(&sample("bar-41-binary.msh"))])
        .ends_with(0)
        .says("24 tetrahedra, 14 nodes, 1 part, 2000000.000 cm³")
        .says("1.00 m × 1.00 m × 2.00 m")
        .says("tissue      14 nodes, 24 cells")
        .says("dihedral angles");
}

#[test]
fn check_says_what_is_good_and_what_a_surface_is_good_for() {
    let desk = Desk::new();
    desk.viscera(&["mesh", "check", text(&sample("A02_patch_linear_hex8.msh"))]).ends_with(0).says("the mesh is good");
    desk.viscera(&["mesh", "check", text(&sample("cube-ascii.stl"))]).ends_with(0).says("the surface is closed");
}

#[test]
fn a_mesh_keeps_its_cells_and_regions_from_gmsh_to_msh_and_scales_to_metres() {
    let desk = Desk::new();
    let source = sample("bar-1-ascii.msh");
    desk.viscera(&["mesh", "convert", text(&source), "bar.msh", "--unit", "mm"]).ends_with(0).says("wrote bar.msh");
    let ImportedMesh::Tet(before) = read_mesh(source, 1e-3).expect("the sample").mesh else { panic!("tetrahedra") };
    let ImportedMesh::Tet(after) = read_mesh(desk.path("bar.msh"), 1.0).expect("the copy").mesh else {
        panic!("tetrahedra")
    };
    assert_eq!(after, before);
    desk.viscera(&["mesh", "convert", "bar.msh", "bar.vtu"]).ends_with(0);
    let ImportedMesh::Tet(vtu) = read_mesh(desk.path("bar.vtu"), 1.0).expect("the copy").mesh else {
        panic!("tetrahedra")
    };
    assert_eq!((vtu.nodes, vtu.cells), (after.nodes, after.cells));
    desk.viscera(&["mesh", "convert", "bar.msh", "bar.stl"]).ends_with(2).complains("end the name with .vtu or .msh");
}

/// A box with its nodes in no order: reordered, it has the same cells at the same places, near one another.
#[test]
fn a_mesh_is_reordered_and_says_how_far_its_numbers_were_apart() {
    let desk = Desk::new();
    let [_, mesh] = plain_and_tangled();
    write_tet_msh(desk.path("tangled.msh"), &mesh).expect("a folder of its own");
    desk.viscera(&["mesh", "info", "tangled.msh"]).ends_with(0).says("viscera mesh convert --reorder");
    desk.viscera(&["mesh", "convert", "tangled.msh", "ordered.msh", "--reorder"])
        .ends_with(0)
        .says("numbers of a cell's nodes lie ")
        .says("wrote ordered.msh");
    let told = desk.viscera(&["mesh", "info", "ordered.msh"]).ends_with(0).says("6 144 tetrahedra");
    assert!(!told.out.contains("--reorder"), "{}", told.out);
    let bar = sample("bar-1-ascii.msh");
    desk.viscera(&["mesh", "convert", text(&bar), "bar.msh", "--reorder"]).ends_with(0).says("theirs stays");
    let meshes = [bar, desk.path("bar.msh")].map(|path| read_mesh(path, 1.0).expect("a mesh").mesh);
    let [ImportedMesh::Tet(before), ImportedMesh::Tet(after)] = meshes else { panic!("tetrahedra") };
    assert_eq!(after, before);
    let surface = sample("cube-ascii.stl");
    desk.viscera(&["mesh", "convert", text(&surface), "cube.vtu", "--reorder"])
        .ends_with(2)
        .complains("a surface has no cells to reorder");
}

#[test]
fn generated_shapes_have_the_volume_of_their_measures() {
    let desk = Desk::new();
    let volume = |arguments: &[&str]| {
        let head = ["mesh", "generate"];
        desk.viscera(&[&head[..], arguments, &["--out", "made.vtu"]].concat()).ends_with(0).says("wrote made.vtu");
        match read_mesh(desk.path("made.vtu"), 1.0).expect("the mesh").mesh {
            ImportedMesh::Tet(mesh) => mesh.volume(),
            ImportedMesh::Hex(mesh) => (0..mesh.cells.len()).map(|cell| mesh.cell_volume(cell)).sum(),
            ImportedMesh::Surface(_) => panic!("a volume"),
        }
    };
    let close = |volume: f64, wanted: f64, tolerance: f64| {
        assert!((volume / wanted - 1.0).abs() < tolerance, "{volume} m³ in place of {wanted} m³");
    };
    for cut in ["five", "six", "one"] {
        close(volume(&["box", "--size", "10cm", "20cm", "0.3", "--cells", "2", "2", "2", "--cut", cut]), 6e-3, 1e-12);
    }
    // The rim is a polygon of 6 × 5 corners: its area is π r² times sin(12°)/(π/15), 0.9927.
    close(volume(&["cylinder", "--radius", "1 cm", "--height", "10 cm", "--edge", "2 mm"]), 3.1187e-5, 1e-3);
    volume(&["tube", "--inner-radius", "7 mm", "--outer-radius", "11 mm", "--height", "10 cm", "--edge", "4 mm"]);
    // A liver of 30 cm weighs about 2 kg, and has the wanted number of cells within a tenth.
    close(volume(&["liver", "--cells", "2000"]), 2e-3, 0.15);
    let ImportedMesh::Tet(liver) = read_mesh(desk.path("made.vtu"), 1.0).expect("the mesh").mesh else {
        panic!("tetrahedra")
    };
    close(liver.cells.len() as f64, 2000.0, 0.1);
}

#[test]
fn a_generator_refuses_what_cannot_be() {
    let desk = Desk::new();
    desk.viscera(&["mesh", "generate", "liver", "--edge", "8 kg", "--out", "a.msh"])
        .ends_with(2)
        .complains("expected a length, found the mass");
    desk.viscera(&[
        "mesh", "generate", "cylinder", "--radius", "1", "--height", "1", "--edge", "1um", "--out", "a.msh",
    ])
    .ends_with(2)
    .complains("take a longer edge");
    desk.viscera(&["mesh", "generate", "box", "--size", "1", "1", "1", "--cells", "1", "1", "1", "--out", "no/a.msh"])
        .ends_with(2)
        .complains("check that the folder is there");
    assert!(!desk.path("a.msh").exists());
}

#[test]
fn a_surface_of_another_program_is_filled_and_measured() {
    let desk = Desk::new();
    let cube = sample("cube-ascii.stl");
    desk.viscera(&["mesh", "tetrahedralize", text(&cube), "--unit", "cm", "--edge", "2 mm", "--out", "cube.msh"])
        .ends_with(0)
        .says("12 triangles")
        .says("of the volume lost")
        .says("smallest dihedral");
    let ImportedMesh::Tet(mesh) = read_mesh(desk.path("cube.msh"), 1.0).expect("the mesh").mesh else {
        panic!("tetrahedra")
    };
    // Edges and corners of the cube are cut off at the size of a cell, a fifth of its side.
    assert!((0.9..1.0).contains(&(mesh.volume() / 1e-6)), "{} m³", mesh.volume());
}

#[test]
fn a_surface_with_a_hole_is_refused_and_the_hole_is_placed() {
    let desk = Desk::new();
    let stl = std::fs::read_to_string(sample("cube-ascii.stl")).expect("the sample");
    // Without its last facet.
    let end = stl.rfind("facet normal").expect("facets");
    desk.write("open.stl", format!("{}endsolid\n", &stl[..end]));
    desk.viscera(&["mesh", "check", "open.stl"]).ends_with(1).says("hole: 3 edges");
    desk.viscera(&["mesh", "tetrahedralize", "open.stl", "--edge", "0.2", "--out", "cube.msh"])
        .ends_with(1)
        .says("hole: 3 edges")
        .complains("open.stl:");
    assert!(!desk.path("cube.msh").exists());
}
