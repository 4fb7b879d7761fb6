use viscera::executor::Executor;
use viscera::world::{BodyId, StepError};
use viscera_scene::file::SceneFile;
use viscera_scene::{Meshes, Scene};

use super::build::{Change, Fresh, Origin};
use super::ghost::Ghost;
use super::surface::{Surface, follow};
use super::tools::{self, Hand, Tool};
use super::world::{AnyWorld, with};
use crate::message::{BodyEntry, Camera, Observables, Refusal};
use crate::refuse;

/// A scene being played.
pub(crate) struct Play {
    pub(crate) origin: Origin,
    /// The scene as it was opened.
    pub(crate) original: SceneFile,
    /// The scene with the present parameters.
    pub(crate) file: SceneFile,
    meshes: Meshes,
    pub(crate) world: AnyWorld,
    pub(crate) surfaces: Vec<Surface>,
    /// Every instrument that there ever was, by number.
    pub(crate) tools: Vec<Tool>,
    pub(crate) ghost: Option<Ghost>,
    /// A ball around all bodies at rest: centre and radius [m].
    pub(crate) ball: ([f64; 3], f64),
}

impl Play {
    /// Opens a scene; gives it and what is to be known about its meshes.
    pub(crate) fn open(name: &str, scene: &Scene) -> Result<(Self, Vec<String>), Box<Refusal>> {
        let mut meshes = Meshes::default();
        let origin = Origin { name: name.into(), files: scene.source_of_files().clone() };
        let built = scene.check().and_then(|file| Ok((file, Fresh::build(scene, &mut meshes)?)));
        let (file, Fresh { world, surfaces, tools, notices }) = built.map_err(|errors| refuse::scene(&errors))?;
        if surfaces.is_empty() {
            return Err(refuse::with_help("the scene has no body", "add one, as [body.liver]"));
        }
        let ball = ball(&world);
        let original = file.clone();
        Ok((Self { origin, original, file, meshes, world, surfaces, tools, ghost: None, ball }, notices))
    }

    /// Takes other parameters. Where they make no sense, nothing changes.
    pub(crate) fn change(&mut self, file: SceneFile, how: &Change) -> Result<(), Box<Refusal>> {
        let Fresh { mut world, surfaces, .. } = Fresh::of_file(&file, &self.origin, &mut self.meshes)?;
        tools::match_slots(&mut world, self.ball.1, &self.tools)?;
        let goes_on = matches!(how, Change::Continue);
        if goes_on {
            world.continue_from(&self.world).map_err(|error| refuse::because(error.to_string()))?;
        } else {
            tools::lead_as_before(&mut world, self.ball.1, &self.world, &self.tools)?;
        }
        let of_ghost = |ghost: &Ghost| {
            let from = goes_on.then_some(&ghost.world);
            Ghost::of(&file, &self.origin, &mut self.meshes, (&self.tools, self.ball.1), from)
        };
        let ghost = self.ghost.as_ref().map(of_ghost).transpose()?;
        // Of the same meshes: vertices keep their numbers, and whoever draws them need not know.
        let before = std::mem::replace(&mut self.surfaces, surfaces);
        let ghost_before = std::mem::replace(&mut self.ghost, ghost);
        if goes_on {
            self.surfaces = before;
            if let (Some(ghost), Some(before)) = (&mut self.ghost, ghost_before) {
                ghost.surfaces = before.surfaces;
            }
        }
        (self.world, self.file) = (world, file);
        self.ball = ball(&self.world);
        Ok(())
    }

    /// Goes back to a state of the scene with other parameters and instruments.
    pub(crate) fn restore(&mut self, kept: &Kept) -> Result<(), Box<Refusal>> {
        let Fresh { mut world, mut surfaces, .. } = Fresh::of_file(&kept.file, &self.origin, &mut self.meshes)?;
        tools::match_slots(&mut world, self.ball.1, &kept.tools)?;
        world.restore(&kept.state).map_err(refuse::because)?;
        let of_ghost =
            |_| Ghost::of(&kept.file, &self.origin, &mut self.meshes, (&kept.tools, self.ball.1), Some(&world));
        let ghost = self.ghost.as_ref().map(of_ghost).transpose()?;
        follow(&world, &mut surfaces);
        (self.world, self.surfaces, self.ghost) = (world, surfaces, ghost);
        (self.file, self.tools) = (kept.file.clone(), kept.tools.clone());
        Ok(())
    }

