//! Studies of many runs behind a page: asked for when the page opens, computed by a thread.

use ratatui::Frame;
use ratatui::layout::Rect;

use crate::scene::Scene;
use crate::tui::job::{Change, Job, JobState, Queue};
use crate::tui::model::{BackgroundJobs, ScreenState};
use crate::tui::view::layout::whole;
use crate::tui::view::panel::message;

/// Progress from one report to the next (1).
const PROGRESS_STEP: f64 = 0.01;

/// Asks for a study, unless it is there or on its way. `work` reports its progress (1).
pub(super) fn ask<T: Send + 'static>(
    model: &mut ScreenState,
    job: fn(&mut BackgroundJobs) -> &mut JobState<T>,
    work: impl FnOnce(&mut dyn FnMut(f64)) -> Result<T, String> + Send + 'static,
) {
    if !job(&mut model.jobs).begin() {
        return;
    }
    model.ask(Job::new(
        Queue::Study,
        move |report: &dyn Fn(Change<ScreenState>)| {
            let mut reported = 0.0;
            work(&mut |share| {
                if share - reported >= PROGRESS_STEP {
                    reported = share;
                    report(Box::new(move |model: &mut ScreenState| {
                        *job(&mut model.jobs) = JobState::Busy(share);
                    }));
                }
            })
        },
        move |model: &mut ScreenState, result| *job(&mut model.jobs) = result.into(),
    ));
}

/// The bench to study; sets a notice if it is not known.
pub(super) fn scene(model: &mut ScreenState) -> Option<Scene> {
    let scene = model.recordings.front().scene.clone();
    if scene.is_none() {
        let words = "this recording names no scene: give one with :scene SCENE";
        model.set_notice(words.to_owned());
    }
    scene
}

/// The result of a job; without it draws its progress, or why there is none. `what` is computed,
/// and `again` says how to ask for it again.
pub(super) fn done<'a, T>(
    job: &'a JobState<T>,
    (what, again): (&str, &str),
    area: Rect,
    frame: &mut Frame,
) -> Option<&'a T> {
    match job {
        JobState::Done(result) => return Some(result),
        JobState::Busy(share) => busy(what, *share, area, frame),
        JobState::Failed(problem) => message(problem, area, frame),
        JobState::Idle => message(again, area, frame),
    }
    None
}

/// The progress of a running job.
fn busy(what: &str, share: f64, area: Rect, frame: &mut Frame) {
    const WIDTH: usize = 20;
    let done = usize::from(whole(share.clamp(0.0, 1.0) * 20.0));
    let bar: String = (0..WIDTH).map(|i| if i < done { '━' } else { '─' }).collect();
    message(&format!("computing {what} {bar} {:.0} %", 100.0 * share), area, frame);
}
