//! Snapshots as bytes.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `viscera\0` |
//! | 2 | format, little-endian |
//! | 1 | bits of a number: 32 or 64 |
//! | … | steps, the tools and whether each is there, forces of attachments, and of each body its fingerprint and its state, as postcard encodes them |
//! | 4 | CRC-32 of all before, little-endian |
//!
//! Numbers keep their bits. Force models are left out: they follow from the mesh and the cells that were removed, in their
//! order. What grows is the nodes' 12 to 25 numbers, not the tables of the models, which are hundreds.

use super::{BodySnapshot, Snapshot, SnapshotError};
use crate::body::{BodyError, BodyState, Models, NodeMotion, SimulatedBody};
use crate::instrument::ToolState;
use crate::math::Vec3;
use crate::model::Precision;
use crate::world::World;

const MARK: &[u8; 8] = b"viscera\0";
/// Grows with every change of what is written.
const FORMAT: u16 = 5;
const HEAD: usize = MARK.len() + 3;
const CHECKSUM: usize = 4;

fn bits<T>() -> u8 {
    8 * size_of::<T>() as u8
}

impl<T: Precision> Snapshot<T> {
    /// The snapshot as bytes, to be kept or sent; equal states give equal bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let bodies: Vec<_> = self.bodies.iter().map(|body| (body.fingerprint, &body.state)).collect();
        let mut head = MARK.to_vec();
        head.extend(FORMAT.to_le_bytes());
        head.push(bits::<T>());
        let mut bytes = postcard::to_extend(&(self.steps, &self.tools, &self.attachments, bodies), head)
            .expect("numbers, and lists of known length, always have an encoding");
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }
}

/// What stands between head and checksum.
type Payload<T> = (u64, Vec<(bool, ToolState)>, Vec<Vec3<f64>>, Vec<(u32, BodyState<T>)>);

impl<T: Precision> World<T> {
    /// Reads a snapshot of this world, or of one that was built alike, from bytes. The world itself is not changed:
    /// [`World::restore`] does that.
    ///
    /// The models of a body that has gone on cutting since, or was cut otherwise, are built anew, which takes as long as adding the
    /// body; those of a body whose cuts are among the snapshot's are copied and cut further.
    ///
    /// # Errors
    /// [`SnapshotError`]: bytes of something else, damaged, of another version, precision or world.
    pub fn read_snapshot(&self, bytes: &[u8]) -> Result<Snapshot<T>, SnapshotError> {
        let (steps, tools, attachments, bodies) = decode::<T>(bytes)?;
        let instruments = tools.len();
        if !self.has_tools(&tools) || bodies.len() != self.bodies.len() {
            let count = |bodies, instruments| format!("{bodies} bodies and {instruments} instruments");
            let (its, here) = (count(bodies.len(), instruments), count(self.bodies.len(), self.instruments.len()));
            return Err(SnapshotError::Foreign { what: format!("it has {its}, and this one {here}") });
        }
        let of_body = |(body, (fingerprint, state)): (&SimulatedBody<T>, _)| {
            if fingerprint != body.fingerprint || !fits(&state, body, instruments) {
                let what = format!("body `{}` has another mesh, mass, law or model", body.name);
                return Err(SnapshotError::Foreign { what });
            }
            Ok(body.with_models(state)?)
        };
        let bodies = self.bodies.iter().zip(bodies).map(of_body).collect::<Result<_, _>>()?;
        if attachments.len() != self.attachments.len() {
            let what = format!("it has {} attachments, and this one {}", attachments.len(), self.attachments.len());
            return Err(SnapshotError::Foreign { what });
        }
        Ok(Snapshot { steps, bodies, tools, attachments })
    }
}

fn decode<T: Precision>(bytes: &[u8]) -> Result<Payload<T>, SnapshotError> {
    let damaged = SnapshotError::Damaged { length: bytes.len() };
    if !bytes.starts_with(MARK) {
        return Err(SnapshotError::NotASnapshot);
    }
    let Some((content, checksum)) = bytes.split_last_chunk::<CHECKSUM>() else { return Err(damaged) };
    if content.len() < HEAD || crc32fast::hash(content) != u32::from_le_bytes(*checksum) {
        return Err(damaged);
    }
    let found = u16::from_le_bytes([content[MARK.len()], content[MARK.len() + 1]]);
    if found != FORMAT {
        return Err(SnapshotError::OtherVersion { found, known: FORMAT });
    }
    let (found, wanted) = (content[HEAD - 1], bits::<T>());
    if found != wanted {
        return Err(SnapshotError::OtherPrecision { found, wanted });
    }
    postcard::from_bytes(&content[HEAD..]).map_err(|_| damaged)
}

/// Whether every array has its length and every number in it means something: a checksum says who wrote it, not that it is
/// right.
fn fits<T: Precision>(state: &BodyState<T>, body: &SimulatedBody<T>, instruments: usize) -> bool {
    let (nodes, cells) = (body.mesh.nodes().len(), body.mesh.cell_count());
    let past = &state.past;
    let nodal = [&state.positions, &state.velocities, &state.internal_forces, &state.grips].map(Vec::len);
    let lengths = nodal.into_iter().chain([state.motions.len(), state.masses.len(), state.cells_at_node.len()]);
    let known = |motion: &NodeMotion| match *motion {
        NodeMotion::Free | NodeMotion::Fixed | NodeMotion::Retired => true,
        NodeMotion::Prescribed(curve) => (curve as usize) < body.prescribed.len(),
        NodeMotion::Guided(guide) => body.guides.has(guide),
        NodeMotion::Held(instrument) => (instrument as usize) < instruments,
        NodeMotion::Following => body.followers.is_some(),
    };
    let mut removed = vec![false; cells];
    let once = |&cell: &u32| removed.get_mut(cell as usize).is_some_and(|gone| !std::mem::replace(gone, true));
    lengths.into_iter().all(|length| length == nodes)
        && [&past.positions, &past.velocities].into_iter().all(|of| of.len() == body.state.past.positions.len())
        && state.motions.iter().all(known)
        && state.removals.are_sound()
        && state.removals.cells().iter().all(once)
        && state.removed == removed
        && state.removed_count == state.removals.cells().len()
        && state.volumes.len() == body.state.volumes.len()
        && state.heat.len() == cells
        && state.seared.len() == nodes
}

impl<T: Precision> SimulatedBody<T> {
    /// A state that came without models, with those that belong to it.
    fn with_models(&self, mut state: BodyState<T>) -> Result<BodySnapshot<T>, BodyError> {
        let goes_on = state.removals.go_on_from(&self.state.removals);
        let Models { mut forces, mut frequency } = if goes_on {
            let copies = self.state.models.iter().map(|model| model.clone_box()).collect();
            Models { forces: copies, frequency: self.frequency.clone_box() }
        } else {
            let failed = |source| BodyError::Model { body: self.name.clone(), source };
            self.plan.build(&self.mesh).map_err(failed)?
        };
        let done = if goes_on { self.state.removals.cut_count() } else { 0 };
        for cells in state.removals.cuts().skip(done) {
            forces.iter_mut().for_each(|model| model.remove(cells));
            frequency.remove(cells);
        }
        state.models = forces;
        state.removals.reserve(self.mesh.cell_count());
        Ok(BodySnapshot { state, frequency, fingerprint: self.fingerprint })
    }
}
