//! Reads reference cases and their meshes of tetrahedra (Gmsh 2.2, text).

use serde_json::Value;
use viscera::mesh::TetMesh;

use super::Vector;

/// A case.
pub(crate) struct Reference {
    pub(crate) data: Value,
}

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/references");

impl Reference {
    pub(crate) fn read(case: &str) -> Self {
        Self { data: serde_json::from_str(&text(&format!("{case}.json"))).unwrap() }
    }

    /// The mesh that the case names.
    pub(crate) fn mesh(&self) -> TetMesh {
        let text = text(self.data["mesh"]["file"].as_str().unwrap());
        let section = |name: &'static str| {
            let lines = text.lines().skip_while(move |line| *line != name).skip(2);
            lines.take_while(|line| !line.starts_with('$')).map(|line| line.split_whitespace().collect::<Vec<_>>())
        };
        let nodes = section("$Nodes").map(|words| Vector::from([1, 2, 3].map(|i| words[i].parse().unwrap()))).collect();
        let tetrahedra = section("$Elements").filter(|words| words[1] == "4").map(|words| {
            let last = words.len() - 4;
            std::array::from_fn(|corner| words[last + corner].parse::<u32>().unwrap() - 1)
        });
        TetMesh::new(nodes, tetrahedra.collect())
    }
}

fn text(file: &str) -> String {
    std::fs::read_to_string(format!("{FOLDER}/{file}")).unwrap()
}

/// A number of the file.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Node numbers of the file.
pub(crate) fn numbers(value: &Value) -> Vec<u32> {
    value.as_array().unwrap().iter().map(|value| value.as_u64().unwrap() as u32).collect()
}

/// Three numbers.
pub(crate) fn vector(value: &Value) -> Vector {
    Vector::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// A list of vectors.
pub(crate) fn vectors(value: &Value) -> Vec<Vector> {
    value.as_array().unwrap().iter().map(vector).collect()
}
