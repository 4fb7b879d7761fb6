//! Surfaces: skins to be filled, and skins to be seen.

use numpy::PyArray2;
use pyo3::prelude::*;
use viscera::mesh::SurfaceMesh;

use crate::arrays::{Numbers, index_array, index_rows, vector_array, vectors};
use crate::error::OrRaise;

/// Triangles in space: the skin of an organ.
#[pyclass(frozen, name = "SurfaceMesh", module = "viscera")]
pub(crate) struct PySurfaceMesh {
    pub(crate) mesh: SurfaceMesh,
}

impl PySurfaceMesh {
    pub(crate) fn new(mesh: SurfaceMesh) -> Self {
        Self { mesh }
    }
}

#[pymethods]
impl PySurfaceMesh {
    /// From arrays: `nodes` [m] of shape (n, 3), `triangles` of shape (m, 3), counter-clockwise seen from outside.
    #[new]
    fn from_arrays(nodes: Numbers<'_>, triangles: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mesh = SurfaceMesh { nodes: vectors(&nodes, "nodes")?, triangles: index_rows(triangles, "triangles")? };
        mesh.check().or_raise()?;
        Ok(Self { mesh })
    }

    /// Positions [m]; shape (n, 3).
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        vector_array(py, &self.mesh.nodes)
    }

    /// Corners of the triangles; shape (n, 3), uint32.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<u32>> {
        index_array(py, self.mesh.triangles.iter().copied())
    }

    /// Area [m²].
    #[getter]
    fn area(&self) -> f64 {
        self.mesh.area()
    }

    /// Volume enclosed, if the surface is closed and oriented outwards [m³].
    #[getter]
    fn enclosed_volume(&self) -> f64 {
        self.mesh.enclosed_volume()
    }

    /// What was found: holes, edges of more than two triangles, corners at one place.
    fn check(&self) -> PyResult<String> {
        self.mesh.check().or_raise().map(|report| report.to_string())
    }

    /// The surface with its corners welded and its triangles turned outwards, and what was found.
    fn repaired(&self) -> PyResult<(Self, String)> {
        let (mesh, report) = self.mesh.repaired().or_raise()?;
        Ok((Self { mesh }, report.to_string()))
    }

    fn __len__(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn __repr__(&self) -> String {
        format!("<surface of {} triangles on {} nodes>", self.mesh.triangles.len(), self.mesh.nodes.len())
    }
}
