use super::sweep::{MARGIN, first_touch};
use super::{MovingCapsule, ToolFrame, Traction};
use crate::math::{Scalar, Vec3};
use crate::mesh::Point;

/// No node.
const NONE: u32 = u32::MAX;

/// A point of a body's surface that touches a tool, or will within the step.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Corners that have a part in the point, ascending; others are `u32::MAX`. With the rod it names the contact: triangles share
    /// edges and corners.
    feature: [u32; 3],
    /// Number of the rod.
    pub(super) rod: u32,
    pub(super) nodes: [u32; 3],
    /// Barycentric weights of the point.
    pub(super) weights: [f64; 3],
    /// From the rod to the tissue.
    pub(super) normal: Point,
    /// Distance of the two surfaces at the beginning of the step, along the normal [m].
    pub(super) gap: f64,
    /// How far the rod's point goes in the step [m].
    pub(super) way: Point,
    /// Where the tool's surface touches at the end of the step, from the tip [m].
    lever: Point,
    pub(super) friction: f64,
    /// Velocity along and across the normal that a unit of impulse makes [1/kg].
    pub(super) mobility: [f64; 2],
    /// Impulse on the tissue, along and across the normal, or the like as force.
    pub(super) push: f64,
    pub(super) drag: Point,
    /// Stiffness of the spring that stands for the contact in an implicit step [N/m]; 0 until it is known.
    pub(super) stiffness: f64,
    pub(super) is_active: bool,
    /// Whether it has opened within the step.
    pub(super) has_opened: bool,
    /// Share of the friction of sticking that the cone lets through.
    pub(super) grip: f64,
    /// Stiffness across the normal that a new contact begins with where its rod slips [N/m]; infinite where it sticks.
    pub(super) slipping: f64,
    /// Friction when that was last decided [N].
    pub(super) tried: f64,
    /// Friction at the beginning of an implicit step [N].
    pub(super) before: Point,
}

/// What a tool did to a body in a step: impulses on the tissue [N s], and their moments about the tip [N m s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolLoad {
    /// By contact.
    pub(crate) contact: Point,
    pub(crate) contact_moment: Point,
    /// By the jaws, on what they hold.
    pub(crate) holding: Point,
    pub(crate) holding_moment: Point,
    /// Points that touched last.
    pub(crate) points: u32,
}

/// All contacts of a body with tools, and memory to find them in.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    pub(super) list: Vec<Contact>,
    /// Triangles that a tool may reach in the step, in the order of their faces.
    candidates: Vec<u32>,
    /// The most contacts that are known at a time.
    most: usize,
    /// How far a node may go before the candidates mean nothing [m].
    reach: f64,
    /// What the tools did in the step, one for each tool.
    pub(crate) loads: Vec<ToolLoad>,
}

impl Contacts {
    /// Asks for memory: for as many tools, for a surface of so many `triangles` before any cut, and of so many `at_most` when it is cut. No more
    /// contacts than it had then are known at a time: were it those that it has, or that there happens to be room for, a world that goes on from a
    /// snapshot could know others.
    pub(crate) fn reserve(&mut self, tools: usize, triangles: usize, at_most: usize) {
        self.loads.resize(tools.max(self.loads.len()), ToolLoad::default());
        self.most = triangles;
        self.list.reserve(triangles.saturating_sub(self.list.len()));
        self.candidates.reserve(at_most.saturating_sub(self.candidates.len()));
    }

    /// Whether nothing touches.
    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether a tool may touch in the step.
    pub(crate) fn are_possible(&self) -> bool {
        !self.candidates.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        self.list.clear();
    }

    /// Forgets what touches and what might: no node goes too far then.
    pub(crate) fn forget(&mut self) {
        self.list.clear();
        self.candidates.clear();
        self.reach = f64::INFINITY;
    }

    pub(crate) fn clear_loads(&mut self) {
        self.loads.fill(ToolLoad::default());
    }

    /// How far a node may go in the step [m].
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Lists the triangles that the rods may meet while no node goes farther than `reach` [m]; gives whether there are any. `faces` tell their order:
    /// that in the skin depends on how it was cut, and decides which are left out where there are too many contacts.
    pub(crate) fn gather<T: Scalar>(
        &mut self,
        rods: &[MovingCapsule],
        (skin, faces): (&[[u32; 3]], &[u32]),
        positions: &[Vec3<T>],
        reach: f64,
    ) -> bool {
        self.reach = reach;
        self.candidates.clear();
        let Some((low, high)) = bounds(rods) else { return false };
        let margin = Point::splat(reach);
        let (low, high): (Vec3<T>, Vec3<T>) = ((low - margin).cast(), (high + margin).cast());
        for (triangle, nodes) in skin.iter().enumerate() {
            let [a, b, c] = nodes.map(|node| positions[node as usize]);
            let (from, to) = (a.min(b).min(c), a.max(b).max(c));
            if (0..3).all(|axis| from[axis] <= high[axis] && low[axis] <= to[axis]) {
                self.candidates.push(triangle as u32);
            }
        }
        self.candidates.sort_unstable_by_key(|&triangle| faces[triangle as usize]);
        !self.candidates.is_empty()
    }

