use super::{BodyError, NodeMotion, SimulatedBody, free_directions};
use crate::constraint::{Constraints, ExactVolume, KeptVolume, Motion, RigidPart};
use crate::math::Scalar;
use crate::mesh::{Face, Region, VolumeMesh};

/// A volume that is kept exactly, as it is now.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptVolumeNow {
    /// Its name.
    pub name: String,
    /// What it is to be [m³].
    pub wanted: f64,
    /// (V − V0)/V0 now.
    pub error: f64,
    /// The pressure from inside that kept it in the last sub-step [Pa].
    pub pressure: f64,
}

/// The constraints of a body with these faces, and the volumes to keep.
pub(super) fn constraints(
    body: &str,
    volumes: Vec<(String, Region)>,
    rigid: Vec<Region>,
    mesh: &VolumeMesh,
    faces: &[Face],
    motions: &[NodeMotion],
) -> Result<(Constraints, Vec<KeptVolume>), BodyError> {
    let region_error =
        |purpose| move |source| BodyError::Region { body: body.into(), purpose, source: Box::new(source) };
    let (mut kept, mut surfaces) = (Vec::new(), Vec::new());
    for (name, region) in volumes {
        let mut chosen = vec![false; mesh.cell_count()];
        let cells = region.cells(mesh).map_err(region_error("an exact volume"))?;
        cells.into_iter().for_each(|cell| chosen[cell as usize] = true);
        let mut surface = ExactVolume::new(name, faces, &chosen, mesh.nodes().len());
        surface.update(&vec![false; mesh.cell_count()]);
        let (volume, _) = surface.measure::<f64>(|node| mesh.nodes()[node as usize]);
        kept.push(KeptVolume { volume, pressure: 0.0 });
        surfaces.push(surface);
    }
    let (mut parts, mut taken) = (Vec::new(), vec![false; mesh.nodes().len()]);
    for region in rigid {
        let nodes = region.nodes(mesh).map_err(region_error("a rigid part"))?;
        for &node in &nodes {
            if motions[node as usize] != NodeMotion::Free {
                return Err(BodyError::HeldRigidPart { body: body.into(), node: node as usize });
            }
            if std::mem::replace(&mut taken[node as usize], true) {
                return Err(BodyError::OverlappingRigidParts { body: body.into(), node: node as usize });
            }
        }
        let count = nodes.len();
        let part = RigidPart::new(nodes, mesh.nodes());
        parts.push(part.ok_or_else(|| BodyError::RigidPartInLine { body: body.into(), nodes: count })?);
    }
    Ok((Constraints::new(surfaces, parts, mesh.nodes().len()), kept))
}

impl<T: Scalar> SimulatedBody<T> {
    /// The volumes that are kept exactly, in the order in which they were asked for.
    pub fn kept_volumes(&self) -> impl Iterator<Item = KeptVolumeNow> + '_ {
        self.state.volumes.iter().enumerate().map(move |(number, kept)| KeptVolumeNow {
            name: self.constraints.volumes[number].name.clone(),
            wanted: kept.volume,
            error: self.constraints.error(number, kept, &self.state.positions).0,
            pressure: kept.pressure,
        })
    }

    /// What of the body only explicit steps know; none where there is nothing.
    pub(crate) fn explicit_feature(&self) -> Option<&'static str> {
        [
            (!self.constraints.volumes.is_empty(), "volumes kept exactly"),
            (!self.constraints.parts.is_empty(), "rigid parts"),
            (!self.muscles.is_empty(), "muscles"),
        ]
        .into_iter()
        .find_map(|(there, name)| there.then_some(name))
    }

    /// Finds the surfaces of kept volumes after a cut, which takes along the volume that its cells have now.
    pub(crate) fn cut_volumes(&mut self) {
        self.constraints.update(&self.state.removed);
        for (volume, kept) in self.constraints.volumes.iter().zip(&mut self.state.volumes) {
            kept.volume = volume.measure::<T>(|node| self.state.positions[node as usize].cast()).0;
        }
    }

    /// Puts nodes where constraints want them after a drift of `dt` [s].
    pub(crate) fn restore_places(&mut self, dt: f64) {
        let (guides, state) = (&self.guides, &mut self.state);
        let (positions, velocities, masses) = (&mut state.positions, &mut state.velocities, &state.masses);
        let mut motion = Motion { positions, velocities, masses };
        let filter = |node: u32| free_directions(guides, state.motions[node as usize]);
        self.constraints.restore_places(&mut motion, &filter, &mut state.volumes, dt);
        state.positions_changed();
    }

    /// Takes from the velocities at the end of a sub-step of `dt` [s] what constraints do not allow.
    pub(crate) fn restore_velocities(&mut self, dt: f64) {
        // The second kick has been divided by this, and would have divided the impulse in it as well.
        let damping = 1.0 + 0.5 * dt * self.damping.to_f64();
        let (guides, state) = (&self.guides, &mut self.state);
        let (positions, velocities, masses) = (&mut state.positions, &mut state.velocities, &state.masses);
        let mut motion = Motion { positions, velocities, masses };
        let filter = |node: u32| free_directions(guides, state.motions[node as usize]);
        self.constraints.restore_velocities(&mut motion, &filter, &mut state.volumes, dt / damping);
    }
}
