//! What `--help` and the manual say of each command beside its options: its group, an example, exit
//! codes, and the page of the docs.

use std::fmt::Write as _;

/// A command in the guide.
#[derive(Clone, Copy)]
struct Guide {
    name: &'static str,
    example: &'static str,
    /// What exit code 1 means; empty where there is none.
    answer_no: &'static str,
    /// Page in `docs/`.
    page: &'static str,
}

const fn guide(name: &'static str, example: &'static str, page: &'static str) -> Guide {
    Guide { name, example, answer_no: "", page }
}

const fn with_answer(guide: Guide, answer_no: &'static str) -> Guide {
    Guide { answer_no, ..guide }
}

/// Commands by what they are for.
const GROUPS: [(&str, &[Guide]); 5] = [
    (
        "Benches",
        &[
            guide("run", "run magnet-0.61g -o first.mcap", "first-trace.md"),
            guide("show", "show magnet-0.61g > mine.toml", "scenes.md"),
            guide("scenes", "scenes magnet-0.61g", "scenes.md"),
            guide("list", "list materials", "scenes.md"),
            guide("view", "view magnet-0.61g", "screen.md"),
            guide("serve", "serve magnet-0.61g --impact-every 2s", "clients.md"),
            guide("magnet", "magnet ring-15-6-6 --preload 2.38N", "models/magnets.md"),
        ],
    ),
    (
        "Records, simulated or measured",
        &[
            guide("acquire", "acquire tcp://127.0.0.1:5025 -o day.mcap --shots 10", "acquire.md"),
            guide("info", "info F0000CH1.CSV", "measurements.md"),
            guide("convert", "convert ALL0000 day.mcap --scene magnet-0.61g", "measurements.md"),
            guide("arrivals", "arrivals day.mcap -o statistics.csv", "traces.md"),
            guide("force", "force day.mcap --channel CH1", "calibration.md"),
            guide("spectrum", "spectrum first.mcap --channel CH2 --plot spectrum.svg", "traces.md"),
            guide("transfer", "transfer shot-*.mcap --between CH2,CH3", "traces.md"),
            guide("spectrogram", "spectrogram first.mcap --truth p14", "traces.md"),
            guide("dispersion", "dispersion first.mcap --plot dispersion.svg", "traces.md"),
            guide("bands", "bands magnet-0.61g --to 10N", "traces.md"),
        ],
    ),
    (
        "Measurement against model",
        &[
            with_answer(
                guide(
                    "compare",
                    "compare day.mcap magnet-0.61g --tolerance peak=5%",
                    "measurements.md",
                ),
                "a score is beyond the tolerance",
            ),
            with_answer(
                guide("fit", "fit day.mcap magnet-0.61g --free striker.speed", "measurements.md"),
                "nothing was determined, or more than noise is left",
            ),
            with_answer(
                guide("calibrate", "calibrate plan.toml -o certificate", "calibration.md"),
                "the plan contradicts itself, nothing is certified",
            ),
            guide("budget", "budget magnet-0.61g --samples 200", "uncertainty.md"),
        ],
    ),
    (
        "Studies",
        &[
            guide("effects", "effects magnet-0.61g --why", "scenes.md"),
            with_answer(guide("hard-cases", "hard-cases --why", "accuracy.md"), "a case fails"),
            guide("cost", "cost magnet-0.61g --plot cost.svg", "accuracy.md"),
            guide("tunability", "tunability --knob preload --plot map.png", "paper.md"),
            guide("sweep", "sweep grid.toml", "sweeps.md"),
            with_answer(guide("gather", "gather grid.sweep", "sweeps.md"), "runs are missing"),
            guide("paper", "paper --figure 9 --out figures", "paper.md"),
        ],
    ),
    (
        "The program",
        &[
            guide("help", "help scene", "scenes.md"),
            with_answer(guide("doctor", "doctor", "first-trace.md"), "something is wrong"),
            guide("completions", "completions bash", "commands.md"),
            guide("man", "man -o man", "commands.md"),
        ],
    ),
];

/// Widest name of a command, and the gap behind it.
const NAME_WIDTH: usize = 13;

/// `command` with its subcommands in groups, and what the guide says of each.
pub fn guided(command: clap::Command) -> clap::Command {
    let mut page = String::from("{about}\n\n{usage-heading} {usage}\n");
    for (group, guides) in GROUPS {
        let known = guides.iter().filter_map(|guide| command.find_subcommand(guide.name));
        let known: Vec<_> = known.collect();
        // Writing to a String cannot fail.
        let _ = write!(page, "\n{group}:\n");
        for found in known {
            let about = found.get_about().map(ToString::to_string).unwrap_or_default();
            let short = about.split([':', ';', ',']).next().unwrap_or_default();
            let _ = writeln!(page, "  {:<NAME_WIDTH$}{short}", found.get_name());
        }
    }
    page.push_str("\nOptions:\n{options}{after-help}");
    let command = command.help_template(page).after_help(
        "A scene is a TOML file that describes one experiment: chain, striker, sensors and oscilloscope (`hertzscope help scene`). A shot is one impact \
         with what the oscilloscope recorded of it; a recording (.mcap) holds one or more shots. `hertzscope help COMMAND` has an example of each command.",
    );
    let all = GROUPS.iter().flat_map(|(_, guides)| guides.iter());
    all.fold(command, |command, guide| {
        if command.find_subcommand(guide.name).is_none() {
            return command;
        }
        command.mut_subcommand(guide.name, |found| found.after_long_help(words(guide)))
    })
}

fn words(guide: &Guide) -> String {
    let no = match guide.answer_no {
        "" => String::new(),
        words => format!("1: {words}; "),
    };
    format!(
        "Example:\n  hertzscope {}\n\nExit code:\n  0: done; {no}2: could not be done\n\nMore:\n  docs/{}",
        guide.example, guide.page
    )
}

/// The examples and pages of all commands, by their names.
#[cfg(test)]
pub fn examples() -> Vec<(&'static str, &'static str, &'static str)> {
    let guides = GROUPS.iter().flat_map(|(_, guides)| guides.iter());
    guides.map(|guide| (guide.name, guide.example, guide.page)).collect()
}
