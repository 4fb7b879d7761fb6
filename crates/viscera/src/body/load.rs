use super::field::{Ball, VolumeShares};
use crate::curve::Curve;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{LoadTriangle, Region, RegionError, VolumeMesh};
use crate::model::BlockSink;

/// What pulls or presses on a body.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// A force on a region, shared equally by its nodes.
    Force {
        /// The nodes.
        region: Region,
        /// Sum over the region [N], along time [s].
        total: Curve<Vec3<f64>>,
    },
    /// A pressure on a part of the surface: it acts along the current inward normal and follows the deformation.
    Pressure {
        /// The faces.
        region: Region,
        /// Pressure [Pa], positive inwards, along time [s].
        pressure: Curve<f64>,
    },
    /// A force per rest area on a part of the surface, of constant direction (a dead load).
    Traction {
        /// The faces.
        region: Region,
        /// Traction [Pa], along time [s].
        traction: Curve<Vec3<f64>>,
    },
    /// A force field of one direction: a force per rest volume, which pulls at all cells of a region alike.
    BodyForce {
        /// The cells.
        region: Region,
        /// Force per rest volume [N/m³], along time [s]. Weight is density times gravity.
        per_volume: Curve<Vec3<f64>>,
    },
    /// A force field towards a place, that of a homogeneous ball: strongest at its surface, falling by the square of the distance
    /// outside and in proportion to it inside. A model that is pre-computed knows it as it is on the rest shape.
    Attraction {
        /// The cells.
        region: Region,
        /// The place [m]. It stays where it is.
        centre: [f64; 3],
        /// Radius of the ball [m, > 0].
        radius: f64,
        /// Force per rest volume at the radius [N/m³], positive inwards, along time [s].
        per_volume: Curve<f64>,
    },
}

/// Loads with their regions resolved, ready to be added up.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodalLoads<T> {
    loads: Vec<NodalLoad<T>>,
}

#[derive(Clone, Debug)]
enum NodalLoad<T> {
    /// Shares of each node; they add up to 1 (force) or to the rest area (traction).
    Shares {
        shares: Vec<(u32, T)>,
        curve: Curve<Vec3<f64>>,
        faces: Vec<FaceShare>,
    },
    Pressure {
        faces: Vec<LoadTriangle>,
        pressure: Curve<f64>,
    },
    BodyForce {
        volumes: VolumeShares,
        per_volume: Curve<Vec3<f64>>,
    },
    Attraction {
        volumes: VolumeShares,
        ball: Ball,
        per_volume: Curve<f64>,
    },
}

/// A load that cannot be.
pub(crate) enum LoadError {
    /// A region, and what it is for.
    Region(&'static str, RegionError),
    /// The radius of an attraction.
    Radius(f64),
}

/// A face of a traction: when the cell behind it is cut away, its share is gone.
#[derive(Clone, Copy, Debug)]
struct FaceShare {
    nodes: [u32; 3],
    cell: u32,
    area: f64,
}

impl<T: Scalar> NodalLoads<T> {
    pub(crate) fn new(loads: &[Load], mesh: &VolumeMesh) -> Result<Self, LoadError> {
        let loads = loads.iter().map(|load| NodalLoad::new(load, mesh)).collect::<Result<_, _>>()?;
        Ok(Self { loads })
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// Leaves out what is cut away of force fields.
    pub(crate) fn update(&mut self, removed: &[bool]) {
        for load in &mut self.loads {
            if let NodalLoad::BodyForce { volumes, .. } | NodalLoad::Attraction { volumes, .. } = load {
                volumes.update(removed);
            }
        }
    }

    /// Adds the loads at `time` [s] on nodes at `x` to `out`. Faces whose cell is removed carry nothing, and nodes that
    /// are retired are the integrator's business.
    pub(crate) fn add(&self, time: f64, x: &[Vec3<T>], removed: &[bool], out: &mut [Vec3<T>]) {
        for load in &self.loads {
            load.add(time, x, removed, out);
        }
    }
}

impl<T: Scalar> NodalLoads<T> {
    /// Whether there is a field that changes with the place.
    pub(crate) fn has_stiffness(&self) -> bool {
        self.loads.iter().any(|load| matches!(load, NodalLoad::Attraction { .. }))
    }

