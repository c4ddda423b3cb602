//! Strikes the bench on its own thread, and computes its bands on another.

use std::sync::mpsc::{Receiver, Sender};

use super::{ScreenEvent, guarded, with_reasons};
use crate::experiment::auto_effects::resolve_auto_effects;
use crate::experiment::{Integration, facts, run};
use crate::predict::{SampleOptions, TraceBand, trace_bands};
use crate::recording::TraceSet;
use crate::scene::Scene;
use crate::scene::adjust::Adjustable;
use crate::tui::model::background_jobs::JobAnswer;
use crate::tui::model::{JobState, StrikeRequest, StrikeResult};

/// Samples of the bench's uncertainty: the ends of 95 % intervals scatter by 7 % of their width.
const BAND_SAMPLES: usize = 100;

/// The newest of the requests that are waiting; the older ones are stale.
fn newest(first: StrikeRequest, waiting: &Receiver<StrikeRequest>) -> StrikeRequest {
    waiting.try_iter().last().unwrap_or(first)
}

/// Computes where 95 % of the traces lie.
pub fn bands(bench: StrikeRequest, waiting: &Receiver<StrikeRequest>, news: &Sender<ScreenEvent>) {
    let StrikeRequest { name, text, .. } = newest(bench, waiting);
    let found = guarded(|| {
        let mut scene =
            Adjustable::from_text(&name, "the bench", &text).map_err(|e| with_reasons(&e))?;
        let options = SampleOptions { samples: BAND_SAMPLES, ..SampleOptions::default() };
        trace_bands(&mut scene, options).map_err(|error| with_reasons(&error))
    });
    let edges = |bands: Vec<TraceBand>| bands.into_iter().map(TraceBand::edges).collect();
    let job = found.map_or_else(JobState::Failed, |bands| JobState::Done(edges(bands)));
    // The screen may be closed already.
    let _ = news.send(ScreenEvent::Answer(JobAnswer::LiveBands(job)));
}

/// Strikes the bench.
pub fn strike(
    strike: StrikeRequest,
    waiting: &Receiver<StrikeRequest>,
    news: &Sender<ScreenEvent>,
) {
    let strike = newest(strike, waiting);
    let answer = guarded(|| struck(&strike)).map(Box::new);
    // The screen may be closed already.
    let _ = news.send(ScreenEvent::Struck(strike.turn, answer));
}

fn struck(strike: &StrikeRequest) -> Result<StrikeResult, String> {
    let told = |error: &dyn std::fmt::Display| {
        error.to_string().split_whitespace().collect::<Vec<&str>>().join(" ")
    };
    let scene = Scene::from_text(&strike.name, "the bench", &strike.text);
    let scene = scene.map_err(|error| told(&error))?;
    let integration = Integration::Accuracy(scene.accuracy);
    let scene = resolve_auto_effects(&scene, integration).into_owned();
    let outcome = run(&scene, integration, strike.shot, &mut |_| ()).map_err(|e| told(&e))?;
    let metadata = facts::facts(&scene, integration).map_err(|error| told(&error))?;
    let notes = facts::shot_notes(&scene, &outcome);
    let log = notes.log.iter().map(|(_, line)| line.clone()).collect();
    let set = TraceSet {
        metadata,
        attachments: vec![facts::scene_attachment(&scene)],
        log,
        notes: std::iter::once((strike.shot, notes)).collect(),
        shots: vec![outcome.shot],
        ..TraceSet::default()
    };
    Ok(StrikeResult { scene, set, summary: outcome.summary })
}
