//! One text, many instruction sets: a model gives the same forces, products and energy with the kernels of each that the processor has.

use viscera::math::{Level, Mat3, Vec3, dispatch_level, with_level};
use viscera::mesh::VolumeMesh;
use viscera::model::{Precision, Scratch};

use crate::law_lanes::levels;
use crate::support::{Evaluate, Named, Random, assert_near, deformed, hex_mesh, models_and_penalty, tet_mesh};

/// Instruction sets may fuse multiplications and additions or not, so that they differ by roundings; of many terms, which cancel.
const ROUNDINGS: f64 = 2e4;

type Answers<T> = (Vec<Vec3<T>>, Vec<Vec3<T>>, Vec<Vec3<T>>, f64);

/// Forces, the product, the forces found along with what products need, and the energy.
fn answers<T: Precision>(named: &mut Named<T>, x: &[Vec3<T>], dx: &[Vec3<T>]) -> Answers<T> {
    let (forces, product) = (named.model.forces(x), named.model.product(x, dx));
    let (mut scratch, mut together) = (Scratch::new(x.len()), vec![Vec3::ZERO; x.len()]);
    named.model.linearize_and_add_forces(x, &mut scratch, &mut together);
    (forces, product, together, named.model.energy(x))
}

fn instruction_sets_agree<T: Precision>(mesh: &VolumeMesh) {
    let mut random = Random::new(57);
    let x = deformed(mesh, random.deformation(0.4), random.vector() * 0.1, 0.004, &mut random);
    let x: Vec<Vec3<T>> = x.iter().map(|x| x.cast()).collect();
    let dx: Vec<Vec3<T>> = random.vectors(x.len(), 0.01).iter().map(|dx| dx.cast()).collect();
    let tolerance = ROUNDINGS * T::EPSILON.to_f64();
    for mut named in models_and_penalty::<T>(mesh) {
        let (forces, product, together, energy) = answers(&mut named, &x, &dx);
        for level in levels() {
            let found = with_level(level, || answers(&mut named, &x, &dx));
            let what = format!("{} in {} with {level:?}", named.name, T::NAME);
            assert_near(&found.0, &forces, tolerance, format!("forces, {what}"));
            assert_near(&found.1, &product, tolerance, format!("product, {what}"));
            assert_near(&found.2, &together, tolerance, format!("linearised, {what}"));
            assert!((found.3 - energy).abs() <= tolerance * energy.abs(), "energy, {what}: {} for {energy}", found.3);
        }
    }
}

#[test]
fn every_model_agrees_between_instruction_sets() {
    assert!(levels().len() > 1);
    for mesh in [VolumeMesh::from(tet_mesh([3, 2, 2])), hex_mesh([3, 2, 2]).into()] {
        instruction_sets_agree::<f64>(&mesh);
        instruction_sets_agree::<f32>(&mesh);
    }
}

/// Registers of AVX-512 hold a block of elements whole, those of AVX2 half of it, and what is computed is the same in every bit. Not of
/// rotations, whose iterations end when those of the whole batch do.
fn widths_agree<T: Precision>(mesh: &VolumeMesh, [narrow, wide]: [Level; 2]) {
    let mut random = Random::new(59);
    let x = deformed(mesh, random.deformation(0.4), random.vector() * 0.1, 0.004, &mut random);
    let x: Vec<Vec3<T>> = x.iter().map(|x| x.cast()).collect();
    let dx: Vec<Vec3<T>> = random.vectors(x.len(), 0.01).iter().map(|dx| dx.cast()).collect();
    for mut named in models_and_penalty::<T>(mesh).into_iter().filter(|named| !named.name.contains("corotational")) {
        let [narrow, wide] = [narrow, wide].map(|level| {
            with_level(level, || {
                let (mut scratch, mut diagonal) = (Scratch::new(x.len()), vec![Mat3::ZERO; x.len()]);
                named.model.linearize(&x, &mut scratch);
                named.model.add_diagonal(&x, &mut scratch, &mut diagonal);
                (answers(&mut named, &x, &dx), diagonal)
            })
        });
        let what = format!("{} in {}", named.name, T::NAME);
        let ((forces, product, together, energy), diagonal) = narrow;
        assert!(forces == wide.0.0, "forces, {what}");
        assert!(product == wide.0.1, "product, {what}");
        assert!(together == wide.0.2, "linearised, {what}");
        assert!(energy == wide.0.3, "energy, {what}");
        assert!(diagonal == wide.1, "diagonal, {what}");
    }
}

#[test]
fn wide_and_narrow_registers_give_the_same_bits() {
    let best = dispatch_level();
    #[cfg(target_arch = "x86_64")]
    let levels = [best.as_avx2().map(Level::Avx2), best.as_avx512().map(Level::Avx512)];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [Some(best); 2];
    let [Some(narrow), Some(wide)] = levels else { return };
    for mesh in [VolumeMesh::from(tet_mesh([5, 4, 6])), hex_mesh([5, 4, 6]).into()] {
        widths_agree::<f64>(&mesh, [narrow, wide]);
        widths_agree::<f32>(&mesh, [narrow, wide]);
    }
}

/// The check would see a kernel of another instruction set that is not used: on most processors lanes round otherwise than the poorest set.
#[test]
fn another_level_is_another_kernel() {
    let mesh = VolumeMesh::from(tet_mesh([3, 2, 2]));
    let mut random = Random::new(58);
    let x = deformed(&mesh, random.deformation(0.4), random.vector(), 0.004, &mut random);
    let [poorest, .., best] = levels()[..] else { panic!("one instruction set alone") };
    let differs = models_and_penalty::<f64>(&mesh)
        .iter()
        .any(|named| with_level(poorest, || named.model.forces(&x)) != with_level(best, || named.model.forces(&x)));
    assert!(differs || !fuses(), "fused and unfused sums cannot be alike in every bit");
}

/// Whether the best instruction set multiplies and adds in one rounding, and the poorest does not.
fn fuses() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}
