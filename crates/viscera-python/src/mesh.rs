//! Meshes: their arrays are made once, closed for writing, and shared by all who ask.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use viscera::mesh::{
    CubeCut, HexMesh, NamedRegion, Reordered, TetMesh, TetQuality, TubeDivisions, VolumeMesh, scaled_jacobian,
};
use viscera_io::write::{Encoding, Grid, write_hex_msh, write_tet_msh, write_vtu};
use viscera_io::{ImportedMesh, read_mesh, read_volume};

use crate::arrays::{Numbers, index_array, index_rows, indices, list_array, read_only, vector_array, vectors};
use crate::error::OrRaise;
use crate::region::region;
use crate::report::PyFillingReport;
use crate::surface::PySurfaceMesh;

/// A mesh of tetrahedra (`TetMesh`) or hexahedra (`HexMesh`): nodes [m], cells, named regions.
#[pyclass(frozen, subclass, name = "VolumeMesh", module = "viscera")]
pub(crate) struct PyVolumeMesh {
    pub(crate) mesh: Arc<VolumeMesh>,
    nodes: PyOnceLock<Py<PyArray2<f64>>>,
    cells: PyOnceLock<Py<PyArray2<u32>>>,
}

/// A mesh of tetrahedra with four corners (a, b, c, d), det[b−a, c−a, d−a] > 0.
#[pyclass(frozen, extends = PyVolumeMesh, name = "TetMesh", module = "viscera")]
pub(crate) struct PyTetMesh;

/// A mesh of hexahedra with eight corners, in the order of Gmsh and VTK.
#[pyclass(frozen, extends = PyVolumeMesh, name = "HexMesh", module = "viscera")]
pub(crate) struct PyHexMesh;

impl PyVolumeMesh {
    fn new(mesh: Arc<VolumeMesh>) -> Self {
        Self { mesh, nodes: PyOnceLock::new(), cells: PyOnceLock::new() }
    }
}

/// The mesh as an object of the class for its cells.
pub(crate) fn mesh_object(py: Python<'_>, mesh: impl Into<Arc<VolumeMesh>>) -> PyResult<Py<PyAny>> {
    let mesh = mesh.into();
    let base = PyClassInitializer::from(PyVolumeMesh::new(mesh.clone()));
    Ok(match *mesh {
        VolumeMesh::Tet(_) => Py::new(py, base.add_subclass(PyTetMesh))?.into_any(),
        VolumeMesh::Hex(_) => Py::new(py, base.add_subclass(PyHexMesh))?.into_any(),
    })
}

fn named<const FACE: usize>(
    given: Option<&Bound<'_, PyDict>>,
    nodes: usize,
    cells: usize,
) -> PyResult<BTreeMap<String, NamedRegion<FACE>>> {
    let mut regions = BTreeMap::new();
    for (name, parts) in given.into_iter().flat_map(|given| given.iter()) {
        let name: String = name.extract()?;
        let mut region = NamedRegion { nodes: Vec::new(), cells: Vec::new(), faces: Vec::new() };
        match parts.cast::<PyDict>() {
            Ok(parts) => {
                let list = |key: &str| match parts.get_item(key)? {
                    Some(list) => indices(&list, key),
                    None => Ok(Vec::new()),
                };
                (region.nodes, region.cells) = (list("nodes")?, list("cells")?);
                if let Some(faces) = parts.get_item("faces")? {
                    region.faces = index_rows(&faces, "faces")?;
                }
            }
            Err(_) => region.nodes = indices(&parts, "nodes")?,
        }
        let beyond = |list: &[u32], count: usize| list.iter().copied().find(|&number| number as usize >= count);
        let of_faces: Vec<u32> = region.faces.iter().flatten().copied().collect();
        if let Some(node) = beyond(&region.nodes, nodes).or_else(|| beyond(&of_faces, nodes)) {
            return Err(PyValueError::new_err(format!("region `{name}` names node {node} of {nodes}")));
        }
        if let Some(cell) = beyond(&region.cells, cells) {
            return Err(PyValueError::new_err(format!("region `{name}` names cell {cell} of {cells}")));
        }
        region.nodes.extend(of_faces);
        region.normalize();
        regions.insert(name, region);
    }
    Ok(regions)
}

fn region_dict<'py, const FACE: usize>(
    py: Python<'py>,
    regions: &BTreeMap<String, NamedRegion<FACE>>,
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (name, region) in regions {
        let parts = PyDict::new(py);
        parts.set_item("nodes", list_array(py, region.nodes.clone()))?;
        parts.set_item("cells", list_array(py, region.cells.clone()))?;
        parts.set_item("faces", index_array(py, region.faces.iter().copied()))?;
        all.set_item(name, parts)?;
    }
    Ok(all)
}

