//! A scene played from start to end and put back to its start, with all that a viewer would ask for.

use viscera::model::Precision;
use viscera::world::Snapshot;
use viscera_scene::BuiltScene;

use crate::failure::Failure;

/// Steps from one look at the surface to the next: 25 pictures a second at steps of 10 ms.
const STEPS_TO_A_PICTURE: u64 = 4;

/// A scene that can be played again and again.
pub(super) struct Rounds<T: Precision> {
    built: BuiltScene<T>,
    start: Snapshot<T>,
    /// How the first round ended.
    end: Option<u32>,
}

impl<T: Precision> Rounds<T> {
    pub(super) fn new(built: BuiltScene<T>) -> Self {
        let start = built.world.snapshot();
        Self { built, start, end: None }
    }

    /// Steps of a round.
    pub(super) fn steps(&self) -> u64 {
        self.built.steps()
    }

    /// Plays a round until its end, or until `is_over` says so, and puts the scene back to its start. Gives how many steps were
    /// made.
    ///
    /// # Errors
    /// Where a step cannot be made, or a round ends with other bits than the first one.
    pub(super) fn play(&mut self, is_over: impl Fn() -> bool) -> Result<u64, Failure> {
        let steps = self.built.steps();
        let world = &mut self.built.world;
        for step in 0..steps {
            if is_over() {
                world.restore(&self.start).map_err(Failure::problem)?;
                return Ok(step);
            }
            world.step().map_err(Failure::problem)?;
            for &id in self.built.bodies.values() {
                world.observe(id);
                if step.is_multiple_of(STEPS_TO_A_PICTURE) {
                    world.body(id).surface();
                }
            }
            for &id in self.built.instruments.values() {
                world.observe_instrument(id);
            }
        }
        let end = crc32fast::hash(&world.snapshot().to_bytes());
        if *self.end.get_or_insert(end) != end {
            return Err(Failure::Problem(
                "error: a round did not end with the bits of the first one: something outlives the return to the start"
                    .into(),
            ));
        }
        world.restore(&self.start).map_err(Failure::problem)?;
        Ok(steps)
    }
}

#[cfg(test)]
mod tests {
    use allocation_counter::measure;
    use viscera_scene::Scene;

    use super::*;
    use viscera_session::library::scenes;

    /// Memory that a round asks for is given back by its end, to the byte: an hour of rounds needs no more than the first.
    #[test]
    fn a_round_of_a_resection_leaves_no_memory_behind() {
        let (_, text) = scenes().find(|(name, _)| *name == "liver-resection").expect("it is built in");
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let mut scene = Scene::parse(text, folder).expect("a good scene");
        for (key, value) in [("body.liver.mesh.edge", "30 mm"), ("duration", "1.2 s")] {
            scene.set(key, value).expect("a key of the scene");
        }
        let mut rounds = Rounds::new(scene.build::<f32>().expect("a good scene"));
        // What is made once, as the memory of threads, is made in the first round.
        rounds.play(|| false).expect("every step can be made");
        for round in 0..2 {
            let used = measure(|| {
                rounds.play(|| false).expect("every step can be made, to the same bits");
            });
            assert!(used.count_total > 0, "surfaces and snapshots ask for memory");
            assert_eq!(used.bytes_current, 0, "round {round}");
            assert_eq!(used.count_current, 0, "round {round}");
        }
    }
}
