use super::BodyError;
use crate::curve::Curve;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{Point, Region, RegionError, VolumeMesh};
use crate::model::BlockSink;

/// Share of its length at rest from which an actuator that has come together loses its direction, and with it the part of its
/// pull that does not grow with its length.
const TOGETHER: f64 = 0.01;

/// A linear actuator: it pulls along a line with τ = k (l − s L) + T, of the length l now and L at rest.
///
/// With s it is a spring whose rest length is commanded, with T a motor whose force is; both follow curves of time. What it does at
/// one end it does at the other: it leaves momentum and angular momentum alone. For every integrator, with its exact tangent
/// k n nᵀ + τ/l (I − n nᵀ) where one is wanted. Closer than a hundredth of L, sL k and T fall in proportion to l.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuator {
    /// Where it pulls.
    pub line: ActuatorLine,
    /// k [≥ 0]: in N/m between two regions, in Pa (Young's modulus along the direction) in the cells of one.
    pub stiffness: f64,
    /// s [≥ 0], along time [s]: the length at which the spring is slack, over that at rest. 1 is that of the rest shape.
    pub length: Curve<f64>,
    /// T, along time [s], positive where it draws together: in N between two regions, in Pa of rest area in the cells of one.
    pub tension: Curve<f64>,
}

/// Where an actuator pulls.
#[derive(Clone, Debug, PartialEq)]
pub enum ActuatorLine {
    /// From the mean place of a region's nodes to that of another's, which share its pull equally. A region may be one node.
    Between {
        /// The nodes at one end.
        from: Region,
        /// The nodes at the other.
        to: Region,
    },
    /// In every cell of a region, along a direction of the rest shape that goes with the tissue: fibres through all of it. Of a
    /// hexahedron the line through its centre counts.
    Along {
        /// The cells.
        region: Region,
        /// The direction at rest, of any length but zero.
        direction: [f64; 3],
    },
}

/// The actuators of a body, their regions resolved.
#[derive(Clone, Debug)]
pub(crate) struct Actuators<T> {
    actuators: Vec<Resolved<T>>,
    /// Nodes of each actuator between two regions.
    groups: Vec<Vec<u32>>,
}

#[derive(Clone, Debug)]
struct Resolved<T> {
    length: Curve<f64>,
    tension: Curve<f64>,
    lines: Vec<Line>,
    /// Nodes, and how much of each the vector of a line is made of: d = Σ w x, with Σ w = 0.
    terms: Vec<(u32, T)>,
}

/// A vector d = Σ w x, and the energy ½ K (|d| − s D)² + A T |d|.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Its terms are those from one number to the next.
    terms: (usize, usize),
    /// The cell that it lies in, or how many of the terms are its first end.
    place: Place,
    /// D, |d| at rest.
    rest: f64,
    /// K.
    stiffness: f64,
    /// A.
    area: f64,
    /// Whether anything of it is left at both ends.
    there: bool,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Cell(u32),
    Ends(usize),
}

impl<T: Scalar> Actuators<T> {
    pub(crate) fn new(body: &str, actuators: Vec<Actuator>, mesh: &VolumeMesh) -> Result<Self, BodyError> {
        let resolved = actuators.iter().map(|actuator| Resolved::new(body, actuator, mesh));
        let actuators = resolved.collect::<Result<Vec<_>, _>>()?;
        let between = |actuator: &&Resolved<T>| matches!(actuator.lines[0].place, Place::Ends(_));
        let nodes = |actuator: &Resolved<T>| actuator.terms.iter().map(|term| term.0).collect();
        let groups = actuators.iter().filter(between).map(nodes).collect();
        Ok(Self { actuators, groups })
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.actuators.is_empty()
    }

    /// Nodes that know each other's forces though no cell joins them, group by group.
    pub(crate) fn groups(&self) -> &[Vec<u32>] {
        &self.groups
    }

    /// Leaves out what is cut away: cells, and nodes without any.
    pub(crate) fn update(&mut self, removed: &[bool], cells_at_node: &[u32]) {
        for actuator in &mut self.actuators {
            for line in &mut actuator.lines {
                match line.place {
                    Place::Cell(cell) => line.there = !removed[cell as usize],
                    Place::Ends(first) => {
                        let (from, to) = actuator.terms.split_at_mut(first);
                        let left =
                            |end: &[(u32, T)]| end.iter().filter(|term| cells_at_node[term.0 as usize] > 0).count();
                        let counts = [left(from), left(to)];
                        line.there = counts.iter().all(|&count| count > 0);
                        for (end, share) in [(from, -1.0 / counts[0] as f64), (to, 1.0 / counts[1] as f64)] {
                            for (node, weight) in end {
                                let is_left = line.there && cells_at_node[*node as usize] > 0;
                                *weight = T::from_f64(if is_left { share } else { 0.0 });
                            }
                        }
                    }
                }
            }
        }
    }

