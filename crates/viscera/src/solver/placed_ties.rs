use super::TieEquations;
use crate::math::{Mat3, Scalar, Vec3};

/// Ties between nodes of a nodal vector.
#[derive(Clone, Debug)]
pub(crate) struct PlacedTies {
    equations: TieEquations,
    /// Where in the vector the nodes are that ties know.
    places: Vec<usize>,
}

impl PlacedTies {
    pub(crate) fn new(equations: TieEquations, places: Vec<usize>) -> Self {
        Self { equations, places }
    }

    /// Takes the mobilities of the nodes by their places; those of nodes that are gone in `by_mass` end their ties.
    pub(crate) fn update(&mut self, by_mass: &TieEquations, mobility: impl Fn(usize) -> Mat3<f64>) {
        self.equations.update(|node| by_mass.knows(node).then(|| mobility(self.places[node])));
    }

    /// Takes out of forces what the ties take; gives λ of each.
    pub(crate) fn take_out<T: Scalar>(&mut self, forces: &mut [Vec3<T>]) -> &[Vec3<f64>] {
        self.equations.resolve_forces(|node| forces[self.places[node]].cast());
        for (node, &place) in self.places.iter().enumerate() {
            forces[place] = (forces[place].cast::<f64>() - self.equations.force(node)).cast();
        }
        self.equations.multipliers()
    }

    /// Moves `x` by the least that makes it fulfil the ties together with what is known besides of each node that they know.
    pub(crate) fn fulfil<T: Scalar>(&mut self, x: &mut [Vec3<T>], known: impl Fn(usize) -> Vec3<f64>) {
        self.equations.resolve(|node| known(node) + x[self.places[node]].cast());
        for (node, &place) in self.places.iter().enumerate() {
            let change = self.equations.mobility(node) * self.equations.force(node);
            x[place] = (x[place].cast::<f64>() - change).cast();
        }
    }
}
