//! `hertzscope help`: a command, or every key of a scene, a calibration plan, a laboratory or a
//! sweep.

use anyhow::bail;
use clap::Args;

use crate::scene::help::annotated;
use crate::scene::vocabulary;

/// Explain a command, or print a scene (`help scene`), a calibration plan (`help plan`), a
/// laboratory (`help lab`) or a sweep (`help grid`) with every key, unit and default
#[derive(Debug, Args)]
pub struct Arguments {
    /// A command, `scene`, `plan`, `lab`, or `grid` [default: list the commands]
    topic: Option<String>,
}

/// Prints the help on a topic.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut command = super::output::command_line();
    command.build();
    let page = match arguments.topic.as_deref() {
        None => command.render_long_help().to_string(),
        Some(topic) => {
            if let Some(page) = annotated(topic) {
                return super::print_toml(page.trim_end());
            }
            let Some(found) = command.find_subcommand_mut(topic) else {
                if let Some(answer) = vocabulary::answer(topic) {
                    bail!("no help on `{topic}`: {answer}");
                }
                let names: Vec<&str> =
                    command.get_subcommands().map(clap::Command::get_name).collect();
                bail!(
                    "no help on `{topic}`: topics are scene, plan, lab, grid, {}",
                    names.join(", ")
                );
            };
            found.render_long_help().to_string()
        }
    };
    super::print(page.trim_end())
}