/// A mesh, and the numbers that its nodes and cells had before.
type ReorderedParts<'py> = (Py<PyAny>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u32>>);

#[pymethods]
impl PyVolumeMesh {
    /// Rest positions of the nodes [m]; shape (n, 3), float64, not to be written to. The same array for all who ask: it is not
    /// copied, and outlives the mesh.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyArray2<f64>>> {
        let made = self.nodes.get_or_try_init(py, || {
            let array = vector_array(py, self.mesh.nodes());
            read_only(&array).map(|()| array.unbind())
        })?;
        Ok(made.bind(py))
    }

    /// Corners of the cells; shape (n, 4) or (n, 8), uint32, not to be written to, and shared as `nodes` are.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyArray2<u32>>> {
        let made = self.cells.get_or_try_init(py, || {
            let array = match &*self.mesh {
                VolumeMesh::Tet(mesh) => index_array(py, mesh.cells.iter().copied()),
                VolumeMesh::Hex(mesh) => index_array(py, mesh.cells.iter().copied()),
            };
            read_only(&array).map(|()| array.unbind())
        })?;
        Ok(made.bind(py))
    }

    /// Named regions: for each name a dict of `nodes`, `cells` and `faces`.
    #[getter]
    fn regions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        match &*self.mesh {
            VolumeMesh::Tet(mesh) => region_dict(py, &mesh.regions),
            VolumeMesh::Hex(mesh) => region_dict(py, &mesh.regions),
        }
    }

    /// Sum of the volumes of all cells [m³].
    #[getter]
    fn volume(&self) -> f64 {
        match &*self.mesh {
            VolumeMesh::Tet(mesh) => mesh.volume(),
            VolumeMesh::Hex(mesh) => (0..mesh.cells.len()).map(|cell| mesh.cell_volume(cell)).sum(),
        }
    }

    /// Smallest and largest coordinates [m].
    #[getter]
    fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let (low, high) = self.mesh.bounds();
        (low.to_array(), high.to_array())
    }

    /// Length of the diagonal of the bounding box [m].
    #[getter]
    fn size(&self) -> f64 {
        self.mesh.size()
    }

    /// Shape of every cell: radius ratio of tetrahedra (1 regular, 0 flat, negative inverted), scaled Jacobian of hexahedra (1
    /// for a box); shape (cells,).
    fn quality<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let qualities = match &*self.mesh {
            VolumeMesh::Tet(mesh) => {
                (0..mesh.cells.len()).map(|cell| TetQuality::of(mesh.corners(cell)).radius_ratio).collect()
            }
            VolumeMesh::Hex(mesh) => (0..mesh.cells.len()).map(|cell| scaled_jacobian(&mesh.corners(cell))).collect(),
        };
        list_array(py, qualities)
    }

    /// The outward surface as triangles, on the same nodes.
    fn surface(&self) -> PySurfaceMesh {
        PySurfaceMesh::new(match &*self.mesh {
            VolumeMesh::Tet(mesh) => mesh.surface(),
            VolumeMesh::Hex(mesh) => mesh.surface(),
        })
    }

    /// Numbers of the nodes in a region, ascending.
    fn nodes_in<'py>(&self, py: Python<'py>, region: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let nodes = self::region(region)?.nodes(&self.mesh).or_raise()?;
        Ok(list_array(py, nodes))
    }

    /// Numbers of the cells whose corners all lie in a region, ascending.
    fn cells_in<'py>(&self, py: Python<'py>, region: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let cells = self::region(region)?.cells(&self.mesh).or_raise()?;
        Ok(list_array(py, cells))
    }

    /// The mesh checked and repaired (mirrored cells turned, nodes of no cell removed), and what was found.
    fn checked(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, String)> {
        let (mesh, report) = match &*self.mesh {
            VolumeMesh::Tet(mesh) => mesh.clone().checked().map(|(mesh, report)| (VolumeMesh::Tet(mesh), report)),
            VolumeMesh::Hex(mesh) => mesh.clone().checked().map(|(mesh, report)| (VolumeMesh::Hex(mesh), report)),
        }
        .or_raise()?;
        Ok((mesh_object(py, mesh)?, report.to_string()))
    }

    /// The mesh with other numbers, neighbours near one another, as its steps take least time then; and the numbers that its nodes and cells had
    /// before, so that `values[nodes]` are those of the new nodes.
    fn reordered<'py>(&self, py: Python<'py>) -> PyResult<ReorderedParts<'py>> {
        let Reordered { mesh, nodes, cells } = self.mesh.reordered().or_raise()?;
        Ok((mesh_object(py, mesh)?, list_array(py, nodes), list_array(py, cells)))
    }

    /// The same cells and regions on other nodes [m]; shape (n, 3).
    fn with_nodes(&self, py: Python<'_>, nodes: Numbers<'_>) -> PyResult<Py<PyAny>> {
        let nodes = crate::arrays::vectors_of(&nodes, "nodes", self.mesh.nodes().len())?;
        let mut mesh = (*self.mesh).clone();
        match &mut mesh {
            VolumeMesh::Tet(mesh) => mesh.nodes = nodes,
            VolumeMesh::Hex(mesh) => mesh.nodes = nodes,
        }
        mesh_object(py, mesh)
    }

    /// Writes the mesh: MSH 2.2 with its regions, or VTU without, by the extension.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| match (path.extension().and_then(|extension| extension.to_str()), &*self.mesh) {
            (Some("vtu"), mesh) => write_vtu(&path, &Grid::from(mesh), Encoding::Raw),
            (_, VolumeMesh::Tet(mesh)) => write_tet_msh(&path, mesh),
            (_, VolumeMesh::Hex(mesh)) => write_hex_msh(&path, mesh),
        })
        .or_raise()
    }

    fn __len__(&self) -> usize {
        self.mesh.cell_count()
    }

    fn __repr__(&self) -> String {
        let kind = if matches!(*self.mesh, VolumeMesh::Tet(_)) { "tetrahedra" } else { "hexahedra" };
        format!("<mesh of {} {kind} on {} nodes>", self.mesh.cell_count(), self.mesh.nodes().len())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().mesh == self.mesh)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, mesh) = (slf.py(), slf.get());
        let arguments = (mesh.nodes(py)?, mesh.cells(py)?, mesh.regions(py)?).into_pyobject(py)?;
        Ok((slf.get_type().into_any(), arguments.into_any()))
    }
}

