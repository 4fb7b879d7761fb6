//! Tools of a world: who leads them, and how they go through a step.

use super::grip::Grip;
use super::{InstrumentId, Integrator, World, WorldError};
use crate::body::{NodeMotion, SimulatedBody};
use crate::contact::{Capsule, MovingCapsule, ToolFrame};
use crate::instrument::{Instrument, InstrumentError, Span, ToolInput, ToolPose, ToolState, ToolUse, check_trocar};
use crate::math::{Scalar, Vec3};

/// The trigger from which on jaws hold.
const CLOSED: f64 = 0.5;

/// Parts of a step in which the speed of tools is looked at.
const GLANCES: u32 = 8;

/// How the tools move: memory that means nothing between steps.
#[derive(Debug, Default)]
pub(super) struct ToolMotion {
    pub(super) frames: Vec<ToolFrame>,
    pub(super) rods: Vec<MovingCapsule>,
    /// Where the tools were before the step.
    before: Vec<ToolState>,
    /// What they are led to in the step.
    goals: Vec<ToolInput>,
    parts: Vec<Capsule>,
    parts_before: Vec<Capsule>,
}

impl<T: Scalar> World<T> {
    /// Adds an instrument.
    ///
    /// # Errors
    /// [`WorldError::Instrument`] where its settings make no sense; [`WorldError::NothingToCut`] for one that removes cells, where there are
    /// bodies and none can lose any; [`WorldError::ToolsNeedMotion`] for one that touches or slips, in a quasi-static world.
    pub fn add_instrument(&mut self, instrument: impl Instrument<T> + 'static) -> Result<InstrumentId, WorldError> {
        instrument.check()?;
        self.check_tool(&instrument)?;
        let trocar = instrument.mount().trocar;
        self.tools.push(ToolState::new(scripted_pose(&instrument, self.time(), trocar), trocar));
        self.instruments.push(Some(Box::new(instrument)));
        self.reserve_for_tools();
        Ok(InstrumentId(self.instruments.len() - 1))
    }

    /// Puts another instrument into the place of one: what that held is let go. It keeps pose and hand where a hand leads it, and has a
    /// trocar where its mount says.
    ///
    /// # Errors
    /// [`WorldError::MissingInstrument`] for one that is not there; the others as in [`World::add_instrument`].
    pub fn replace_instrument(
        &mut self,
        id: InstrumentId,
        instrument: impl Instrument<T> + 'static,
    ) -> Result<(), WorldError> {
        self.check_instrument(id)?;
        instrument.check()?;
        self.check_tool(&instrument)?;
        self.let_go(id);
        let (hand, pose) = (self.tools[id.0].hand, self.tools[id.0].pose);
        let trocar = instrument.mount().trocar;
        let pose = if hand.is_some() { pose.through(trocar) } else { scripted_pose(&instrument, self.time(), trocar) };
        self.tools[id.0] = ToolState { hand, has_moved: hand.is_some(), ..ToolState::new(pose, trocar) };
        self.instruments[id.0] = Some(Box::new(instrument));
        self.reserve_for_tools();
        Ok(())
    }

    /// Takes an instrument out: what it held is let go. Its number is not given again.
    ///
    /// # Errors
    /// [`WorldError::MissingInstrument`] for one that is not there.
    pub fn remove_instrument(&mut self, id: InstrumentId) -> Result<(), WorldError> {
        self.check_instrument(id)?;
        self.let_go(id);
        self.tools[id.0] = ToolState::new(self.tools[id.0].pose, None);
        self.instruments[id.0] = None;
        Ok(())
    }

    /// Leads an instrument by hand, over its path, until [`World::release_tool`]: at the end of the next step it is where `input`
    /// says, or as far on the way as its speed brings it, and it goes straight. Tissue in between is pushed along, however fast it goes. One
    /// that has not taken a step yet is put there at once.
    ///
    /// # Errors
    /// [`WorldError::MissingInstrument`] for one that is not there; [`WorldError::Instrument`] for a pose that is none.
    pub fn set_tool(&mut self, id: InstrumentId, input: ToolInput) -> Result<(), WorldError> {
        self.check_instrument(id)?;
        let kind = self.instrument(id).kind();
        input.pose.check(kind)?;
        if input.trigger.is_nan() {
            let (name, range) = ("trigger", "between 0 and 1");
            return Err(InstrumentError::OutOfRange { kind, name, value: input.trigger, range }.into());
        }
        if input.speed.is_nan() || input.speed <= 0.0 {
            let (name, range) = ("speed", "positive [m/s]");
            return Err(InstrumentError::OutOfRange { kind, name, value: input.speed, range }.into());
        }
        let tool = &mut self.tools[id.0];
        let pose = input.pose.through(tool.trocar);
        tool.hand = Some(ToolInput { trigger: input.trigger.clamp(0.0, 1.0), ..input });
        if !tool.has_moved {
            tool.pose = pose;
        }
        Ok(())
    }

