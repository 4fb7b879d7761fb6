//! Tissues as they were measured: their numbers say where they come from, and their laws do what the numbers say.

use viscera::material::{Evidence, LawFamily, LawVisitor, Measured, Tissue, TissuePreset};
use viscera::math::{Mat3, Vec3};

/// Fibres along x: the axes are then axes of symmetry of every tissue.
const ALONG_X: [f64; 3] = [1.0, 0.0, 0.0];

fn numbers(preset: &TissuePreset) -> Vec<Measured> {
    let along = preset.fibre.map(|fibre| fibre.young);
    [preset.young, preset.poisson, preset.density].into_iter().chain(along).collect()
}

#[test]
fn every_number_lies_in_its_range_and_says_where_it_comes_from() {
    for preset in TissuePreset::ALL {
        for Measured { value, range: (least, most), source, species, state, weakness, .. } in numbers(preset) {
            assert!(0.0 < least && least <= value && value <= most, "{}: {value} not in {least}..{most}", preset.name);
            let year = |text: &str| (1950..2030).any(|year| text.contains(&year.to_string()));
            let named = TissuePreset::ALL.iter().any(|other| source.contains(other.name));
            assert!(year(source) || named, "{}: no year in {source}", preset.name);
            assert!(!species.is_empty() && !state.is_empty() && weakness != Some(""), "{}", preset.name);
        }
    }
}

/// What was not read where it was published is told: nothing is as strong as it looks only because it has a source.
#[test]
fn numbers_that_were_chosen_say_why_and_elastography_was_read() {
    for preset in TissuePreset::ALL {
        for number in numbers(preset) {
            let chosen = number.evidence == Evidence::Chosen;
            assert!(!chosen || number.weakness.is_some(), "{}: chosen without a reason: {number:?}", preset.name);
        }
        assert_ne!(preset.density.evidence, Evidence::Read, "{}: densities are tabulated", preset.name);
    }
    for name in ["liver", "kidney", "spleen", "artery"] {
        let preset = TissuePreset::named(name).unwrap();
        let number = preset.fibre.map_or(preset.young, |fibre| fibre.young);
        assert_eq!(number.evidence, Evidence::Read, "{name}");
    }
}

#[test]
fn names_are_unique_and_lead_back() {
    for preset in TissuePreset::ALL {
        assert_eq!(TissuePreset::named(preset.name), Some(preset));
    }
    assert_eq!(TissuePreset::named("livr"), None);
}

/// First Piola–Kirchhoff stress of a tissue at F.
struct StressAt<'a>(&'a Tissue, Mat3<f64>);

impl LawVisitor for StressAt<'_> {
    type Output = Mat3<f64>;
    fn visit<L: LawFamily>(self) -> Mat3<f64> {
        L::from_values(self.0.values(0)).stress(&self.1)
    }
}

fn stress(tissue: &Tissue, f: Mat3<f64>) -> Mat3<f64> {
    tissue.kind().visit(StressAt(tissue, f))
}

fn diagonal([x, y, z]: [f64; 3]) -> Mat3<f64> {
    Mat3::from_columns(Vec3::new(x, 0.0, 0.0), Vec3::new(0.0, y, 0.0), Vec3::new(0.0, 0.0, z))
}

fn entry(matrix: &Mat3<f64>, axis: usize) -> f64 {
    matrix.columns[axis].to_array()[axis]
}

/// Young's modulus of a small stretch along an axis with free sides, from central differences of the
/// stress: 1/(K⁻¹)₀₀ of the stiffness K of the three normal strains.
fn young_along(tissue: &Tissue, axis: usize) -> f64 {
    let step = 1e-6;
    let stretched = |column: usize, by: f64| {
        let mut stretch = [1.0; 3];
        stretch[column] += by;
        stress(tissue, diagonal(stretch))
    };
    let k = |row: usize, column: usize| {
        (entry(&stretched(column, step), row) - entry(&stretched(column, -step), row)) / (2.0 * step)
    };
    let (a, b, c) = (axis, (axis + 1) % 3, (axis + 2) % 3);
    let sides = k(b, b) * k(c, c) - k(b, c) * k(c, b);
    let coupled = k(a, b) * (k(b, a) * k(c, c) - k(b, c) * k(c, a)) - k(a, c) * (k(b, a) * k(c, b) - k(b, b) * k(c, a));
    (k(a, a) * sides - coupled) / sides
}

