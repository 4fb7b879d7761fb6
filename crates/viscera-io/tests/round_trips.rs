//! What is written is what was there, and nobody ever sees half a file.

use std::io::{Error, Write};

use viscera::mesh::{HexMesh, NamedRegion, Point, SurfaceMesh, TetMesh};
use viscera_io::write::{
    Cells, Encoding, Field, Grid, Table, TimeSeries, Values, write_atomically, write_csv, write_hex_msh, write_tet_msh,
    write_vtu,
};
use viscera_io::{Imported, ImportedMesh, Notice, read_mesh};

/// Two tetrahedra at coordinates that decimal text does not hold exactly, with every kind of region.
fn two_tets() -> TetMesh {
    let third = 1.0 / 3.0;
    let nodes = [[0., 0., 0.], [third, 0., 0.], [0., 0.1 + 0.2, 0.], [0., 0., 1e-300], [1e300, -third, 7.]];
    let mut mesh = TetMesh::new(nodes.map(|[x, y, z]| Point::new(x, y, z)).to_vec(), vec![[0, 1, 2, 3], [1, 2, 3, 4]]);
    let region = |nodes: &[u32], cells: &[u32], faces: &[[u32; 3]]| NamedRegion {
        nodes: nodes.to_vec(),
        cells: cells.to_vec(),
        faces: faces.to_vec(),
    };
    mesh.regions.insert("both".into(), region(&[0, 1, 2, 3, 4], &[0, 1], &[]));
    mesh.regions.insert("second".into(), region(&[1, 2, 3, 4], &[1], &[]));
    mesh.regions.insert("skin of the liver".into(), region(&[0, 1, 2, 3], &[], &[[0, 2, 1], [0, 1, 3]]));
    mesh.regions.insert("handles".into(), region(&[0, 4], &[], &[]));
    mesh
}

fn one_hex() -> HexMesh {
    let nodes = (0..8).map(|corner| {
        Point::new(f64::from(corner & 1 ^ corner >> 1 & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2))
    });
    let mut mesh = HexMesh::new(nodes.collect(), vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
    mesh.regions
        .insert("top".into(), NamedRegion { nodes: vec![4, 5, 6, 7], cells: vec![], faces: vec![[4, 5, 6, 7]] });
    mesh
}

fn read(path: &std::path::Path) -> Imported {
    read_mesh(path, 1.0).unwrap_or_else(|error| panic!("{error}"))
}

/// Every bit of every coordinate and every region comes back.
#[test]
fn msh_brings_back_meshes_and_regions() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("mesh.msh");
    write_tet_msh(&path, &two_tets()).expect("a written file");
    assert_eq!(read(&path), Imported { mesh: ImportedMesh::Tet(two_tets()), notices: vec![] });
    write_hex_msh(&path, &one_hex()).expect("a written file");
    assert_eq!(read(&path), Imported { mesh: ImportedMesh::Hex(one_hex()), notices: vec![] });
}

/// Both encodings bring back the same mesh; VTU has no regions.
#[test]
fn vtu_brings_back_meshes_in_both_encodings() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("mesh.vtu");
    let (tets, hex) =
        (TetMesh { regions: Default::default(), ..two_tets() }, HexMesh { regions: Default::default(), ..one_hex() });
    let surface = SurfaceMesh { nodes: tets.nodes.clone(), triangles: vec![[0, 1, 2], [2, 3, 4]] };
    let stiffness = [1.5f32, 2.5];
    for encoding in [Encoding::Raw, Encoding::Base64] {
        let grid = Grid::from(&tets)
            .with_point_data(Field::vector("velocity <m/s>", &tets.nodes))
            .with_cell_data(Field { name: "stiffness", components: 1, values: Values::F32(&stiffness) });
        write_vtu(&path, &grid, encoding).expect("a written file");
        let names = ["stiffness", "velocity <m/s>"].map(str::to_owned).to_vec();
        assert_eq!(
            read(&path),
            Imported { mesh: ImportedMesh::Tet(tets.clone()), notices: vec![Notice::DataSkipped { names }] }
        );
        write_vtu(&path, &Grid::from(&hex), encoding).expect("a written file");
        assert_eq!(read(&path), Imported { mesh: ImportedMesh::Hex(hex.clone()), notices: vec![] });
        write_vtu(&path, &Grid::from(&surface), encoding).expect("a written file");
        assert_eq!(read(&path), Imported { mesh: ImportedMesh::Surface(surface.clone()), notices: vec![] });
    }
}

