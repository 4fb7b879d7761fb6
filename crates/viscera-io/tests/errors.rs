//! Every error as the person sees it: the place, what was expected and found, and how to mend it.

use viscera_io::{Imported, ParseError, gmsh, obj, read_mesh, read_volume, stl, vtk, vtu};

fn sample(name: &str) -> std::path::PathBuf {
    std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(sample(name)).expect("the sample")
}

fn message(read: Result<Imported, ParseError>) -> String {
    read.expect_err("this file is wrong").to_string()
}

const NODES: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";

/// A MSH 2.2 file of four nodes and these lines of elements.
fn with_elements(count: usize, lines: &str) -> String {
    message(gmsh::parse(format!("{NODES}$Elements\n{count}\n{lines}\n$EndElements\n").as_bytes()))
}

/// The sample, with `from` made into `to` at its first place.
fn changed(name: &str, from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes(name);
    let at = bytes.windows(from.len()).position(|window| window == from).expect("the part to change");
    bytes.splice(at..at + from.len(), to.iter().copied());
    bytes
}

#[test]
fn a_file_that_is_not_there() {
    let error = read_mesh("no/such/liver.msh", 1.0).expect_err("there is no file").to_string();
    assert_eq!(
        error,
        "no/such/liver.msh: there is no such file; check the name, and the folder that it is relative to"
    );
}

#[test]
fn a_folder_is_no_file() {
    let error = read_mesh(env!("CARGO_MANIFEST_DIR"), 1.0).expect_err("a folder").to_string();
    assert!(error.contains(": the file cannot be read: "), "{error}");
}

#[test]
fn a_format_that_nobody_knows() {
    let error = read_mesh(sample("README.md"), 1.0).expect_err("no mesh").to_string();
    assert!(
        error.ends_with(
            "README.md: the format is not known (the file starts with `# Sample meshes, written…`); \
             Viscera reads Gmsh (.msh 1, 2.2, 4.1), VTK (.vtk, .vtu), STL and OBJ"
        ),
        "{error}"
    );
}

#[test]
fn a_scale_that_makes_no_mesh() {
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = read_mesh(sample("cube.obj"), scale).expect_err("no scale").to_string();
        assert_eq!(
            error,
            format!(
                "a scale of {scale} makes no mesh; give the length of the file's unit in metres, such as 0.001 for mm"
            )
        );
    }
}

#[test]
fn a_skin_where_a_volume_is_needed() {
    let error = read_volume(sample("cube.obj"), 1.0).expect_err("a surface").to_string();
    assert!(
        error.ends_with(
            "cube.obj: this file holds 12 triangles and no volume; run `viscera mesh tetrahedralize` to fill it with tetrahedra"
        ),
        "{error}"
    );
}

#[test]
fn a_mesh_that_fails_the_check() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("flat.msh");
    let flat = NODES.replace("4 0 0 1", "4 1 1 0");
    std::fs::write(&path, format!("{flat}$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n")).expect("a file");
    let error = read_volume(&path, 1.0).expect_err("flat").to_string();
    assert!(
        error.ends_with(
            "flat.msh: cell 0 has no volume (its corners [0, 1, 2, 3] lie in a plane); remove it or re-export the mesh without merging nodes"
        ),
        "{error}"
    );
}

#[test]
fn a_file_that_was_cut_off() {
    assert_eq!(
        message(gmsh::parse(&bytes("bar-22-ascii.msh")[..1000])),
        "line 63: the file ends where the rest of this line should stand; it was cut off: copy or export it again"
    );
    assert_eq!(
        message(gmsh::parse(&bytes("bar-41-binary.msh")[..3000])),
        "byte 2844: 33 elements are promised, but only 156 bytes follow; the count is damaged or the file was cut off: export it again"
    );
    assert_eq!(
        message(stl::parse(&bytes("cube-binary.stl")[..600])),
        "byte 80: 12 triangles are promised, but only 516 bytes follow; the count is damaged or the file was cut off: export it again"
    );
    assert_eq!(
        message(gmsh::parse(b"")),
        "line 1: the file ends where $MeshFormat or $NOD should stand; it was cut off: copy or export it again"
    );
    assert_eq!(
        message(vtu::parse(&bytes("tets-vtk-appended-raw.vtu")[..2300])),
        "line 33: the file ends where the data of an array should stand; it was cut off: copy or export it again"
    );
}

