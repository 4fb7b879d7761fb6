//! What can be typed behind `viscera bench`.

use clap::{Args, Subcommand};

use crate::arguments::SceneArguments;
use crate::units::time;

#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    /// Find the largest organ that this machine moves in real time: by 1 000 explicit steps of 1 ms in a second, and by 60
    /// implicit ones.
    Capacity(CapacityArguments),
    /// Run a scene over and over, and fail if the memory of the program grows or two rounds do not end with the same bits.
    Soak(SoakArguments),
}

#[derive(Debug, Args)]
pub(crate) struct CapacityArguments {
    /// To 10 % instead of 2 %, and from fewer measurements.
    #[arg(long)]
    pub(crate) quick: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SoakArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// How long by the clock on the wall, such as "10 min" or "1 h" (a bare number is seconds).
    #[arg(long = "for", value_name = "TIME", value_parser = time, default_value = "1 h")]
    pub(crate) duration: f64,
}
