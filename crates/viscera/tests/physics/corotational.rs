//! Corotational elements: the numbers of cases A09 and A11, and what holds in which variant.

use viscera::material::{Lame, LinearElastic, StVenantKirchhoff, Tissue, TransverseLinear};
use viscera::mesh::{CubeCut, HexMesh, TetMesh, VolumeMesh};
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement, Tangent};
use viscera::model::{Corotational, ForceModel, ModelRecipe, Scratch};

use crate::support::{
    Evaluate, Random, Reference, Vector, assert_close, assert_near, deformed, hex_mesh, largest, number, plain,
    tet_mesh, vectors,
};

const ROTATIONS: [Rotation; 3] = [Rotation::Polar, Rotation::Qr, Rotation::Svd];
const STRAINS: [StrainDisplacement; 2] = [StrainDisplacement::AtRest, StrainDisplacement::Updated];
const VOLUMES: [IntegrationVolume; 2] = [IntegrationVolume::Initial, IntegrationVolume::Current];

#[derive(Clone, Copy, Debug, PartialEq)]
struct Variant {
    rotation: Rotation,
    strain: StrainDisplacement,
    volume: IntegrationVolume,
}

impl Variant {
    fn all() -> impl Iterator<Item = Self> {
        let volumes = |rotation, strain| VOLUMES.map(|volume| Self { rotation, strain, volume });
        ROTATIONS
            .into_iter()
            .flat_map(move |rotation| STRAINS.into_iter().flat_map(move |strain| volumes(rotation, strain)))
    }

    fn recipe(self, tissue: &Tissue, tangent: Tangent) -> Corotational {
        Corotational::new(tissue.clone())
            .rotation(self.rotation)
            .strain_displacement(self.strain)
            .volume(self.volume)
            .tangent(tangent)
    }

    fn build(self, tissue: &Tissue, mesh: &VolumeMesh, tangent: Tangent) -> Box<dyn ForceModel<f64>> {
        self.recipe(tissue, tangent).build_double(mesh).unwrap()
    }

    fn updated(self) -> bool {
        self.strain == StrainDisplacement::Updated
    }

    /// B at rest, initial volume, and the nearest rotation.
    fn derives_from_an_energy(self) -> bool {
        !self.updated() && self.volume == IntegrationVolume::Initial && self.rotation != Rotation::Qr
    }
}

fn isotropic() -> Tissue {
    Tissue::uniform(LinearElastic::new(Lame::from_young_poisson(10e3, 0.3).unwrap()))
}

fn fibred() -> Tissue {
    let lame = |young| Lame::from_young_poisson(young, 0.3).unwrap();
    Tissue::uniform(TransverseLinear::new(lame(10e3), [2.0, 3.0, 6.0], lame(40e3)).unwrap())
}

fn sum(forces: &[Vector]) -> Vector {
    forces.iter().fold(Vector::ZERO, |sum, &force| sum + force)
}

/// |Σ x×f| over Σ |f| times the size of the body.
fn relative_torque(x: &[Vector], forces: &[Vector]) -> f64 {
    let centre = sum(x) / x.len() as f64;
    let torque = x.iter().zip(forces).fold(Vector::ZERO, |sum, (&x, &force)| sum + (x - centre).cross(force));
    let arm = x.iter().map(|&x| (x - centre).norm()).fold(0.0, f64::max);
    torque.norm() / (forces.iter().map(|force| force.norm()).sum::<f64>() * arm)
}

#[test]
fn a_single_tetrahedron_has_the_forces_of_the_reference_in_every_variant() {
    let reference = Reference::read("A09_corotational_tet");
    let tet = &reference.data["tet"];
    let mesh = VolumeMesh::from(TetMesh::new(vectors(&tet["X_rest_m"]), vec![[0, 1, 2, 3]]));
    let x = vectors(&tet["x_current_m"]);
    let tissue = reference.tissue("linear");
    let ratio = number(&tet["V1_m3"]) / number(&tet["V0_m3"]);
    for variant in Variant::all() {
        let expected = &reference.data["reference"][if variant.rotation == Rotation::Qr { "qr" } else { "polar" }];
        let forces = variant.build(&tissue, &mesh, Tangent::Frozen).forces(&x);
        let (key, factor) = match (variant.strain, variant.volume) {
            (StrainDisplacement::AtRest, IntegrationVolume::Initial) => ("force_B_not_updated_N", 1.0),
            (StrainDisplacement::AtRest, IntegrationVolume::Current) => ("force_B_not_updated_N", ratio),
            (StrainDisplacement::Updated, IntegrationVolume::Initial) => ("force_B_updated_V_initial_N", 1.0),
            (StrainDisplacement::Updated, IntegrationVolume::Current) => ("force_B_and_V_updated_N", 1.0),
        };
        let expected: Vec<_> = vectors(&expected[key]).into_iter().map(|force| force * factor).collect();
        assert_near(&forces, &expected, reference.tolerance(), format!("{variant:?}"));
    }
    let energy = number(&reference.data["reference"]["polar"]["energy_B_not_updated_J"]);
    let model = Corotational::new(tissue).build_double(&mesh).unwrap() as Box<dyn ForceModel<f64>>;
    assert_close(model.energy(&x), energy, reference.tolerance(), "energy");
}

