//! Standard output, and the answer "no" as an exit code.

use std::io::{ErrorKind, IsTerminal as _, Write as _};

use crate::quantity::printable;

/// Error for an answer of no that has been printed already.
#[derive(Debug, thiserror::Error)]
#[error("the answer is no")]
pub(super) struct AnswerIsNo;

pub(super) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = error.downcast_ref::<std::io::Error>().map(std::io::Error::kind);
    kind == Some(ErrorKind::BrokenPipe)
}

/// Prints `text` and a line end on standard output. What comes from files and from other programs cannot command the terminal: control
/// characters are written as `\u001b`.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    print_as_it_is(&printable(text))
}

/// Says something beside the answer, on standard error, in one or more lines.
pub(super) fn say(text: &str) {
    // Where nobody listens, nothing is to be done about it.
    let _ = writeln!(std::io::stderr(), "{}", printable(text));
}

/// Prints text of the program's own, colours included.
pub(super) fn print_as_it_is(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.write_all(b"\n")?;
    out.flush()?;
    Ok(())
}

/// Whether output may be coloured: it goes to a terminal, and the environment variable `NO_COLOR` is not set.
pub(super) fn is_coloured() -> bool {
    let is_plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    !is_plain && std::io::stdout().is_terminal()
}
