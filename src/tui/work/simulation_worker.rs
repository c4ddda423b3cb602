//! Strikes the bench on its own thread.

use std::sync::mpsc::{Receiver, Sender};

use super::{ScreenEvent, guarded};
use crate::experiment::accuracy::of_scene;
use crate::experiment::auto_effects::resolve_auto_effects;
use crate::experiment::{Integration, facts, run};
use crate::recording::TraceSet;
use crate::scene::Scene;
use crate::tui::model::{StrikeRequest, StrikeResult};

/// Does the newest of the strikes that are waiting; the older ones are stale.
pub fn strike(
    mut strike: StrikeRequest,
    waiting: &Receiver<StrikeRequest>,
    news: &Sender<ScreenEvent>,
) {
    while let Ok(newer) = waiting.try_recv() {
        strike = newer;
    }
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
    let accuracy = of_scene(&scene).map_err(|error| told(&error))?.value;
    let integration = Integration::Accuracy(accuracy);
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
