//! `hertzscope show`: a scene with everything it is based on.

use std::path::PathBuf;

use clap::Args;

use crate::scene::Scene;

/// Print a scene with everything it is based on and every default, as a scene that gives the same
/// run
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    super::print_toml(Scene::resolved(&arguments.scene)?.trim_end())
}
