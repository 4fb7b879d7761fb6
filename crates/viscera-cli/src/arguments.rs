//! What can be typed behind `viscera`.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Parser, Subcommand};
use viscera_haptics::Extrapolation;
use viscera_reproduce::EXPERIMENTS;

use crate::bench::arguments::{BenchCommand, extrapolation};
use crate::emulated::Emulated;
use crate::mesh::arguments::MeshCommand;
use crate::units::time;

const EXIT_CODES: &str = "\
Exit codes:
  0    it went well
  1    the run or the check found a problem
  2    wrong usage or input: a missing file, a mistake in a scene, a folder that cannot be written
  130  interrupted by Ctrl-C; what was computed is kept

Begin with `viscera` alone, which starts the simulator, or with `viscera scenes` and `viscera run liver-resection`.";

/// Soft tissue in real time, physically: play with organs, run scenes, check them, make meshes.
#[derive(Debug, Parser)]
#[command(name = "viscera", version, after_help = EXIT_CODES, disable_help_subcommand = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Start the simulator: an organ in a page of the browser, to be grasped, probed and cut. The same as no command at all.
    #[command(after_help = EXIT_CODES)]
    Serve(ServeArguments),
    /// Run a scene: a ParaView series, observables, a summary and pictures go into a folder.
    #[command(after_help = EXIT_CODES)]
    Run(RunArguments),
    /// Say what a scene holds, what it takes to run it, and what is wrong or odd with it; runs nothing.
    #[command(after_help = EXIT_CODES)]
    Check(SceneArguments),
    /// Compute the responses of `precomputed` bodies once and keep them in files, which the scene names (`model.responses`).
    #[command(after_help = EXIT_CODES)]
    Precompute(PrecomputeArguments),
    /// Run a scene with a clock on every stage: where the time goes, against the time of a frame, and what would lower it.
    #[command(after_help = EXIT_CODES)]
    Profile(ProfileArguments),
    /// Run a scene with many values of its parameters: one row of a table for each combination.
    #[command(after_help = EXIT_CODES)]
    Sweep(SweepArguments),
    /// Measure what this machine holds: the largest organ in real time, the longest run.
    #[command(after_help = EXIT_CODES)]
    Bench {
        #[command(subcommand)]
        command: BenchCommand,
    },
    /// Run the experiments of the founding papers again: one page with their figures and tables, the published values beside ours.
    #[command(after_help = EXIT_CODES)]
    Reproduce(ReproduceArguments),
    /// Look at meshes, convert and make them.
    #[command(after_help = EXIT_CODES)]
    Mesh {
        #[command(subcommand)]
        command: MeshCommand,
    },
    /// List the scenes that are built in, or copy them to change them.
    Scenes(ScenesArguments),
    /// List the tissues that a scene can name, with their numbers; or all that is known of one of them, with its sources.
    #[command(after_help = EXIT_CODES)]
    Tissues(TissuesArguments),
    /// Print the JSON schema of scene files, for editors.
    Schema(SchemaArguments),
}

/// Which scene, and what to change in it.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// A scene file, or the name of a scene that is built in (see `viscera scenes`).
    pub(crate) scene: String,
    /// Change a value of the scene, such as body.liver.law.young="8 kPa"; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Run for another time, such as "0.5 s", than the scene's duration.
    #[arg(long, value_name = "TIME")]
    pub(crate) time: Option<String>,
    /// Compute in another precision than the scene's.
    #[arg(long, value_parser = ["single", "double"])]
    pub(crate) precision: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// The folder for results; by default out/ and the name of the scene.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// How many pictures to take, evenly over the run; by default start, middle and end.
    #[arg(long, value_name = "COUNT", default_value_t = 3)]
    pub(crate) pictures: u64,
    /// Keep a checkpoint after every so much simulated time, such as "0.5 s" (a bare number is seconds). A run that is killed,
    /// or finds the disk full, goes on from the last one with --resume.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) checkpoint: Option<f64>,
    /// Go on from the last checkpoint in the folder for results, to the same bits as a run that was never stopped; from the
    /// start where there is none yet. Keeps checkpoints as before, unless --checkpoint says otherwise.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Threads to compute on. The results are the same to the last bit; bodies of a few thousand cells gain nothing.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: u16,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct PrecomputeArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Threads to compute on; the files are the same to the last bit.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: u16,
}

