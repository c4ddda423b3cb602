//! Background jobs: work that takes long or touches files, as closures.
//!
//! The model asks for a [`Job`]; a thread does its work and sends back a [`Change`] of the model,
//! which the screen's loop applies. Each [`Queue`] has a thread.

use std::fmt;
use std::panic::{self, AssertUnwindSafe};

/// A change of the state `S`.
pub type Change<S> = Box<dyn FnOnce(&mut S) + Send>;

/// The thread that does a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Queue {
    /// Impacts of the live bench; a newer job replaces one that waits.
    Bench,
    /// 95 % bands of the live bench; a newer job replaces one that waits.
    Bands,
    /// What the screen shows of a trace; a newer job replaces one that waits.
    Reading,
    /// What a press of a key needs; a newer job replaces one that waits.
    Key,
    /// Comparisons; a newer job replaces one that waits.
    Comparison,
    /// Studies of many runs, which measure time: one after the other.
    Study,
    /// Files: one after the other.
    File,
}

impl Queue {
    /// All queues.
    pub const ALL: [Self; 7] = [
        Self::Bench,
        Self::Bands,
        Self::Reading,
        Self::Key,
        Self::Comparison,
        Self::Study,
        Self::File,
    ];

    /// Whether a newer job replaces one that waits.
    pub fn keeps_newest(self) -> bool {
        !matches!(self, Self::Study | Self::File)
    }
}

/// Work for a thread.
pub struct Job<S> {
    /// The thread that does it.
    pub queue: Queue,
    work: Work<S>,
}

/// Does the work, reports changes meanwhile, and returns the last one.
type Work<S> = Box<dyn FnOnce(&dyn Fn(Change<S>)) -> Change<S> + Send>;

impl<S: 'static> Job<S> {
    /// A job that does `work` and applies its result, or the message of its failure. While it works
    /// it can report changes.
    pub fn new<T: Send + 'static>(
        queue: Queue,
        work: impl FnOnce(&dyn Fn(Change<S>)) -> Result<T, String> + Send + 'static,
        apply: impl FnOnce(&mut S, Result<T, String>) + Send + 'static,
    ) -> Self {
        let work = move |report: &dyn Fn(Change<S>)| -> Change<S> {
            let result = guarded(|| work(report));
            Box::new(move |state| apply(state, result))
        };
        Self { queue, work: Box::new(work) }
    }

    /// Does the work; the change that is left to be applied.
    pub fn run(self, report: &dyn Fn(Change<S>)) -> Change<S> {
        (self.work)(report)
    }
}

impl<S> fmt::Debug for Job<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Job").field("queue", &self.queue).finish_non_exhaustive()
    }
}

/// Progress of a job.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum JobState<T> {
    /// Not asked for.
    #[default]
    Idle,
    /// At work, with the share that is done (1).
    Busy(f64),
    /// The result.
    Done(T),
    /// It failed, with a message.
    Failed(String),
}

impl<T> JobState<T> {
    /// Begins the job unless it is at work or done; whether it has to be asked for.
    pub fn begin(&mut self) -> bool {
        let begins = matches!(self, Self::Idle | Self::Failed(_));
        if begins {
            *self = Self::Busy(0.0);
        }
        begins
    }

    /// The result, if it is there.
    pub fn done(&self) -> Option<&T> {
        match self {
            Self::Done(result) => Some(result),
            _ => None,
        }
    }
}

impl<T> From<Result<T, String>> for JobState<T> {
    fn from(result: Result<T, String>) -> Self {
        result.map_or_else(Self::Failed, Self::Done)
    }
}

/// An error with all its reasons: what failed, and why the system says so.
pub fn with_reasons(error: &dyn std::error::Error) -> String {
    let reasons = std::iter::successors(error.source(), |reason| reason.source());
    reasons.fold(error.to_string(), |text, reason| format!("{text}: {reason}"))
}

/// Does a piece of work; a panic in it becomes a message, and the thread goes on.
///
/// # Errors
/// The error of `work`, or its panic.
pub fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<&str>().map(|words| (*words).to_owned());
        let words = words.or_else(|| panic.downcast_ref::<String>().cloned());
        let words = words.unwrap_or_else(|| "no words about it".to_owned());
        Err(format!("an error of this program, please report it: {words}"))
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_panic_becomes_an_error_with_its_message() {
        let error = super::guarded(|| -> Result<(), String> { panic!("at shot {}", 3) });
        assert_eq!(error.unwrap_err(), "an error of this program, please report it: at shot 3");
        assert_eq!(super::guarded(|| Ok::<_, String>(4)), Ok(4));
    }
}
