//! Solids with closed forms, as signed distances and as triangle surfaces.

use std::f64::consts::{PI, TAU};

use viscera::mesh::{Point, SignedDistance, SurfaceMesh, TetMesh};

pub(crate) struct Sphere {
    pub(crate) radius: f64,
}

impl SignedDistance for Sphere {
    fn distance(&self, place: Point) -> f64 {
        place.norm() - self.radius
    }

    fn bounds(&self) -> (Point, Point) {
        (Point::splat(-self.radius), Point::splat(self.radius))
    }
}

/// A ring around the z axis.
pub(crate) struct Torus {
    pub(crate) ring: f64,
    pub(crate) tube: f64,
}

impl Torus {
    pub(crate) fn volume(&self) -> f64 {
        2.0 * PI * PI * self.ring * self.tube * self.tube
    }
}

impl SignedDistance for Torus {
    fn distance(&self, place: Point) -> f64 {
        (place.x.hypot(place.y) - self.ring).hypot(place.z) - self.tube
    }

    fn bounds(&self) -> (Point, Point) {
        let high = Point::new(self.ring + self.tube, self.ring + self.tube, self.tube);
        (-high, high)
    }
}

/// The skin of a torus in `around` × `across` quadrilaterals, each cut in two.
pub(crate) fn torus_surface(torus: &Torus, around: usize, across: usize) -> SurfaceMesh {
    let mut surface = SurfaceMesh::default();
    for i in 0..around {
        for j in 0..across {
            let (along, over) = (TAU * i as f64 / around as f64, TAU * j as f64 / across as f64);
            let r = torus.ring + torus.tube * over.cos();
            surface.nodes.push(Point::new(r * along.cos(), r * along.sin(), torus.tube * over.sin()));
            let node = |i: usize, j: usize| (i % around * across + j % across) as u32;
            let (a, b, c, d) = (node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1));
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// The skin of a box from `low`, in triangles.
pub(crate) fn box_surface(cells: [usize; 3], low: [f64; 3], size: [f64; 3]) -> SurfaceMesh {
    let mut surface = TetMesh::box_grid(cells, size).surface();
    surface.nodes.iter_mut().for_each(|node| *node += Point::from(low));
    surface
}

/// Two surfaces in one.
pub(crate) fn together(one: &SurfaceMesh, other: &SurfaceMesh) -> SurfaceMesh {
    let mut both = one.clone();
    let first = one.nodes.len() as u32;
    both.nodes.extend(&other.nodes);
    both.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|node| node + first)));
    both
}

/// Three nodes of its own for every triangle, rounded to single precision: what an STL file holds.
pub(crate) fn soup(surface: &SurfaceMesh) -> SurfaceMesh {
    let rounded = |x: f64| f64::from(x as f32);
    let place = |node: u32| surface.nodes[node as usize];
    let corner = |node: u32| Point::new(rounded(place(node).x), rounded(place(node).y), rounded(place(node).z));
    let triangles = (0..surface.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    SurfaceMesh {
        nodes: surface.triangles.iter().flatten().map(|&node| corner(node)).collect(),
        triangles: triangles.collect(),
    }
}