fn check_divisions(divisions: &[usize]) -> PyResult<()> {
    match divisions.contains(&0) {
        true => Err(PyValueError::new_err("a mesh is cut into at least one piece along every axis")),
        false => Ok(()),
    }
}

#[pymethods]
impl PyTetMesh {
    /// Tetrahedra from arrays: `nodes` [m] of shape (n, 3), `cells` of shape (m, 4), and by name the nodes of regions, or dicts
    /// of their `nodes`, `cells` and `faces`. What is wrong with the shapes of cells is found by `checked`, and by a body.
    #[new]
    #[pyo3(signature = (nodes, cells, regions=None))]
    fn new(
        nodes: Numbers<'_>,
        cells: &Bound<'_, PyAny>,
        regions: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let mut mesh = TetMesh::new(vectors(&nodes, "nodes")?, index_rows(cells, "cells")?);
        mesh.check_indices().or_raise()?;
        mesh.regions = named(regions, mesh.nodes.len(), mesh.cells.len())?;
        Ok(PyClassInitializer::from(PyVolumeMesh::new(Arc::new(mesh.into()))).add_subclass(Self))
    }

    /// A box from the origin, cut into `cells` cubes of six (or five) tetrahedra each; sides of `size` [m]. Regions: "x-min",
    /// "x-max", … "z-max".
    #[staticmethod]
    #[pyo3(signature = (cells, size, cut="six"))]
    fn box_grid(py: Python<'_>, cells: [usize; 3], size: [f64; 3], cut: &str) -> PyResult<Py<PyAny>> {
        check_divisions(&cells)?;
        let cut = match cut {
            "six" => CubeCut::Six,
            "five" => CubeCut::Five,
            other => return Err(PyValueError::new_err(format!("cut = `{other}`: there are `six` and `five`"))),
        };
        mesh_object(py, VolumeMesh::from(TetMesh::box_grid_cut(cells, size, cut)))
    }

    /// A solid cylinder of `radius` and `height` [m] that stands on the origin along z. Regions: "bottom", "top", "side".
    #[staticmethod]
    fn cylinder(py: Python<'_>, radius: f64, height: f64, rings: usize, layers: usize) -> PyResult<Py<PyAny>> {
        mesh_object(py, VolumeMesh::from(TetMesh::cylinder(radius, height, rings, layers).or_raise()?))
    }

