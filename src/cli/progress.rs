//! A progress bar on standard error for whatever takes longer than a second.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output::{stop_flag, stop_if_asked};
use crate::quantity::printable_line;

/// How long something may take without a bar.
const BAR_DELAY: Duration = Duration::from_secs(1);
/// Parts in which progress is counted.
const PROGRESS_PARTS: u64 = 1000;

/// Progress of one job.
pub struct JobProgress {
    started: Instant,
    bar: Option<ProgressBar>,
    quiet: bool,
    what: String,
    /// Share that was done before it began (1).
    before: f64,
    /// What ends the command within another program.
    stop: Option<Arc<AtomicBool>>,
}

impl JobProgress {
    /// A job called `what`, never shown if `quiet`.
    pub fn new(what: &str, quiet: bool) -> Self {
        Self::resumed(what, quiet, 0.0)
    }

    /// The same of a job of which the share `before` was done earlier (1).
    pub fn resumed(what: &str, quiet: bool, before: f64) -> Self {
        let what = printable_line(what).into_owned();
        Self { started: Instant::now(), bar: None, quiet, what, before, stop: stop_flag() }
    }

    /// Shows that `share` of the work is done, 0 to 1.
    pub fn at(&mut self, share: f64) {
        stop_if_asked(self.stop.as_ref());
        if self.quiet || (self.bar.is_none() && self.started.elapsed() < BAR_DELAY) {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let bar =
                ProgressBar::with_draw_target(Some(PROGRESS_PARTS), ProgressDrawTarget::stderr())
                    .with_elapsed(self.started.elapsed())
                    .with_message(self.what.clone());
            let template = "{msg} [{bar:30}] {percent:>3} %, {eta} left";
            let style = ProgressStyle::with_template(template);
            bar.set_style(
                style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "),
            );
            bar.set_position(parts(self.before));
            bar.reset_eta();
            bar
        });
        bar.set_position(parts(share));
    }

    /// Takes the bar away.
    pub fn done(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A share in parts (1).
fn parts(share: f64) -> u64 {
    (share.clamp(0.0, 1.0) * PROGRESS_PARTS as f64) as u64
}
