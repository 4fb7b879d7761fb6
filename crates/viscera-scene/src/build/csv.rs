//! Tables of numbers: curves along time, directions of fibres.

use std::path::Path;

use super::site::Site;
use crate::error::SceneErrors;
use crate::unit::Dimension;

/// The rows of a file with one column for each of `columns`, in SI; `None` is a number without a unit.
///
/// Separators are commas, semicolons or tabs; empty lines and those that begin with `#` mean nothing. A first row of
/// names may carry units in brackets: `time [ms], x [mm], y [mm], z [mm]`.
pub(super) fn read(
    site: &Site,
    file: &Path,
    columns: &[Option<&'static Dimension>],
) -> Result<Vec<Vec<f64>>, SceneErrors> {
    let path = site.path(file);
    let unreadable = |error: &dyn std::fmt::Display| {
        site.error(format!("cannot read {}: {error}", path.display()), "the path starts at the scene file's folder")
    };
    let bytes = site.read(file).map_err(|error| unreadable(&error))?;
    let text = std::str::from_utf8(&bytes).map_err(|error| unreadable(&error))?;
    parse(text, columns)
        .map_err(|(line, problem)| site.error(format!("{}, line {line}: {problem}", path.display()), ""))
}

/// The rows, or the line (from 1) that is wrong and what is wrong with it.
pub(super) fn parse(text: &str, columns: &[Option<&'static Dimension>]) -> Result<Vec<Vec<f64>>, (usize, String)> {
    let mut factors = vec![1.0; columns.len()];
    let mut rows = Vec::new();
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    for (line, content) in lines.filter(|(_, content)| !content.is_empty() && !content.starts_with('#')) {
        let fields: Vec<&str> = content.split([',', ';', '\t']).map(str::trim).collect();
        if fields.len() != columns.len() {
            return Err((line, format!("expected {} columns, found {}", columns.len(), fields.len())));
        }
        let is_heading = rows.is_empty() && fields[0].parse::<f64>().is_err();
        for (index, field) in fields.iter().enumerate().filter(|_| is_heading) {
            factors[index] = heading_factor(field, columns[index]).map_err(|problem| (line, problem))?;
        }
        if is_heading {
            continue;
        }
        let numbers = fields.iter().zip(&factors).map(|(field, factor)| match field.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number * factor),
            _ => Err((line, format!("`{field}` is not a finite number"))),
        });
        rows.push(numbers.collect::<Result<_, _>>()?);
    }
    if rows.is_empty() { Err((text.lines().count().max(1), "the file holds no numbers".into())) } else { Ok(rows) }
}

/// What a column's numbers are multiplied with: the unit in the brackets of its name.
fn heading_factor(name: &str, dimension: Option<&Dimension>) -> Result<f64, String> {
    let unit = name.split_once('[').and_then(|(_, rest)| rest.split_once(']')).map(|(unit, _)| unit);
    match (unit, dimension) {
        (Some(unit), Some(dimension)) => dimension.parse(&format!("1 {unit}")).map_err(|error| error.to_string()),
        (Some(unit), None) => Err(format!("the column `{name}` is a plain number, without the unit `{unit}`")),
        (None, _) => Ok(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::{LENGTH, TIME};

    #[test]
    fn units_stand_in_the_first_row() {
        let rows = parse("# a path\n\ntime [ms]; x [cm]\n500; 2\n1000; -3.5\n", &[Some(&TIME), Some(&LENGTH)]);
        assert_eq!(rows, Ok(vec![vec![0.5, 0.02], vec![1.0, -0.035]]));
        assert_eq!(parse("0,1\n", &[Some(&TIME), Some(&LENGTH)]), Ok(vec![vec![0.0, 1.0]]), "SI without a first row");
    }

    #[test]
    fn a_wrong_row_is_named_by_its_line() {
        let refusal = |text: &str| parse(text, &[Some(&TIME), Some(&LENGTH)]).unwrap_err();
        assert_eq!(refusal("0,1\n1\n"), (2, "expected 2 columns, found 1".into()));
        assert_eq!(refusal("0,1\n1,two\n"), (2, "`two` is not a finite number".into()));
        assert_eq!(refusal("0,1\n1,nan\n"), (2, "`nan` is not a finite number".into()));
        assert_eq!(refusal("t [s], x [N]\n"), (1, "expected a length, found the force \"1 N\"".into()));
        assert_eq!(refusal("# nothing\n"), (1, "the file holds no numbers".into()));
    }
}
