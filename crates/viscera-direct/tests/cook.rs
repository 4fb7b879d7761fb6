//! Case D02: Cook's membrane, a tapered panel of nearly incompressible tissue (ν = 0.4999) in plane strain, bent and sheared at
//! its end; against a converged mixed method, and against the locked elements of another program.

use std::path::Path;

use serde_json::Value;
use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{LinearElastic, NeoHookean, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{CubeCut, Region, TetMesh};
use viscera::model::{ModelRecipe, NodallyIntegrated, TotalLagrangian};
use viscera::world::{World, WorldConfig};
use viscera_direct::Cholesky;

fn data() -> Value {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../viscera/tests/data/references");
    serde_json::from_str(&std::fs::read_to_string(folder.join("D02_cook_plane_strain.json")).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Displacement of the upper right corner, the mean of both faces [m].
fn corner(cells: usize, cut: CubeCut, recipe: impl ModelRecipe + 'static, small_strain: bool) -> Vec3<f64> {
    let mut mesh = TetMesh::box_grid_cut([cells, cells, 1], [1.0; 3], cut);
    for node in &mut mesh.nodes {
        let (x, y) = (node.x, node.y);
        *node = Vec3::new(0.048 * x, 0.044 * x + y * (0.044 * (1.0 - x) + 0.016 * x), 0.004 * node.z);
    }
    let end = Region::plane([0.048, 0.0, 0.0], [1.0, 0.0, 0.0], 1e-9);
    // Superposed cells show each face of the end twice.
    let share = if cut == CubeCut::Ten { 0.5 } else { 1.0 };
    let traction = Curve::constant(Vec3::new(0.0, share * 6250.0, 0.0));
    let body = Body::new(mesh, 1000.0)
        .boxed_model(Box::new(recipe))
        .fix(Region::plane([0.0; 3], [1.0, 0.0, 0.0], 1e-9))
        .slide(Region::All, [0.0, 0.0, 1.0])
        .load(Load::Traction { region: end, traction });
    let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], ..WorldConfig::default() }).unwrap();
    let id = world.add(body).unwrap();
    let settings = QuasiStatic { tolerance: 1e-9, small_strain, ..QuasiStatic::default() };
    world.settle(id, &settings, &mut Cholesky::default()).unwrap();
    let body = world.body(id);
    let above = |node: &usize| (body.mesh().nodes()[*node] - Vec3::new(0.048, 0.06, 0.0)).norm() < 0.0041;
    let moved = |node: usize| body.positions()[node] - body.mesh().nodes()[node];
    let corners: Vec<usize> =
        (0..body.positions().len()).filter(above).filter(|&n| body.mesh().nodes()[n].y > 0.0599).collect();
    corners.iter().fold(Vec3::ZERO, |sum, &node| sum + moved(node)) / corners.len() as f64
}

fn neo_hookean(share: f64) -> Tissue {
    Tissue::uniform(NeoHookean::from_young_poisson(share * 240_565.0, 0.4999).unwrap())
}

/// Plain tetrahedra give a third of the deflection, to six digits what another program gives.
#[test]
fn plain_tetrahedra_lock_as_others_found() {
    for expected in data()["locking_of_low_order_elements"].as_array().unwrap() {
        let cells = expected["cells"].as_u64().unwrap() as usize;
        if expected["element"] != "tet6" || cells > 16 {
            continue;
        }
        let moved = if expected["model"] == "linear" {
            let linear = Tissue::uniform(LinearElastic::from_young_poisson(240_565.0, 0.4999).unwrap());
            corner(cells, CubeCut::Six, TotalLagrangian::new(linear), true)
        } else {
            corner(cells, CubeCut::Six, TotalLagrangian::new(neo_hookean(1.0)), false)
        };
        let other = number(&expected["A_top_right_m"][1]);
        assert!((moved.y - other).abs() <= 1e-6 * other, "{cells} cells, {}: {moved:?}", expected["model"]);
        assert!(number(&expected["ratio_uy_to_converged"]) < 0.4);
    }
}

/// Integrated at the nodes they come within 2 % of the converged deflection: on 32 × 32 cells of six, or 16 × 16 of ten.
#[test]
fn tetrahedra_integrated_at_the_nodes_bend_as_far_as_they_should() {
    let data = data();
    for (cells, cut, share) in [(32, CubeCut::Six, 1.0), (16, CubeCut::Ten, 0.5)] {
        for (model, small_strain) in [("linear", true), ("neohooke", false)] {
            let expected = number(&data["converged_reference"][model]["A_top_right_m"][1]);
            let moved = corner(cells, cut, NodallyIntegrated::new(neo_hookean(share)), small_strain);
            let ratio = moved.y / expected;
            assert!((ratio - 1.0).abs() < 0.02, "{cut:?}, {model}: {ratio} of the converged deflection");
        }
    }
}
