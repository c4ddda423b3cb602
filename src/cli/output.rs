//! Standard output, and the answer "no" as an exit code.

use std::io::{ErrorKind, Write as _};

/// What was asked has been answered, and the answer, already printed, is no.
#[derive(Debug, thiserror::Error)]
#[error("the answer is no")]
pub(super) struct AnswerIsNo;

pub(super) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = error.downcast_ref::<std::io::Error>().map(std::io::Error::kind);
    kind == Some(ErrorKind::BrokenPipe)
}

/// Prints `text` and a line end on standard output.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.write_all(b"\n")?;
    out.flush()?;
    Ok(())
}