    /// Adds the forces on nodes at `x` [m] at `time` [s] to `out` [N].
    pub(crate) fn add(&self, time: f64, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        for actuator in &self.actuators {
            let (length, tension) = (actuator.length.at(time), actuator.tension.at(time));
            for line in actuator.lines.iter().filter(|line| line.there) {
                let terms = actuator.terms(line);
                let d = vector(terms, x);
                let constant = T::from_f64(line.constant(length, tension));
                let pull = d * (T::from_f64(line.stiffness) + constant / line.span(d.norm()));
                terms.iter().for_each(|&(node, weight)| out[node as usize] += -(pull * weight));
            }
        }
    }

    /// Shows `visit` the terms of every line and the stiffness H by which what it pulls with grows with its vector, at `time`
    /// [s] on nodes at `x`: the tangent −∂f_i/∂x_j is w_i w_j H.
    pub(crate) fn for_stiffness(&self, time: f64, x: &[Vec3<T>], mut visit: impl FnMut(&[(u32, T)], Mat3<T>)) {
        for actuator in &self.actuators {
            let (length, tension) = (actuator.length.at(time), actuator.tension.at(time));
            for line in actuator.lines.iter().filter(|line| line.there) {
                let terms = actuator.terms(line);
                let d = vector(terms, x);
                let (size, constant) = (d.norm(), T::from_f64(line.constant(length, tension)));
                let span = line.span(size);
                let mut stiffness = Mat3::diagonal(T::from_f64(line.stiffness) + constant / span);
                if size >= span {
                    let along = d / size;
                    stiffness = stiffness - along.outer(along * (constant / span));
                }
                visit(terms, stiffness);
            }
        }
    }

    /// Adds −∂f/∂x [N/m] times `factor` to `sink`, between all nodes of each line.
    pub(crate) fn add_blocks(&self, time: f64, x: &[Vec3<T>], factor: f64, sink: &mut dyn BlockSink<T>) {
        let factor = T::from_f64(factor);
        self.for_stiffness(time, x, |terms, stiffness| {
            for &(row, of_row) in terms {
                for &(column, of_column) in terms {
                    sink.add(row, column, stiffness * (factor * of_row * of_column));
                }
            }
        });
    }

    /// What they add to the bound of ω² [1/s²] at any time on nodes at `x`, `sums` being nodal memory.
    ///
    /// Where h bounds H, Σ h |Σ w_i v_i|² ≤ Σ h Σ_j |w_j| Σ_i |w_i| |v_i|².
    pub(crate) fn squared_frequency(&self, x: &[Vec3<T>], masses: &[T], sums: &mut [[T; 4]]) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        sums.iter_mut().for_each(|row| row[0] = T::ZERO);
        for actuator in &self.actuators {
            let shortest = least(&actuator.length, 1.0);
            let strongest = -least(&actuator.tension, -1.0);
            for line in actuator.lines.iter().filter(|line| line.there) {
                let terms = actuator.terms(line);
                let across = line.constant(shortest, strongest).max(0.0) / line.span(vector(terms, x).norm()).to_f64();
                let all: f64 = terms.iter().map(|term| term.1.to_f64().abs()).sum();
                for &(node, weight) in terms {
                    let share = (line.stiffness + across) * all * weight.to_f64().abs();
                    sums[node as usize][0] += T::from_f64(share);
                }
            }
        }
        let of_node = |(row, mass): (&[T; 4], &T)| row[0].to_f64() / mass.to_f64();
        sums.iter().zip(masses).filter(|(row, _)| row[0] > T::ZERO).map(of_node).fold(0.0, f64::max)
    }
}

/// The least of a curve's values times `sign`.
fn least(curve: &Curve<f64>, sign: f64) -> f64 {
    curve.points().iter().map(|point| sign * point.1).fold(f64::INFINITY, f64::min)
}

/// d = Σ w x, counted from the first node: weights add up to nothing, and rounding then knows nothing of where the body is.
fn vector<T: Scalar>(terms: &[(u32, T)], x: &[Vec3<T>]) -> Vec3<T> {
    let base = x[terms[0].0 as usize];
    terms.iter().fold(Vec3::ZERO, |sum, &(node, weight)| sum + (x[node as usize] - base) * weight)
}