    /// Leads the shaft of an instrument through a point [m] from the next step on, or lets it go. The tip stays where it is led: a
    /// tool that has taken a step turns about it within the next one, and what is on the way of its shaft is pushed along. Without a
    /// trocar one that a hand leads keeps its direction until the hand says another.
    ///
    /// # Errors
    /// [`WorldError::MissingInstrument`] for one that is not there; [`WorldError::Instrument`] for a point that is none.
    pub fn set_trocar(&mut self, id: InstrumentId, trocar: Option<Vec3<f64>>) -> Result<(), WorldError> {
        self.check_instrument(id)?;
        check_trocar(self.instrument(id).kind(), trocar)?;
        let tool = &mut self.tools[id.0];
        tool.trocar = trocar;
        if !tool.has_moved {
            tool.pose = tool.pose.through(trocar);
        }
        if let Some(hand) = &mut tool.hand {
            hand.pose.direction = tool.pose.through(trocar).direction;
        }
        Ok(())
    }

    /// Lets an instrument follow its path again, from the next step on.
    ///
    /// # Errors
    /// [`WorldError::MissingInstrument`] for one that is not there.
    pub fn release_tool(&mut self, id: InstrumentId) -> Result<(), WorldError> {
        self.check_instrument(id)?;
        self.tools[id.0].hand = None;
        Ok(())
    }

    /// An instrument as it is now. Panics for a number of another world.
    pub fn tool(&self, id: InstrumentId) -> &ToolState {
        &self.tools[id.0]
    }

    /// The rigid parts of an instrument where they are now. Panics for one that is not there.
    pub fn tool_capsules(&self, id: InstrumentId) -> Vec<Capsule> {
        let (tool, mut parts) = (&self.tools[id.0], Vec::new());
        self.instrument(id).add_parts(&tool.pose, tool.trigger, &mut parts);
        parts
    }

    /// Whether an instrument is at work now: jaws closed, current on. Panics for one that is not there.
    pub fn is_at_work(&self, id: InstrumentId) -> bool {
        let tool = &self.tools[id.0];
        tool.hand.map_or_else(|| self.instrument(id).is_active(self.time()), |_| tool.is_closed)
    }

    fn check_tool(&self, instrument: &dyn Instrument<T>) -> Result<(), WorldError> {
        if instrument.cuts()
            && let Some(advice) = self.bodies.iter().map(SimulatedBody::no_burning).reduce(Option::and).flatten()
        {
            return Err(WorldError::NothingToCut { kind: instrument.kind(), advice });
        }
        // Between equilibria nodes are held or free: nothing pushes them, and nothing slips.
        if !matches!(self.config.integrator, Integrator::QuasiStatic(_)) {
            return Ok(());
        }
        let mut parts = Vec::new();
        let pose = scripted_pose(instrument, self.time(), instrument.mount().trocar);
        instrument.add_parts(&pose, 0.0, &mut parts);
        if parts.is_empty() && instrument.grip() == f64::INFINITY { Ok(()) } else { Err(WorldError::ToolsNeedMotion) }
    }

    fn check_instrument(&self, id: InstrumentId) -> Result<(), WorldError> {
        match self.instruments.get(id.0) {
            Some(Some(_)) => Ok(()),
            _ => Err(WorldError::MissingInstrument { instrument: id.0 }),
        }
    }