/// The collection names every moment relative to itself, and every file it names can be read.
#[test]
fn a_time_series_names_a_file_for_every_moment() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let mut series = TimeSeries::new(folder.path().join("liver.pvd"));
    let mesh = one_hex();
    for time in [0.0, 0.04] {
        let file = series.write(time, &Grid::from(&mesh), Encoding::Raw).expect("a written moment");
        assert!(matches!(read(&file).mesh, ImportedMesh::Hex(_)));
    }
    let text = std::fs::read_to_string(folder.path().join("liver.pvd")).expect("the collection");
    let moments: Vec<&str> = text.lines().filter(|line| line.starts_with("<DataSet")).collect();
    assert_eq!(
        moments,
        [
            "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"liver-000000.vtu\"/>",
            "<DataSet timestep=\"0.04\" group=\"\" part=\"0\" file=\"liver-000001.vtu\"/>",
        ]
    );
    let error = series.add(1.0, std::path::Path::new("/elsewhere/x.vtu")).expect_err("another folder").to_string();
    assert!(error.starts_with("/elsewhere/x.vtu does not lie in the folder of "), "{error}");
}

/// Numbers keep their bits; names with commas are quoted.
#[test]
fn csv_keeps_every_bit() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("observables.csv");
    let mut table = Table::new(["time [s]", "tip, \"z\" [m]"]);
    table.push(&[0.1 + 0.2, 1e-300]).expect("a row");
    table.push(&[1.0, -0.0]).expect("a row");
    write_csv(&path, &table).expect("a written file");
    let text = std::fs::read_to_string(&path).expect("the table");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "time [s],\"tip, \"\"z\"\" [m]\"");
    let row: Vec<f64> = lines[1].split(',').map(|cell| cell.parse().expect("a number")).collect();
    assert_eq!(row, [0.1 + 0.2, 1e-300]);
    assert_eq!(lines[2], "1,-0");
    let error = table.push(&[1.0]).expect_err("one value for two columns").to_string();
    assert_eq!(error, "row 2 has 1 values, but the header has 2 columns");
}

/// A writer that fails leaves the old file as it was, and nothing beside it.
#[test]
fn a_failed_write_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("result.csv");
    write_atomically(&path, |out| out.write_all(b"old")).expect("a written file");
    let failed = write_atomically(&path, |out| {
        out.write_all(b"half of the n")?;
        Err(Error::other("the disk is full"))
    });
    let error = failed.expect_err("the disk is full").to_string();
    assert!(
        error.contains("result.csv: the file cannot be written: the disk is full; check that the folder is there"),
        "{error}"
    );
    assert_eq!(std::fs::read(&path).expect("the old file"), b"old");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 1);
}

/// What does not fit is refused before a file is touched.
#[test]
fn data_that_does_not_fit_is_not_written() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("mesh.vtu");
    let mesh = two_tets();
    let short = [1.0; 4];
    let grid = Grid::from(&mesh).with_point_data(Field::scalar("pressure", &short));
    let error = write_vtu(&path, &grid, Encoding::Raw).expect_err("four values for five nodes").to_string();
    assert_eq!(error, "field `pressure` has 4 values, but 5 are needed (1 for each of 5 nodes)");
    let grid = Grid::new(&mesh.nodes[..4], Cells::Tet(&mesh.cells));
    let error = write_vtu(&path, &grid, Encoding::Raw).expect_err("a node is missing").to_string();
    assert_eq!(error, "cell 1 names node 4, but there are only 4 positions; write the cells of the same mesh");
    let mut mesh = two_tets();
    mesh.regions.insert("a \"b\"".into(), NamedRegion::default());
    let error = write_tet_msh(&path, &mesh).expect_err("quotes").to_string();
    assert_eq!(
        error,
        "the name \"a \\\"b\\\"\" cannot be written, because it is empty or has quotes or line breaks; choose another"
    );
    let mut mesh = two_tets();
    mesh.regions.insert("far".into(), NamedRegion { cells: vec![2], ..NamedRegion::default() });
    let error = write_tet_msh(&path, &mesh).expect_err("no such cell").to_string();
    assert_eq!(error, "region `far` names cell 2, which the mesh does not have; number its nodes and cells anew");
    assert!(!path.exists());
}