#[test]
fn net_force_vanishes_in_every_variant_and_torque_where_it_is_claimed() {
    let mesh = VolumeMesh::from(tet_mesh([2, 2, 2]));
    let mut random = Random::new(301);
    let x = deformed(&mesh, random.rotation() * random.deformation(0.3), Vector::ZERO, 0.005, &mut random);
    for (tissue, isotropic) in [(isotropic(), true), (fibred(), false)] {
        for variant in Variant::all() {
            let forces = variant.build(&tissue, &mesh, Tangent::Frozen).forces(&x);
            let scale = largest(&forces) * x.len() as f64;
            assert!(sum(&forces).norm() <= 1e-14 * scale, "{variant:?}: {:?}", sum(&forces));
            let torque = relative_torque(&x, &forces);
            let free = variant.updated() || (isotropic && variant.rotation != Rotation::Qr);
            if free {
                assert!(torque <= 1e-14, "{variant:?}: torque {torque:e}");
            } else {
                assert!(torque >= 1e-4, "{variant:?}: torque {torque:e} hardly is one");
            }
        }
    }
}

/// One cell, so that what the variants do is not washed out: the torques of case A09.
#[test]
fn torques_of_the_single_tetrahedron_are_those_of_the_reference() {
    let reference = Reference::read("A09_corotational_tet");
    let tet = &reference.data["tet"];
    let mesh = VolumeMesh::from(TetMesh::new(vectors(&tet["X_rest_m"]), vec![[0, 1, 2, 3]]));
    let x = vectors(&tet["x_current_m"]);
    let qr: Box<dyn ForceModel<f64>> =
        Corotational::new(reference.tissue("linear")).rotation(Rotation::Qr).build_double(&mesh).unwrap();
    let forces = qr.forces(&x);
    let torque = x.iter().zip(&forces).fold(Vector::ZERO, |sum, (&x, &force)| sum + x.cross(force));
    let expected = vectors(&serde_json::json!([reference.data["reference"]["qr"]["torque_B_not_updated_Nm"]]));
    assert_near(&[torque], &expected, reference.tolerance(), "torque of QR with B at rest");
}

/// Forces along a closed path do work unless they have a potential: ∮ f·dx over a small circle, relative to |f| |dx|.
fn circulation(model: &dyn ForceModel<f64>, x: &[Vector], random: &mut Random) -> f64 {
    let (a, b) = (random.vectors(x.len(), 0.004), random.vectors(x.len(), 0.004));
    // the trapezoidal rule converges faster than any power on a smooth closed path
    let steps = 32;
    let (mut work, mut size) = (0.0, 0.0);
    for step in 0..steps {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
        let (sine, cosine) = angle.sin_cos();
        let place: Vec<_> = (0..x.len()).map(|i| x[i] + a[i] * cosine + b[i] * sine).collect();
        for (i, force) in model.forces(&place).into_iter().enumerate() {
            let along = b[i] * cosine - a[i] * sine;
            work += force.dot(along);
            size += force.norm() * along.norm();
        }
    }
    work.abs() / size
}

/// Only polar and SVD with B at rest and the initial volume have a potential, and only for an isotropic law.
#[test]
fn work_along_a_closed_path_tells_which_variants_have_an_energy() {
    let mesh = VolumeMesh::from(tet_mesh([1, 1, 1]));
    for (tissue, isotropic) in [(isotropic(), true), (fibred(), false)] {
        for variant in Variant::all() {
            let mut random = Random::new(302);
            let x = deformed(&mesh, random.deformation(0.25), Vector::ZERO, 0.002, &mut random);
            let work = circulation(&*variant.build(&tissue, &mesh, Tangent::Frozen), &x, &mut random);
            if isotropic && variant.derives_from_an_energy() {
                assert!(work <= 1e-14, "{variant:?}: {work:e}");
            } else {
                assert!(work >= 1e-6, "{variant:?}: {work:e} hardly is any work");
            }
        }
    }
}