    /// Shows `visit` −∂f/∂x [N/m] of every node that a field changes with, at `time` [s] on nodes at `x`.
    pub(crate) fn for_stiffness(&self, time: f64, x: &[Vec3<T>], mut visit: impl FnMut(u32, Mat3<T>)) {
        for load in &self.loads {
            let NodalLoad::Attraction { volumes, ball, per_volume } = load else { continue };
            let strength = per_volume.at(time);
            for (node, volume) in volumes.nodes() {
                visit(node as u32, (ball.stiffness(x[node]) * (strength * volume)).cast());
            }
        }
    }

    /// What fields add to the bound of ω² [1/s²] at any time and place, `masses` being those of the nodes [kg].
    pub(crate) fn squared_frequency(&self, masses: &[T]) -> f64 {
        let of_load = |load: &NodalLoad<T>| {
            let NodalLoad::Attraction { volumes, ball, per_volume } = load else { return 0.0 };
            let strongest = per_volume.points().iter().map(|point| point.1.abs()).fold(0.0, f64::max);
            let of_node = |(node, volume): (usize, f64)| volume / masses[node].to_f64();
            strongest * ball.steepest() * volumes.nodes().map(of_node).fold(0.0, f64::max)
        };
        self.loads.iter().map(of_load).sum()
    }

    /// Adds −∂f_ext/∂x [N/m] of the loads that follow the surface and of fields, times `factor`, to `sink`: its symmetric part, which is all
    /// of it but at the rim of the loaded surface.
    pub(crate) fn add_blocks(
        &self,
        time: f64,
        x: &[Vec3<T>],
        removed: &[bool],
        factor: f64,
        sink: &mut dyn BlockSink<T>,
    ) {
        for load in &self.loads {
            let NodalLoad::Pressure { faces, pressure } = load else { continue };
            let pressure = factor * pressure.at(time);
            for face in faces.iter().filter(|face| !removed[face.cell as usize]) {
                let [a, b, c] = face.nodes.map(|node| x[node as usize]);
                // (b − a)×(c − a) changes by v×w when a corner moves by v, with w the edge opposite to it
                let half = T::from_f64(-0.5 * pressure * face.weight / 6.0);
                for (opposite, column) in [b - c, c - a, a - b].into_iter().zip(face.nodes) {
                    let axes = Mat3::IDENTITY.columns;
                    let block = Mat3 { columns: axes.map(|axis: Vec3<T>| opposite.cross(axis) * half) };
                    for row in face.nodes {
                        sink.add(row, column, block);
                        sink.add(column, row, block.transpose());
                    }
                }
            }
        }
        self.for_stiffness(time, x, |node, block| sink.add(node, node, block * T::from_f64(factor)));
    }

    /// Forces [N] of every load on the body as it is at `rest`, for a unit of each component of its curve: number, component, forces.
    pub(crate) fn unit_forces(&self, rest: &[Vec3<T>]) -> Vec<(usize, usize, Vec<Vec3<T>>)> {
        let mut all = Vec::new();
        for (number, load) in self.loads.iter().enumerate() {
            for (component, unit) in Mat3::<f64>::IDENTITY.columns.into_iter().enumerate().take(load.components()) {
                let mut forces = vec![Vec3::ZERO; rest.len()];
                load.add_value(unit, rest, &[], &mut forces);
                all.push((number, component, forces));
            }
        }
        all
    }

