//! `viscera-peers CASE serve` is the driver; `mesh X Y Z` prints a mesh, `reference X Y Z` the equilibria on it.

use std::path::Path;

use serde_json::{Map, Value, json};
use viscera_peers::{Reference, Viscera, deflection, mesh};
use viscera_peers_protocol::{Case, Failure, serve};

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, task, cells @ ..] = arguments.as_slice() else {
        return Err("say: CASE serve, CASE mesh X Y Z, or CASE reference X Y Z".into());
    };
    let case = Case::read(Path::new(case))?;
    if task == "serve" {
        return serve(&Viscera, &case);
    }
    let cells = cells.iter().map(|number| number.parse()).collect::<Result<Vec<usize>, _>>()?;
    let mesh = mesh(&case, cells.try_into().map_err(|_| "a mesh has three numbers of cubes")?);
    match task.as_str() {
        "mesh" => print!("{}", mesh.text()),
        "reference" => {
            let mut found = Map::new();
            for reference in Reference::ALL {
                let answer = match deflection(&case, &mesh, reference) {
                    Ok(tip) => json!(tip),
                    Err(failure) => json!({ "error": failure.to_string() }),
                };
                found.insert(reference.name().into(), answer);
            }
            println!("{}", Value::Object(found));
        }
        other => return Err(format!("no such task: {other}").into()),
    }
    Ok(())
}
