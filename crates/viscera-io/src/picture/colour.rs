//! Colours: sRGB outside, linear light inside.

use viscera::math::Vec3;

/// Linear light per channel, 1 = white paper under full light.
pub(super) type Light = Vec3<f32>;

/// A colour as people name it: sRGB bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// Red, 0–255.
    pub red: u8,
    /// Green, 0–255.
    pub green: u8,
    /// Blue, 0–255.
    pub blue: u8,
}

impl Colour {
    /// Wet red-brown of a perfused liver.
    pub const LIVER: Self = Self::new(124, 44, 35);
    /// Raw red of a fresh cut.
    pub const CUT: Self = Self::new(128, 10, 16);
    /// Brushed surgical steel.
    pub const STEEL: Self = Self::new(206, 210, 214);
    /// A quiet blue for bodies without a colour of their own.
    pub const PLAIN: Self = Self::new(112, 150, 196);

    /// The colour with these sRGB bytes.
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    pub(super) fn linear(self) -> Light {
        Vec3::new(decode(self.red), decode(self.green), decode(self.blue))
    }
}

/// sRGB byte to linear light (IEC 61966-2-1).
pub(super) fn decode(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Linear light to sRGB byte (IEC 61966-2-1); out of range is clamped, NaN is black.
pub(super) fn encode(light: f32) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (value * 255.0 + 0.5) as u8
}

/// `a` where t = 0, `b` where t = 1.
pub(super) fn mix(a: Light, b: Light, t: f32) -> Light {
    a * (1.0 - t) + b * t
}

/// Channel by channel product.
pub(super) fn tint(a: Light, b: Light) -> Light {
    Vec3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}

/// The viridis colour map (van der Walt and Smith 2015), even in perceived lightness, at t in 0..1 (clamped).
///
/// Sixth-degree fit by M. Zucker (CC0), within 4/255 of matplotlib's table. NaN is grey: no value.
pub fn viridis(t: f64) -> Colour {
    const COEFFICIENTS: [[f64; 3]; 7] = [
        [0.277_727_327_223_417_7, 0.005_407_344_544_966_578, 0.334_099_805_335_306_1],
        [0.105_093_043_108_577_4, 1.404_613_529_898_575, 1.384_590_162_594_685],
        [-0.330_861_828_725_556_3, 0.214_847_559_468_213, 0.095_095_163_028_236_59],
        [-4.634_230_498_983_486, -5.799_100_973_351_585, -19.332_440_956_279_87],
        [6.228_269_936_347_081, 14.179_933_366_805_09, 56.690_552_600_681_05],
        [4.776_384_997_670_288, -13.745_145_377_746_01, -65.353_032_633_372_34],
        [-5.435_455_855_934_631, 4.645_852_612_178_535, 26.312_435_249_583_2],
    ];
    if t.is_nan() {
        return Colour::new(150, 150, 150);
    }
    let t = t.clamp(0.0, 1.0);
    let channel = |axis: usize| {
        let value = COEFFICIENTS.iter().rev().fold(0.0, |sum, row| sum * t + row[axis]);
        (value.clamp(0.0, 1.0) * 255.0).round() as u8
    };
    Colour::new(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every byte survives the way through linear light.
    #[test]
    fn srgb_encoding_inverts_decoding() {
        for byte in 0..=255 {
            assert_eq!(encode(decode(byte)), byte);
        }
    }

    /// matplotlib 3: viridis at 0, 1/2, 1 is (68, 1, 84), (33, 145, 140), (253, 231, 37).
    #[test]
    fn viridis_matches_the_published_table() {
        for (t, expected) in [(0.0, [68, 1, 84]), (0.5, [33, 145, 140]), (1.0, [253, 231, 37])] {
            let Colour { red, green, blue } = viridis(t);
            for (found, expected) in [red, green, blue].into_iter().zip(expected) {
                assert!(i32::from(found).abs_diff(expected) <= 4, "{t}: {found} {expected}");
            }
        }
    }
}
