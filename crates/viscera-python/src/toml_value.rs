//! Values of Python's in the words of scene files.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyMapping, PySequence, PyString};

/// The value as TOML. Texts stand in quotes; numpy's numbers and arrays are what `tolist` makes of them.
pub(crate) fn toml(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(quoted(&text.to_cow()?));
    }
    if value.hasattr("tolist")? {
        return toml(&value.call_method0("tolist")?);
    }
    if value.hasattr("__fspath__")? {
        return Ok(quoted(&value.call_method0("__fspath__")?.extract::<String>()?));
    }
    if let Ok(truth) = value.cast::<PyBool>() {
        return Ok(truth.is_true().to_string());
    }
    if value.is_instance_of::<PyInt>() {
        return value.call_method0("__int__")?.str()?.extract();
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        // Rust writes NaN where TOML has nan.
        return Ok(format!("{:?}", number.value()).to_lowercase());
    }
    if let Ok(table) = value.cast::<PyMapping>() {
        let mut entries = Vec::new();
        for entry in table.items()?.iter() {
            let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = entry.extract()?;
            let key = key.cast::<PyString>().map_err(|_| {
                PyTypeError::new_err(format!("the key {key} is no text: keys of a scene are names, such as \"young\""))
            })?;
            entries.push(format!("{} = {}", quoted(&key.to_cow()?), toml(&value)?));
        }
        return Ok(format!("{{ {} }}", entries.join(", ")));
    }
    if let Ok(list) = value.cast::<PySequence>() {
        let items = list.try_iter()?.map(|item| toml(&item?)).collect::<PyResult<Vec<_>>>()?;
        return Ok(format!("[{}]", items.join(", ")));
    }
    if value.is_none() {
        return Err(PyValueError::new_err(
            "None is no value of a scene: leave the key as it is, or give what it shall be",
        ));
    }
    let kind = value.get_type().qualname()?;
    Err(PyTypeError::new_err(format!(
        "a scene has no words for {} of type {kind}: give numbers, texts, truth values, lists, dicts or numpy arrays",
        value.repr()?
    )))
}

/// A basic string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            control if control.is_control() => quoted += &format!("\\u{:04x}", u32::from(control)),
            other => quoted.push(other),
        }
    }
    quoted.push('"');
    quoted
}