#[derive(Debug, Args)]
pub(crate) struct ProfileArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// The time that a frame may take, such as "16.7 ms" (a bare number is seconds).
    #[arg(long, value_name = "TIME", value_parser = time, default_value = "16.7 ms")]
    pub(crate) frame: f64,
    /// Threads to compute on.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: u16,
    /// Measure where the time goes, and try no other settings.
    #[arg(long)]
    pub(crate) no_trials: bool,
}

/// The port of the simulator: V-I-S-C is 8472 on a telephone.
const PORT: u16 = 8472;

#[derive(Debug, Args)]
pub(crate) struct ServeArguments {
    /// A scene file, or the name of a scene that is built in; by default a liver that nothing happens to.
    pub(crate) scene: Option<String>,
    /// The port to listen on; 0 takes any that is free. Without it, any that is free where the usual one is taken.
    #[arg(long, value_name = "PORT")]
    pub(crate) port: Option<u16>,
    /// The address to listen on. Others than 127.0.0.1 let other machines drive the simulation.
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    pub(crate) address: IpAddr,
    /// A name, with or without a port, by which pages may reach the simulator besides addresses and localhost; may be repeated.
    #[arg(long, value_name = "NAME")]
    pub(crate) allow_host: Vec<String>,
    /// Open no browser.
    #[arg(long)]
    pub(crate) no_open: bool,
    /// Threads to compute on; by default one less than there are cores. Bodies of a few thousand cells gain nothing.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Put an instrument into a hand that feels the tissue a thousand times a second; how regularly is told at the end. `emulated` is a
    /// hand without hardware: it goes along the instrument's path in the scene and back, or presses along its direction where
    /// it has none. `emulated:80mm` presses so far.
    #[arg(long, value_name = "DEVICE", value_parser = Emulated::parse)]
    pub(crate) haptics: Option<Emulated>,
    /// Which instrument the hand leads, by its number from 0 in the order of the scene; by default the first that is no cautery.
    #[arg(long, value_name = "NUMBER", requires = "haptics")]
    pub(crate) haptics_instrument: Option<u32>,
    /// How the force goes on between two steps of the simulation: hold, time, position or linearised (the default).
    #[arg(long, value_name = "HOW", requires = "haptics", value_parser = extrapolation)]
    pub(crate) haptics_extrapolation: Option<Extrapolation>,
}

impl ServeArguments {
    /// The ports to try, in order.
    pub(crate) fn ports(&self) -> Vec<u16> {
        self.port.map_or_else(|| vec![PORT, 0], |port| vec![port])
    }
}

impl Default for ServeArguments {
    fn default() -> Self {
        Self {
            scene: None,
            port: None,
            address: IpAddr::V4(Ipv4Addr::LOCALHOST),
            allow_host: Vec::new(),
            no_open: false,
            threads: None,
            haptics: None,
            haptics_instrument: None,
            haptics_extrapolation: None,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct SweepArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Values of a key, such as body.liver.law.young="4 kPa,8 kPa"; repeated for more keys, in all combinations.
    #[arg(long, value_name = "KEY=VALUE,…", required = true)]
    pub(crate) vary: Vec<String>,
    /// The table, as CSV; by default out/ and the name of the scene. Rows are written as they come.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Cases that run at a time, a thread each.
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: u16,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ReproduceArguments {
    /// Which experiments; all of them if none is named.
    #[arg(value_name = "NAME", value_parser = PossibleValuesParser::new(experiments()))]
    pub(crate) names: Vec<String>,
    /// The folder for the page, and for its tables, plots and pictures as files.
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    pub(crate) out: PathBuf,
    /// Coarse meshes: less than a minute for all of it.
    #[arg(long)]
    pub(crate) quick: bool,
    /// The folder, or the file, with the measured beads of the truth cube: `uniaxial_positions.csv` of Kerdok et al. (2003), which is
    /// published without a licence and therefore not built in.
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// Names of the experiments, with their headings for the help.
fn experiments() -> impl Iterator<Item = PossibleValue> {
    EXPERIMENTS.into_iter().map(|experiment| PossibleValue::new(experiment.name).help(experiment.title))
}

#[derive(Debug, Args)]
pub(crate) struct ScenesArguments {
    /// Write all of them, with the files that they name and the schema, into this folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) copy_to: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct TissuesArguments {
    /// A tissue, such as liver; all of them by default.
    pub(crate) name: Option<String>,
    /// Write JSON, in SI units.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write Markdown, as the guide has it.
    #[arg(long, conflicts_with = "json")]
    pub(crate) markdown: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SchemaArguments {
    /// Write tables of all keys in Markdown instead, as the guide has them.
    #[arg(long)]
    pub(crate) markdown: bool,
}