    /// Takes in all contacts between candidates and rods that are not known yet; gives whether there are any. `places` gives a node's
    /// place at the beginning and at the end of the step.
    pub(crate) fn find(
        &mut self,
        rods: &[MovingCapsule],
        skin: &[[u32; 3]],
        frames: &[ToolFrame],
        places: impl Fn(u32) -> (Point, Point),
    ) -> bool {
        let known = self.list.len();
        for &candidate in &self.candidates {
            let nodes = skin[candidate as usize];
            let moves = nodes.map(&places);
            let (start, end) = (moves.map(|(start, _)| start), moves.map(|(_, end)| end));
            let low = start.iter().chain(&end).fold(Point::splat(f64::INFINITY), |low, &place| low.min(place));
            let high = start.iter().chain(&end).fold(Point::splat(f64::NEG_INFINITY), |high, &place| high.max(place));
            for (number, rod) in rods.iter().enumerate() {
                let (from, to) = rod.bounds();
                let margin = MARGIN * rod.start.radius;
                if (0..3).any(|axis| low[axis] > to[axis] + margin || from[axis] > high[axis] + margin)
                    || self.list.len() == self.most
                {
                    continue;
                }
                let Some(touch) = first_touch(&start, &end, rod) else { continue };
                let feature = feature(nodes, touch.weights);
                if self.list[..known].iter().any(|old| old.feature == feature && old.rod == number as u32) {
                    continue;
                }
                let place: Point = (0..3).fold(Point::ZERO, |sum, i| sum + start[i] * touch.weights[i]);
                let (axis, axis_at_end) = rod.axis(touch.along);
                self.list.push(Contact {
                    feature,
                    rod: number as u32,
                    nodes,
                    weights: touch.weights,
                    normal: touch.normal,
                    gap: touch.normal.dot(place - axis) - rod.start.radius,
                    way: axis_at_end - axis,
                    lever: axis_at_end + touch.normal * rod.start.radius - frames[rod.tool as usize].tip.1,
                    friction: rod.friction,
                    mobility: [0.0; 2],
                    push: 0.0,
                    drag: Point::ZERO,
                    stiffness: 0.0,
                    is_active: false,
                    has_opened: false,
                    grip: 1.0,
                    slipping: f64::INFINITY,
                    tried: 0.0,
                    before: Point::ZERO,
                });
            }
        }
        if self.list.len() == known {
            return false;
        }
        // Triangles meet at corners and edges: one contact for each. Equal ones in the order of their triangles.
        let new = &mut self.list[known..];
        new.sort_unstable_by(|a, b| {
            let key = |contact: &Contact| (contact.rod, contact.feature, contact.nodes);
            key(a).cmp(&key(b))
        });
        self.list.dedup_by_key(|contact| (contact.rod, contact.feature));
        true
    }

    /// Adds what the contacts do in `duration` [s], with impulses or forces as they are now, to the tools' loads.
    pub(crate) fn account(&mut self, rods: &[MovingCapsule], duration: f64) {
        self.loads.iter_mut().for_each(|load| load.points = 0);
        for contact in &self.list {
            let impulse = (contact.normal * contact.push + contact.drag) * duration;
            let load = &mut self.loads[rods[contact.rod as usize].tool as usize];
            load.contact += impulse;
            load.contact_moment += contact.lever.cross(impulse);
            load.points += u32::from(contact.push > 0.0);
        }
    }

    /// Friction that an implicit step begins with, for contacts that have just been found. Those that were there in the step before go on
    /// with theirs. Where the others of a rod slip, a new one slips as they do, with their mean friction over the way that it goes when
    /// nodes go by their `increment` [m]: tissue that slides comes to new contacts all the time, and each that stuck at first held it back.
    pub(crate) fn find_before(
        &mut self,
        tractions: &[Traction],
        rods: &[MovingCapsule],
        increment: impl Fn(u32) -> Point,
    ) {
        for place in 0..self.list.len() {
            let contact = &self.list[place];
            if contact.stiffness > 0.0 {
                continue;
            }
            let rod = rods[contact.rod as usize];
            let of_rod = || tractions.iter().filter(|old| old.is_of_rod(rod.tool, rod.part));
            let known = of_rod().find(|old| old.is_of(contact.feature));
            let (count, sum) = of_rod()
                .filter(|old| old.grip() < 1.0)
                .fold((0.0, 0.0), |(count, sum), old| (count + 1.0, sum + old.force().norm()));
            let way = contact.across(contact.slide(&increment)).norm();
            let contact = &mut self.list[place];
            match known {
                Some(known) => {
                    contact.grip = known.grip();
                    contact.before = contact.across(known.force());
                }
                None if count > 0.0 && way > 0.0 => contact.slipping = sum / (count * way),
                None => {}
            }
        }
    }

    /// Keeps the friction of this step for the next one.
    pub(crate) fn keep_tractions(&self, tractions: &mut Vec<Traction>, rods: &[MovingCapsule]) {
        tractions.clear();
        let touching = self.list.iter().filter(|contact| contact.push > 0.0);
        tractions.extend(touching.map(|contact| {
            let rod = rods[contact.rod as usize];
            Traction::new(contact.feature, (rod.tool, rod.part), contact.drag, contact.grip)
        }));
    }
}

/// The box of all that rods sweep; none without rods.
fn bounds(rods: &[MovingCapsule]) -> Option<(Point, Point)> {
    let boxes = rods.iter().map(|rod| {
        let ((low, high), margin) = (rod.bounds(), Point::splat(MARGIN * rod.start.radius));
        (low - margin, high + margin)
    });
    boxes.reduce(|(low, high), (from, to)| (low.min(from), high.max(to)))
}

/// The corners that have a part in a point.
fn feature(nodes: [u32; 3], weights: [f64; 3]) -> [u32; 3] {
    let mut feature = [NONE; 3];
    for i in 0..3 {
        if weights[i] > 0.0 {
            feature[i] = nodes[i];
        }
    }
    feature.sort_unstable();
    feature
}
