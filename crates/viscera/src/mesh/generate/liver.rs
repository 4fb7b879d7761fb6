use super::super::{Point, SignedDistance, TetMesh, TetTopology};
use super::GenerateError;
use crate::mesh::thickening;

/// A liver-like organ: a thick right lobe and a thin left one, a fissure between them, a hollowed underside.
///
/// Frame: x along the length (right lobe at negative x, left lobe at positive x), y up, z to the front, the origin near
/// the middle. The shape is drawn for a length of one and scaled; it is made of smoothly joined ellipsoids, a stand-in
/// for the anatomy and no segmentation of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Liver {
    length: f64,
}

impl Liver {
    /// A liver of the given length [m]; a grown-up's is 0.25 to 0.3 m.
    ///
    /// # Errors
    /// [`GenerateError::Length`] for a length that is not positive.
    pub fn new(length: f64) -> Result<Self, GenerateError> {
        GenerateError::check_length("length", length)?;
        Ok(Self { length })
    }

    /// Distance for a length of one.
    fn unit_distance(p: Point) -> f64 {
        // The dome under the diaphragm: thick and round on the right, running out thin to the left.
        let right = ellipsoid(p, [-0.19, -0.1, -0.01], [0.3, 0.33, 0.22]);
        let left = ellipsoid(turned(p, 0.1), [0.16, 0.02, 0.0], [0.36, 0.125, 0.14]);
        let dome = smooth_union(right, left, 0.2);
        // The underside looks down, back and to the left, so that the lower edge in front is the sharp one; stomach and
        // kidney press into it.
        let underside = plane(turned(p, 0.33), [0.0, -0.86, -0.5], 0.08);
        let stomach = ellipsoid(p, [0.24, -0.14, -0.06], [0.2, 0.16, 0.14]);
        let kidney = ellipsoid(p, [-0.26, -0.255, -0.15], [0.12, 0.15, 0.1]);
        let organ = smooth_intersection(dome, underside, 0.06);
        let organ = smooth_cut(organ, smooth_union(stomach, kidney, 0.05), 0.04);
        // The fissure of the round ligament: a notch in the lower edge, and a furrow up the front where the lobes meet.
        let notch = ellipsoid(turned(p, -0.15), [0.06, -0.2, 0.08], [0.024, 0.15, 0.16]);
        let furrow = ellipsoid(p, [0.07, 0.0, 0.178], [0.024, 0.2, 0.05]);
        smooth_cut(organ, smooth_union(notch, furrow, 0.04), 0.03)
    }
}

impl SignedDistance for Liver {
    fn distance(&self, place: Point) -> f64 {
        self.length * Self::unit_distance(place / self.length)
    }

    fn bounds(&self) -> (Point, Point) {
        (Point::new(-0.53, -0.32, -0.27) * self.length, Point::new(0.53, 0.32, 0.27) * self.length)
    }
}

/// Approximate distance to an ellipsoid, exact to first order at its skin (Quilez, "ellipsoids – distance functions").
fn ellipsoid(p: Point, centre: [f64; 3], radii: [f64; 3]) -> f64 {
    let p = p - Point::from(centre);
    let scaled = Point::new(p.x / radii[0], p.y / radii[1], p.z / radii[2]);
    let gradient = Point::new(scaled.x / radii[0], scaled.y / radii[1], scaled.z / radii[2]);
    let (k, slope) = (scaled.norm(), gradient.norm());
    if slope > 0.0 { k * (k - 1.0) / slope } else { -radii[0].min(radii[1]).min(radii[2]) }
}

/// Distance from a plane whose normal need not have length one.
fn plane(p: Point, normal: [f64; 3], offset: f64) -> f64 {
    let normal = Point::from(normal);
    normal.dot(p) / normal.norm() - offset
}

/// A place turned back by an angle around z, so that what is drawn there appears turned forwards.
fn turned(p: Point, angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    Point::new(cos * p.x + sin * p.y, cos * p.y - sin * p.x, p.z)
}

/// Union with a fillet of about `width` (polynomial smooth minimum, quadratic).
fn smooth_union(a: f64, b: f64, width: f64) -> f64 {
    let overlap = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - 0.25 * width * overlap * overlap
}

fn smooth_intersection(a: f64, b: f64, width: f64) -> f64 {
    -smooth_union(-a, -b, width)
}

/// What is left of `a` without `b`.
fn smooth_cut(a: f64, b: f64, width: f64) -> f64 {
    smooth_intersection(a, -b, width)
}

impl TetMesh {
    /// A liver-like organ of the given `length` [m] in tetrahedra of about `edge` [m] ([`Liver`], by
    /// [isosurface stuffing](Self::from_signed_distance), with its thinnest cells thickened).
    ///
    /// Regions: the cells "right-lobe" and "left-lobe" on both sides of the fissure; the boundary faces "back" (what
    /// faces backwards on the right lobe, where a liver hangs from the diaphragm), "underside", and "left-lobe-edge" (the
    /// tip of the left lobe, where a grasper takes hold).
    ///
    /// # Errors
    /// Those of [`Liver::new`] and [`TetMesh::from_signed_distance`].
    pub fn liver(length: f64, edge: f64) -> Result<Self, GenerateError> {
        let solid = Liver::new(length)?;
        let mut mesh = Self::from_signed_distance(&solid, edge)?;
        thickening::thicken(&mut mesh, &solid, edge);
        for cell in 0..mesh.cells.len() {
            let centre = mesh.corners(cell).into_iter().fold(Point::ZERO, |sum, corner| sum + corner) * 0.25;
            let name = if centre.x < 0.06 * length { "right-lobe" } else { "left-lobe" };
            let lobe = mesh.regions.entry(name.to_owned()).or_default();
            lobe.cells.push(cell as u32);
            lobe.nodes.extend(mesh.cells[cell]);
        }
        for face in TetTopology::new(&mesh).surface() {
            let [a, b, c] = face.map(|node| mesh.nodes[node as usize]);
            let centre = (a + b + c) / (3.0 * length);
            let Some(normal) = (b - a).cross(c - a).normalized() else { continue };
            let mut name = |name: &str| {
                let side = mesh.regions.entry(name.to_owned()).or_default();
                side.faces.push(face);
                side.nodes.extend(face);
            };
            if normal.z < -0.6 && centre.x < 0.0 && normal.y > -0.5 {
                name("back");
            }
            if normal.y < -0.6 {
                name("underside");
            }
            if centre.x > 0.38 {
                name("left-lobe-edge");
            }
        }
        mesh.regions.values_mut().for_each(|region| region.normalize());
        Ok(mesh)
    }
}
