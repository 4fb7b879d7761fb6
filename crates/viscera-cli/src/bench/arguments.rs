//! What can be typed behind `viscera bench`.

use clap::{Args, Subcommand};
use viscera_haptics::Extrapolation;

use crate::arguments::SceneArguments;
use crate::units::time;

#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    /// Find the largest organ that this machine moves in real time: by 1 000 explicit steps of 1 ms in a second, and by 60
    /// implicit ones.
    Capacity(CapacityArguments),
    /// Run a scene over and over, and fail if the memory of the program grows or two rounds do not end with the same bits.
    Soak(SoakArguments),
    /// Run a haptic channel of 1 kHz beside a scene, with an emulated device whose hand leads an instrument; print how punctual it
    /// is, and fail if less than 99.9 % of its periods are within 1.2 ms.
    Haptics(HapticsArguments),
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

#[derive(Debug, Args)]
pub(crate) struct HapticsArguments {
    /// A scene file, or the name of a scene that is built in; without one, `liver-resection` with 6 000 tetrahedra.
    pub(crate) scene: Option<String>,
    /// Change a value of the scene, such as body.liver.law.young="8 kPa"; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// How long by the clock on the wall, such as "20 s" (a bare number is seconds).
    #[arg(long = "for", value_name = "TIME", value_parser = time, default_value = "20 s")]
    pub(crate) duration: f64,
    /// How the force goes on between two samples of the simulation.
    #[arg(long, value_name = "HOW", value_parser = extrapolation, default_value = "linearised")]
    pub(crate) extrapolation: Extrapolation,
    /// While the scene is served, and a client takes its frames as a page does, 60 a second.
    #[arg(long)]
    pub(crate) page: bool,
    /// Leave the channel's thread at ordinary priority.
    #[arg(long)]
    pub(crate) ordinary: bool,
}

impl HapticsArguments {
    pub(super) fn scene_arguments(&self) -> SceneArguments {
        SceneArguments {
            scene: self.scene.clone().unwrap_or_else(|| "liver-resection".into()),
            set: self.set.clone(),
            time: None,
            precision: None,
        }
    }

    /// What makes 6 000 tetrahedra of the scene that is taken where none is named.
    pub(super) fn default_size(&self) -> Option<(&'static str, &'static str)> {
        let is_sized = self.scene.is_some() || self.set.iter().any(|change| change.contains("mesh.edge"));
        (!is_sized).then_some(("body.liver.mesh.edge", "16.3 mm"))
    }
}

/// How a channel goes on between samples of tissue that is stepped beside it.
pub(crate) fn extrapolation(text: &str) -> Result<Extrapolation, String> {
    // `direct` needs tissue that is stepped within the channel.
    let known = || Extrapolation::ALL.into_iter().filter(|&how| how != Extrapolation::Direct);
    known().find(|how| how.name() == text).ok_or_else(|| {
        let names: Vec<_> = known().map(Extrapolation::name).collect();
        format!("there is no such extrapolation; known are {}", names.join(", "))
    })
}
