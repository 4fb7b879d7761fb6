use super::super::Point;
use super::lattice::Lattice;

/// Closer to the skin than this part of an edge, a node lies on it. Far below any angle, far above rounding: flat sides
/// that run through lattice nodes are met exactly instead of flickering from node to node.
const ON_SKIN: f64 = 1e-9;

/// What the lattice nodes know of the solid.
pub(super) struct Skin {
    /// Negative inside, positive outside, zero on the skin [m].
    pub(super) value: Vec<f64>,
    /// Where each node lies [m]: its lattice place until it is warped.
    pub(super) place: Vec<Point>,
}

impl Skin {
    /// Asks for the distance at every lattice node.
    pub(super) fn sample(lattice: &Lattice, distance: impl Fn(Point) -> f64) -> Self {
        let place: Vec<_> = (0..lattice.node_count() as u32).map(|node| lattice.position(node)).collect();
        let snapped = |value: f64| if value.abs() < ON_SKIN * lattice.edge { 0.0 } else { value };
        let value = place.iter().map(|&place| snapped(distance(place))).collect();
        Self { value, place }
    }
}

/// Where the skin crosses a lattice edge.
pub(super) struct Cut {
    /// The lattice nodes at the ends.
    pub(super) ends: [u32; 2],
    /// How far along the edge from the first end, 0 to 1.
    pub(super) fraction: f64,
    /// Where [m].
    pub(super) place: Point,
}

/// All crossings of the skin with lattice edges, in the order of the edges.
pub(super) fn crossings(lattice: &Lattice, skin: &Skin, distance: impl Fn(Point) -> f64) -> Vec<Cut> {
    let crossed = lattice.edges().filter(|&[a, b]| skin.value[a as usize] * skin.value[b as usize] < 0.0);
    crossed
        .map(|ends| {
            let [from, to] = ends.map(|node| skin.place[node as usize]);
            let along = |fraction: f64| from + (to - from) * fraction;
            let values = ends.map(|node| skin.value[node as usize]);
            let fraction = root(values, ON_SKIN * lattice.edge, |fraction| distance(along(fraction)));
            Cut { ends, fraction, place: along(fraction) }
        })
        .collect()
}

/// A zero between 0 and 1 of a function with values of opposite sign there.
///
/// False position with the Illinois rule (halve the value at an end that stays twice), bisecting when that stalls.
fn root([mut low_value, mut high_value]: [f64; 2], enough: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let mut fraction = 0.5;
    for trial in 0..60 {
        fraction =
            if trial < 12 { low + (high - low) * low_value / (low_value - high_value) } else { 0.5 * (low + high) };
        let value = f(fraction);
        if value.abs() < enough || high - low < ON_SKIN {
            break;
        }
        if (value < 0.0) == (low_value < 0.0) {
            (low, low_value, high_value) = (fraction, value, 0.5 * high_value);
        } else {
            (high, high_value, low_value) = (fraction, value, 0.5 * low_value);
        }
    }
    fraction
}
