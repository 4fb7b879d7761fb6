use viscera::model::Precision;
use viscera_scene::file::Precision as Wanted;
use viscera_scene::{BuiltScene, Scene, SceneErrors};

use crate::failure::Failure;
use crate::interrupt::Interrupt;

/// One run of the scene: what is changed in it, key by key.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Case {
    changes: Vec<(String, String)>,
}

/// What came of a case: columns and their texts, the changes first.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) columns: Vec<(String, String)>,
    /// Why it did not go to its end.
    error: Option<String>,
}

/// All combinations of the values, the last key's changing fastest. Each of `vary` is KEY=VALUE,VALUE,….
pub(super) fn cases(vary: &[String]) -> Result<Vec<Case>, Failure> {
    let mut cases = vec![Case { changes: Vec::new() }];
    for entry in vary {
        let (key, values) = entry.split_once('=').ok_or_else(|| {
            Failure::input(format!(
                "--vary {entry}: there is no `=`; write it as --vary body.liver.law.young=\"4 kPa,8 kPa\""
            ))
        })?;
        let values = split(values);
        let with = |case: &Case, value: &String| {
            let mut changes = case.changes.clone();
            changes.push((key.trim().to_owned(), value.clone()));
            Case { changes }
        };
        cases = cases.iter().flat_map(|case| values.iter().map(move |value| with(case, value))).collect();
    }
    Ok(cases)
}

/// Parts between commas, but for those in brackets and quotes.
fn split(list: &str) -> Vec<String> {
    let (mut parts, mut depth, mut quoted) = (vec![String::new()], 0_i32, false);
    for letter in list.chars() {
        match letter {
            '"' => quoted = !quoted,
            '[' | '{' if !quoted => depth += 1,
            ']' | '}' if !quoted => depth -= 1,
            _ => {}
        }
        if letter == ',' && depth == 0 && !quoted {
            parts.push(String::new());
        } else {
            parts.last_mut().into_iter().for_each(|part| part.push(letter));
        }
    }
    parts.into_iter().map(|part| part.trim().to_owned()).collect()
}

impl Case {
    /// The scene with the changes of this case.
    pub(super) fn change(&self, scene: &Scene) -> Result<Scene, SceneErrors> {
        let mut scene = scene.clone();
        self.changes.iter().try_for_each(|(key, value)| scene.set(key, value))?;
        Ok(scene)
    }

    /// Runs the case to its end; nothing if the user stopped it.
    pub(super) fn run(&self, scene: &Scene, interrupt: &Interrupt) -> Option<Row> {
        let outcome = self.change(scene).and_then(|scene| scene.check().map(|file| (scene, file)));
        let measured = match outcome {
            Err(error) => Err(error.to_string()),
            Ok((scene, file)) => match file.precision {
                Wanted::Single => play::<f32>(&scene, interrupt)?,
                Wanted::Double => play::<f64>(&scene, interrupt)?,
            },
        };
        let mut columns = self.changes.clone();
        let (time, error, measured) = match measured {
            Ok((time, measured)) => (time.to_string(), None, measured),
            Err(error) => (String::new(), Some(error), Vec::new()),
        };
        columns.push(("time".into(), time));
        columns.push(("error".into(), error.clone().unwrap_or_default()));
        columns.extend(measured.into_iter().map(|(name, value)| (name, value.to_string())));
        Some(Row { columns, error })
    }
}

impl Row {
    /// In a line, for a person.
    pub(super) fn summary(&self) -> String {
        let changes = self.columns.iter().take_while(|(name, _)| name != "time");
        let changes: Vec<_> = changes.map(|(key, value)| format!("{key} = {value}")).collect();
        format!("{}{}", changes.join(", "), self.error.as_ref().map_or(String::new(), |error| format!(": {error}")))
    }
}

/// The time at the end [s], and what was measured there; or why a step was not made.
type Measured = Result<(f64, Vec<(String, f64)>), String>;

fn play<T: Precision>(scene: &Scene, interrupt: &Interrupt) -> Option<Measured> {
    let mut built = match scene.build::<T>() {
        Ok(built) => built,
        Err(error) => return Some(Err(error.to_string())),
    };
    for _ in 0..built.steps() {
        if interrupt.is_asked() {
            return None;
        }
        if let Err(error) = built.world.step() {
            return Some(Err(error.to_string()));
        }
    }
    Some(Ok((built.world.time(), measure(&mut built))))
}

/// Numbers of every body and instrument, by name.
fn measure<T: Precision>(built: &mut BuiltScene<T>) -> Vec<(String, f64)> {
    let mut row = Vec::new();
    for (name, &id) in &built.bodies {
        let seen = built.world.observe(id);
        let [x, y, z] = seen.reaction.to_array();
        let columns = [
            ("kinetic energy [J]", seen.kinetic_energy),
            ("elastic energy [J]", seen.elastic_energy),
            ("volume variation [1]", seen.volume_variation),
            ("max displacement [m]", seen.max_displacement),
            ("reaction x [N]", x),
            ("reaction y [N]", y),
            ("reaction z [N]", z),
            ("removed cells [1]", seen.removed_cells as f64),
            ("inverted cells [1]", seen.inverted_cells as f64),
        ];
        row.extend(columns.map(|(column, value)| (format!("{name}: {column}"), value)));
    }
    for (name, &id) in &built.instruments {
        let force = built.world.observe_instrument(id).force.to_array();
        row.extend(
            ["x", "y", "z"].into_iter().zip(force).map(|(axis, value)| (format!("{name}: force {axis} [N]"), value)),
        );
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_combine_with_the_last_key_fastest_and_lists_stay_whole() {
        let vary = ["a.young=2 kPa, 4 kPa".to_owned(), "gravity=[0, -1, 0],[0, -2, 0]".to_owned()];
        let cases = cases(&vary).map_err(|failure| failure.to_string()).unwrap();
        let texts: Vec<_> =
            cases.iter().map(|case| case.changes.iter().map(|(_, value)| value.as_str()).collect::<Vec<_>>()).collect();
        assert_eq!(
            texts,
            [["2 kPa", "[0, -1, 0]"], ["2 kPa", "[0, -2, 0]"], ["4 kPa", "[0, -1, 0]"], ["4 kPa", "[0, -2, 0]"]]
        );
    }
}
