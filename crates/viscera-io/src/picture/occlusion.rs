//! Ambient occlusion on the image: creases and contacts are darker than open surface.
//!
//! The "Alchemy" estimator of McGuire, Osman, Bukowski and Hennessy (2011), eq. 10, over a spiral of taps turned per
//! pixel, then a blur that stops at edges of depth.

use viscera::math::Vec3;

use super::camera::View;

const TAPS: usize = 14;

/// A surface point under a pixel.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    pub(super) position: Vec3<f32>,
    pub(super) normal: Vec3<f32>,
}

/// Share of ambient light that reaches each pixel, 0..1; 1 where there is no surface.
pub(super) fn openness(view: &View, width: usize, height: usize, surfaces: &[Option<Surface>]) -> Vec<f32> {
    let radius = (view.size * 0.09) as f32;
    let tolerance = (view.size * 0.004) as f32;
    let mut raw = vec![1.0_f32; surfaces.len()];
    for (pixel, surface) in surfaces.iter().enumerate() {
        let Some(surface) = surface else { continue };
        let (column, row) = (pixel % width, pixel / width);
        let reach = (view.scale_at(surface.position.cast()) as f32 * radius).min(height as f32 * 0.25);
        let start = turn(column, row);
        let mut closed = 0.0;
        for tap in 0..TAPS {
            let share = (tap as f32 + 0.5) / TAPS as f32;
            let (sine, cosine) = (start + share * 5.0 * std::f32::consts::TAU).sin_cos();
            let x = column as f32 + cosine * share * reach;
            let y = row as f32 + sine * share * reach;
            if x < 0.0 || y < 0.0 || x >= width as f32 || y >= height as f32 {
                continue;
            }
            let Some(other) = &surfaces[y as usize * width + x as usize] else { continue };
            let towards = other.position - surface.position;
            let squared = towards.squared_norm();
            if squared < radius * radius {
                let fall = 1.0 - squared / (radius * radius);
                let rise = (towards.dot(surface.normal) - tolerance).max(0.0);
                closed += fall * rise / (squared.sqrt() + tolerance);
            }
        }
        raw[pixel] = (1.0 - 1.5 * closed / TAPS as f32).clamp(0.0, 1.0);
    }
    blurred(&raw, width, height, surfaces, tolerance * 6.0)
}

/// A turn of the spiral that differs between neighbours but not between runs, in a 4×4 tile that the blur averages out.
fn turn(column: usize, row: usize) -> f32 {
    const ORDER: [u8; 16] = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];
    f32::from(ORDER[(row % 4) * 4 + column % 4]) / 16.0 * std::f32::consts::TAU
}

/// The mean over the 4×4 pixels around each, along rows and then columns, of those no farther off than `tolerance`.
fn blurred(raw: &[f32], width: usize, height: usize, surfaces: &[Option<Surface>], tolerance: f32) -> Vec<f32> {
    let pass = |from: &[f32], dx: isize, dy: isize| -> Vec<f32> {
        let mut out = from.to_vec();
        for (pixel, surface) in surfaces.iter().enumerate() {
            let Some(surface) = surface else { continue };
            let (mut sum, mut count) = (0.0, 0.0);
            for offset in -2..2_isize {
                let x = (pixel % width) as isize + offset * dx;
                let y = (pixel / width) as isize + offset * dy;
                if x < 0 || y < 0 || x >= width as isize || y >= height as isize {
                    continue;
                }
                let other = y as usize * width + x as usize;
                let near = |other: &Surface| (other.position - surface.position).dot(surface.normal).abs() < tolerance;
                if surfaces[other].as_ref().is_some_and(near) {
                    sum += from[other];
                    count += 1.0;
                }
            }
            out[pixel] = if count > 0.0 { sum / count } else { from[pixel] };
        }
        out
    };
    pass(&pass(raw, 1, 0), 0, 1)
}