    /// A tube [m] that stands on the origin along z, in so many pieces. Regions: "bottom", "top", "inner", "outer".
    #[staticmethod]
    fn tube(
        py: Python<'_>,
        inner_radius: f64,
        outer_radius: f64,
        height: f64,
        around: usize,
        wall: usize,
        along: usize,
    ) -> PyResult<Py<PyAny>> {
        let divisions = TubeDivisions { around, wall, along };
        mesh_object(py, VolumeMesh::from(TetMesh::tube(inner_radius, outer_radius, height, divisions).or_raise()?))
    }

    /// An organ like a liver with two lobes, around the origin: `length` from lobe to lobe [m], tetrahedra of `edge` [m].
    #[staticmethod]
    fn liver(py: Python<'_>, length: f64, edge: f64) -> PyResult<Py<PyAny>> {
        let mesh = py.detach(|| TetMesh::liver(length, edge)).or_raise()?;
        mesh_object(py, VolumeMesh::from(mesh))
    }

    /// An upright trunk of `height` [m] in tetrahedra of about `edge` [m], with abdomen, thorax, diaphragm and ribs as regions.
    #[staticmethod]
    fn trunk(py: Python<'_>, height: f64, edge: f64) -> PyResult<Py<PyAny>> {
        let mesh = py.detach(|| TetMesh::trunk(height, edge)).or_raise()?;
        mesh_object(py, VolumeMesh::from(mesh))
    }

    /// A closed surface filled with tetrahedra of about `edge` [m], after mending what can be mended; its skin is new. `filled` says as well
    /// how much of the surface the mesh holds. Raises `SurfaceRefused` for one with holes.
    #[staticmethod]
    fn from_surface(py: Python<'_>, surface: &PySurfaceMesh, edge: f64) -> PyResult<Py<PyAny>> {
        Ok(Self::filled(py, surface, edge)?.0)
    }

    /// `from_surface`, and what became of the surface: volume lost, thin parts, pieces.
    #[staticmethod]
    fn filled(py: Python<'_>, surface: &PySurfaceMesh, edge: f64) -> PyResult<(Py<PyAny>, PyFillingReport)> {
        let (mesh, report) = py.detach(|| TetMesh::from_surface(&surface.mesh, edge)).or_raise()?;
        Ok((mesh_object(py, VolumeMesh::from(mesh))?, PyFillingReport(report)))
    }
}

#[pymethods]
impl PyHexMesh {
    /// Hexahedra from arrays, as `TetMesh`: `cells` of shape (m, 8).
    #[new]
    #[pyo3(signature = (nodes, cells, regions=None))]
    fn new(
        nodes: Numbers<'_>,
        cells: &Bound<'_, PyAny>,
        regions: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let mut mesh = HexMesh::new(vectors(&nodes, "nodes")?, index_rows(cells, "cells")?);
        mesh.check_indices().or_raise()?;
        mesh.regions = named(regions, mesh.nodes.len(), mesh.cells.len())?;
        Ok(PyClassInitializer::from(PyVolumeMesh::new(Arc::new(mesh.into()))).add_subclass(Self))
    }

    /// A box from the origin of `cells` hexahedra, sides of `size` [m]. Regions: "x-min", "x-max", … "z-max".
    #[staticmethod]
    fn box_grid(py: Python<'_>, cells: [usize; 3], size: [f64; 3]) -> PyResult<Py<PyAny>> {
        check_divisions(&cells)?;
        mesh_object(py, VolumeMesh::from(HexMesh::box_grid(cells, size)))
    }
}

/// Reads a mesh file: Gmsh (MSH 1, 2.2, 4.1), VTK, VTU, STL or OBJ. `scale` is the file's unit [m], 0.001 for mm. Volumes are
/// checked and repaired. Gives the mesh, and what of the file is not in it or was mended.
#[pyfunction]
#[pyo3(name = "read_mesh", signature = (path, scale=1.0))]
pub(crate) fn read(py: Python<'_>, path: PathBuf, scale: f64) -> PyResult<(Py<PyAny>, Vec<String>)> {
    let read = py.detach(|| read_mesh(&path, scale)).or_raise()?;
    if let ImportedMesh::Surface(surface) = read.mesh {
        let notices = read.notices.iter().map(ToString::to_string).collect();
        return Ok((Py::new(py, PySurfaceMesh::new(surface))?.into_any(), notices));
    }
    let read = py.detach(|| read_volume(&path, scale)).or_raise()?;
    let notices = read.notices.iter().map(ToString::to_string).chain([read.report.to_string()]).collect();
    Ok((mesh_object(py, read.mesh)?, notices))
}