    /// The state, with all that is needed to come back to it.
    pub(crate) fn keep(&self) -> Kept {
        let (file, tools, state) = (self.file.clone(), self.tools.clone(), self.world.snapshot());
        Kept { time: self.world.time(), file, tools, state }
    }

    /// Shows the linear model beside each body, or hides it.
    pub(crate) fn show_ghost(&mut self, on: bool) -> Result<(), Box<Refusal>> {
        if on != self.ghost.is_some() {
            let make =
                || Ghost::of(&self.file, &self.origin, &mut self.meshes, (&self.tools, self.ball.1), Some(&self.world));
            self.ghost = on.then(make).transpose()?;
        }
        Ok(())
    }

    /// Makes a step; a ghost that cannot follow is given up, and why comes back.
    pub(crate) fn step(&mut self, executor: &Executor) -> Result<Option<StepError>, StepError> {
        self.world.step(executor)?;
        follow(&self.world, &mut self.surfaces);
        let Some(ghost) = &mut self.ghost else { return Ok(None) };
        match ghost.world.step(executor) {
            Ok(_) => {
                follow(&ghost.world, &mut ghost.surfaces);
                Ok(None)
            }
            Err(error) => {
                self.ghost = None;
                Ok(Some(error))
            }
        }
    }

    /// Brings an instrument in; gives its number.
    pub(crate) fn add_tool(&mut self, kind: &str, hand: &Hand, trocar: Option<[f64; 3]>) -> Result<u32, Box<Refusal>> {
        tools::add(&mut self.world, kind, self.ball.1, hand, trocar).map_err(refuse::because)?;
        if let Some(ghost) = &mut self.ghost {
            tools::add(&mut ghost.world, kind, self.ball.1, hand, trocar).map_err(refuse::because)?;
        }
        let number = self.tools.len() as u32;
        let name = format!("{kind} {}", number + 1);
        self.tools.push(Tool {
            kind: kind.into(),
            name,
            of_scene: false,
            scripted: false,
            removed: false,
            stamp: None,
        });
        Ok(number)
    }

    /// Takes an instrument away.
    pub(crate) fn remove_tool(&mut self, instrument: u32) -> Result<(), Box<Refusal>> {
        self.tool(instrument)?;
        tools::remove(&mut self.world, instrument).map_err(refuse::because)?;
        if let Some(ghost) = &mut self.ghost {
            tools::remove(&mut ghost.world, instrument).map_err(refuse::because)?;
        }
        self.tools[instrument as usize].removed = true;
        Ok(())
    }

    /// Says where an instrument should be at the end of the next step, or go as fast as it may.
    pub(crate) fn lead_tool(&mut self, instrument: u32, hand: &Hand, stamp: Option<f64>) -> Result<(), Box<Refusal>> {
        self.tool(instrument)?;
        tools::lead(&mut self.world, instrument, self.ball.1, hand).map_err(refuse::because)?;
        if let Some(ghost) = &mut self.ghost {
            tools::lead(&mut ghost.world, instrument, self.ball.1, hand).map_err(refuse::because)?;
        }
        let tool = &mut self.tools[instrument as usize];
        (tool.scripted, tool.stamp) = (false, stamp);
        Ok(())
    }

    /// Leads the shaft of an instrument through a point [m], or lets it go.
    pub(crate) fn set_trocar(&mut self, instrument: u32, trocar: Option<[f64; 3]>) -> Result<(), Box<Refusal>> {
        self.tool(instrument)?;
        tools::set_trocar(&mut self.world, instrument, trocar).map_err(refuse::because)?;
        if let Some(ghost) = &mut self.ghost {
            tools::set_trocar(&mut ghost.world, instrument, trocar).map_err(refuse::because)?;
        }
        Ok(())
    }