/// Five points in the step h leave h⁴ times the fifth derivative.
#[test]
fn exact_products_are_the_derivative_of_forces_in_every_variant() {
    let mesh = VolumeMesh::from(tet_mesh([2, 1, 1]));
    let mut random = Random::new(303);
    let x = deformed(&mesh, random.rotation() * random.deformation(0.2), Vector::ZERO, 0.002, &mut random);
    let dx = random.vectors(x.len(), 1.0);
    let h = 2e-4 * mesh.size();
    let moved = |s: f64| x.iter().zip(&dx).map(|(&x, &dx)| x + dx * (s * h)).collect::<Vec<_>>();
    for tissue in [isotropic(), fibred()] {
        for variant in Variant::all() {
            let model = variant.build(&tissue, &mesh, Tangent::Exact);
            let forces = |s: f64| model.forces(&moved(s));
            let (back2, back, ahead, ahead2) = (forces(-2.0), forces(-1.0), forces(1.0), forces(2.0));
            let slopes: Vec<_> =
                (0..x.len()).map(|i| ((ahead[i] - back[i]) * 8.0 - (ahead2[i] - back2[i])) / (12.0 * h)).collect();
            assert_near(&model.product(&x, &dx), &slopes, 1e-8, format!("{variant:?}"));
        }
    }
}

/// Frozen products hold the rotation: close to the exact ones at small strain, and the same at none, turned or not.
#[test]
fn frozen_products_are_exact_without_strain() {
    let mesh = VolumeMesh::from(tet_mesh([2, 2, 2]));
    let mut random = Random::new(304);
    let x = deformed(&mesh, random.rotation(), random.vector(), 0.0, &mut random);
    let dx = random.vectors(x.len(), 1.0);
    for tissue in [isotropic(), fibred()] {
        for variant in Variant::all() {
            let [frozen, exact] =
                [Tangent::Frozen, Tangent::Exact].map(|tangent| variant.build(&tissue, &mesh, tangent));
            assert_near(&frozen.product(&x, &dx), &exact.product(&x, &dx), 1e-11, format!("{variant:?}"));
        }
    }
}

/// Rotated gradients, computed once, give the products that each product finds for itself without them.
#[test]
fn linearized_products_equal_products_from_the_positions() {
    let mesh = VolumeMesh::from(tet_mesh([3, 2, 2]));
    let mut random = Random::new(305);
    let x = deformed(&mesh, random.rotation() * random.deformation(0.3), Vector::ZERO, 0.005, &mut random);
    for tissue in [isotropic(), fibred()] {
        for variant in Variant::all() {
            let mut model = variant.build(&tissue, &mesh, Tangent::Frozen);
            model.remove(&[3]);
            let mut scratch = Scratch::for_models(x.len(), std::slice::from_ref(&model));
            model.linearize(&x, &mut scratch);
            for _ in 0..2 {
                let dx = random.vectors(x.len(), 1.0);
                let mut product = vec![Vector::ZERO; x.len()];
                model.add_product(&x, &dx, &mut scratch, &mut product);
                assert_near(&product, &model.product(&x, &dx), 1e-13, format!("{variant:?}"));
            }
        }
    }
}

/// Turned by any angle and strained by s, a corotational body has the forces of linear elasticity but for s² of them.
#[test]
fn small_strains_after_any_rotation_are_linear_elasticity() {
    let mesh = VolumeMesh::from(tet_mesh([2, 2, 2]));
    for tissue in [isotropic(), fibred()] {
        let linear = plain::<f64>(&tissue, &mesh);
        for variant in Variant::all() {
            let mut random = Random::new(306);
            let (turn, strain) = (random.rotation(), 1e-6);
            let stretch = (random.matrix() * strain).symmetric_part();
            let f = viscera::math::Mat3::IDENTITY + stretch.into();
            let still = deformed(&mesh, f, Vector::ZERO, 0.0, &mut random);
            let turned: Vec<_> = still.iter().map(|&x| turn * x).collect();
            let expected: Vec<_> = linear.forces(&still).into_iter().map(|force| turn * force).collect();
            let forces = variant.build(&tissue, &mesh, Tangent::Frozen).forces(&turned);
            assert_near(&forces, &expected, 10.0 * strain, format!("{variant:?}"));
        }
    }
}

