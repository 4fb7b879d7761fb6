//! The driver on the coarsest beam: what the comparison relies on, without any of the programs compared.

use std::path::Path;

use viscera_peers::{Reference, Variant, Viscera, deflection, mesh};
use viscera_peers_protocol::{Case, Mesh, Peer, Setup};

fn case() -> Case {
    Case::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../case.toml")).unwrap()
}

/// Deflection of the tip [m] after six seconds of nearly critical damping: 2e-4 of the way are left, (1 + ωt) exp(−ωt) with
/// ω = 2/s of the first mode (Euler–Bernoulli).
fn deflection_at_rest(case: &Case, mesh: &Mesh, variant: Variant) -> f64 {
    let setup = Setup {
        variant: variant.name().into(),
        step: case.step.longest,
        gravity: case.beam.gravity,
        damping: case.settle.damping,
    };
    let mut beam = Viscera.build(case, mesh, &setup).unwrap();
    beam.advance((6.0 / setup.step) as u64).unwrap();
    let tip = mesh.tip(case);
    mesh.nodes[tip][1] - beam.positions()[tip][1]
}

/// What swings in single precision comes to rest where Newton's method in double precision says, to twice what the damping
/// leaves.
#[test]
fn every_variant_comes_to_rest_in_its_equilibrium() {
    let case = case();
    let mesh = mesh(&case, case.beam.meshes[0]);
    for variant in Variant::ALL {
        let moved = deflection_at_rest(&case, &mesh, variant);
        let rest = -deflection(&case, &mesh, variant.reference()).unwrap()[1];
        assert!((moved / rest - 1.0).abs() < 5e-4, "{variant:?}: {moved} m, at rest {rest} m");
    }
}

/// The drivers read the mesh that is written, to the last bit, and it is the beam: its mass is right, and its tip in its place.
#[test]
fn the_written_mesh_is_the_beam() {
    let case = case();
    let written = mesh(&case, case.beam.meshes[0]);
    let path = std::env::temp_dir().join(format!("viscera-peers-{}.txt", std::process::id()));
    std::fs::write(&path, written.text()).unwrap();
    let read = Mesh::read(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!((&read.nodes, &read.cells), (&written.nodes, &written.cells));
    assert_eq!(read.cells.len(), 6 * case.beam.meshes[0].iter().product::<usize>());
    let [width, height, length] = case.beam.size;
    let mass: f64 = read.masses(case.tissue.density).iter().sum();
    assert!((mass / (width * height * length * case.tissue.density) - 1.0).abs() < 1e-12);
    assert_eq!(read.nodes[read.tip(&case)], [0.5 * width, 0.5 * height, length]);
}

/// A softer element lies lower: tetrahedra that do not lock hang deeper than plain ones of the same law, at ν = 0.45 by a
/// fifth or more on the coarsest mesh.
#[test]
fn plain_tetrahedra_lock_on_the_coarsest_beam() {
    let case = case();
    let mesh = mesh(&case, case.beam.meshes[0]);
    let rest = |reference| -deflection(&case, &mesh, reference).unwrap()[1];
    assert!(rest(Reference::NodallyIntegrated) > 1.2 * rest(Reference::StableNeoHookean));
}
