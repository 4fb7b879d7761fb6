//! A body that answers statically: at the end of a step it is where it rests under its loads, what drives it, what jaws hold, and tools
//! that push on it.

use super::Drive;
use crate::body::{NodeMotion, SimulatedBody, StaticAnswer};
use crate::math::{Scalar, Vec3};

/// How many times contacts are looked for: what is pushed pushes its neighbours into the tool, rarely more than twice.
const ROUNDS: u32 = 8;

/// Puts a body that answers statically to where it rests at the end of a step of `dt` [s], of which `drive` tells; gives whether it has
/// such a place. Its velocities are zero, and friction is not known.
pub fn answer<T: Scalar>(body: &mut SimulatedBody<T>, dt: f64, drive: &Drive<'_, T>) -> bool {
    let Some(mut own) = body.answer.take() else { return true };
    let rests = Answering { body, own: &mut own, drive, dt }.find_rest();
    body.answer = Some(own);
    rests
}

struct Answering<'a, T: Scalar> {
    body: &'a mut SimulatedBody<T>,
    own: &'a mut StaticAnswer,
    drive: &'a Drive<'a, T>,
    dt: f64,
}

impl<T: Scalar> Answering<'_, T> {
    fn find_rest(&mut self) -> bool {
        let Self { body, own, drive, .. } = self;
        own.rest_alone(body.drivers(), drive.gravity.cast(), drive.end);
        let rests = self.hold();
        if rests {
            self.meet_tools();
            self.place();
            self.account();
        }
        rests
    }

    /// Takes what jaws hold along. Nodes that want more than the grip gives slip: the grip's force is a load on them then.
    fn hold(&mut self) -> bool {
        let held =
            self.body.state.motions.iter().enumerate().filter(|(_, motion)| matches!(motion, NodeMotion::Held(_)));
        self.own.wanted.clear();
        self.own.wanted.extend(held.map(|(node, _)| node as u32));
        self.own.slipping.clear();
        self.own.forces.fill(Vec3::ZERO);
        loop {
            let own = &mut *self.own;
            if own.held.impose(&own.responses, &own.wanted).is_err() {
                return false;
            }
            self.compose();
            let before = self.own.slipping.len();
            for place in (0..self.own.wanted.len()).rev() {
                let own = &mut *self.own;
                let node = own.wanted[place];
                let (force, limit) = (own.held.force(place), self.drive.frames[tool_of(self.body, node)].limit);
                let size = force.norm();
                if size > limit {
                    let force = force * (limit / size);
                    own.responses.displace(own.held.handle(place), force, &mut own.alone);
                    own.slipping.push((node, force));
                    own.wanted.remove(place);
                }
            }
            if self.own.slipping.len() == before {
                self.own.unpushed.copy_from_slice(&self.own.displacements);
                return true;
            }
        }
    }

    /// Puts the nodes to where the pushes and the jaws have them, with what slipped; the jaws' forces are in the system then.
    fn compose(&mut self) {
        let (body, own) = (&*self.body, &mut *self.own);
        own.displacements.copy_from_slice(&own.alone);
        for (handle, &force) in own.forces.iter().enumerate().filter(|(_, force)| **force != Vec3::ZERO) {
            own.responses.displace(handle, force, &mut own.displacements);
        }
        own.imposed.clear();
        for &node in &own.wanted {
            own.imposed.push(displacement_in_jaws(body, self.drive, node) - own.displacements[node as usize]);
        }
        own.held.displace(&own.responses, &own.imposed, &mut own.displacements);
    }

    /// Lets the tools push: each contact until it is at the surface of its tool, and none that would have to pull.
    fn meet_tools(&mut self) {
        let drive = self.drive;
        self.body.contacts.forget();
        if !self.body.contacts.gather(drive.rods, self.body.skin.numbered(), &self.body.state.positions, f64::INFINITY)
        {
            return;
        }
        for _ in 0..ROUNDS {
            let (body, own) = (&mut *self.body, &mut *self.own);
            let (rest, start) = (&body.rest, &body.state.positions);
            let start = |node: u32| start[node as usize].cast::<f64>();
            let place = |node: u32, of: &[Vec3<f64>]| rest[node as usize].cast::<f64>() + of[node as usize];
            let places = |node: u32| (start(node), place(node, &own.displacements));
            if !body.contacts.find(drive.rods, body.skin.triangles(), drive.frames, places) {
                break;
            }
            let way = |node: u32| place(node, &own.unpushed) - start(node);
            body.contacts.solve_pushes(&mut own.pushes, &own.responses, &mut own.held, way);
            own.forces.fill(Vec3::ZERO);
            for (node, push) in body.contacts.pushes() {
                if let Some(handle) = own.responses.handle_of(node) {
                    own.forces[handle] += push;
                }
            }
            self.compose();
        }
        self.body.contacts.account(drive.rods, self.dt);
    }

    fn place(&mut self) {
        let (body, own) = (&mut *self.body, &*self.own);
        for (node, &displacement) in own.displacements.iter().enumerate() {
            body.state.positions[node] = (body.rest[node].cast::<f64>() + displacement).cast();
        }
        body.state.velocities.fill(Vec3::ZERO);
        body.state.positions_changed();
    }

    /// What jaws do to the body, and where they have what slipped.
    fn account(&mut self) {
        let (body, own) = (&mut *self.body, &*self.own);
        let carried = own.wanted.iter().enumerate().map(|(place, &node)| (node, own.held.force(place)));
        for (node, force) in carried.chain(own.slipping.iter().copied()) {
            let tool = tool_of(body, node);
            let lever = body.state.positions[node as usize].cast::<f64>() - self.drive.frames[tool].tip.1;
            let load = &mut body.contacts.loads[tool];
            load.holding += force * self.dt;
            load.holding_moment += lever.cross(force) * self.dt;
        }
        for &(node, _) in &own.slipping {
            let (frame, node) = (&self.drive.frames[tool_of(body, node)], node as usize);
            body.state.grips[node] = frame.own(body.state.positions[node].cast()).cast();
        }
    }
}

/// The tool that holds a node, by a list of those that are held.
fn tool_of<T: Scalar>(body: &SimulatedBody<T>, node: u32) -> usize {
    match body.state.motions[node as usize] {
        NodeMotion::Held(tool) => tool as usize,
        other => unreachable!("node {node} is listed as held, and moves so: {other:?}"),
    }
}

/// Where jaws want a node that they hold, from its place at rest [m].
fn displacement_in_jaws<T: Scalar>(body: &SimulatedBody<T>, drive: &Drive<'_, T>, node: u32) -> Vec3<f64> {
    let (frame, node) = (&drive.frames[tool_of(body, node)], node as usize);
    frame.at_end(body.state.grips[node].cast()) - body.rest[node].cast()
}