/// No finite place of the nodes is without a finite force: flat, collapsed to a line or a point, inverted, enormous.
#[test]
fn every_place_of_the_nodes_has_finite_forces_and_products() {
    let mesh = VolumeMesh::from(TetMesh::box_grid_cut([2, 1, 1], [0.2, 0.1, 0.1], CubeCut::Ten));
    let rest = mesh.nodes();
    let along =
        |keep: Vector| rest.iter().map(|x| Vector::new(x.x * keep.x, x.y * keep.y, x.z * keep.z)).collect::<Vec<_>>();
    let places = [
        along(Vector::new(1.0, 1.0, 0.0)),
        along(Vector::new(1.0, 0.0, 0.0)),
        along(Vector::ZERO),
        along(Vector::new(1.0, 1.0, -1.0)),
        along(Vector::new(-1.0, -1.0, -1.0)),
        along(Vector::new(1.0, -1e-200, 1e-200)),
        along(Vector::new(1e30, 1.0, 1e-30)),
        Random::new(307).vectors(rest.len(), 0.1),
    ];
    let dx = Random::new(308).vectors(rest.len(), 1e-3);
    for tissue in [isotropic(), fibred()] {
        for variant in Variant::all() {
            for (number, x) in places.iter().enumerate() {
                for tangent in [Tangent::Frozen, Tangent::Exact] {
                    let model = variant.build(&tissue, &mesh, tangent);
                    let all = [model.forces(x), model.product(x, &dx)].concat();
                    let what = format!("{variant:?}, {tangent:?}, place {number}");
                    assert!(all.iter().all(|v| v.is_finite()), "{what}");
                }
            }
        }
    }
}

/// Pushed through itself, a cell is driven back: the force on its apex points to the side from which it came.
#[test]
fn an_inverted_tetrahedron_is_driven_back() {
    let mesh = TetMesh::new(
        vec![Vector::ZERO, Vector::new(0.1, 0.0, 0.0), Vector::new(0.0, 0.1, 0.0), Vector::new(0.02, 0.03, 0.1)],
        vec![[0, 1, 2, 3]],
    );
    let mut x = mesh.nodes.clone();
    x[3].z = -0.02;
    for variant in Variant::all().filter(|variant| variant.rotation != Rotation::Qr) {
        let held = variant.build(&isotropic(), &mesh.clone().into(), Tangent::Frozen).forces(&x)[3];
        // what holds the apex down pulls against the tissue
        assert!(held.z < 0.0, "{variant:?}: {held:?}");
    }
}

#[test]
fn other_laws_are_refused_with_advice() {
    let tissue = Tissue::uniform(StVenantKirchhoff::new(Lame::from_young_poisson(10e3, 0.3).unwrap()));
    let error = Corotational::new(tissue).build_double(&tet_mesh([1, 1, 1]).into()).err().unwrap();
    assert_eq!(
        error.to_string(),
        "the model `corotational` cannot compute the law `st-venant-kirchhoff`: it turns small strains; take the law \
         `linear` or `transverse-linear`, or the model `total-lagrangian`"
    );
}

