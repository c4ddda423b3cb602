//! Runs analyses on their own threads: comparisons on one, studies that measure time on another.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender};

use super::{ScreenEvent, guarded, with_reasons};
use crate::experiment::{Integration, facts, run};
use crate::measurement::compare::score_limits::ScoreLimits;
use crate::measurement::compare::{Align, Compared, ComparedShot, compare};
use crate::predict::{SampleOptions, UncertainPrediction, judge, uncertain_prediction};
use crate::recording::format::{Format, open};
use crate::recording::{Origin, Shot, TraceSet};
use crate::scene::Scene;
use crate::scene::adjust::Adjustable;
use crate::studies::{cost, effects, hard_cases};
use crate::tui::model::background_jobs::JobAnswer;
use crate::tui::model::{JobState, ScreenState};

/// Limits of the comparison's scores.
const SCORE_LIMITS: &str = "rms=1lsb";
/// Share of progress from one report to the next (1).
const PROGRESS_STEP: f64 = 0.01;

/// A shot to hold against another one.
pub struct ComparisonRequest {
    /// A recording, a folder or a scene; none takes the last one.
    other: Option<String>,
    name: String,
    set: TraceSet,
    /// Whether a bench is on screen, which is simulated here.
    is_bench: bool,
}

impl ComparisonRequest {
    /// The shot on screen, if any.
    pub fn of(model: &ScreenState, other: Option<String>) -> Option<Self> {
        let shot = model.shot()?.clone();
        let set = model.set();
        let set = TraceSet {
            shots: vec![shot],
            metadata: set.metadata.clone(),
            attachments: set.attachments.clone(),
            ..TraceSet::default()
        };
        Some(Self {
            other,
            name: model.title().to_owned(),
            set,
            is_bench: model.live().is_some_and(|live| live.served.is_none()),
        })
    }
}

/// The other side of a comparison.
struct Other {
    name: String,
    set: TraceSet,
    /// Whether it is a scene that states its uncertainty.
    is_uncertain: bool,
    /// What that scene predicts with its uncertainty, once it is computed.
    predicted: Option<UncertainPrediction>,
}

impl Other {
    fn of(name: &str) -> Result<Self, String> {
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
        let attachments = vec![facts::scene_attachment(&scene)];
        let set =
            TraceSet { shots: vec![outcome.shot], metadata, attachments, ..TraceSet::default() };
        let is_uncertain = !scene.uncertainty.is_empty();
        Ok(Self { name: name.to_owned(), set, is_uncertain, predicted: None })
    }
}

/// Compares, and remembers what with.
pub fn comparer()
-> impl FnMut(ComparisonRequest, &Receiver<ComparisonRequest>, &Sender<ScreenEvent>) + Send {
    let mut other: Option<Other> = None;
    move |mut asked, waiting, news| {
        while let Ok(newer) = waiting.try_recv() {
            asked = ComparisonRequest { other: newer.other.or(asked.other), ..newer };
        }
        let answer = guarded(|| {
            if let Some(name) = &asked.other {
                other = Some(Other::of(name)?);
                // Those of another scene are none of this one's.
                let _ = news.send(ScreenEvent::Answer(JobAnswer::Bands(Vec::new())));
            }
            compared(&asked, other.as_ref().ok_or("there is nothing to compare with")?)
        });
        // The screen may be closed already.
        let tell = |answer: Result<Compared, String>| {
            let job =
                answer.map_or_else(JobState::Failed, |compared| JobState::Done(Box::new(compared)));
            let _ = news.send(ScreenEvent::Answer(JobAnswer::Comparison(job)));
        };
        tell(answer);
        let is_open = |other: &&mut Other| other.is_uncertain && other.predicted.is_none();
        let Some(other) = other.as_mut().filter(is_open) else { return };
        match guarded(|| predicted(&other.name)) {
            Ok(predicted) => {
                let bands = predicted.bands.clone();
                let _ = news.send(ScreenEvent::Answer(JobAnswer::Bands(bands)));
                other.predicted = Some(predicted);
                tell(guarded(|| compared(&asked, other)));
            }
            Err(words) => {
                other.is_uncertain = false;
                let words = format!("no bands of {}: {words}", other.name);
                let _ = news.send(ScreenEvent::Told(words));
            }
        }
    }
}