/// The law of a preset has the modulus that the preset states: along the fibres, across them, and without them.
#[test]
fn a_small_stretch_meets_the_modulus_that_is_stated() {
    for preset in TissuePreset::ALL {
        let (without, with) = (preset.tissue().unwrap(), preset.tissue_along(ALONG_X).unwrap());
        let along = preset.fibre.map_or(preset.young.value, |fibre| fibre.young.value);
        let across = preset.young.value;
        for (tissue, axis, expected) in
            [(&without, 1, across), (&with, 0, along), (&with, 1, across), (&with, 2, across)]
        {
            let found = young_along(tissue, axis);
            assert!((found / expected - 1.0).abs() < 1e-6, "{}: {found} Pa for {expected} Pa", preset.name);
        }
    }
}

/// The least of a⊗b : ∂P/∂F : a⊗b over 13 × 13 axes a and b, at diagonal F: below zero a wave grows instead of running.
fn least_wave_modulus(tissue: &Tissue, stretch: [f64; 3]) -> f64 {
    struct LeastWaveModulus<'a>(&'a Tissue, Mat3<f64>);
    impl LawVisitor for LeastWaveModulus<'_> {
        type Output = f64;
        fn visit<L: LawFamily>(self) -> f64 {
            let law = L::from_values(self.0.values(0));
            let modulus = |a: Vec3<f64>, b: Vec3<f64>| {
                let df = Mat3::from_columns(a * b.x, a * b.y, a * b.z);
                let dp = law.tangent(&self.1, &df);
                (0..3).map(|column| dp.columns[column].dot(df.columns[column])).sum::<f64>()
            };
            let pairs = (0..13).flat_map(|a| (0..13).map(move |b| (axis(a), axis(b))));
            pairs.map(|(a, b)| modulus(a, b)).fold(f64::INFINITY, f64::min)
        }
    }
    tissue.kind().visit(LeastWaveModulus(tissue, diagonal(stretch)))
}

/// The 13 axes through faces, edges and corners of a cube.
fn axis(number: usize) -> Vec3<f64> {
    let digits = [(number + 14) % 3, (number + 14) / 3 % 3, (number + 14) / 9 % 3];
    let [x, y, z] = digits.map(|digit| digit as f64 - 1.0);
    let length = (x * x + y * y + z * z).sqrt();
    Vec3::new(x / length, y / length, z / length)
}

#[test]
fn every_tissue_is_stable_at_rest_and_stretched_by_a_tenth() {
    for preset in TissuePreset::ALL {
        let (without, with) = (preset.tissue().unwrap(), preset.tissue_along(ALONG_X).unwrap());
        for stretch in [[1.0; 3], [1.1, 0.95, 0.95], [0.9, 1.05, 1.05]] {
            assert!(least_wave_modulus(&without, stretch) > 0.0, "{} at {stretch:?}", preset.name);
        }
        for stretch in [[1.0; 3], [1.1, 0.95, 0.95]] {
            assert!(least_wave_modulus(&with, stretch) > 0.0, "{} with fibres at {stretch:?}", preset.name);
        }
    }
}

/// Fibres that are pressed buckle at a strain of about μ/2κ_a, which is 1.8 % for muscle.
#[test]
fn muscle_that_is_pressed_along_its_fibres_buckles_at_two_per_cent() {
    let muscle = TissuePreset::named("muscle").unwrap().tissue_along(ALONG_X).unwrap();
    let pressed = |by: f64| least_wave_modulus(&muscle, [1.0 - by, 1.0 + 0.45 * by, 1.0 + 0.45 * by]);
    assert!(pressed(0.01) > 0.0 && pressed(0.03) < 0.0, "{} and {} Pa", pressed(0.01), pressed(0.03));
}

#[test]
fn a_direction_of_length_zero_is_refused_where_there_are_fibres() {
    assert!(TissuePreset::named("muscle").unwrap().tissue_along([0.0; 3]).is_err());
    assert!(TissuePreset::named("liver").unwrap().tissue_along([0.0; 3]).is_ok());
}
