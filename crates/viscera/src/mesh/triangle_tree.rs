use std::f64::consts::PI;

use super::{Point, SignedDistance, SurfaceMesh};

/// A closed triangle surface as a solid: a box tree that answers how far and on which side a place lies.
///
/// The side comes from the generalized winding number (Jacobson, Kavan, Sorkine-Hornung 2013), which bears self-crossing
/// facets and small faults; far branches are replaced by one dipole each (Barill et al. 2018, first order).
#[derive(Clone, Debug)]
pub struct TriangleTree {
    triangles: Vec<[Point; 3]>,
    branches: Vec<Branch>,
}

/// A box with the triangles `from..to`; its halves are the next branch and `second`, unless it is a leaf.
#[derive(Clone, Debug)]
struct Branch {
    low: Point,
    high: Point,
    from: u32,
    to: u32,
    second: Option<u32>,
    /// Sum of the area vectors [m²].
    dipole: Point,
    /// Area-weighted centre of the triangles, and a radius around it that holds them all [m].
    centre: Point,
    radius: f64,
}

/// Triangles in a leaf.
const LEAF: usize = 6;
/// A branch this many radii away counts as one dipole: the winding number is then good to about 0.01.
const FAR: f64 = 3.0;

impl TriangleTree {
    /// Sorts the triangles of a surface into a tree. Corners must exist: see [`SurfaceMesh::repaired`].
    pub fn new(surface: &SurfaceMesh) -> Self {
        let triangles = surface.triangles.iter().map(|triangle| triangle.map(|node| surface.nodes[node as usize]));
        let mut tree = Self { triangles: triangles.collect(), branches: Vec::new() };
        if !tree.triangles.is_empty() {
            tree.grow(0, tree.triangles.len());
        }
        tree
    }

    /// Adds the branch of a range of triangles and what hangs on it; returns its number.
    fn grow(&mut self, from: usize, to: usize) -> u32 {
        let own = &self.triangles[from..to];
        let (low, high) = bounds(own.iter().flatten());
        let dipole = own.iter().fold(Point::ZERO, |sum, &triangle| sum + area_vector(triangle));
        let areas = own.iter().map(|&triangle| area_vector(triangle).norm());
        let area: f64 = areas.clone().sum();
        let weighted =
            own.iter().zip(areas).fold(Point::ZERO, |sum, (&[a, b, c], area)| sum + (a + b + c) * (area / 3.0));
        let centre = if area > 0.0 { weighted / area } else { (low + high) * 0.5 };
        let radius = own.iter().flatten().map(|&corner| (corner - centre).norm()).fold(0.0, f64::max);
        let number = self.branches.len();
        self.branches.push(Branch {
            low,
            high,
            from: from as u32,
            to: to as u32,
            second: None,
            dipole,
            centre,
            radius,
        });
        if to - from > LEAF {
            let extent = high - low;
            let axis = (0..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
            let middle = (from + to) / 2;
            let along = |[a, b, c]: &[Point; 3]| a[axis] + b[axis] + c[axis];
            self.triangles[from..to]
                .select_nth_unstable_by(middle - from, |one, other| along(one).total_cmp(&along(other)));
            self.grow(from, middle);
            let second = self.grow(middle, to);
            self.branches[number].second = Some(second);
        }
        number as u32
    }

    /// Distance to the nearest triangle [m]; infinite without triangles.
    pub fn unsigned_distance(&self, place: Point) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut waiting: Vec<(f64, u32)> = Vec::with_capacity(64);
        if let Some(root) = self.branches.first() {
            waiting.push((root.squared_distance(place), 0));
        }
        while let Some((at_least, number)) = waiting.pop() {
            if at_least >= nearest {
                continue;
            }
            let branch = &self.branches[number as usize];
            match branch.second {
                None => {
                    for &triangle in self.own(branch) {
                        nearest = nearest.min((closest_point(triangle, place) - place).squared_norm());
                    }
                }
                Some(second) => {
                    let mut halves =
                        [number + 1, second].map(|half| (self.branches[half as usize].squared_distance(place), half));
                    if halves[0].0 < halves[1].0 {
                        halves.swap(0, 1);
                    }
                    waiting.extend(halves);
                }
            }
        }
        nearest.sqrt()
    }

