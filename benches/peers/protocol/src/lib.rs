//! How the comparison speaks to a driver: commands come as lines of JSON, and each is answered by a line.
//!
//! | command | answer |
//! |---|---|
//! | `{"do": "about"}` | what the driver is, and its variants |
//! | `{"do": "build", "mesh": path, "variant": name, "step": s, "gravity": [m/s²], "damping": 1/s}` | `{}` |
//! | `{"do": "run", "steps": n}` | `{"seconds": processor time, "steps": steps made, "tip": [m], "farthest": m}` |
//! | `{"do": "place", "positions": [[m]]}` | `{}`; everything is at rest there |
//!
//! What fails answers `{"error": why}`. The same in Python: `protocol.py`.

mod case;
mod mesh;

use std::io::{BufRead, Write};
use std::path::Path;

use cpu_time::ProcessTime;
use serde_json::{Value, json};

pub use case::Case;
pub use mesh::Mesh;

/// What can go wrong, for a person to read.
pub type Failure = Box<dyn std::error::Error>;

/// A program to be compared.
pub trait Peer {
    /// Name, version and variants.
    fn about(&self) -> Value;

    /// The beam, at rest in its rest shape.
    ///
    /// # Errors
    /// Where the program refuses it.
    fn build(&self, case: &Case, mesh: &Mesh, setup: &Setup) -> Result<Box<dyn Simulation>, Failure>;
}

/// How the beam is to be simulated.
pub struct Setup {
    /// Name of the variant.
    pub variant: String,
    /// Time of one step [s].
    pub step: f64,
    /// Gravity [m/s²].
    pub gravity: [f64; 3],
    /// Rate of mass damping [1/s].
    pub damping: f64,
}

/// A beam that moves.
pub trait Simulation {
    /// Advances by this many steps of [`Setup::step`]. Gives how many steps the program made of them.
    ///
    /// # Errors
    /// Where the program refuses to go on.
    fn advance(&mut self, steps: u64) -> Result<u64, Failure>;

    /// Where the nodes are [m].
    fn positions(&self) -> Vec<[f64; 3]>;

    /// Puts all nodes somewhere, at rest.
    fn place(&mut self, positions: &[[f64; 3]]);
}

/// Answers commands until there are no more.
///
/// # Errors
/// Where the case cannot be read, or the other side is gone.
pub fn serve(peer: &dyn Peer, case: &Case) -> Result<(), Failure> {
    let mut session = Session { peer, case, built: None };
    for line in std::io::stdin().lock().lines() {
        let command = serde_json::from_str(&line?)?;
        let answer = session.answer(&command).unwrap_or_else(|failure| json!({ "error": failure.to_string() }));
        let mut out = std::io::stdout().lock();
        writeln!(out, "{answer}")?;
        out.flush()?;
    }
    Ok(())
}

struct Session<'a> {
    peer: &'a dyn Peer,
    case: &'a Case,
    built: Option<(Mesh, Box<dyn Simulation>)>,
}

impl Session<'_> {
    fn answer(&mut self, command: &Value) -> Result<Value, Failure> {
        match command["do"].as_str() {
            Some("about") => Ok(self.peer.about()),
            Some("build") => self.build(command),
            Some("run") => self.run(command["steps"].as_u64().ok_or("`run` needs `steps`")?),
            Some("place") => {
                let positions: Vec<[f64; 3]> = serde_json::from_value(command["positions"].clone())?;
                self.built.as_mut().ok_or("nothing is built")?.1.place(&positions);
                Ok(json!({}))
            }
            _ => Err(format!("no such command: {command}").into()),
        }
    }

    fn build(&mut self, command: &Value) -> Result<Value, Failure> {
        let mesh = Mesh::read(Path::new(command["mesh"].as_str().ok_or("`build` needs `mesh`")?))?;
        let setup = Setup {
            variant: command["variant"].as_str().ok_or("`build` needs `variant`")?.into(),
            step: command["step"].as_f64().ok_or("`build` needs `step`")?,
            gravity: serde_json::from_value(command["gravity"].clone())?,
            damping: command["damping"].as_f64().unwrap_or(0.0),
        };
        self.built = None;
        let simulation = self.peer.build(self.case, &mesh, &setup)?;
        self.built = Some((mesh, simulation));
        Ok(json!({}))
    }

    fn run(&mut self, steps: u64) -> Result<Value, Failure> {
        let (mesh, simulation) = self.built.as_mut().ok_or("nothing is built")?;
        // Time on the processor: what else the machine does is not counted.
        let begin = ProcessTime::now();
        let made = simulation.advance(steps)?;
        let seconds = begin.elapsed().as_secs_f64();
        let positions = simulation.positions();
        let tip = mesh.tip(self.case);
        let displacement =
            |node: usize| -> [f64; 3] { std::array::from_fn(|axis| positions[node][axis] - mesh.nodes[node][axis]) };
        let distance = |node: usize| displacement(node).iter().map(|d| d * d).sum::<f64>().sqrt();
        // Not a number in JSON is null, and has to win over every number.
        let farthest = (0..positions.len()).map(distance).fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) });
        Ok(json!({ "seconds": seconds, "steps": made, "tip": displacement(tip), "farthest": farthest }))
    }
}
