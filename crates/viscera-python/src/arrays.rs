//! numpy arrays in and out: rows of three numbers are vectors, rows of nine are matrices.

use numpy::ndarray::{Array1, Array2, Array3, ArrayViewD};
use numpy::{AllowTypeChange, Element, PyArray1, PyArray2, PyArray3, PyArrayLikeDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use viscera::math::{Mat3, Scalar, Vec3};

/// Numbers of any type, shape and stride, as `f64`.
pub(crate) type Numbers<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;

/// A precision that numpy knows as well.
pub(crate) trait NumpyScalar: Scalar + Element {}
impl NumpyScalar for f32 {}
impl NumpyScalar for f64 {}

fn wrong_shape(what: &str, wanted: &str, given: &[usize]) -> PyErr {
    PyValueError::new_err(format!("{what} must have shape {wanted}, and has {given:?}"))
}

/// One vector for each row of an array of shape (n, 3).
pub(crate) fn vectors(numbers: &Numbers<'_>, what: &str) -> PyResult<Vec<Vec3<f64>>> {
    let view = numbers.as_array();
    match view.shape() {
        [_, 3] => Ok(rows(&view).map(|row| Vec3::new(row[0], row[1], row[2])).collect()),
        shape => Err(wrong_shape(what, "(n, 3)", shape)),
    }
}

/// The same for a known count.
pub(crate) fn vectors_of(numbers: &Numbers<'_>, what: &str, count: usize) -> PyResult<Vec<Vec3<f64>>> {
    let given = vectors(numbers, what)?;
    if given.len() == count {
        Ok(given)
    } else {
        Err(wrong_shape(what, &format!("({count}, 3), one row for each node"), numbers.as_array().shape()))
    }
}

fn rows<'a>(view: &'a ArrayViewD<'_, f64>) -> impl Iterator<Item = Vec<f64>> + 'a {
    view.outer_iter().map(|row| row.iter().copied().collect())
}

/// Matrices of an array of shape (3, 3) or (n, 3, 3).
pub(crate) fn matrices(numbers: &Numbers<'_>, what: &str) -> PyResult<Vec<Mat3<f64>>> {
    let view = numbers.as_array();
    let matrix = |m: &ArrayViewD<'_, f64>| {
        Mat3::from_columns(
            Vec3::new(m[[0, 0]], m[[1, 0]], m[[2, 0]]),
            Vec3::new(m[[0, 1]], m[[1, 1]], m[[2, 1]]),
            Vec3::new(m[[0, 2]], m[[1, 2]], m[[2, 2]]),
        )
    };
    match view.shape() {
        [3, 3] => Ok(vec![matrix(&view)]),
        [_, 3, 3] => Ok(view.outer_iter().map(|m| matrix(&m)).collect()),
        shape => Err(wrong_shape(what, "(3, 3) or (n, 3, 3)", shape)),
    }
}

/// An array of shape (n,) or one number, as a list.
pub(crate) fn scalars(numbers: &Numbers<'_>, what: &str) -> PyResult<Vec<f64>> {
    let view = numbers.as_array();
    match view.shape() {
        [] | [_] => Ok(view.iter().copied().collect()),
        shape => Err(wrong_shape(what, "(n,)", shape)),
    }
}

/// A new array of shape (n, 3).
pub(crate) fn vector_array<'py, T: NumpyScalar>(py: Python<'py>, vectors: &[Vec3<T>]) -> Bound<'py, PyArray2<T>> {
    let number = |(row, column): (usize, usize)| vectors[row].to_array()[column];
    PyArray2::from_owned_array(py, Array2::from_shape_fn((vectors.len(), 3), number))
}

/// A new array of shape (n, 3, 3), entry [k, i, j] in row i and column j of matrix k.
pub(crate) fn matrix_array<'py>(py: Python<'py>, matrices: &[Mat3<f64>]) -> Bound<'py, PyArray3<f64>> {
    let entry = |(k, i, j): (usize, usize, usize)| matrices[k].columns[j].to_array()[i];
    PyArray3::from_owned_array(py, Array3::from_shape_fn((matrices.len(), 3, 3), entry))
}

/// A new array of shape (n, N) of whole numbers.
pub(crate) fn index_array<'py, const N: usize>(
    py: Python<'py>,
    rows: impl ExactSizeIterator<Item = [u32; N]>,
) -> Bound<'py, PyArray2<u32>> {
    let rows: Vec<[u32; N]> = rows.collect();
    PyArray2::from_owned_array(py, Array2::from_shape_fn((rows.len(), N), |(i, j)| rows[i][j]))
}

/// A new array of shape (n,).
pub(crate) fn list_array<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_owned_array(py, Array1::from_vec(values))
}

/// The array, closed for writing.
pub(crate) fn read_only<'py, D>(array: &Bound<'py, numpy::PyArray<D, impl numpy::ndarray::Dimension>>) -> PyResult<()>
where
    D: Element,
{
    array.as_any().getattr("flags")?.setattr("writeable", false)
}

/// Rows of whole numbers of an array of shape (n, N).
pub(crate) fn index_rows<const N: usize>(
    numbers: &PyArrayLikeDyn<'_, i64, AllowTypeChange>,
    what: &str,
) -> PyResult<Vec<[u32; N]>> {
    let view = numbers.as_array();
    if view.ndim() != 2 || view.shape()[1] != N {
        return Err(wrong_shape(what, &format!("(n, {N})"), view.shape()));
    }
    let number = |&value: &i64| {
        u32::try_from(value).map_err(|_| PyValueError::new_err(format!("{what} holds {value}, which numbers no node")))
    };
    let row = |row: numpy::ndarray::ArrayViewD<'_, i64>| -> PyResult<[u32; N]> {
        let mut corners = [0; N];
        for (corner, value) in corners.iter_mut().zip(row.iter()) {
            *corner = number(value)?;
        }
        Ok(corners)
    };
    view.outer_iter().map(row).collect()
}
