//! Parts of the model's state.

use std::collections::VecDeque;

use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::Spectrum;
use crate::analysis::time_frequency::Spectrogram;
use crate::measurement::arrivals::Survey;
use crate::measurement::compare::Compared;
use crate::predict::TraceBand;
use crate::recording::Capture;
use crate::scope::{Source, Waveform};
use crate::studies::cost::CostStudy;
use crate::studies::effects::Ledger;
use crate::studies::hard_cases::CaseResult;
use crate::trace::Trace;
use crate::tui::job::JobState;

/// A popup over the scope's screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Popup {
    /// Nothing.
    Scope,
    /// The keys.
    Help,
    /// The keys, while a search in them is typed.
    Search,
    /// Problems of the file and lines of its log.
    Log,
    /// The command line.
    Prompt,
}

/// A panel beside the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SidePanel {
    /// Nothing: the page has all columns.
    Nothing,
    /// Measurements of the selected trace, arrivals and speeds.
    Measurements,
    /// The bench's knobs.
    Knobs,
}

/// Whether the terminal shows colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Palette {
    /// The sixteen colours that every terminal has.
    Colour,
    /// None, as the environment variable `NO_COLOR` asks.
    Plain,
}

/// Whether a trace is on the screen, and if not, why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// It is.
    Shown,
    /// It was turned off.
    Off,
    /// It belongs to another abscissa than the selected trace: a spectrum among signals, or the
    /// reverse.
    OtherAxis,
}

/// How a trace is shown differently from its recording.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Adjustment {
    pub(super) scale: Option<f64>,
    pub(super) position: Option<f64>,
    pub(super) off: bool,
}

/// Which way the cursors measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CursorKind {
    /// No cursors.
    #[default]
    Off,
    /// Along the abscissa.
    Time,
    /// Along the ordinate.
    Volts,
}

/// One cursor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedCursor {
    /// Where it stands: abscissa or ordinate of its trace (unit).
    pub at: f64,
    /// The trace it was put on.
    pub source: Source,
}

/// The pair of cursors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cursors {
    /// Which way they measure.
    pub kind: CursorKind,
    /// Both, where they have been put.
    pub pair: Option<[PlacedCursor; 2]>,
    /// Which of them moves: 0 or 1.
    pub active: usize,
}

/// How the comparison's page shows its two traces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Overlay {
    /// One over the other, and their difference below.
    #[default]
    Both,
    /// One over the other.
    Traces,
    /// Their difference.
    Difference,
}

/// How a recording is played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Playback {
    /// Whether it runs.
    pub running: bool,
    /// Shots a second, or on the page of the bench milliseconds of its time a second (1).
    pub speed: f64,
    /// Since the shot on screen came (s).
    pub(super) waited: f64,
    /// Time of the bench's page, on the bench's own clock (s).
    pub bench_time: f64,
}

impl Default for Playback {
    fn default() -> Self {
        Self { running: false, speed: 1.0, waited: 0.0, bench_time: 0.0 }
    }
}

/// State of the acquisition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunState {
    /// Each turn of a knob strikes the bench again.
    Running,
    /// One trigger is waited for.
    Armed,
    /// Nothing is taken.
    Stopped,
}

/// Traces of earlier shots that stay on screen.
pub type PersistedTraces = VecDeque<Vec<Capture>>;

/// What a command can say of the bench behind a recording, as the options of the same names do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BenchOption {
    /// The scene.
    Scene,
    /// Which of its sensors is at a channel.
    Map,
    /// A channel's sensor.
    Sensor,
    /// The distance between two channels' sensors.
    Distance,
}

/// The background jobs and their results.
#[derive(Debug, Default)]
pub struct BackgroundJobs {
    /// The shot on screen against a simulation.
    pub comparison: JobState<Box<Compared>>,
    /// Where an uncertain simulation expects 95 % of its traces, on its own axis.
    pub bands: Vec<TraceBand>,
    /// Work against precision.
    pub study: JobState<Box<CostStudy>>,
    /// Cost and change of each effect.
    pub ledger: JobState<Box<Ledger>>,
    /// Results of the hard cases.
    pub hard_cases: JobState<Vec<CaseResult>>,
    /// Lower and upper edge of where 95 % of each channel's traces lie, by what the scene does not
    /// know.
    pub live_bands: JobState<Vec<[Trace; 2]>>,
}

/// A measured number, none where the signal has no such thing.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementReading {
    /// As the instrument's menu names it.
    pub name: &'static str,
    /// The number (unit).
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
}

/// The inputs of derived data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DerivedKey {
    pub(super) version: u64,
    pub(super) source: Option<Source>,
    pub(super) page: Option<&'static str>,
    pub(super) side: SidePanel,
}

impl DerivedKey {
    /// Whether the same is shown of the same trace, of another shot.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        Self { version: other.version, ..*self } == *other
    }
}

/// Computed data of the screen.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Derived {
    pub(super) made_of: Option<DerivedKey>,
    /// The selected trace's spectrum, or why there is none.
    pub spectrum: Option<Result<Spectrum, String>>,
    /// Its spectrum over time, or why there is none.
    pub map: Option<Result<Spectrogram, String>>,
    /// The chain around its sensor, for the band edges.
    pub chain: Option<DiatomicChain>,
    /// Its measurements.
    pub readings: Vec<MeasurementReading>,
    /// Arrivals and speeds of the shot.
    pub survey: Option<Survey>,
    /// Scales of the chain in motion.
    pub film: Option<FilmScales>,
    /// Whether it is being computed.
    pub is_pending: bool,
}

/// Scales of the chain in motion, for all times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmScales {
    /// Top of the forces' scale, above the static force (N).
    pub strongest: f64,
    /// Largest displacement of a bead (m).
    pub farthest: f64,
}

/// A recording of which one shot is in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each says another thing of a file")]
pub(super) struct PartialRecording {
    /// Shots found so far.
    pub(super) count: usize,
    /// Whether the file may still hold or get more.
    pub(super) open: bool,
    /// Place of the shot in memory.
    pub(super) here: Option<usize>,
    /// Whether the newest shot was asked for whenever one comes.
    pub(super) follow: bool,
    /// Whether it is shown now: not after a step back, until the last shot is shown again.
    pub(super) follows: bool,
    /// Whether commands said something of the bench, which what is read of the file does not
    /// replace.
    pub(super) is_noted: bool,
}

/// Unit of a record's ordinate; some files write `Volts`.
pub fn ordinate_unit(waveform: &Waveform) -> &str {
    match waveform.preamble.y_unit.as_str() {
        "Volts" => "V",
        unit => unit,
    }
}

/// Less than this share of a level is round-off (1).
const ROUND_OFF: f64 = 1e-9;

/// The value of a trace at an abscissa, along the straight line between two points; none beyond the
/// record (unit).
pub fn value_at(waveform: &Waveform, at: f64) -> Option<f64> {
    let place = (at - waveform.time(0)) / waveform.preamble.x_incr;
    if !(place >= 0.0 && place.is_finite()) {
        return None;
    }
    let index = place.floor() as usize;
    let here = waveform.volts(index)?;
    let share = place - index as f64;
    let next = if share == 0.0 { here } else { waveform.volts(index + 1)? };
    let value = here + share * (next - here);
    // What is left of a difference of levels is nothing.
    let nothing = value.abs() < ROUND_OFF * waveform.preamble.y_mult.abs();
    Some(if nothing { 0.0 } else { value })
}
