//! numpy arrays in and out: rows of three numbers are vectors, rows of nine are matrices.

use numpy::ndarray::{Array1, Array2, Array3, ArrayViewD, Dimension};
use numpy::{
    AllowTypeChange, Element, PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayLikeDyn, PyArrayMethods,
    PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::{Borrowed, FromPyObject};
use viscera::math::{Mat3, Scalar, Vec3};

/// Numbers of any type, shape, stride and alignment, as `f64`.
pub(crate) struct Numbers<'py>(PyReadonlyArrayDyn<'py, f64>);

impl Numbers<'_> {
    pub(crate) fn as_array(&self) -> ArrayViewD<'_, f64> {
        self.0.as_array()
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Numbers<'py> {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let numbers: PyArrayLikeDyn<'py, f64, AllowTypeChange> = given.extract()?;
        let array: &Bound<'py, PyArrayDyn<f64>> = &numbers;
        // A field of a record steps by the bytes of the whole record: what is no multiple of a number's size, or begins between two
        // numbers, cannot be looked at where it is.
        let size = size_of::<f64>();
        let in_steps = array.strides().iter().all(|stride| stride.unsigned_abs().is_multiple_of(size));
        if in_steps && array.data().is_aligned() {
            return Ok(Self((*numbers).clone()));
        }
        let copy = array.call_method0("copy")?.cast_into::<PyArrayDyn<f64>>()?;
        Ok(Self(copy.readonly()))
    }
}

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

/// Whole numbers of any type, shape, stride and alignment; refused are fractions, which numpy would cut off, and masks.
fn whole<'py>(given: &Bound<'py, PyAny>, what: &str) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let array = given.py().import("numpy")?.call_method1("asarray", (given,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    match kind.as_str() {
        "i" | "u" => {}
        "f" | "O" => all_whole(&array.extract()?, what)?,
        "b" => {
            return Err(PyTypeError::new_err(format!(
                "{what} is a mask of True and False, and must hold whole numbers; numpy.flatnonzero makes them of it"
            )));
        }
        _ => {
            let kind = array.getattr("dtype")?;
            return Err(PyTypeError::new_err(format!("{what} must hold whole numbers, and holds {kind}")));
        }
    }
    Ok(array.call_method1("astype", ("int64",))?.cast_into::<PyArrayDyn<i64>>()?.readonly())
}

/// Refuses the first number that is none of those that floats count exactly.
fn all_whole(numbers: &Numbers<'_>, what: &str) -> PyResult<()> {
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    let view = numbers.as_array();
    let fraction = view.indexed_iter().find(|(_, value)| value.fract() != 0.0 || value.abs() > LARGEST);
    match fraction {
        None => Ok(()),
        Some((place, value)) => Err(PyValueError::new_err(format!(
            "{what} holds {value:?} at {:?}, which is no whole number; round it where it is made, or give an array of integers",
            place.slice()
        ))),
    }
}

/// A list of whole numbers from an array of any shape.
pub(crate) fn indices(given: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<u32>> {
    whole(given, what)?.as_array().iter().map(|&value| index(value, what, "is no number of one")).collect()
}

fn index(value: i64, what: &str, fault: &str) -> PyResult<u32> {
    u32::try_from(value).map_err(|_| PyValueError::new_err(format!("{what} holds {value}, which {fault}")))
}

/// Rows of whole numbers of an array of shape (n, N).
pub(crate) fn index_rows<const N: usize>(given: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<[u32; N]>> {
    let numbers = whole(given, what)?;
    let view = numbers.as_array();
    if view.ndim() != 2 || view.shape()[1] != N {
        return Err(wrong_shape(what, &format!("(n, {N})"), view.shape()));
    }
    let row = |row: ArrayViewD<'_, i64>| -> PyResult<[u32; N]> {
        let mut corners = [0; N];
        for (corner, &value) in corners.iter_mut().zip(row.iter()) {
            *corner = index(value, what, "numbers no node")?;
        }
        Ok(corners)
    };
    view.outer_iter().map(row).collect()
}