/// What a scene predicts with its uncertainty, as `compare` computes it.
fn predicted(scene: &str) -> Result<UncertainPrediction, String> {
    let mut scene = Adjustable::load(scene).map_err(|error| with_reasons(&error))?;
    uncertain_prediction(&mut scene, SampleOptions::default(), true, &|_| ())
        .map_err(|error| with_reasons(&error))
}

/// The measurement is the one that was measured; of two of a kind, the one on screen, unless that
/// is a bench.
fn compared(asked: &ComparisonRequest, other: &Other) -> Result<Compared, String> {
    let first = |set: &TraceSet, name: &str| -> Result<Shot, String> {
        set.shots.first().cloned().ok_or_else(|| format!("{name}: found no shots"))
    };
    let (here, there) = (first(&asked.set, &asked.name)?, first(&other.set, &other.name)?);
    let here_side = ComparedShot { name: &asked.name, set: &asked.set, shot: &here, scene: None };
    let there_side = ComparedShot { name: &other.name, set: &other.set, shot: &there, scene: None };
    let simulated_here = here.origin == Origin::Simulated && there.origin == Origin::Measured;
    let (measured, simulated) = if asked.is_bench || simulated_here {
        (there_side, here_side)
    } else {
        (here_side, there_side)
    };
    let tolerance = ScoreLimits::parse(SCORE_LIMITS)?;
    let is_predicted = simulated.name == other.name;
    let mut compared = compare(measured, simulated, (Align::default(), &[]), &tolerance)
        .map_err(|error| with_reasons(&error))?;
    if let Some(predicted) = other.predicted.as_ref().filter(|_| is_predicted) {
        judge(&mut compared, predicted);
    }
    Ok(compared)
}

/// A question that is answered by many runs.
pub enum StudyRequest {
    /// Work against precision.
    Study(Box<Scene>),
    /// Every effect with and without.
    Ledger(Box<Scene>),
    /// The hard cases, which are no scene's.
    HardCases,
}

/// Answers one question, and tells how far it is meanwhile.
pub fn research(order: StudyRequest, _: &Receiver<StudyRequest>, news: &Sender<ScreenEvent>) {
    let mut told = 0.0;
    let mut tell = |share: f64, answer: fn(f64) -> JobAnswer| {
        if share - told >= PROGRESS_STEP {
            told = share;
            // The screen may be closed already.
            let _ = news.send(ScreenEvent::Answer(answer(share)));
        }
    };
    let answer = match order {
        StudyRequest::Study(scene) => {
            let found = guarded(|| {
                cost::study(&scene, cost::TIMED_RUNS, &mut |s| {
                    tell(s, |s| JobAnswer::Study(JobState::Busy(s)));
                })
            });
            JobAnswer::Study(
                found.map_or_else(JobState::Failed, |study| JobState::Done(Box::new(study))),
            )
        }
        StudyRequest::Ledger(scene) => {
            let found = guarded(|| {
                effects::ledger(&scene, scene.accuracy, &mut |s| {
                    tell(s, |s| JobAnswer::Ledger(JobState::Busy(s)));
                })
                .map_err(|error| with_reasons(&error))
            });
            JobAnswer::Ledger(
                found.map_or_else(JobState::Failed, |ledger| JobState::Done(Box::new(ledger))),
            )
        }
        StudyRequest::HardCases => {
            let found = guarded(|| {
                Ok(hard_cases::run_all(&mut |s| {
                    tell(s, |s| JobAnswer::HardCases(JobState::Busy(s)));
                }))
            });
            JobAnswer::HardCases(found.map_or_else(JobState::Failed, JobState::Done))
        }
    };
    let _ = news.send(ScreenEvent::Answer(answer));
}
