//! What a model cannot compute it refuses, and the message says what to do.

use viscera::material::{LawKind, StVenantKirchhoff, Tissue};
use viscera::mesh::{TetMesh, VolumeMesh};
use viscera::model::{ModelKind, ModelRecipe, TensorMass, VolumePenalty};

use crate::support::{Random, Vector, examples, hex_mesh, tet_mesh, uneven};

fn refusal(kind: ModelKind, tissue: &Tissue, mesh: &VolumeMesh) -> Option<String> {
    kind.recipe(tissue.clone()).build_double(mesh).err().map(|error| error.to_string())
}

/// The list of laws and cells that a model publishes is what it accepts.
#[test]
fn models_accept_what_they_list_and_nothing_else() {
    let (tets, hexes) = (VolumeMesh::from(tet_mesh([1, 1, 1])), VolumeMesh::from(hex_mesh([1, 1, 1])));
    for &kind in ModelKind::ALL {
        for (tissue, _) in examples() {
            let able = kind.info().laws.contains(&tissue.kind());
            assert_eq!(refusal(kind, &tissue, &tets).is_none(), able, "{kind} with {}", tissue.kind());
            let able = able && kind.info().hexahedra;
            assert_eq!(refusal(kind, &tissue, &hexes).is_none(), able, "{kind} with {} on hexahedra", tissue.kind());
        }
    }
}

/// Every refusal names the model and the law, and an existing way out.
#[test]
fn refusals_say_what_to_take_instead() {
    let tets = VolumeMesh::from(tet_mesh([1, 1, 1]));
    for &kind in ModelKind::ALL {
        for (tissue, _) in examples() {
            let Some(message) = refusal(kind, &tissue, &tets) else { continue };
            assert!(
                message.contains(&format!("`{kind}`")) && message.contains(&format!("`{}`", tissue.kind())),
                "{message}"
            );
            let (_, advice) = message.split_once(": ").unwrap();
            let known = |name: &str| {
                ModelKind::ALL.iter().any(|kind| kind.info().name == name)
                    || LawKind::ALL.iter().any(|law| law.name() == name)
            };
            let named: Vec<_> = advice.split('`').skip(1).step_by(2).collect();
            assert!(!named.is_empty() && named.iter().all(|name| known(name)), "{message}");
        }
    }
    let linear = &examples()[0].0;
    assert_eq!(
        refusal(ModelKind::TensorMass, linear, &tets).unwrap(),
        "the model `tensor-mass` cannot compute the law `linear`: it is made for St Venant-Kirchhoff laws; take \
         `linear-tensor-mass` for linear ones and `total-lagrangian` for the rest"
    );
    let hexes = VolumeMesh::from(hex_mesh([1, 1, 1]));
    assert_eq!(
        refusal(ModelKind::LinearTensorMass, linear, &hexes).unwrap(),
        "the model `linear-tensor-mass` works on tetrahedra, and the mesh is made of hexahedra; take \
         `total-lagrangian`, or tetrahedra"
    );
}

fn stvk() -> Tissue {
    Tissue::uniform(StVenantKirchhoff::from_young_poisson(5e3, 0.4).unwrap())
}

#[test]
fn a_cell_without_volume_is_named() {
    let flat = |mut mesh: TetMesh| {
        mesh.nodes.push(mesh.nodes[0]);
        let last = mesh.nodes.len() as u32 - 1;
        mesh.cells.push([0, 1, last, 2]);
        (mesh.cells.len() - 1, mesh)
    };
    let (cell, mesh) = flat(tet_mesh([1, 1, 1]));
    let message = refusal(ModelKind::TensorMass, &stvk(), &mesh.clone().into()).unwrap();
    assert!(message.starts_with(&format!("cell {cell} has no volume")), "{message}");
    for kind in [ModelKind::TensorMass, ModelKind::TotalLagrangian] {
        assert_eq!(refusal(kind, &stvk(), &mesh.clone().into()).unwrap(), message);
    }
    assert_eq!(VolumePenalty::<f64>::new(&mesh, 1.0).unwrap_err().to_string(), message);
}

/// Four corners in an oblique plane: rounding gives the cell a volume of some 1e-17 of its edges cubed, of either sign.
#[test]
fn corners_in_an_oblique_plane_have_no_volume() {
    let mut random = Random::new(82);
    for _ in 0..50 {
        let (origin, u, v) = (random.vector(), random.vector() * 0.01, random.vector() * 0.01);
        let nodes = vec![origin, origin + u, origin + v, origin + u * 0.3 + v * 0.4];
        let mesh = VolumeMesh::from(TetMesh::new(nodes, vec![[0, 1, 2, 3]]));
        for kind in [ModelKind::TensorMass, ModelKind::TotalLagrangian] {
            assert!(refusal(kind, &stvk(), &mesh).is_some(), "{kind} takes a flat cell");
        }
    }
}

#[test]
fn meshes_and_tissues_that_do_not_fit_are_refused() {
    let mesh = tet_mesh([1, 1, 1]);
    let cells = mesh.cells.len();
    let tissue = uneven(LawKind::StVenantKirchhoff, cells - 1, &mut Random::new(81));
    for kind in [ModelKind::TensorMass, ModelKind::TotalLagrangian] {
        let expected =
            format!("{} laws are given for {cells} cells; give one for each cell, or one for all", cells - 1);
        assert_eq!(refusal(kind, &tissue, &mesh.clone().into()).unwrap(), expected);
        let empty = VolumeMesh::from(TetMesh::new(vec![Vector::ZERO], vec![]));
        let message = refusal(kind, &stvk(), &empty).unwrap();
        assert_eq!(message, "the mesh has no cells; export the volume, not only points or curves");
        let mut damaged = mesh.clone();
        damaged.cells[2][1] = 99;
        let message = refusal(kind, &stvk(), &damaged.into()).unwrap();
        assert_eq!(message, "cell 2 names node 99, but the mesh has only 8 nodes; the file is damaged or was cut off");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let mesh = tet_mesh([1, 1, 1]);
    for threshold in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let recipe = TensorMass::new(stvk()).adaptive(threshold);
        let error = recipe.build_double(&mesh.clone().into()).err().unwrap();
        assert_eq!(error.to_string(), format!("adaptive = {threshold} is out of range: it must be positive [m]"));
    }
    for kappa in [-1.0, f64::NAN, f64::INFINITY] {
        let message = VolumePenalty::<f64>::new(&mesh, kappa).unwrap_err().to_string();
        assert_eq!(message, format!("keep-volume = {kappa} is out of range: it must be zero or positive [Pa]"));
    }
}
