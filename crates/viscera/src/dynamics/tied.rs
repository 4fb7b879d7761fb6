//! Bodies that ties hold together, and what ties do in explicit sub-steps.
//!
//! On lumped masses, before the drift for places and after the second kick for velocities, as RATTLE does for equations: these are linear and
//! never change, so that one solve with their factors is exact.

use super::implicit::{Implicit, ImplicitTies};
use crate::body::SimulatedBody;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::Point;
use crate::solver::{Filter, PlacedTies, Tie, TieEquations};

/// A node of one body that stays at a place of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedNode {
    /// Number of the node.
    pub(crate) node: u32,
    /// Nodes of the other body that say where the place is.
    pub(crate) anchors: [u32; 4],
    /// Their weights, of the sum 1.
    pub(crate) weights: [f64; 4],
}

/// What impulses are to bring about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aim {
    /// Tied places meet at the end of the drift.
    Place,
    /// They move alike.
    Velocity,
}

/// A node that ties know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct TiedNode {
    /// Which of the tied bodies.
    pub(super) member: usize,
    pub(super) node: usize,
}

/// Bodies that ties hold together, directly or by way of others.
#[derive(Debug)]
pub(crate) struct TiedBodies<T> {
    /// Numbers of the bodies in their world, ascending.
    pub(crate) bodies: Vec<usize>,
    pub(super) nodes: Vec<TiedNode>,
    /// Number of the attachment of each tie, and which of the bodies its node is of.
    pub(super) attachments: Vec<(usize, usize)>,
    pub(super) ties: Vec<Tie>,
    /// The equations over lumped masses.
    pub(super) by_mass: TieEquations,
    /// What implicit steps need besides.
    pub(super) implicit: Option<ImplicitTies<T>>,
}

/// Which bodies of a world are solved together.
#[derive(Debug)]
pub(crate) enum Together<'a, T> {
    /// The one of this number.
    Alone(usize),
    /// Those that ties hold together.
    Tied(&'a mut TiedBodies<T>),
}

impl<'a, T: Scalar> Together<'a, T> {
    /// Those of which the body of this number is the first; none where another one is.
    pub(crate) fn led_by(number: usize, tied: &'a mut [TiedBodies<T>]) -> Option<Self> {
        match tied.iter_mut().find(|tied| tied.bodies.contains(&number)) {
            None => Some(Self::Alone(number)),
            Some(tied) => (tied.bodies.first() == Some(&number)).then_some(Self::Tied(tied)),
        }
    }
}

impl<T: Scalar> TiedBodies<T> {
    /// The bodies of these numbers in their world, and their attachments: the number of each, the bodies whose nodes it ties and to which it
    /// ties them, and the nodes.
    pub(crate) fn new<'a>(
        bodies: Vec<usize>,
        attachments: impl Iterator<Item = (usize, [usize; 2], &'a [PlacedNode])>,
    ) -> Self {
        let mut of_ties = Vec::new();
        let mut rows = Vec::new();
        for (number, ends, nodes) in attachments {
            let [own, other] = ends.map(|end| bodies.iter().position(|&body| body == end).unwrap_or_default());
            for placed in nodes {
                let anchors = placed.anchors.map(|node| TiedNode { member: other, node: node as usize });
                let node = TiedNode { member: own, node: placed.node as usize };
                let [a, b, c, d] = placed.weights.map(|weight| -weight);
                of_ties.push((number, own));
                rows.push(([node, anchors[0], anchors[1], anchors[2], anchors[3]], [1.0, a, b, c, d]));
            }
        }
        let mut nodes: Vec<TiedNode> = rows.iter().flat_map(|(nodes, _)| *nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let number = |node: TiedNode| nodes.binary_search(&node).unwrap_or_default() as u32;
        let ties: Vec<Tie> = rows.iter().map(|&(nodes, weights)| Tie { nodes: nodes.map(number), weights }).collect();
        let by_mass = TieEquations::new(ties.clone(), nodes.len());
        Self { bodies, nodes, attachments: of_ties, ties, by_mass, implicit: None }
    }

    /// The same with the memory that implicit steps take.
    pub(crate) fn with_implicit_steps(self, bodies: &[SimulatedBody<T>], settings: &Implicit) -> Self {
        Self { implicit: Some(ImplicitTies::new(&self, bodies, settings)), ..self }
    }

    /// The ties in a nodal vector of all these bodies, where the nodes of each begin at `starts`.
    pub(super) fn placed(&self, starts: &[usize]) -> PlacedTies {
        let places = self.nodes.iter().map(|node| starts[node.member] + node.node).collect();
        PlacedTies::new(TieEquations::new(self.ties.clone(), self.nodes.len()), places)
    }

    /// Hears of the force on the node of each tie in the equilibrium that was found last [N], with the number of its attachment.
    pub(crate) fn each_force(&self, mut give: impl FnMut(usize, Point)) {
        let multipliers = self.by_mass.multipliers();
        self.attachments.iter().zip(multipliers).for_each(|(&(attachment, _), &force)| give(attachment, -force));
    }

    /// Looks whether nodes were cut off, taken hold of or let go, before the sub-steps of a step.
    pub(crate) fn begin(&mut self, bodies: &[SimulatedBody<T>]) {
        let (numbers, nodes) = (&self.bodies, &self.nodes);
        self.by_mass.update(|node| {
            let TiedNode { member, node } = nodes[node];
            let body = &bodies[numbers[member]];
            mobility_of_mass(body.state.masses[node], &body.free_directions(node))
        });
    }

    /// Impulses that hold together what is tied, in a sub-step of `dt` [s]; `give` hears of those on the node of each tie, with the number of
    /// its attachment.
    pub(crate) fn hold_together(
        &mut self,
        bodies: &mut [SimulatedBody<T>],
        dt: f64,
        aim: Aim,
        mut give: impl FnMut(usize, Point),
    ) {
        let (numbers, nodes) = (&self.bodies, &self.nodes);
        self.by_mass.resolve(|node| {
            let TiedNode { member, node } = nodes[node];
            let state = &bodies[numbers[member]].state;
            match aim {
                Aim::Place => state.positions[node].cast::<f64>() / dt,
                Aim::Velocity => state.velocities[node].cast(),
            }
        });
        for (number, &TiedNode { member, node }) in nodes.iter().enumerate() {
            let state = &mut bodies[numbers[member]].state;
            let change = -(self.by_mass.mobility(number) * self.by_mass.force(number));
            state.velocities[node] += change.cast();
            if aim == Aim::Place {
                state.positions[node] = (state.positions[node].cast::<f64>() + change * dt).cast();
            }
        }
        for (&(attachment, own), &multiplier) in self.attachments.iter().zip(self.by_mass.multipliers()) {
            // The second kick has been divided by this, and would have divided the impulse in it as well.
            let damping = match aim {
                Aim::Place => 1.0,
                Aim::Velocity => 1.0 + 0.5 * dt * bodies[numbers[own]].damping.to_f64(),
            };
            give(attachment, -(multiplier * damping));
        }
    }
}

/// The velocity that a unit of impulse gives a node in its free directions [1/kg]; none for a node that was cut off.
pub(super) fn mobility_of_mass<T: Scalar>(mass: T, filter: &Filter<T>) -> Option<Mat3<f64>> {
    let mass = mass.to_f64();
    (mass > 0.0).then(|| match filter.cast::<f64>() {
        Filter::Free => Mat3::diagonal(1.0 / mass),
        Filter::Held => Mat3::ZERO,
        filter => Mat3 { columns: Mat3::IDENTITY.columns.map(|axis: Vec3<f64>| filter.apply(axis) / mass) },
    })
}