fn single_hexahedron(reference: &Reference) -> (VolumeMesh, Vec<Vector>) {
    let hex = &reference.data["hex"];
    let mesh = HexMesh::new(vectors(&hex["X_rest_m"]), vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
    (mesh.into(), vectors(&hex["x_current_m"]))
}

#[test]
fn a_single_hexahedron_has_the_forces_and_the_torque_of_the_reference() {
    let reference = Reference::read("A11_corotational_hex");
    let (mesh, x) = single_hexahedron(&reference);
    let data = &reference.data["reference"];
    for rotation in [Rotation::Polar, Rotation::Svd] {
        let recipe = Corotational::new(reference.tissue("linear")).rotation(rotation);
        let model: Box<dyn ForceModel<f64>> = recipe.build_double(&mesh).unwrap();
        let forces = model.forces(&x);
        assert_near(&forces, &vectors(&data["internal_force_N"]), reference.tolerance(), format!("{rotation:?}"));
        let torque = x.iter().zip(&forces).fold(Vector::ZERO, |sum, (&x, &force)| sum + x.cross(force));
        let expected = vectors(&serde_json::json!([data["torque_Nm"]]));
        assert_near(&[torque], &expected, reference.tolerance(), "torque");
    }
}

/// The mean edges of a hexahedron deform as its centre does, and their rotation is that of the reference.
#[test]
fn mean_edges_deform_as_the_centre() {
    let reference = Reference::read("A11_corotational_hex");
    let (mesh, x) = single_hexahedron(&reference);
    let VolumeMesh::Hex(rest) = mesh else { unreachable!() };
    let now = HexMesh::new(x.clone(), rest.cells.clone());
    let j = now.mean_edges(0) * rest.mean_edges(0).inverse();
    let expected = crate::support::matrix(&reference.data["reference"]["J"]);
    assert_near(&j.columns, &expected.columns, 1e-12, "J");
    let gradients = rest.centre_gradients(0).unwrap();
    let f = (0..8).fold(viscera::math::Mat3::ZERO, |f, a| f + x[a].outer(gradients[a]));
    assert_near(&f.columns, &expected.columns, 1e-12, "F at the centre");
    let r = viscera::math::rotation::polar(&j);
    assert_near(&r.columns, &crate::support::matrix(&reference.data["reference"]["R"]).columns, 1e-12, "R");
}

#[test]
fn hexahedra_keep_force_always_and_torque_only_with_an_updated_b() {
    let mesh = VolumeMesh::from(hex_mesh([2, 2, 1]));
    let mut random = Random::new(311);
    let x = deformed(&mesh, random.rotation() * random.deformation(0.3), Vector::ZERO, 0.005, &mut random);
    for tissue in [isotropic(), fibred()] {
        for variant in Variant::all() {
            let forces = variant.build(&tissue, &mesh, Tangent::Frozen).forces(&x);
            assert!(sum(&forces).norm() <= 1e-14 * largest(&forces) * x.len() as f64, "{variant:?}");
            let torque = relative_torque(&x, &forces);
            if variant.updated() {
                assert!(torque <= 1e-14, "{variant:?}: torque {torque:e}");
            } else {
                assert!(torque >= 1e-4, "{variant:?}: torque {torque:e} hardly is one");
            }
        }
    }
}

#[test]
fn products_of_hexahedra_are_exact_where_they_say_so_and_linearized_ones_are_the_same() {
    let mesh = VolumeMesh::from(hex_mesh([2, 1, 1]));
    let mut random = Random::new(312);
    let x = deformed(&mesh, random.rotation() * random.deformation(0.2), Vector::ZERO, 0.002, &mut random);
    let dx = random.vectors(x.len(), 1.0);
    let h = 2e-4 * mesh.size();
    let moved = |s: f64| x.iter().zip(&dx).map(|(&x, &dx)| x + dx * (s * h)).collect::<Vec<_>>();
    for tissue in [isotropic(), fibred()] {
        for variant in Variant::all() {
            let model = variant.build(&tissue, &mesh, Tangent::Exact);
            let forces = |s: f64| model.forces(&moved(s));
            let (back2, back, ahead, ahead2) = (forces(-2.0), forces(-1.0), forces(1.0), forces(2.0));
            let slopes: Vec<_> =
                (0..x.len()).map(|i| ((ahead[i] - back[i]) * 8.0 - (ahead2[i] - back2[i])) / (12.0 * h)).collect();
            assert_near(&model.product(&x, &dx), &slopes, 1e-8, format!("{variant:?}"));

            let model = variant.build(&tissue, &mesh, Tangent::Frozen);
            let mut scratch = Scratch::for_models(x.len(), std::slice::from_ref(&model));
            model.linearize(&x, &mut scratch);
            let mut product = vec![Vector::ZERO; x.len()];
            model.add_product(&x, &dx, &mut scratch, &mut product);
            assert_near(&product, &model.product(&x, &dx), 1e-14, format!("{variant:?}, linearized"));
        }
    }
}

#[test]
fn small_strains_of_turned_hexahedra_are_linear_elasticity() {
    let mesh = VolumeMesh::from(hex_mesh([2, 2, 1]));
    let linear = plain::<f64>(&fibred(), &mesh);
    for variant in Variant::all() {
        let mut random = Random::new(313);
        let (turn, strain) = (random.rotation(), 1e-6);
        let f = viscera::math::Mat3::IDENTITY + (random.matrix() * strain).symmetric_part().into();
        let still = deformed(&mesh, f, Vector::ZERO, 0.0, &mut random);
        let turned: Vec<_> = still.iter().map(|&x| turn * x).collect();
        let expected: Vec<_> = linear.forces(&still).into_iter().map(|force| turn * force).collect();
        let forces = variant.build(&fibred(), &mesh, Tangent::Frozen).forces(&turned);
        assert_near(&forces, &expected, 10.0 * strain, format!("{variant:?}"));
    }
}