/// A small file that promises a billion nodes is an error, not an allocation.
#[test]
fn counts_that_lie() {
    assert_eq!(
        message(gmsh::parse(NODES.replace("\n4\n", "\n1000000000000\n").as_bytes())),
        "line 5: 1000000000000 nodes are promised, but only 43 bytes follow; the count is damaged or the file was cut off: export it again"
    );
    let binary = changed("bar-22-binary.msh", b"$Nodes\n14\n", b"$Nodes\n999999999999\n");
    assert!(message(gmsh::parse(&binary)).contains("999999999999 nodes are promised"));
    let vtk = changed("tets-4-binary.vtk", b"POINTS 5", b"POINTS 88888888888");
    assert!(message(vtk::parse(&vtk)).contains("88888888888 points are promised"));
    let vtu = changed("tets-vtk-ascii.vtu", b"NumberOfPoints=\"5\"", b"NumberOfPoints=\"7777777777777777777\"");
    assert!(message(vtu::parse(&vtu)).contains("coordinates of points: 18446744073709551615 are needed, 15 are there"));
    let mut stl = bytes("cube-binary.stl");
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(message(stl::parse(&stl)).contains("4294967295 triangles are promised"));
}

#[test]
fn coordinates_that_are_no_place() {
    assert_eq!(
        message(gmsh::parse(NODES.replace("3 0 1 0", "3 0 nan 0").as_bytes())),
        "line 8: node 3 lies at (0, NaN, 0), which is not a finite place; repair the program that wrote the file"
    );
    assert!(
        message(obj::parse(b"v 0 0 inf\n"))
            .starts_with("line 1: node 1 lies at (0, 0, inf), which is not a finite place")
    );
    let mut stl = bytes("cube-binary.stl");
    stl[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(message(stl::parse(&stl)).starts_with("byte 96: node 0 lies at (NaN, "));
}

#[test]
fn numbers_that_are_none() {
    assert_eq!(
        message(gmsh::parse(NODES.replace("3 0 1 0", "3 0 1,5 0").as_bytes())),
        "line 8: expected a coordinate, found `1,5`; correct it or export the file again"
    );
    assert_eq!(
        message(vtk::parse(&changed("tets-4-ascii.vtk", b"CELLS 2", b"CELLS two"))),
        "line 7: expected the number of cells, found `two`; correct it or export the file again"
    );
}

#[test]
fn lines_with_wrong_columns() {
    assert_eq!(
        message(gmsh::parse(NODES.replace("3 0 1 0", "3 0 1").as_bytes())),
        "line 8: this line has 3 columns, but a node has 4: its number, x, y and z; correct it or export the file again"
    );
    assert_eq!(
        message(gmsh::parse(NODES.replace("3 0 1 0", "3 0 1 0 9").as_bytes())),
        "line 8: this line has 5 columns, but a node has 4: its number, x, y and z; correct it or export the file again"
    );
    assert_eq!(
        message(obj::parse(b"v 0 0 0 1 2\n")),
        "line 1: this line has 6 columns, but a node has x, y and z, and perhaps a weight and a colour; correct it or export the file again"
    );
}

#[test]
fn nodes_that_do_not_exist() {
    assert_eq!(
        with_elements(1, "1 4 2 1 1 1 2 3 9"),
        "line 13: cell 1 names node 9, which the file does not have; nodes were lost: export it again"
    );
    assert_eq!(
        message(obj::parse(b"v 0 0 0\nf 1 0 1\n")),
        "line 2: cell 1 names node 0, which the file does not have; nodes were lost: export it again"
    );
    assert!(
        message(vtk::parse(&changed("tets-4-ascii.vtk", b"4\n0\n1\n2\n3", b"4\n0\n1\n2\n7")))
            .contains("cell 0 names node 7")
    );
    assert!(
        message(vtu::parse(&changed("tets-vtk-ascii.vtu", b"0 1 2 3 1 2", b"0 1 2 -3 1 2")))
            .contains("cell 0 names node -3")
    );
}

#[test]
fn nodes_that_are_there_twice() {
    assert_eq!(
        message(gmsh::parse(NODES.replace("3 0 1 0", "2 0 1 0").as_bytes())),
        "line 8: node 2 is defined twice; renumber the nodes or export the file again"
    );
}

#[test]
fn cells_of_unknown_kind_or_size() {
    assert_eq!(
        with_elements(1, "1 77 2 1 1 1 2 3 4"),
        "line 13: cell type 77 is not known; export the file with tetrahedra or hexahedra of first order"
    );
    let text = "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n1\n5 4 0 0 3 1 1 1\n$ENDELM\n";
    assert_eq!(
        message(gmsh::parse(text.as_bytes())),
        "line 7: cell 5 is one of the tetrahedra, but lists 3 corners; export the file again"
    );
}

#[test]
fn tetrahedra_and_hexahedra_together() {
    assert_eq!(
        with_elements(2, "1 4 0 1 2 3 4\n2 5 0 1 2 3 4 1 2 3 4"),
        "as a whole: the file mixes 1 tetrahedra and 1 hexahedra, and a body is made of one kind; export them as two files or mesh with one kind"
    );
}

#[test]
fn nothing_that_a_body_is_made_of() {
    assert_eq!(
        message(gmsh::parse(&bytes("bar-second-order.msh"))),
        "as a whole: there are no tetrahedra, hexahedra or triangles of first order in the file (it holds 63 nodes, \
         1 second- or higher-order edges, \
         8 second- or higher-order triangles, 24 second- or higher-order tetrahedra); export the volume, with first-order cells"
    );
}

#[test]
fn parts_of_formats_that_are_not_read() {
    assert_eq!(
        message(gmsh::parse(&bytes("bar-40-ascii.msh"))),
        "line 2: MSH version 4 cannot be read; save the mesh as version 4.1 or 2.2 (in Gmsh: `gmsh in.msh -save -format msh22 -o out.msh`)"
    );
    assert_eq!(
        message(vtu::parse(&bytes("tets-meshio-lzma.vtu"))),
        "line 2: data compressed by `vtkLZMADataCompressor` cannot be read; write the file with ZLib or without compression"
    );
    assert_eq!(
        message(vtu::parse(b"<VTKFile type=\"ImageData\"></VTKFile>")),
        "line 1: a VTK file of kind `ImageData` cannot be read; write an UnstructuredGrid or PolyData in one file (ParaView: save as .vtu or .vtp)"
    );
    assert_eq!(
        message(vtk::parse(b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\n")),
        "line 4: a VTK data set of kind `STRUCTURED_POINTS` cannot be read; write an UNSTRUCTURED_GRID or POLYDATA \
         (ParaView: filter Append Datasets or Extract Surface)"
    );
}

#[test]
fn lists_that_contradict_each_other() {
    assert_eq!(
        message(vtu::parse(&changed("tets-vtk-ascii.vtu", b"NumberOfPoints=\"5\"", b"NumberOfPoints=\"6\""))),
        "line 26: coordinates of points: 18 are needed, 15 are there; the file contradicts itself: export it again"
    );
    assert_eq!(
        message(vtu::parse(&changed("tets-vtk-ascii.vtu", b"NumberOfCells=\"2\"", b"NumberOfCells=\"3\""))),
        "line 40: cells of a piece: 3 are needed, 2 are there; the file contradicts itself: export it again"
    );
}

#[test]
fn xml_and_encodings_that_are_damaged() {
    assert!(message(vtu::parse(b"<VTKFile>\n<Piece>\n</VTKFile>")).starts_with("line 3: the XML is malformed ("));
    let base64 = changed("tets-meshio-base64.vtu", b"format=\"binary\">\n", b"format=\"binary\">\n!!!!");
    assert!(message(vtu::parse(&base64)).contains("the base64 data cannot be unpacked ("));
    let mut zlib = bytes("tets-vtk-appended-raw-zlib.vtu");
    let at =
        zlib.windows(2).rposition(|window| window == [0x78, 0x9c] || window == [0x78, 0x5e] || window == [0x78, 0x01]);
    zlib[at.expect("a zlib header")] = 0;
    assert!(message(vtu::parse(&zlib)).contains("the zlib data cannot be unpacked ("));
}

#[test]
fn words_that_should_be_others() {
    assert_eq!(
        message(stl::parse(b"solid x\nfacet normal 0 0 1\nouter loop\nvortex 0 0 0\n")),
        "line 4: expected vertex, found `vortex`; correct it or export the file again"
    );
    assert_eq!(
        message(obj::parse(b"v 0 0 0\n\x00\x01 7\n")),
        "line 2: expected a statement such as `v` or `f`, found `··`; correct it or export the file again"
    );
}

/// Ten thousand pieces that all point at the same data would fill the memory from a small file.
#[test]
fn data_that_many_pieces_claim() {
    let piece = "<Piece NumberOfPoints=\"1000\"><Points><DataArray type=\"Float32\" format=\"appended\" offset=\"0\"/></Points></Piece>";
    let pieces = piece.repeat(10_000);
    let head = format!("<VTKFile><UnstructuredGrid>{pieces}</UnstructuredGrid><AppendedData encoding=\"raw\">_");
    let bytes: Vec<u8> = head.into_bytes().into_iter().chain(12_000u32.to_le_bytes()).chain([0; 12_000]).collect();
    assert!(message(vtu::parse(&bytes)).starts_with("line 1: bytes of all arrays: "));
}

/// XML a hundred thousand levels deep must not overflow the stack.
#[test]
fn xml_that_is_too_deep() {
    let deep = format!("<VTKFile>{}", "<a>".repeat(100_000));
    assert!(message(vtu::parse(deep.as_bytes())).starts_with("line 1: the XML is malformed ("));
}
