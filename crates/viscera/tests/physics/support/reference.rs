//! Reads reference cases and their meshes (Gmsh 2.2, text, tetrahedra or hexahedra).

use serde_json::Value;
use viscera::material::{Lame, LinearElastic, StVenantKirchhoff, Tissue, TransverseStVenantKirchhoff};
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};

use super::{Matrix, Vector};

/// A case.
pub(crate) struct Reference {
    pub(crate) data: Value,
}

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/references");

fn text(file: &str) -> String {
    std::fs::read_to_string(format!("{FOLDER}/{file}")).unwrap()
}

impl Reference {
    pub(crate) fn read(case: &str) -> Self {
        Self { data: serde_json::from_str(&text(&format!("{case}.json"))).unwrap() }
    }

    /// The tolerance that the case states.
    pub(crate) fn tolerance(&self) -> f64 {
        number(&self.data["tolerance"]["relative"])
    }

    /// The mesh that the case names.
    pub(crate) fn mesh(&self) -> VolumeMesh {
        parse_mesh(&text(self.data["mesh"]["file"].as_str().unwrap()))
    }

    /// The material of the case under the law `model`: `linear`, `stvk` or `ti_stvk`.
    pub(crate) fn tissue(&self, model: &str) -> Tissue {
        let material = &self.data["material"];
        let transverse = Lame::new(number(&material["lambda_Pa"]), number(&material["mu_Pa"])).unwrap();
        match model {
            "linear" => Tissue::uniform(LinearElastic::new(transverse)),
            "stvk" => Tissue::uniform(StVenantKirchhoff::new(transverse)),
            "ti_stvk" => {
                let longitudinal = Lame::new(number(&material["lambdaL_Pa"]), number(&material["muL_Pa"])).unwrap();
                let direction = vector(&material["a0"]).to_array();
                Tissue::uniform(TransverseStVenantKirchhoff::new(transverse, direction, longitudinal).unwrap())
            }
            _ => panic!("no law `{model}` in the references"),
        }
    }
}

/// A number of the file.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Three numbers.
pub(crate) fn vector(value: &Value) -> Vector {
    Vector::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// A list of vectors.
pub(crate) fn vectors(value: &Value) -> Vec<Vector> {
    value.as_array().unwrap().iter().map(vector).collect()
}

/// Three rows of three numbers.
pub(crate) fn matrix(value: &Value) -> Matrix {
    Matrix::from_rows(vector(&value[0]), vector(&value[1]), vector(&value[2]))
}

fn parse_mesh(text: &str) -> VolumeMesh {
    let section = |name: &'static str| {
        let lines = text.lines().skip_while(move |line| *line != name).skip(2);
        lines.take_while(|line| !line.starts_with('$')).map(|line| line.split_whitespace().collect::<Vec<_>>())
    };
    let nodes = section("$Nodes").map(|words| Vector::from([1, 2, 3].map(|i| words[i].parse().unwrap()))).collect();
    let (mut tets, mut hexes) = (Vec::new(), Vec::new());
    for words in section("$Elements") {
        let numbers: Vec<u32> = words.iter().map(|word| word.parse().unwrap()).collect();
        let corners: Vec<u32> = numbers[3 + numbers[2] as usize..].iter().map(|node| node - 1).collect();
        match numbers[1] {
            4 => tets.push(corners.try_into().unwrap()),
            5 => hexes.push(corners.try_into().unwrap()),
            _ => {}
        }
    }
    if hexes.is_empty() { TetMesh::new(nodes, tets).into() } else { HexMesh::new(nodes, hexes).into() }
}
