use super::BodyError;
use crate::curve::Curve;
use crate::math::{Scalar, Vec3};
use crate::mesh::{Region, VolumeMesh};
use crate::solver::Filter;

/// What is left of a direction once those before are taken out of it, below which it adds nothing.
const INDEPENDENT: f64 = 1e-6;

/// Directions in which nodes do not follow the forces but a displacement that is known: symmetry planes, rollers, plates that
/// slide.
#[derive(Clone, Debug)]
pub(crate) struct Guides {
    curves: Vec<Curve<f64>>,
    guides: Vec<Guide>,
    /// Which guides meet at a node that has any, for those with this number.
    meetings: Vec<Vec<usize>>,
}

/// Up to three orthonormal directions, and in each the displacement as a sum of curves with factors.
#[derive(Clone, Debug, Default)]
struct Guide {
    directions: Vec<Vec3<f64>>,
    displacements: Vec<Vec<(usize, f64)>>,
}

impl Guide {
    /// Adds the condition that the displacement along the unit vector `normal` follows a curve. A direction that is fixed
    /// already is left as it is.
    fn add(&mut self, normal: Vec3<f64>, curve: usize) {
        let (mut rest, mut terms) = (normal, vec![(curve, 1.0)]);
        for (&direction, known) in self.directions.iter().zip(&self.displacements) {
            let along = direction.dot(normal);
            rest -= direction * along;
            terms.extend(known.iter().map(|&(curve, factor)| (curve, -along * factor)));
        }
        let length = rest.norm();
        if length > INDEPENDENT {
            self.directions.push(rest / length);
            self.displacements.push(terms.into_iter().map(|(curve, factor)| (curve, factor / length)).collect());
        }
    }
}

impl Guides {
    /// Guides of regions along normals; gives them besides the number of the guide of each node, where there is one.
    pub(crate) fn new(
        body: &str,
        guided: Vec<(Region, [f64; 3], Curve<f64>)>,
        mesh: &VolumeMesh,
    ) -> Result<(Self, Vec<Option<u32>>), BodyError> {
        let mut at_nodes: Vec<Vec<usize>> = vec![Vec::new(); mesh.nodes().len()];
        let (mut curves, mut normals) = (Vec::new(), Vec::new());
        for (number, (region, normal, curve)) in guided.into_iter().enumerate() {
            let normal = Vec3::from(normal);
            let length = normal.norm();
            if !(length.is_finite() && length > 0.0) {
                let (name, range) = ("the length of a guide's normal", "positive and finite");
                return Err(BodyError::OutOfRange { body: body.into(), name, value: length, range });
            }
            let nodes = region.nodes(mesh).map_err(|source| BodyError::Region {
                body: body.into(),
                purpose: "a guide",
                source: Box::new(source),
            })?;
            nodes.into_iter().for_each(|node| at_nodes[node as usize].push(number));
            normals.push(normal / length);
            curves.push(curve);
        }
        let mut guides = Self { curves, guides: Vec::new(), meetings: Vec::new() };
        let number = |meeting: Vec<usize>| guides.number(meeting, &normals);
        let at_nodes = at_nodes.into_iter().map(number).collect();
        Ok((guides, at_nodes))
    }

    /// The number of the guide for normals that meet; none if there are none.
    fn number(&mut self, meeting: Vec<usize>, normals: &[Vec3<f64>]) -> Option<u32> {
        if meeting.is_empty() {
            return None;
        }
        let known = self.meetings.iter().position(|other| *other == meeting);
        let number = known.unwrap_or_else(|| {
            let mut guide = Guide::default();
            meeting.iter().for_each(|&curve| guide.add(normals[curve], curve));
            self.guides.push(guide);
            self.meetings.push(meeting);
            self.guides.len() - 1
        });
        Some(number as u32)
    }

    /// Whether there is a guide of this number.
    pub(crate) fn has(&self, guide: u32) -> bool {
        (guide as usize) < self.guides.len()
    }

    /// The directions that are left to the forces.
    pub(crate) fn filter<T: Scalar>(&self, guide: u32) -> Filter<T> {
        match self.guides[guide as usize].directions[..] {
            [] => Filter::Free,
            [p] => Filter::Plane(p.cast()),
            [p, q] => Filter::Line(p.cast(), q.cast()),
            _ => Filter::Held,
        }
    }

    /// Displacement from rest along the directions that are known [m], at `time` [s].
    pub(crate) fn displacement(&self, guide: u32, time: f64) -> Vec3<f64> {
        let Guide { directions, displacements } = &self.guides[guide as usize];
        let mut sum = Vec3::ZERO;
        for (&direction, terms) in directions.iter().zip(displacements) {
            sum += direction * terms.iter().map(|&(curve, factor)| factor * self.curves[curve].at(time)).sum::<f64>();
        }
        sum
    }

    /// How many curves displace along guides.
    pub(crate) fn curve_count(&self) -> usize {
        self.curves.len()
    }

    /// Where a curve is at `time` [s]: a displacement [m].
    pub(crate) fn value(&self, curve: usize, time: f64) -> f64 {
        self.curves[curve].at(time)
    }

    /// Displacement of a guide's nodes for a unit of one curve, the others at zero.
    pub(crate) fn share_of(&self, guide: u32, curve: usize) -> Vec3<f64> {
        let Guide { directions, displacements } = &self.guides[guide as usize];
        let of = |terms: &[(usize, f64)]| terms.iter().filter(|term| term.0 == curve).map(|term| term.1).sum::<f64>();
        directions.iter().zip(displacements).fold(Vec3::ZERO, |sum, (&direction, terms)| sum + direction * of(terms))
    }
}
