//! Standard output, and the answer "no" as an exit code.

use std::cell::RefCell;
use std::io::{ErrorKind, IsTerminal as _, Write as _};
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use serde::Serialize;

use crate::quantity::printable;
use crate::report::text::{folded, folded_comments};
use crate::report::{check_finite, to_json};

/// What a command would print, for a program that runs it in its own process.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CommandAnswer {
    /// What it prints on standard output.
    pub output: String,
    /// What it says on standard error.
    pub messages: String,
    /// Its exit code.
    pub code: u8,
}

/// An answer in the making.
struct CapturedAnswer {
    answer: CommandAnswer,
    stop: Arc<AtomicBool>,
}

thread_local! {
    /// The answer that this thread's command gives, if it runs within another program.
    static CAPTURED: RefCell<Option<CapturedAnswer>> = const { RefCell::new(None) };
}

/// What unwinds a command that is to stop.
struct Stopped;

/// The answer of `command`; none if `stop` ended it.
pub(super) fn captured(
    stop: &Arc<AtomicBool>,
    command: impl FnOnce() -> u8,
) -> Option<CommandAnswer> {
    let started = CapturedAnswer { answer: CommandAnswer::default(), stop: Arc::clone(stop) };
    CAPTURED.set(Some(started));
    // Nothing of the command outlives it but files, which are written whole or not at all.
    let code = panic::catch_unwind(AssertUnwindSafe(command));
    let made = CAPTURED.take()?;
    match code {
        Ok(code) => Some(CommandAnswer { code, ..made.answer }),
        Err(stopped) if stopped.is::<Stopped>() => None,
        Err(fault) => panic::resume_unwind(fault),
    }
}

/// Whether this thread's command runs within another program.
pub(super) fn is_captured() -> bool {
    CAPTURED.with_borrow(Option::is_some)
}

/// What ends this thread's command, if it runs within another program.
pub(super) fn stop_flag() -> Option<Arc<AtomicBool>> {
    CAPTURED.with_borrow(|made| made.as_ref().map(|made| Arc::clone(&made.stop)))
}

/// Ends a command that is to stop; called wherever progress is told, by any of its threads.
pub(super) fn stop_if_asked(flag: Option<&Arc<AtomicBool>>) {
    if flag.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
        panic::resume_unwind(Box::new(Stopped));
    }
}

/// Keeps `line` where `part` of the answer says; false if there is no answer in the making.
fn keep(line: &str, part: fn(&mut CommandAnswer) -> &mut String) -> bool {
    CAPTURED.with_borrow_mut(|made| {
        let Some(made) = made else { return false };
        let text = part(&mut made.answer);
        text.push_str(line);
        text.push('\n');
        true
    })
}

/// Error for an answer of no that has been printed already.
#[derive(Debug, thiserror::Error)]
#[error("the answer is no")]
pub(super) struct AnswerIsNo;

pub(super) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = error.downcast_ref::<std::io::Error>().map(std::io::Error::kind);
    kind == Some(ErrorKind::BrokenPipe)
}

/// Makes the program's command line; set by `main`, so that the pages that describe all commands do
/// not depend on the table of commands.
pub(super) static COMMAND_LINE: OnceLock<fn() -> clap::Command> = OnceLock::new();

/// The program's command line.
pub(super) fn command_line() -> clap::Command {
    COMMAND_LINE.get().map_or_else(|| clap::Command::new("hertzscope"), |make| make())
}

/// Columns of a terminal that does not say how many it has.
const USUAL_WIDTH: usize = 80;

/// Shows a result as JSON, or as its `page`. All results are printed here: one with a number that
/// is not finite is an error.
pub(super) fn show<R: Serialize + ?Sized>(
    result: &R,
    json: bool,
    page: impl FnOnce(&R) -> String,
) -> anyhow::Result<()> {
    if json {
        return print(&to_json(result)?);
    }
    check_finite(result)?;
    print(&page(result))
}

/// Prints `text` and a line end on standard output. What comes from files and from other programs
/// cannot command the terminal: control characters are written as `\u001b`. On a terminal, long
/// notes are wrapped, and marked with colour.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    let text = printable(text);
    if !is_terminal() {
        return print_as_it_is(&text);
    }
    let folded = folded(&text, terminal_width());
    print_as_it_is(&if is_coloured() { tinted(&folded) } else { folded })
}

/// Prints a page of TOML, whose comments are wrapped on a terminal.
pub(super) fn print_toml(text: &str) -> anyhow::Result<()> {
    let text = printable(text);
    if is_terminal() {
        return print_as_it_is(&folded_comments(&text, terminal_width()));
    }
    print_as_it_is(&text)
}

fn terminal_width() -> usize {
    #[cfg(feature = "tui")]
    if let Ok((columns, _)) = ratatui::crossterm::terminal::size() {
        return usize::from(columns);
    }
    std::env::var("COLUMNS").ok().and_then(|text| text.parse().ok()).unwrap_or(USUAL_WIDTH)
}

/// What a line begins with that is marked, and how.
const TINTS: [(&str, &str); 5] = [
    ("error:", "1;31"),
    ("warning:", "1;33"),
    ("note:", "33"),
    ("  note ", "33"),
    ("  beyond ", "1;31"),
];

fn tinted(text: &str) -> String {
    let line = |line: &str| {
        let tint = TINTS.iter().find(|(word, _)| line.starts_with(word));
        tint.map_or(line.to_owned(), |(word, colour)| {
            format!("\u{1b}[{colour}m{word}\u{1b}[0m{}", &line[word.len()..])
        })
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// Says something beside the answer, on standard error, in one or more lines.
pub(super) fn say(text: &str) {
    if keep(&printable(text), |answer| &mut answer.messages) {
        return;
    }
    let is_plain = !std::io::stderr().is_terminal() || wants_no_colour();
    let text = printable(text);
    // A closed or full standard error leaves no way to report that.
    let _ = if is_plain {
        writeln!(std::io::stderr(), "{text}")
    } else {
        writeln!(std::io::stderr(), "{}", tinted(&folded(&text, terminal_width())))
    };
}

/// Prints text of the program's own, colours included.
pub(super) fn print_as_it_is(text: &str) -> anyhow::Result<()> {
    if keep(text, |answer| &mut answer.output) {
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.write_all(b"\n")?;
    out.flush()?;
    Ok(())
}

/// Whether output may be coloured: it goes to a terminal, and the environment variable `NO_COLOR`
/// is not set.
pub(super) fn is_coloured() -> bool {
    !wants_no_colour() && is_terminal()
}

fn is_terminal() -> bool {
    !is_captured() && std::io::stdout().is_terminal()
}

fn wants_no_colour() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}
