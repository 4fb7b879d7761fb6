//! Single elements of every size and shape, in every deformation that numbers can tell: forces, products and energies.

use std::panic::{AssertUnwindSafe, catch_unwind};

use viscera::math::{Scalar, Vec3};
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::{ForceModel, ModelError, Precision, Scratch};

use super::combination::{Combination, Stiffness};
use super::random::Random;
use crate::references::Vector;
use crate::setting::Cells;
use crate::{Size, ValidationError};

/// Deformations that each element is put in.
pub(super) const DEFORMATIONS: usize = 10;

/// What became of the elements of a combination in one precision.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementTally {
    /// The force model of a law on a kind of cells.
    pub combination: Combination,
    /// Whether in single precision.
    pub single: bool,
    /// Elements in a deformation that were tried.
    pub tried: u64,
    /// Of them, elements that were refused as flat, by an error of a type made for that.
    pub refused: u64,
    /// Of them, those whose numbers are within the range of the precision.
    pub in_range: u64,
    /// Numbers that are none, or infinite, although they are within the range.
    pub broken: u64,
    /// Numbers that are none, or infinite, beyond the range.
    pub overflown: u64,
    /// Panics.
    pub panics: u64,
    /// The first element that broke: log10 of its size, and of the largest stretch.
    pub first_broken: Option<(f64, f64)>,
}

/// Tries `count` elements in the precision `T`.
pub(super) fn attempt<T: Precision>(
    combination: Combination,
    size: Size,
    random: &mut Random,
) -> Result<ElementTally, ValidationError> {
    let count = if size == Size::Full { 40_000 } else { 400 };
    let mut tally = ElementTally {
        combination,
        single: size_of::<T>() == 4,
        tried: 0,
        refused: 0,
        in_range: 0,
        broken: 0,
        overflown: 0,
        panics: 0,
        first_broken: None,
    };
    for _ in 0..count / DEFORMATIONS {
        let element = Element::new(combination.cells, random);
        let young = 10f64.powf(5.5 + 3.5 * random.signed());
        let tissue = Stiffness { young, poisson: 0.25 + 0.2499 * random.signed() }.of(combination.law)?;
        let recipe = combination.model.recipe(tissue);
        tally.tried += DEFORMATIONS as u64;
        match catch_unwind(AssertUnwindSafe(|| T::build_model(recipe.as_ref(), &element.mesh))) {
            Ok(Ok(model)) => {
                for _ in 0..DEFORMATIONS {
                    element.deform::<T>(model.as_ref(), young, random, &mut tally);
                }
            }
            Ok(Err(ModelError::Mesh(_))) => tally.refused += DEFORMATIONS as u64,
            Ok(Err(error)) => return Err(error.into()),
            Err(_) => tally.panics += 1,
        }
    }
    Ok(tally)
}

struct Element {
    mesh: VolumeMesh,
    /// Length of its longest edge over that of its shortest height, and log10 of its size.
    slimness: f64,
    size: f64,
}

impl Element {
    /// A tetrahedron or a distorted cube: half of them as large as those of organs, a quarter of any size that squares without
    /// a loss, a quarter of any size at all, down to denormal numbers; a fifth of them slivers.
    fn new(cells: Cells, random: &mut Random) -> Self {
        let size = match random.below(4) {
            0 | 1 => -2.0 + 2.0 * random.signed(),
            2 => 40.0 * random.signed(),
            _ => 315.0 * random.signed(),
        };
        let slimness = if random.below(5) == 0 { 6.0 * random.signed().abs() } else { 0.0 };
        let flat = Vector::new(1.0, 1.0, 10f64.powf(-slimness));
        let place = |x: Vector| Vector::new(x.x * flat.x, x.y * flat.y, x.z * flat.z) * 10f64.powf(size);
        let mesh = if cells == Cells::Hexahedra {
            let mut mesh = HexMesh::box_grid([1; 3], [1.0; 3]);
            mesh.nodes.iter_mut().for_each(|node| *node = place(*node + random.vector() * 0.2));
            mesh.into()
        } else {
            let mut corners = [(); 4].map(|()| random.vector());
            if (corners[1] - corners[0]).dot((corners[2] - corners[0]).cross(corners[3] - corners[0])) < 0.0 {
                corners.swap(2, 3);
            }
            TetMesh::new(corners.map(place).to_vec(), vec![[0, 1, 2, 3]]).into()
        };
        Self { mesh, slimness, size }
    }

    /// Puts it in a deformation and asks for everything.
    fn deform<T: Scalar>(&self, model: &dyn ForceModel<T>, young: f64, random: &mut Random, tally: &mut ElementTally) {
        let stretch = match random.below(4) {
            0 | 1 => random.signed(),
            2 => 8.0 * random.signed(),
            _ => 320.0 * random.signed(),
        };
        let scale = 10f64.powf(self.size) * 10f64.powf(stretch);
        let kind = random.below(6);
        let (point, axis) = (random.vector(), random.vector());
        let mut place = |rest: Vector| match kind {
            0 => point * scale,
            1 => (point + axis * random.signed()) * scale,
            2 => Vector::new(-rest.x, rest.y, rest.z) * 10f64.powf(stretch),
            3 => Vector::new(random.signed(), random.signed(), 0.0) * scale,
            _ => random.vector() * scale,
        };
        let x: Vec<Vec3<T>> = self.mesh.nodes().iter().map(|&rest| place(rest).cast()).collect();
        let dx: Vec<Vec3<T>> = x.iter().map(|_| (random.vector() * scale).cast()).collect();
        let asked = catch_unwind(AssertUnwindSafe(|| {
            let mut scratch = Scratch::new(x.len());
            let (mut forces, mut product) = (vec![Vec3::ZERO; x.len()], vec![Vec3::ZERO; x.len()]);
            model.add_forces(&x, &mut scratch, &mut forces);
            model.linearize(&x, &mut scratch);
            model.add_product(&x, &dx, &mut scratch, &mut product);
            forces.iter().chain(&product).all(|v| v.is_finite()) && model.energy(&x).is_finite()
        }));
        let in_range = self.is_in_range::<T>(stretch, young);
        tally.in_range += u64::from(in_range);
        match asked {
            Ok(true) => {}
            Ok(false) if in_range => {
                tally.broken += 1;
                tally.first_broken = tally.first_broken.or(Some((self.size, stretch)));
            }
            Ok(false) => tally.overflown += 1,
            Err(_) => tally.panics += 1,
        }
    }

    /// Whether every number that a law or a table is made of can be told: the eighth power of the stretch (J² I_C of inverted
    /// neo-Hookean tissue) times a modulus, and the fourth power of lengths and of their inverses.
    fn is_in_range<T: Scalar>(&self, stretch: f64, young: f64) -> bool {
        let most = if size_of::<T>() == 4 { 38.0 } else { 308.0 };
        let stretch = stretch.max(0.0) + self.slimness + 1.5;
        let length = self.size.abs() + self.slimness + 0.5;
        8.0 * stretch + young.log10() + 4.0 * length < most
    }
}