impl Line {
    /// A T − K s D: what it pulls with besides K |d|.
    fn constant(&self, length: f64, tension: f64) -> f64 {
        self.area * tension - self.stiffness * length * self.rest
    }

    /// |d|, but no less than what still has a direction.
    fn span<T: Scalar>(&self, size: T) -> T {
        size.max(T::from_f64(TOGETHER * self.rest))
    }
}

impl<T: Scalar> Resolved<T> {
    fn new(body: &str, actuator: &Actuator, mesh: &VolumeMesh) -> Result<Self, BodyError> {
        let out = |name, value, range| Err(BodyError::OutOfRange { body: body.into(), name, value, range });
        let Actuator { line, stiffness, length, tension } = actuator;
        let (name_of_stiffness, name_of_length, unit) = match line {
            ActuatorLine::Between { .. } => ("actuator stiffness", "actuator length", "zero or positive [N/m]"),
            ActuatorLine::Along { .. } => ("active fibre stiffness", "active fibre length", "zero or positive [Pa]"),
        };
        if !(stiffness.is_finite() && *stiffness >= 0.0) {
            return out(name_of_stiffness, *stiffness, unit);
        }
        if let Some(&(_, value)) = length.points().iter().find(|(_, value)| *value < 0.0) {
            return out(name_of_length, value, "zero or positive, a share of the length at rest");
        }
        let region_error = |source: RegionError| BodyError::Region {
            body: body.into(),
            purpose: "an actuator",
            source: Box::new(source),
        };
        let (mut lines, mut terms) = (Vec::new(), Vec::new());
        match line {
            ActuatorLine::Between { from, to } => {
                let ends = [from, to].map(|region| region.nodes(mesh).map_err(region_error));
                let [from, to] = ends;
                let (from, to) = (from?, to?);
                let mean = |nodes: &[u32]| {
                    nodes.iter().fold(Point::ZERO, |sum, &node| sum + mesh.nodes()[node as usize]) / nodes.len() as f64
                };
                let rest = (mean(&to) - mean(&from)).norm();
                if rest <= 1e-9 * mesh.size() {
                    return out("actuator length at rest", rest, "positive [m]: its two ends lie in one place");
                }
                let end = |nodes: &[u32], sign: f64| {
                    let share = T::from_f64(sign / nodes.len() as f64);
                    nodes.iter().map(|&node| (node, share)).collect::<Vec<_>>()
                };
                terms.extend(end(&from, -1.0));
                terms.extend(end(&to, 1.0));
                let place = Place::Ends(from.len());
                let stiffness = *stiffness;
                lines.push(Line { terms: (0, terms.len()), place, rest, stiffness, area: 1.0, there: true });
            }
            ActuatorLine::Along { region, direction } => {
                let Some(direction) = Point::from(*direction).normalized().filter(|unit| unit.is_finite()) else {
                    return out("active fibre direction", 0.0, "a vector with a length");
                };
                for cell in region.cells(mesh).map_err(region_error)? {
                    let (volume, gradients) = cell_gradients(mesh, cell as usize)
                        .map_err(|source| BodyError::Mesh { body: body.into(), source })?;
                    let start = terms.len();
                    let weights = gradients.iter().map(|gradient| T::from_f64(gradient.dot(direction)));
                    terms.extend(mesh.cell(cell as usize).iter().copied().zip(weights));
                    let (place, stiffness) = (Place::Cell(cell), stiffness * volume);
                    let terms = (start, terms.len());
                    lines.push(Line { terms, place, rest: 1.0, stiffness, area: volume, there: true });
                }
            }
        }
        Ok(Self { length: length.clone(), tension: tension.clone(), lines, terms })
    }

    fn terms(&self, line: &Line) -> &[(u32, T)] {
        &self.terms[line.terms.0..line.terms.1]
    }
}

/// Volume [m³] of a cell and the gradients of its shape functions [1/m], of a hexahedron those at its centre.
fn cell_gradients(mesh: &VolumeMesh, cell: usize) -> Result<(f64, Vec<Point>), crate::mesh::MeshError> {
    match mesh {
        VolumeMesh::Tet(mesh) => {
            let [a, b, c] = mesh.edge_matrix(cell).inverse().transpose().columns;
            Ok((mesh.cell_volume(cell), vec![-(a + b + c), a, b, c]))
        }
        VolumeMesh::Hex(mesh) => Ok((mesh.cell_volume(cell), mesh.centre_gradients(cell)?.to_vec())),
    }
}
