//! Cases B (large static deflection) and F (cylinder and fibre tube of RR-4028), node by node.

use serde_json::Value;
use viscera::body::Body;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{Lame, LawKind, LinearElastic, StVenantKirchhoff, Tissue, TransverseStVenantKirchhoff};
use viscera::mesh::{CubeCut, HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::corotational::Tangent;
use viscera::model::{Corotational, TensorMass, TotalLagrangian};
use viscera::solver::Iterative;

use crate::reference::{
    assert_displaced, bottom, displacements, force, mesh, number, read, settle, vector, vectors, world,
};

fn lame(material: &Value) -> Lame {
    Lame::new(number(&material["lambda_Pa"]), number(&material["mu_Pa"])).unwrap()
}

/// A cantilever under its weight or a force on its end; the tolerance is the file's, 1e-8 of the largest displacement.
fn cantilever(case: &str) {
    let data = read(case);
    let material = &data["material"];
    let tissue = match material["model"].as_str().unwrap() {
        "stvk" => Tissue::uniform(StVenantKirchhoff::new(lame(material))),
        "corotational" => Tissue::uniform(LinearElastic::new(lame(material))),
        _ => {
            let along = Lame::new(number(&material["lambdaL_Pa"]), number(&material["muL_Pa"])).unwrap();
            let direction = vector(&material["a0"]).to_array();
            Tissue::uniform(TransverseStVenantKirchhoff::new(lame(material), direction, along).unwrap())
        }
    };
    let mesh = mesh(data["mesh"]["file"].as_str().unwrap());
    let density = number(&material["density_kg_m3"]);
    let mut body = Body::new(mesh, density).fix(bottom());
    body = match tissue.kind() {
        LawKind::LinearElastic => body.model(Corotational::new(tissue).tangent(Tangent::Exact)),
        _ => body.model(TotalLagrangian::new(tissue)),
    };
    let loads = &data["loads"];
    let mut gravity = [0.0; 3];
    if loads["gravity_m_s2"].is_array() {
        gravity = vector(&loads["gravity_m_s2"]).to_array();
    } else {
        for (node, load) in vectors(&loads["nodal_loads_N"]).into_iter().enumerate() {
            if load.norm() > 0.0 {
                body = body.load(force(vec![node as u32], load));
            }
        }
    }
    let (mut world, id) = world(body, gravity);
    settle(&mut world, id).unwrap();
    let expected = &data["reference"];
    let tolerance = number(&data["tolerance"]["relative"]);
    assert_displaced(&displacements(&world, id), &vectors(&expected["nodal_displacement_m"]), tolerance, case);
    let seen = world.observe(id);
    if expected["reaction_sum_N"].is_array() {
        let reaction = vector(&expected["reaction_sum_N"]);
        assert!((seen.reaction - reaction).norm() <= 1e-8 * reaction.norm(), "{case}: {:?}", seen.reaction);
    }
    let energy = number(&expected["strain_energy_J"]);
    assert!((seen.elastic_energy - energy).abs() <= 1e-8 * energy, "{case}: {} J", seen.elastic_energy);
}

#[test]
fn b01_tetrahedra_under_their_weight() {
    cantilever("B01_beam_s_tet_nu03_g05");
}

#[test]
fn b02_tetrahedra_near_the_limit_of_the_law() {
    cantilever("B02_beam_s_tet_nu03_g1");
}

#[test]
fn b03_hexahedra_under_their_weight() {
    cantilever("B03_beam_s_hex_nu03_g05");
}

#[test]
fn b04_a_finer_mesh() {
    cantilever("B04_beam_m_tet_nu03_g05");
}

#[test]
fn b07_corotational_tetrahedra() {
    cantilever("B07_beam_s_tet_corot_g05");
}

/// C01: the clamped beam of 40 × 4 × 2 m, linear, in three kinds of cells, node by node to 1e-8 of the largest displacement;
/// and the tip of each as far from beam theory as the file says.
#[test]
fn c01_a_long_beam_of_linear_tissue_locks_as_others_found() {
    let data = read("C01_nesme_beam_40x4x2");
    let (cells, size) = ([40, 4, 2], [40.0, 4.0, 2.0]);
    let wall = Region::plane([0.0; 3], [1.0, 0.0, 0.0], 0.0);
    let gravity = vector(&data["loads"]["gravity_m_s2"]).to_array();
    for expected in data["reference"]["per_nu"].as_array().unwrap() {
        let young = number(&data["material"]["E_Pa"]);
        // superposed cells share stiffness and density
        let kinds: [(&str, VolumeMesh, f64); 3] = [
            ("tet6", TetMesh::box_grid(cells, size).into(), 1.0),
            ("tet10_superposed", TetMesh::box_grid_cut(cells, size, CubeCut::Ten).into(), 0.5),
            ("hex8", HexMesh::box_grid(cells, size).into(), 1.0),
        ];
        for (kind, mesh, share) in kinds {
            let law = LinearElastic::from_young_poisson(share * young, number(&expected["nu"])).unwrap();
            let body = Body::new(mesh, share * number(&data["material"]["density_kg_m3"]))
                .model(TotalLagrangian::new(Tissue::uniform(law)))
                .fix(wall.clone());
            let (mut world, id) = world(body, gravity);
            let settings = QuasiStatic { small_strain: true, ..QuasiStatic::default() };
            world.settle(id, &settings, &mut Iterative::new(1e-13)).unwrap();
            let what = format!("{kind}, nu {}", expected["nu"]);
            let tolerance = number(&data["tolerance"]["discrete_relative"]);
            assert_displaced(
                &displacements(&world, id),
                &vectors(&expected[kind]["nodal_displacement_m"]),
                tolerance,
                &what,
            );
        }
    }
}

#[test]
fn b05_a_force_on_the_end() {
    cantilever("B05_beam_s_tet_nu03_tip");
}

#[test]
fn b06_fibres_across_the_beam() {
    cantilever("B06_beam_s_tet_ti_g05");
}

/// F01: the cylinder of RR-4028 under three forces, with and without the volume penalty, by both models of the law; and the
/// swelling of linear elasticity that it shows.
#[test]
fn f01_a_bent_cylinder_keeps_its_volume_better_than_a_linear_one() {
    let data = read("F01_cylinder_bending");
    let (lame, kappa) = (lame(&data["material"]), number(&data["material"]["volume_penalty_kappa_Pa"]));
    let tolerance = number(&data["tolerance"]["displacement_relative"]);
    let volume_tolerance = number(&data["tolerance"]["volume_variation_absolute"]);
    let tip = data["loads"]["node_0based"].as_u64().unwrap() as u32;
    for expected in data["reference"].as_array().unwrap() {
        let load = force(vec![tip], vector(&serde_json::json!([expected["force_x_N"], 0.0, 0.0])));
        let body = || Body::new(mesh("F01_cylinder_bending.msh"), 1000.0).fix(bottom()).load(load.clone());
        let stvk = Tissue::uniform(StVenantKirchhoff::new(lame));
        let linear = Tissue::uniform(LinearElastic::new(lame));
        for (name, body) in [
            ("linear", body().model(TotalLagrangian::new(linear))),
            ("stvk", body().model(TensorMass::new(stvk.clone()))),
            ("stvk_volume_penalty", body().model(TotalLagrangian::new(stvk)).keep_volume(kappa)),
        ] {
            let (mut world, id) = world(body, [0.0; 3]);
            settle(&mut world, id).unwrap();
            let (u, expected) = (displacements(&world, id), &expected[name]);
            if expected["nodal_displacement_m"].is_array() {
                assert_displaced(&u, &vectors(&expected["nodal_displacement_m"]), tolerance, name);
            }
            assert_displaced(&[u[tip as usize]], &[vector(&expected["tip_displacement_m"])], tolerance, name);
            let volume = world.observe(id).volume_variation;
            let error = (volume - number(&expected["volume_variation"])).abs();
            assert!(error <= volume_tolerance, "{name}: volume variation {volume}");
        }
    }
}

/// F02: fibres along the tube make it stiffer against bending.
#[test]
fn f02_a_tube_with_fibres_bends_less() {
    let data = read("F02_ti_tube");
    let tolerance = number(&data["tolerance"]["displacement_relative"]);
    let across = lame(&data["material"]);
    let loads = &data["loads"];
    let nodes: Vec<u32> =
        loads["nodes_0based"].as_array().unwrap().iter().map(|node| node.as_u64().unwrap() as u32).collect();
    let top = Region::plane([0.0, 0.0, number(&data["mesh"]["H_m"])], [0.0, 0.0, 1.0], 0.0);
    for expected in data["reference"].as_array().unwrap() {
        let along = Lame::new(number(&expected["lambdaL_Pa"]), number(&expected["muL_Pa"])).unwrap();
        let tissue =
            TransverseStVenantKirchhoff::new(across, vector(&data["material"]["a0"]).to_array(), along).unwrap();
        let body = Body::new(mesh("F02_ti_tube.msh"), 1000.0)
            .model(TotalLagrangian::new(Tissue::uniform(tissue)))
            .fix(bottom())
            .fix(top.clone())
            .load(force(nodes.clone(), vector(&loads["total_force_N"])));
        let (mut world, id) = world(body, [0.0; 3]);
        settle(&mut world, id).unwrap();
        let what = format!("fibres {} times as stiff", expected["factor"]);
        let expected = vectors(&expected["nodal_displacement_m"]);
        assert_displaced(&displacements(&world, id), &expected, tolerance, &what);
    }
}