    /// Asks for the memory that tools need in a step.
    pub(super) fn reserve_for_tools(&mut self) {
        let (tools, motion) = (&self.tools, &mut self.motion);
        motion.parts.clear();
        for (instrument, tool) in self.instruments.iter().zip(tools) {
            if let Some(instrument) = instrument {
                instrument.add_parts(&tool.pose, tool.trigger, &mut motion.parts);
            }
        }
        let parts = motion.parts.len();
        motion.parts_before.reserve(parts);
        motion.rods.reserve(parts.saturating_sub(motion.rods.len()));
        motion.frames.reserve(tools.len().saturating_sub(motion.frames.len()));
        motion.goals.reserve(tools.len().saturating_sub(motion.goals.len()));
        motion.before.reserve(tools.len().saturating_sub(motion.before.len()));
        for body in &mut self.bodies {
            body.reserve_contacts(tools.len(), parts > 0);
        }
    }

    /// Remembers where the tools are.
    pub(super) fn keep_tools(&mut self) {
        self.motion.before.clone_from(&self.tools);
    }

    /// Puts the tools back to where they were.
    pub(super) fn put_tools_back(&mut self) {
        self.tools.clone_from(&self.motion.before);
    }

    /// Says where the tools are to go in a step, and lets those whose triggers cross take hold or let go.
    pub(super) fn lead_tools(&mut self, span: &Span) {
        self.motion.goals.clear();
        for body in &mut self.bodies {
            body.contacts.clear_loads();
        }
        for number in 0..self.tools.len() {
            let tool = self.tools[number];
            let Some(instrument) = &self.instruments[number] else {
                self.motion.goals.push(ToolInput::new(tool.pose, tool.trigger));
                continue;
            };
            let goal = match tool.hand {
                Some(hand) => {
                    let pose = hand.reached(&tool.pose, span.to - span.from);
                    let trigger = hand.pulled(&tool);
                    ToolInput { pose: pose.through(tool.trocar), trigger, ..hand }
                }
                None => ToolInput::new(
                    scripted_pose(instrument.as_ref(), span.to, tool.trocar),
                    f64::from(u8::from(instrument.is_active_before(span.to))),
                ),
            };
            self.motion.goals.push(goal);
            let closes = goal.trigger >= CLOSED;
            if closes != tool.is_closed {
                self.tools[number].is_closed = closes;
                if closes {
                    self.take_hold(number);
                } else {
                    self.let_go(InstrumentId(number));
                }
            }
        }
    }

    fn take_hold(&mut self, number: usize) {
        let (tool, Some(instrument)) = (&mut self.tools[number], &self.instruments[number]) else { return };
        let grip = Grip::new(number as u32, tool.pose);
        tool.held_nodes = 0;
        for body in &mut self.bodies {
            for node in 0..body.state.positions.len() {
                let place = body.state.positions[node].cast::<f64>();
                if instrument.takes_hold_of(&tool.pose, place) {
                    tool.held_nodes += grip.hold(body, node);
                }
            }
            tool.held_nodes += grip.hold_cells(body, instrument.as_ref());
        }
    }

    fn let_go(&mut self, id: InstrumentId) {
        self.tools[id.0].held_nodes = 0;
        for body in &mut self.bodies {
            for motion in &mut body.state.motions {
                if *motion == NodeMotion::Held(id.0 as u32) {
                    *motion = NodeMotion::Free;
                }
            }
        }
    }

    /// Moves the tools from one share of the step to another.
    pub(super) fn move_tools(&mut self, span: &Span, from: f64, to: f64) {
        let ToolMotion { frames, rods, before, goals, parts, parts_before } = &mut self.motion;
        frames.clear();
        rods.clear();
        for (number, instrument) in self.instruments.iter().enumerate() {
            let (start, goal, held) = (&before[number], &goals[number], self.tools[number].held_nodes);
            let at = |share: f64| match instrument {
                Some(instrument) => place(instrument.as_ref(), start, goal, span, share),
                None => (start.pose, start.trigger),
            };
            let ((pose, trigger), (end, end_trigger)) = (at(from), at(to));
            let limit = instrument.as_ref().map_or(f64::INFINITY, |tool| tool.grip()) / f64::from(held.max(1));
            frames.push(ToolFrame { tip: (pose.tip, end.tip), turn: (pose.turn(), end.turn()), limit });
            let Some(instrument) = instrument else { continue };
            parts_before.clear();
            parts.clear();
            instrument.add_parts(&pose, trigger, parts_before);
            instrument.add_parts(&end, end_trigger, parts);
            let idle = if held > 0 { instrument.parts_that_hold() } else { 0 };
            let touching = parts.len().saturating_sub(idle);
            for (part, (&start, &end)) in parts_before.iter().zip(parts.iter()).take(touching).enumerate() {
                let (tool, part, friction) = (number as u32, part as u32, instrument.friction());
                rods.push(MovingCapsule { tool, part, friction, start, end });
            }
        }
    }

