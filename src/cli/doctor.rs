//! `hertzscope doctor`: whether the installation is sound.

use clap::Args;
use serde::Serialize;

use super::AnswerIsNo;
use super::installation::{Check, examine};
use crate::motion::kernel::{InstructionSet, VARIABLE};

/// Check the installation: shipped files, instruction sets of the processor, a run against an
/// independent reference; exit code 1 if anything is wrong
#[derive(Debug, Args)]
pub struct Arguments {
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

/// State of the installation.
#[derive(Serialize)]
struct Installation {
    version: &'static str,
    features: Vec<&'static str>,
    instructions: Vec<&'static str>,
    instructions_used: &'static str,
    checks: Vec<Check>,
    sound: bool,
}

/// Parts that can be left out when the program is built.
const FEATURES: [(&str, bool); 4] = [
    ("server", cfg!(feature = "server")),
    ("tui", cfg!(feature = "tui")),
    ("png", cfg!(feature = "png")),
    ("parquet", cfg!(feature = "parquet")),
];

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let checks = examine();
    let sound = checks.iter().all(|check| check.good);
    let sets: Vec<&str> = InstructionSet::available().iter().map(|set| set.name()).collect();
    let features: Vec<&str> = FEATURES.iter().filter(|f| f.1).map(|f| f.0).collect();
    let version = env!("CARGO_PKG_VERSION");
    let report = Installation {
        version,
        features,
        instructions: sets,
        instructions_used: InstructionSet::best().name(),
        checks,
        sound,
    };
    super::show(&report, arguments.json, |found| {
        let mut lines = vec![
            format!("hertzscope {version}, features: {}", found.features.join(", ")),
            format!(
                "instructions of this processor: {}; used: {} (choose with {VARIABLE})",
                found.instructions.join(", "),
                found.instructions_used
            ),
        ];
        lines.extend(found.checks.iter().map(line));
        lines.push(if sound { "all is well" } else { "something is wrong" }.to_owned());
        lines.join("\n")
    })?;
    if sound { Ok(()) } else { Err(AnswerIsNo.into()) }
}

fn line(Check { what, good, found }: &Check) -> String {
    format!("  {}  {what:<21}  {found}", if *good { "good " } else { "WRONG" })
}