    pub(crate) fn tool(&self, instrument: u32) -> Result<(), Box<Refusal>> {
        match self.tools.get(instrument as usize) {
            Some(tool) if !tool.removed => Ok(()),
            _ => Err(refuse::with_help(format!("there is no instrument {instrument}"), "`scene` lists them")),
        }
    }

    /// The bodies, and behind them their ghosts.
    pub(crate) fn bodies(&self) -> Vec<BodyEntry> {
        let names: Vec<&String> = self.file.body.keys().collect();
        let entries = |world: &AnyWorld, surfaces: &[Surface], is_ghost: bool| -> Vec<BodyEntry> {
            let entry = |body: usize| {
                let (law, model) = world.law_and_model(body);
                BodyEntry {
                    name: names[body].clone(),
                    ghost_of: is_ghost.then_some(body),
                    cells: world.cell_count(body),
                    nodes: world.rest(body).len(),
                    vertices: surfaces[body].nodes.len(),
                    law,
                    model,
                }
            };
            (0..surfaces.len()).map(entry).collect()
        };
        let mut bodies = entries(&self.world, &self.surfaces, false);
        bodies.extend(self.ghost.iter().flat_map(|ghost| entries(&ghost.world, &ghost.surfaces, true)));
        bodies
    }

    /// Worlds with their bodies' numbers among all and their surfaces.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (&AnyWorld, usize, &Surface)> {
        fn of<'a>(
            world: &'a AnyWorld,
            surfaces: &'a [Surface],
        ) -> impl Iterator<Item = (&'a AnyWorld, usize, &'a Surface)> {
            surfaces.iter().enumerate().map(move |(body, surface)| (world, body, surface))
        }
        let ghost = self.ghost.iter().flat_map(|ghost| of(&ghost.world, &ghost.surfaces));
        of(&self.world, &self.surfaces).chain(ghost)
    }

    /// Numbers about each body, and behind them those of their ghosts.
    pub(crate) fn observe(&mut self) -> Vec<Observables> {
        let of = |world: &mut AnyWorld| -> Vec<Observables> {
            (0..world.body_count()).map(|body| observables(world, body)).collect()
        };
        let mut all = of(&mut self.world);
        all.extend(self.ghost.iter_mut().flat_map(|ghost| of(&mut ghost.world)));
        all
    }

    /// From where the scene is best seen.
    pub(crate) fn camera(&self) -> Camera {
        let camera = &self.file.output.camera;
        Camera { look: camera.look, up: camera.up }
    }
}

/// A state that is kept, with what the scene was then.
#[derive(Clone)]
pub(crate) struct Kept {
    /// When it was [s].
    pub(crate) time: f64,
    pub(crate) file: SceneFile,
    pub(crate) tools: Vec<Tool>,
    /// Bytes of the world's snapshot.
    pub(crate) state: Vec<u8>,
}

fn observables(world: &mut AnyWorld, body: usize) -> Observables {
    let seen = world.observe(body);
    let keeps_volumes = with!(world, world => world.body(BodyId(body)).kept_volumes().next().is_some());
    Observables {
        kinetic: seen.kinetic_energy,
        elastic: seen.elastic_energy,
        gravity: seen.gravity_energy,
        volume_variation: seen.volume_variation,
        largest_displacement: seen.max_displacement,
        cells: world.cell_count(body),
        removed: seen.removed_cells,
        inverted: seen.inverted_cells,
        worst_quality: seen.worst_quality,
        nonlinear_nodes: seen.nonlinear_nodes,
        at_rest: seen.at_rest,
        volume_error: keeps_volumes.then_some(seen.volume_error),
        interface_residual: seen.interface_residual,
    }
}

/// A ball around all bodies at rest: the middle of their bounding box, and the farthest node from there.
fn ball(world: &AnyWorld) -> ([f64; 3], f64) {
    let nodes = || (0..world.body_count()).flat_map(|body| world.rest(body));
    let Some(&first) = nodes().next() else { return ([0.0; 3], 1.0) };
    let (low, high) = nodes().fold((first, first), |(low, high), &node| (low.min(node), high.max(node)));
    let centre = (low + high) * 0.5;
    let radius = nodes().map(|&node| (node - centre).squared_norm()).fold(0.0, f64::max).sqrt();
    (centre.to_array(), radius)
}
