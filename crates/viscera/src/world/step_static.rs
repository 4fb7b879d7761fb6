use super::{StepError, World};
use crate::body::SimulatedBody;
use crate::dynamics::{Drive, answer};
use crate::instrument::Span;
use crate::math::{Scalar, Vec3};

impl<T: Scalar> World<T> {
    /// Puts bodies that answer statically, and such parts of bodies, to where they rest at the end of the step.
    pub(super) fn respond_statically(&mut self, span: &Span) -> Result<(), StepError> {
        let gravity = Vec3::from(self.config.gravity).cast();
        self.bodies.iter_mut().for_each(|body| body.place_followers(span.to, gravity));
        if self.bodies.iter().all(SimulatedBody::moves) {
            return Ok(());
        }
        self.move_tools(span, 0.0, 1.0);
        let drive = Drive { end: span.to, frames: &self.motion.frames, rods: &self.motion.rods, gravity };
        let mut rest = true;
        for body in &mut self.bodies {
            rest &= answer::answer(body, span.to - span.from, &drive) && body.is_within_bounds();
        }
        if rest { Ok(()) } else { Err(self.diverged()) }
    }
}