    /// A component of a load's curve at `time` [s].
    pub(crate) fn value(&self, number: usize, component: usize, time: f64) -> f64 {
        self.loads[number].value(time)[component]
    }
}

impl<T: Scalar> NodalLoad<T> {
    fn new(load: &Load, mesh: &VolumeMesh) -> Result<Self, LoadError> {
        let region_error = |purpose| move |error| LoadError::Region(purpose, error);
        match load {
            Load::Force { region, total } => {
                let nodes = region.nodes(mesh).map_err(region_error("a force"))?;
                let share = T::from_f64(1.0 / nodes.len() as f64);
                let shares = nodes.into_iter().map(|node| (node, share)).collect();
                Ok(Self::Shares { shares, curve: total.clone(), faces: Vec::new() })
            }
            Load::Traction { region, traction } => {
                let triangles = region.surface_triangles(mesh).map_err(region_error("a traction"))?;
                let share = |LoadTriangle { nodes, cell, weight }| {
                    let [a, b, c] = nodes.map(|node| mesh.nodes()[node as usize]);
                    FaceShare { nodes, cell, area: 0.5 * weight * (b - a).cross(c - a).norm() }
                };
                let faces = triangles.into_iter().map(share).collect();
                Ok(Self::Shares { shares: Vec::new(), curve: traction.clone(), faces })
            }
            Load::Pressure { region, pressure } => {
                let faces = region.surface_triangles(mesh).map_err(region_error("a pressure"))?;
                Ok(Self::Pressure { faces, pressure: pressure.clone() })
            }
            Load::BodyForce { region, per_volume } => {
                let volumes = VolumeShares::new(region, mesh).map_err(region_error("a body force"))?;
                Ok(Self::BodyForce { volumes, per_volume: per_volume.clone() })
            }
            Load::Attraction { region, centre, radius, per_volume } => {
                let ball = Ball::new(*centre, *radius).ok_or(LoadError::Radius(*radius))?;
                let volumes = VolumeShares::new(region, mesh).map_err(region_error("an attraction"))?;
                Ok(Self::Attraction { volumes, ball, per_volume: per_volume.clone() })
            }
        }
    }

    fn add(&self, time: f64, x: &[Vec3<T>], removed: &[bool], out: &mut [Vec3<T>]) {
        self.add_value(self.value(time), x, removed, out);
    }

    /// What the load's curve says [N, Pa or N/m³]; a number stands in the first component.
    fn value(&self, time: f64) -> Vec3<f64> {
        match self {
            Self::Shares { curve, .. } | Self::BodyForce { per_volume: curve, .. } => curve.at(time),
            Self::Pressure { pressure: curve, .. } | Self::Attraction { per_volume: curve, .. } => {
                Vec3::new(curve.at(time), 0.0, 0.0)
            }
        }
    }

    /// How many components its curve has.
    fn components(&self) -> usize {
        match self {
            Self::Shares { .. } | Self::BodyForce { .. } => 3,
            Self::Pressure { .. } | Self::Attraction { .. } => 1,
        }
    }

    /// Adds the forces for this value of the curve; cells beyond the end of `removed` are there.
    fn add_value(&self, value: Vec3<f64>, x: &[Vec3<T>], removed: &[bool], out: &mut [Vec3<T>]) {
        let is_there = |cell: u32| !removed.get(cell as usize).copied().unwrap_or(false);
        match self {
            Self::Shares { shares, faces, .. } => {
                let force: Vec3<T> = value.cast();
                for &(node, share) in shares {
                    out[node as usize] += force * share;
                }
                for face in faces.iter().filter(|face| is_there(face.cell)) {
                    let third: Vec3<T> = (value * (face.area / 3.0)).cast();
                    for node in face.nodes {
                        out[node as usize] += third;
                    }
                }
            }
            // −p n A/3 on each corner, with n A = ½ (b − a)×(c − a) the current outward area vector
            Self::Pressure { faces, .. } => {
                for face in faces.iter().filter(|face| is_there(face.cell)) {
                    let [a, b, c] = face.nodes.map(|node| x[node as usize]);
                    let force = (b - a).cross(c - a) * T::from_f64(-value.x * face.weight / 6.0);
                    for node in face.nodes {
                        out[node as usize] += force;
                    }
                }
            }
            Self::BodyForce { volumes, .. } => {
                for (node, volume) in volumes.nodes() {
                    out[node] += (value * volume).cast();
                }
            }
            Self::Attraction { volumes, ball, .. } => {
                for (node, volume) in volumes.nodes() {
                    out[node] += (ball.field(x[node]) * (value.x * volume)).cast();
                }
            }
        }
    }
}
