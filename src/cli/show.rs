//! `hertzscope show`: a scene with everything it stands on.

use clap::Args;

use crate::scene::resolved::resolved;

/// Print a scene with everything it stands on and every default, as a scene that gives the same run
#[derive(Debug, Args)]
pub struct Arguments {
    /// A scene that ships with the program, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: String,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    super::print_toml(resolved(&arguments.scene)?.trim_end())
}