    /// Leaves the tools where the step has brought them, with what they did in it.
    pub(super) fn settle_tools(&mut self, span: &Span) {
        let per_second = 1.0 / (span.to - span.from);
        for (number, (tool, goal)) in self.tools.iter_mut().zip(&self.motion.goals).enumerate() {
            (tool.pose, tool.trigger, tool.has_moved) = (goal.pose, goal.trigger, true);
            tool.is_awaited =
                tool.hand.is_some_and(|hand| hand.pose.tip == goal.pose.tip && hand.trigger > goal.trigger);
            let loads = || self.bodies.iter().map(|body| &body.contacts.loads[number]);
            let mean = |of: fn(&crate::contact::ToolLoad) -> Vec3<f64>| {
                loads().fold(Vec3::ZERO, |sum, load| sum + of(load)) * per_second
            };
            tool.contact_force = mean(|load| load.contact);
            tool.contact_torque = mean(|load| load.contact_moment);
            tool.holding_force = mean(|load| load.holding);
            tool.holding_torque = mean(|load| load.holding_moment);
            tool.contacts = loads().map(|load| load.points).sum();
            if tool.held_nodes > 0 {
                // A cut may have taken some.
                let motion = NodeMotion::Held(number as u32);
                let of = |body: &SimulatedBody<T>| body.state.motions.iter().filter(|own| **own == motion).count();
                tool.held_nodes = self.bodies.iter().map(of).sum::<usize>() as u32;
            }
        }
    }

    /// What a tool did in the step.
    pub(super) fn tool_use(&self, number: usize, span: &Span) -> ToolUse {
        let (tool, from) = (&self.tools[number], self.motion.before[number].pose);
        ToolUse { span: *span, from, to: tool.pose, trigger: tool.trigger, is_led: tool.hand.is_some() }
    }

    /// How far tools would go in the step at the highest speed that they have in it [m], and the largest ratio of that to the radius: a path
    /// may lead there and back. Leaves the rods as they go from one end of the step to the other.
    pub(super) fn survey_tools(&mut self, span: &Span) -> (f64, f64) {
        let (mut way, mut ratio) = (0.0f64, 0.0f64);
        for part in 0..GLANCES {
            self.move_tools(span, f64::from(part) / f64::from(GLANCES), f64::from(part + 1) / f64::from(GLANCES));
            for rod in &self.motion.rods {
                way = way.max(rod.way() * f64::from(GLANCES));
                ratio = ratio.max(rod.way() * f64::from(GLANCES) / rod.start.radius);
            }
        }
        self.move_tools(span, 0.0, 1.0);
        (way, ratio)
    }
}

/// Where an instrument's script has it at `time` [s].
fn scripted_pose<T: Scalar>(instrument: &dyn Instrument<T>, time: f64, trocar: Option<Vec3<f64>>) -> ToolPose {
    instrument.mount().pose(instrument.path().at(time), time, trocar)
}

/// Where a tool is at a share of its step, and its trigger: on its script if it was on it before, straight to the goal otherwise; through
/// its trocar all the time, unless that is another than in the step before.
fn place<T: Scalar>(
    instrument: &dyn Instrument<T>,
    start: &ToolState,
    goal: &ToolInput,
    span: &Span,
    share: f64,
) -> (ToolPose, f64) {
    let trigger = start.trigger + (goal.trigger - start.trigger) * share;
    if share == 1.0 {
        return (goal.pose, goal.trigger);
    }
    let trocar = start.trocar;
    if start.hand.is_none() && start.pose == scripted_pose(instrument, span.from, trocar) {
        return (scripted_pose(instrument, span.at(share), trocar), trigger);
    }
    let pose = start.pose.towards(&goal.pose, share);
    let turns = trocar.is_some() && start.pose.through(trocar) != start.pose;
    (if turns { pose } else { pose.through(trocar) }, trigger)
}
