//! Depth pictures: how far a surface is from a camera, pixel by pixel.

use numpy::PyArray2;
use numpy::ndarray::Array2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use viscera::math::Vec3;

use crate::arrays::{Numbers, index_rows, vectors};

/// A camera that looks along `forward` from `eye`, with unit vectors to the right and up, scaled by the focal length in pixels.
struct View {
    eye: Vec3<f64>,
    forward: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    focal: f64,
    width: usize,
    height: usize,
}

impl View {
    /// Column and row of a place, from the left and the top in pixels, and its distance along the view [m].
    fn project(&self, place: Vec3<f64>) -> [f64; 3] {
        let arm = place - self.eye;
        let depth = arm.dot(self.forward);
        let scale = self.focal / depth;
        [
            0.5 * self.width as f64 + arm.dot(self.right) * scale,
            0.5 * self.height as f64 - arm.dot(self.up) * scale,
            depth,
        ]
    }

    /// Enters a triangle into the picture: 1/depth is linear over the screen.
    fn draw(&self, corners: [Vec3<f64>; 3], picture: &mut Array2<f32>) {
        let [a, b, c] = corners.map(|corner| self.project(corner));
        // A triangle that reaches behind the eye is left out: cameras stand outside of what they see.
        if [a, b, c].iter().any(|corner| corner[2].is_nan() || corner[2] <= 0.0) {
            return;
        }
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 {
            return;
        }
        let range = |axis: usize, size: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]).floor().clamp(0.0, size as f64);
            let high = a[axis].max(b[axis]).max(c[axis]).ceil().clamp(0.0, size as f64);
            low as usize..high as usize
        };
        let side = |p: [f64; 3], q: [f64; 3], x: f64, y: f64| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        for row in range(1, self.height) {
            for column in range(0, self.width) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let weights = [side(b, c, x, y) / area, side(c, a, x, y) / area, side(a, b, x, y) / area];
                if weights.iter().all(|&weight| weight >= 0.0) {
                    let depth = 1.0 / (weights[0] / a[2] + weights[1] / b[2] + weights[2] / c[2]);
                    let pixel = &mut picture[[row, column]];
                    *pixel = pixel.min(depth as f32);
                }
            }
        }
    }
}

/// Distance along the view [m] of the nearest triangle in each pixel, infinite where there is none; shape (height, width),
/// float32. `positions` [m] of shape (n, 3), `triangles` of shape (m, 3); a pinhole camera at `eye` that looks at `target` with `up`
/// upwards and an opening of `field_of_view` [rad] across the height.
#[pyfunction]
#[pyo3(signature = (positions, triangles, *, eye, target, up=[0.0, 1.0, 0.0], field_of_view=0.8, size=(64, 64)))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn depth_image<'py>(
    py: Python<'py>,
    positions: Numbers<'py>,
    triangles: &Bound<'py, PyAny>,
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    field_of_view: f64,
    size: (usize, usize),
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (positions, triangles) = (vectors(&positions, "positions")?, index_rows::<3>(triangles, "triangles")?);
    if let Some(&node) = triangles.iter().flatten().find(|&&node| node as usize >= positions.len()) {
        return Err(PyValueError::new_err(format!("triangles name node {node}, and there are {}", positions.len())));
    }
    let (width, height) = size;
    let view = view(eye, target, up, field_of_view, width, height)?;
    let picture = py.detach(|| {
        let mut picture = Array2::from_elem((height, width), f32::INFINITY);
        for triangle in triangles {
            view.draw(triangle.map(|node| positions[node as usize]), &mut picture);
        }
        picture
    });
    Ok(PyArray2::from_owned_array(py, picture))
}

fn view(eye: [f64; 3], target: [f64; 3], up: [f64; 3], angle: f64, width: usize, height: usize) -> PyResult<View> {
    let eye = Vec3::from(eye);
    let forward = (Vec3::from(target) - eye).normalized();
    let right = forward.and_then(|forward| forward.cross(Vec3::from(up)).normalized());
    let (Some(forward), Some(right)) = (forward, right) else {
        return Err(PyValueError::new_err(
            "the camera has no direction: eye and target fall together, or up lies along the view",
        ));
    };
    if !(angle > 0.0 && angle < std::f64::consts::PI) {
        return Err(PyValueError::new_err(format!("field_of_view = {angle} must be above 0 and below pi [rad]")));
    }
    let focal = 0.5 * height as f64 / (0.5 * angle).tan();
    Ok(View { eye, forward, right, up: right.cross(forward), focal, width, height })
}
