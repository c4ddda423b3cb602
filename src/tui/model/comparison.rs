//! The comparison of the shot on screen with a recording, a folder or a scene.

use std::path::Path;
use std::sync::{Arc, Mutex};

use crate::experiment::{Integration, facts, run};
use crate::measurement::compare::score_limits::ScoreLimits;
use crate::measurement::compare::{Align, Compared, ComparedShot, compare};
use crate::predict::{SampleOptions, UncertainPrediction, judge, uncertain_prediction};
use crate::recording::format::{Format, open};
use crate::recording::{Origin, Shot, TraceSet};
use crate::scene::Scene;
use crate::scene::adjust::Adjustable;
use crate::tui::job::with_reasons;

/// Limits of the comparison's scores.
const SCORE_LIMITS: &str = "rms=1lsb";

/// The other side of the last comparison, which the next one with the same name uses again.
pub type OtherSide = Arc<Mutex<Option<LoadedSide>>>;

/// The other side of a comparison.
#[derive(Debug)]
pub struct LoadedSide {
    /// Its name: a path, or a scene.
    pub name: String,
    set: TraceSet,
    /// Whether it is a scene that states its uncertainty.
    pub is_uncertain: bool,
    /// What that scene predicts with its uncertainty, once it is computed.
    pub predicted: Option<UncertainPrediction>,
}

impl LoadedSide {
    /// Reads the recording, or simulates the scene, that is called `name`.
    ///
    /// # Errors
    /// A message for the user.
    pub fn load(name: &str) -> Result<Self, String> {
        let path = Path::new(name);
        if Format::of(path).is_some() {
            let set = open(path).map_err(|error| with_reasons(&error))?;
            let name = name.to_owned();
            return Ok(Self { name, set, is_uncertain: false, predicted: None });
        }
        let scene = Scene::load(name).map_err(|error| with_reasons(&error))?;
        let integration = Integration::Accuracy(scene.accuracy);
        let outcome = run(&scene, integration, 1, &mut |_| ()).map_err(|e| with_reasons(&e))?;
        let metadata = facts::facts(&scene, integration).map_err(|error| with_reasons(&error))?;
        let attachments = facts::scene_attachments(&scene);
        let set =
            TraceSet { shots: vec![outcome.shot], metadata, attachments, ..TraceSet::default() };
        let is_uncertain = !scene.uncertainty.is_empty();
        Ok(Self { name: name.to_owned(), set, is_uncertain, predicted: None })
    }
}

/// The shot on screen, as one side of a comparison.
pub struct ShownSide {
    /// Its name.
    pub name: String,
    /// A recording of this shot alone.
    pub set: TraceSet,
    /// Whether a bench is on screen, which is simulated here.
    pub is_bench: bool,
    /// What that bench predicts with its uncertainty, once it is computed.
    pub predicted: Option<UncertainPrediction>,
}

/// What the bench of this text predicts; none if it states no uncertainty.
///
/// # Errors
/// A message for the user.
pub fn predicted_bench(title: &str, text: &str) -> Result<Option<UncertainPrediction>, String> {
    let mut scene =
        Adjustable::from_text(title, "the bench", text).map_err(|error| with_reasons(&error))?;
    if scene.scene().map_err(|error| with_reasons(&error))?.uncertainty.is_empty() {
        return Ok(None);
    }
    let found = uncertain_prediction(&mut scene, SampleOptions::default(), true, &|_| ());
    found.map(Some).map_err(|error| with_reasons(&error))
}

/// What a scene predicts with its uncertainty, as `compare` computes it.
///
/// # Errors
/// A message for the user.
pub fn predicted(scene: &str) -> Result<UncertainPrediction, String> {
    let mut scene = Adjustable::load(scene).map_err(|error| with_reasons(&error))?;
    uncertain_prediction(&mut scene, SampleOptions::default(), true, &|_| ())
        .map_err(|error| with_reasons(&error))
}

/// The measurement is the one that was measured; of two of a kind, the one on screen, unless that
/// is a bench.
///
/// # Errors
/// A message for the user.
pub fn compared(shown: &ShownSide, other: &LoadedSide) -> Result<Compared, String> {
    let first = |set: &TraceSet, name: &str| -> Result<Shot, String> {
        set.shots.first().cloned().ok_or_else(|| format!("{name}: found no shots"))
    };
    let (here, there) = (first(&shown.set, &shown.name)?, first(&other.set, &other.name)?);
    let here_side = ComparedShot { name: &shown.name, set: &shown.set, shot: &here, scene: None };
    let there_side = ComparedShot { name: &other.name, set: &other.set, shot: &there, scene: None };
    let simulated_here = here.origin == Origin::Simulated && there.origin == Origin::Measured;
    let (measured, simulated) = if shown.is_bench || simulated_here {
        (there_side, here_side)
    } else {
        (here_side, there_side)
    };
    let tolerance = ScoreLimits::parse(SCORE_LIMITS)?;
    let predicted = if simulated.name == other.name { &other.predicted } else { &shown.predicted };
    let mut compared = compare(measured, simulated, (Align::default(), &[]), &tolerance)
        .map_err(|error| with_reasons(&error))?;
    if let Some(predicted) = predicted {
        judge(&mut compared, predicted);
    }
    Ok(compared)
}