    /// How often the surface winds around a place: 1 inside, 0 outside, in between near faults.
    pub fn winding_number(&self, place: Point) -> f64 {
        let mut total = 0.0;
        let mut waiting = Vec::with_capacity(64);
        waiting.extend(self.branches.first().map(|_| 0u32));
        while let Some(number) = waiting.pop() {
            let branch = &self.branches[number as usize];
            let towards = branch.centre - place;
            let distance = towards.norm();
            if distance > FAR * branch.radius {
                total += branch.dipole.dot(towards) / (distance * distance * distance);
                continue;
            }
            match branch.second {
                None => total += self.own(branch).iter().map(|&triangle| solid_angle(triangle, place)).sum::<f64>(),
                Some(second) => waiting.extend([number + 1, second]),
            }
        }
        total / (4.0 * PI)
    }

    /// Distance along a ray of unit direction to the first triangle that it meets beyond `start` [m], if any.
    pub fn first_hit(&self, origin: Point, direction: Point, start: f64) -> Option<f64> {
        let mut first = f64::INFINITY;
        let mut waiting = Vec::with_capacity(64);
        waiting.extend(self.branches.first().map(|_| 0u32));
        while let Some(number) = waiting.pop() {
            let branch = &self.branches[number as usize];
            if !branch.meets_ray(origin, direction, first) {
                continue;
            }
            match branch.second {
                None => {
                    for &triangle in self.own(branch) {
                        if let Some(along) = ray_meets(triangle, origin, direction).filter(|&along| along > start) {
                            first = first.min(along);
                        }
                    }
                }
                Some(second) => waiting.extend([number + 1, second]),
            }
        }
        first.is_finite().then_some(first)
    }

    fn own(&self, branch: &Branch) -> &[[Point; 3]] {
        &self.triangles[branch.from as usize..branch.to as usize]
    }
}

impl SignedDistance for TriangleTree {
    fn distance(&self, place: Point) -> f64 {
        let distance = self.unsigned_distance(place);
        if self.winding_number(place) > 0.5 { -distance } else { distance }
    }

    fn bounds(&self) -> (Point, Point) {
        self.branches.first().map_or((Point::ZERO, Point::ZERO), |root| (root.low, root.high))
    }
}

impl Branch {
    fn squared_distance(&self, place: Point) -> f64 {
        (place.max(self.low).min(self.high) - place).squared_norm()
    }

    /// Whether a ray enters the box before `limit` (slabs; a direction of zero gives ±∞, which compares rightly).
    fn meets_ray(&self, origin: Point, direction: Point, limit: f64) -> bool {
        let (mut enter, mut leave) = (0.0f64, limit);
        for axis in 0..3 {
            let a = (self.low[axis] - origin[axis]) / direction[axis];
            let b = (self.high[axis] - origin[axis]) / direction[axis];
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter <= leave
    }
}

fn bounds<'a>(points: impl Iterator<Item = &'a Point>) -> (Point, Point) {
    let everywhere = (Point::new(f64::INFINITY, f64::INFINITY, f64::INFINITY), -Point::splat(f64::INFINITY));
    points.fold(everywhere, |(low, high), &point| (low.min(point), high.max(point)))
}

/// Half the cross product of two edges: as long as the area, outwards [m²].
fn area_vector([a, b, c]: [Point; 3]) -> Point {
    (b - a).cross(c - a) * 0.5
}

/// Solid angle under which a place sees a triangle, positive from inside (van Oosterom & Strackee 1983).
fn solid_angle(corners: [Point; 3], place: Point) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - place);
    let [x, y, z] = [a.norm(), b.norm(), c.norm()];
    2.0 * a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
}

/// The place of a triangle nearest to another place (Ericson, Real-Time Collision Detection, §5.1.5).
fn closest_point([a, b, c]: [Point; 3], place: Point) -> Point {
    let (ab, ac, ap) = (b - a, c - a, place - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = place - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = place - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let whole = va + vb + vc;
    a + ab * (vb / whole) + ac * (vc / whole)
}

/// How far along a ray it crosses a triangle (Möller & Trumbore 1997).
fn ray_meets([a, b, c]: [Point; 3], origin: Point, direction: Point) -> Option<f64> {
    let (ab, ac, from) = (b - a, c - a, origin - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let q = from.cross(ab);
    let (u, v) = (from.dot(p) / determinant, direction.dot(q) / determinant);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| ac.dot(q) / determinant)
}
