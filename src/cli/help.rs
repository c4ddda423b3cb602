//! `hertzscope help`: a command, or what a scene, a calibration's plan or a laboratory may hold.

use anyhow::bail;
use clap::Args;

use crate::scene::resolved::{annotated_lab, annotated_plan, annotated_scene};

/// Explain a command, or print a scene (`help scene`), a calibration plan (`help plan`) or a laboratory (`help lab`) with every key, unit and default
#[derive(Debug, Args)]
pub struct Arguments {
    /// A command, `scene`, `plan`, or `lab` [default: list the commands]
    topic: Option<String>,
}

/// Prints the help on a topic; `command` is the program's command line.
pub fn run(arguments: &Arguments, mut command: clap::Command) -> anyhow::Result<()> {
    command.build();
    let page = match arguments.topic.as_deref() {
        None => command.render_long_help().to_string(),
        Some("scene") => return super::print_toml(annotated_scene().trim_end()),
        Some("plan") => return super::print_toml(annotated_plan().trim_end()),
        Some("lab") => return super::print_toml(annotated_lab().trim_end()),
        Some(topic) => {
            let Some(found) = command.find_subcommand_mut(topic) else {
                let names: Vec<&str> =
                    command.get_subcommands().map(clap::Command::get_name).collect();
                bail!("no help on `{topic}`: topics are scene, plan, lab, {}", names.join(", "));
            };
            found.render_long_help().to_string()
        }
    };
    super::print(page.trim_end())
}
