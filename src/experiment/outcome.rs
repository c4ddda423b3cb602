//! Results of a run, as in `run --json`: names and units are part of the interface.

use std::fmt::Write as _;
use std::time::Instant;

use serde::Serialize;

use super::paper_speeds::PaperSpeed;
use super::pulse::{FOOT_SHARE, HALF_RISE_SHARE, PEAK_SHARE, PassedOver, Peak, PulseRecorder};
use crate::chain::{
    Chain, ContactLoss, ContactOverride, Dissipated, Energy, Indentations, LossKind, LossSpec,
};
use crate::note::Note;
use crate::quantity::engineering;
use crate::recording::Shot;
use crate::scene::{LOOSEST_ACCURACY, PlacedSensor, PlatePlace, Scene, Site, distance};
use crate::scope::waveform::levels_per_division;
use crate::scope::{ChannelSetup, Deviation};

/// Everything a run leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Numbers for people and scripts.
    pub summary: Summary,
    /// The scope's records and the truth behind them.
    pub shot: Shot,
    /// Indentations that the contacts have at the end.
    pub indentations: Indentations,
}

/// Summary of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Scene name.
    pub scene: String,
    /// One line about the scene.
    pub title: String,
    /// SHA-256 of what the scene was made of.
    pub scene_hash: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Integration method.
    pub method: String,
    /// Publication that defines the method.
    pub method_source: String,
    /// Accuracy that was asked for; none for a method by hand (1).
    pub accuracy: Option<f64>,
    /// How far off first peaks and arrivals may be, where that was looked for.
    pub error_estimate: Option<ErrorEstimate>,
    /// Time after which errors of forces at the sensors may exceed the square root of the accuracy;
    /// none if they do not (s).
    pub horizon_s: Option<f64>,
    /// Fixed step, where there is one (s).
    pub step_s: Option<f64>,
    /// Tolerated error of a step, relative to the largest overlap change and speed so far; none
    /// where steps are fixed (1).
    pub tolerance: Option<f64>,
    /// Evaluations of all contact forces of the chain.
    pub force_evaluations: u64,
    /// Accepted steps.
    pub steps: u64,
    /// Steps thrown away by the error control.
    pub rejected_steps: u64,
    /// Steps tried in which contacts opened or closed; none where the method does not ask.
    pub contact_changes: Option<u64>,
    /// Wall-clock time of the simulation, recording excluded (s).
    pub wall_s: f64,
    /// The same with all runs that it was held against, and those that were not accurate enough;
    /// none where there were none (s).
    pub wall_held_s: Option<f64>,
    /// Time simulated on the bench (s).
    pub simulated_s: f64,
    /// End of the time in which peaks and arrivals were looked for (s).
    pub duration_s: f64,
    /// Names of the effects that were on.
    pub effects: Vec<String>,
    /// The effects that were on, each with its setting.
    pub effect_settings: Vec<String>,
    /// The energy ledger.
    pub energy: EnergyLedger,
    /// Readings of the force at each sensor, before any electronics.
    pub sensors: Vec<Reading>,
    /// Readings of the force at the wall; none without a wall.
    pub wall: Option<Reading>,
    /// Speeds between pairs of particles with sensors, by every estimator.
    pub speeds: Vec<Speed>,
    /// Velocities of all bodies at the end of the record, the striker first, where there are no
    /// sensors; downward positive (m/s).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub final_velocities_m_per_s: Vec<f64>,
    /// The paper's speeds for this scene, from particle 14 to 27.
    pub paper: Option<PaperSpeed>,
    /// Whether the scope triggered, and when.
    pub trigger: TriggerReport,
    /// Notes for the user about this run.
    pub notes: Vec<Note>,
}

/// Estimated errors of a run's first peaks, arrivals and traces.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ErrorEstimate {
    /// Relative error of first-peak dynamic forces, the largest of all places (1).
    pub peak: f64,
    /// Relative error of first-peak times, half-rises and tenths, the largest of all places (1).
    pub arrival: f64,
    /// Largest deviation of the force at any sensor, at the scope's sample times up to the end of
    /// the scene's duration, relative to the largest dynamic one there; none if no sensor has a
    /// pulse (1).
    pub trace: Option<f64>,
    /// Time up to which no trace deviates by more than the accuracy asked for; none if none ever
    /// does, or if none was asked for (s).
    pub trace_holds_s: Option<f64>,
    /// The reference of the estimate.
    pub how: String,
}

impl ErrorEstimate {
    /// The larger of the errors of peaks and arrivals, which an accuracy limits (1).
    pub fn worst(&self) -> f64 {
        self.peak.max(self.arrival)
    }
}

/// A first peak that exceeds its threshold by so much stays one, and what lacks so much of it
/// becomes none, whatever late forces come to: chaos shuffles energy about, it makes none. Less
/// where two runs agree better (1).
const PEAK_MARGIN: f64 = 0.5;

/// Results of the comparison of a run with its reference run.
#[derive(Debug, Clone)]
pub struct Assessment {
    pub(super) estimate: Option<ErrorEstimate>,
    pub(super) notes: Vec<Note>,
    /// What would keep the energy better.
    pub(super) energy_advice: &'static str,
    /// Time after which traces deviate (s), and the share of their largest force by which they do
    /// (1).
    pub(super) unreliable: Option<(f64, f64)>,
}

impl Outcome {
    /// The outcome with the results of a comparison that began at `started`.
    pub(super) fn assessed(mut self, assessment: Assessment, started: Instant) -> Self {
        let summary = &mut self.summary;
        summary.notes.extend(assessment.notes);
        summary.error_estimate = assessment.estimate.filter(|_| summary.has_pulse());
        summary.note_energy(assessment.energy_advice);
        if let Some((time, limit)) = assessment.unreliable {
            summary.note_horizon(time, limit);
            summary.note_undecided();
        }
        summary.wall_held_s = Some(started.elapsed().as_secs_f64());
        self
    }
}

impl Summary {
    /// Whether a pulse was felt anywhere: of nothing no number says how far off it is.
    fn has_pulse(&self) -> bool {
        self.sensors.iter().chain(&self.wall).any(|reading| reading.first_peak.is_some())
    }

    /// Notes where the method has made energy, or lost it, and what may be done about it.
    fn note_energy(&mut self, advice: &str) {
        let drift = self.energy.drift;
        if !self.energy.is_kept(TOLERABLE) {
            let (what, share) = (if drift > 0.0 { "made" } else { "lost" }, drift.abs());
            let sentence = format!(
                "the method has {what} energy, {share:.1e} of that in motion: {advice} reduces this"
            );
            self.notes.push(Note::new("energy_drift", sentence).with("drift", drift));
        }
    }

    /// Notes first peaks that hang on forces felt when the motion is no longer known, as far as two
    /// runs differ there.
    fn note_undecided(&mut self) {
        let Some(horizon) = self.horizon_s else { return };
        let differ = self.error_estimate.as_ref().and_then(|estimate| estimate.trace);
        let clear = 1.0 + differ.map_or(PEAK_MARGIN, |differ| differ.min(PEAK_MARGIN));
        let hangs = |reading: &&Reading| {
            let threshold = PEAK_SHARE * reading.largest_n;
            let is_late = reading.largest_s.is_some_and(|time| time > horizon);
            let just = reading.first_peak.is_some_and(|peak| peak.dynamic_n < clear * threshold);
            let was = |p: PassedOver| p.until_s > horizon && clear * p.dynamic_n > threshold;
            is_late && just || reading.passed_over.is_some_and(was)
        };
        let places = self.sensors.iter().chain(&self.wall).filter(hangs).map(|r| r.name.clone());
        let places: Vec<String> = places.collect();
        if !places.is_empty() {
            let sentence = format!(
                "which maximum is the first peak is not decided at {}: it, or an earlier one, is near a quarter of the largest force, which comes when two runs no longer agree on it; a shorter duration decides it, a tighter accuracy may",
                places.join(", ")
            );
            self.notes.push(Note::new("first_peak_undecided", sentence).with("places", places));
        }
    }

    /// Notes that after `time` (s) the forces at the sensors deviate by more than the share `limit`
    /// (1) of their largest values.
    fn note_horizon(&mut self, time: f64, limit: f64) {
        let words = engineering(time, "s", 2);
        self.horizon_s = Some(time);
        let sentence = format!(
            "after {words} forces at the sensors are not reliable in detail (errors may exceed {limit:.0e} of their largest values); a tighter --accuracy or a shorter step extends this"
        );
        self.notes.push(Note::new("chaotic", sentence).with("from_s", time));
    }
}

/// Readings of the force at one probe.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reading {
    /// Name of the sensor, or `wall`.
    pub name: String,
    /// The particle, counted from 1; none for the wall.
    pub particle: Option<usize>,
    /// Offset of the plate in particle lengths; 0 is centred (1).
    pub offset: f64,
    /// Static force (N).
    pub static_n: f64,
    /// Largest dynamic force felt (N).
    pub largest_n: f64,
    /// When it was felt; none if nothing was (s).
    pub largest_s: Option<f64>,
    /// First local maximum of the dynamic force above a quarter of its largest value; none if
    /// nothing arrived.
    pub first_peak: Option<Peak>,
    /// The highest maximum before it that was the first peak until forces became larger; none if
    /// none was.
    pub passed_over: Option<PassedOver>,
    /// When the dynamic force first reached half of its first peak (s).
    pub half_rise_s: Option<f64>,
    /// When it first reached a tenth (s).
    pub ten_percent_s: Option<f64>,
}

impl Reading {
    /// Reads a recorder out.
    pub fn of(name: &str, particle: Option<usize>, offset: f64, pulse: &PulseRecorder) -> Self {
        let first_peak = pulse.first_peak();
        let reach =
            |share: f64| first_peak.and_then(|peak| pulse.first_reach(share * peak.dynamic_n));
        Self {
            name: name.to_owned(),
            particle,
            offset,
            static_n: pulse.static_force(),
            largest_n: pulse.largest(),
            largest_s: pulse.first_reach(pulse.largest()).filter(|_| !pulse.is_quiet()),
            first_peak,
            passed_over: pulse.passed_over(),
            half_rise_s: reach(HALF_RISE_SHARE),
            ten_percent_s: reach(FOOT_SHARE),
        }
    }
}

/// A speed between two particles.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Speed {
    /// Particle from which.
    pub from: usize,
    /// Particle to which.
    pub to: usize,
    /// Sensor from which.
    pub from_sensor: String,
    /// Sensor to which.
    pub to_sensor: String,
    /// Static distance of the plates, overlaps subtracted (m).
    pub distance_m: f64,
    /// Which arrival was taken: `half_rise`, `peak` or `ten_percent`.
    pub estimator: &'static str,
    /// Distance over difference of arrivals (m/s).
    pub m_per_s: f64,
}

/// Speeds between all pairs of particles with a reading, nearest pairs first.
pub fn speeds(chain: &Chain, readings: &[Reading]) -> Vec<Speed> {
    type Arrival = fn(&Reading) -> Option<f64>;
    const ESTIMATORS: [(&str, Arrival); 3] = [
        ("half_rise", |r| r.half_rise_s),
        ("peak", |r| r.first_peak.map(|p| p.time_s)),
        ("ten_percent", |r| r.ten_percent_s),
    ];
    let mut speeds = Vec::new();
    for gap in 1..readings.len() {
        for (upper, lower) in readings.iter().zip(&readings[gap..]) {
            let (Some(from), Some(to)) = (upper.particle, lower.particle) else {
                continue;
            };
            let place = |particle: usize, reading: &Reading| PlatePlace {
                site: Site::Particle(particle),
                offset: reading.offset,
                offset_u: 0.0,
            };
            let Some(distance_m) = distance(chain, place(from, upper), place(to, lower)) else {
                continue;
            };
            for (estimator, arrival) in ESTIMATORS {
                let (Some(start), Some(end)) = (arrival(upper), arrival(lower)) else {
                    continue;
                };
                if from != to && (end - start).abs() > 0.0 {
                    let m_per_s = distance_m / (end - start);
                    let (from_sensor, to_sensor) = (upper.name.clone(), lower.name.clone());
                    speeds.push(Speed {
                        from,
                        to,
                        from_sensor,
                        to_sensor,
                        distance_m,
                        estimator,
                        m_per_s,
                    });
                }
            }
        }
    }
    speeds
}

/// The scope's trigger.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TriggerReport {
    /// Whether a record was taken.
    pub recorded: bool,
    /// Whether the level was crossed; automatic mode records without.
    pub crossed: bool,
    /// Time of the trigger after the striker's first contact (s).
    pub time_s: Option<f64>,
}

/// Names and settings of all effects that were on: the chain's, then those of sensors and scope.
pub fn effects(scene: &Scene) -> Vec<(String, String)> {
    let settings = scene.spec.effects.settings().into_iter();
    let mut effects: Vec<(String, String)> =
        settings.map(|(name, set)| (name.to_owned(), set)).collect();
    if let Some((magnet, pull)) = scene.chain.magnet().and_then(|m| Some((m, m.pull.as_ref()?)))
        && let Some((_, set)) = effects.iter_mut().find(|(name, _)| name == "magnet_preload")
    {
        let (force, distance) = (engineering(magnet.force, "N", 4), pull.distance);
        let _ = write!(set, "; {force} at rest, {} away", engineering(distance, "m", 4));
    }
    for kind in LossKind::ALL {
        let given = |spec: &LossSpec| {
            let of = |own: &ContactOverride| own.restitution.is_some();
            spec.restitution.is_some() || spec.overrides.iter().any(of)
        };
        let model = kind.model();
        let coefficient = |loss: ContactLoss| loss.coefficients()[kind as usize];
        let losses = scene.chain.contacts().iter().filter_map(|contact| contact.loss);
        let range = losses.map(coefficient).fold(None, |range: Option<[f64; 2]>, value| {
            let [low, high] = range.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        });
        let is_given = scene.spec.effects.loss(kind).is_some_and(given);
        if let (true, Some([low, high])) = (is_given, range)
            && let Some((_, set)) = effects.iter_mut().find(|(name, _)| name == model.name)
        {
            let [low, high] = [low, high].map(|value| engineering(value, model.unit, 4));
            let _ = write!(set, "; {} {low} to {high}", model.label);
        }
    }
    if let (Some(spread), Some(speed)) = (scene.striker_speed_spread, scene.striker_speed()) {
        let set = format!("{} % around {}", 100.0 * spread, engineering(speed, "m/s", 3));
        effects.push(("striker_speed_spread".to_owned(), set));
    }
    if !scene.sensors.is_empty() {
        effects.push(("sensor_droop".to_owned(), "RC of plate, cable and scope input".to_owned()));
    }
    if let Some(tolerance) = &scene.sensor_tolerance {
        let mut set = format!("d33 and permittivity within {} %", 100.0 * tolerance.spread);
        if tolerance.temperature > 0.0 {
            let _ = write!(set, ", temperature within {} K", tolerance.temperature);
        }
        if scene.sensors.iter().any(|placed| placed.sensor.measured.sensitivity.is_some()) {
            set.push_str("; measured sensors by their own uncertainty");
        }
        effects.push(("sensor_tolerance".to_owned(), set));
    }
    let off_centre = |sensor: &&PlacedSensor| sensor.offset != 0.0 && sensor.site != Site::Wall;
    if let Some(sensor) = scene.sensors.iter().find(off_centre) {
        effects.push(("sensor_offset".to_owned(), format!("{} and maybe others", sensor.name)));
    }
    let mut channels = scene.scope.channels.iter().flatten();
    if let Some(channel) = channels.find(|channel| channel.offset != 0.0) {
        let volts = engineering(channel.offset, "V", 3);
        effects.push(("scope_offset".to_owned(), format!("{volts} on the first channel with one")));
    }
    let deviates = |channel: &&ChannelSetup| channel.deviation != Deviation::default();
    if scene.scope.channels.iter().flatten().any(|channel| deviates(&channel)) {
        let drawn = "gain and zero of each channel, drawn within the data sheet".to_owned();
        effects.push(("scope_errors".to_owned(), drawn));
    }
    if scene.scope.noise > 0.0 {
        effects.push(("scope_noise".to_owned(), format!("{} div rms", scene.scope.noise)));
    }
    let bits = scene.scope.model.bits;
    let levels = format!("{bits} bits, {} levels a division", levels_per_division(bits));
    effects.push(("quantisation".to_owned(), levels));
    effects
}

/// A run that has made or lost more of the energy in motion is not taken for what the bench would
/// show without a word (1).
pub const TOLERABLE: f64 = 0.01;
/// What sums of energies may be off, relative to all that is stored (1).
const ROUNDING: f64 = 1e-12;

/// Largest share of the energy in motion that a run to an accuracy may make or lose: beyond it even
/// the statistics of late motion are those of another bench (1).
pub const MAX_ENERGY_DRIFT: f64 = LOOSEST_ACCURACY;

/// The energy ledger of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnergyLedger {
    /// At the striker's first contact (J).
    pub initial: f64,
    /// At the end (J).
    pub r#final: f64,
    /// Booked as lost by the effects that were on; what a drive has put in is apart (J).
    pub dissipated: f64,
    /// What [`drift`] says: the integrator's error (1).
    pub drift: f64,
    /// The initial energy by kind.
    pub initial_by_kind: Energy,
    /// The final energy by kind, without what is left in contacts held at zero force.
    pub final_by_kind: Energy,
    /// What was lost, by loss, and what is left in contacts.
    pub dissipated_by_kind: Dissipated,
}

impl EnergyLedger {
    /// The ledger of a run from its `initial` to its `last` energy.
    pub fn new(initial: Energy, last: Energy, taken: Dissipated) -> Self {
        let (before, after, dissipated) = (initial.total(), last.total(), taken.lost());
        Self {
            initial: before,
            r#final: after,
            dissipated,
            drift: drift(&initial, &last, &taken),
            initial_by_kind: initial,
            final_by_kind: last,
            dissipated_by_kind: taken,
        }
    }

    /// Whether no more than `share` (1) of the energy in motion has been made or lost, but for
    /// rounding of all that is stored.
    pub fn is_kept(&self, share: f64) -> bool {
        self.drift.abs() <= share || self.is_rounding()
    }

    /// Whether what has been made or lost may be rounding of all that is stored.
    pub fn is_rounding(&self) -> bool {
        let made = self.r#final + self.dissipated_by_kind.total() - self.initial;
        made.abs() <= ROUNDING * self.initial.abs()
    }
}

/// `(after + taken - before)` over the kinetic energy before or after, the work of a drive or what
/// the losses moved, whichever is most: what a method has made of energy, as a share of that in
/// motion. Static overlaps, which may hold a thousand times as much, do not hide it; what they
/// round to is in it (1).
pub fn drift(before: &Energy, after: &Energy, taken: &Dissipated) -> f64 {
    let work = taken.work_of_drive.unwrap_or(0.0).abs();
    let lost: f64 = taken.losses.iter().map(|entry| entry.energy.abs()).sum();
    let moving = before.kinetic.max(after.kinetic).max(work).max(lost);
    (after.total() + taken.total() - before.total()) / moving
}

#[cfg(test)]
mod tests {
    use crate::experiment::accuracy::run_to_accuracy;
    use crate::note::Note;
    use crate::scene::Scene;

    /// A bead of 0.13 mg rattles on while heavy ones press it harder and harder: maxima that it
    /// makes on the way are first until larger forces come. Where two runs agree on them, the first
    /// peak is decided.
    #[test]
    fn maxima_before_the_first_peak_are_told_where_runs_differ() {
        let text = "
            duration = \"100 ms\"
            materials.hard = { youngs_modulus = \"35.16 GPa\", poissons_ratio = 0.4182 }
            materials.heavy = { youngs_modulus = \"37.23 GPa\", poissons_ratio = 0.1698 }
            materials.soft = { youngs_modulus = \"20.63 MPa\", poissons_ratio = 0.1799 }
            particles.a = { material = \"hard\", diameter = \"358.5 um\", mass = \"131.8 ug\" }
            particles.b = { material = \"heavy\", diameter = \"5.46 mm\", mass = \"8.723 g\" }
            particles.c = { material = \"soft\", diameter = \"283.5 um\", mass = \"1.869 mg\" }
            chain = { top = \"free\", bottom = { wall = \"stainless_steel\" }, segments = [{ particles = [\"a\", \"c\", \"a\", \"a\", \"b\", \"a\", \"c\", \"a\", \"c\", \"a\"] }] }
            striker = { material = \"stainless_steel\", mass = \"39.13 g\", diameter = \"22.27 mm\", speed = \"251.7 um/s\" }
            effects.gravity = { acceleration = \"0.0598 m/s^2\" }
            effects.dashpot = { gamma = \"0.2542 mN*s/m\", end_of_contact = \"zero_overlap\" }
            sensors.a = { model = \"pzt-5a-710pf\", particle = 1 }
            [scope]
            model = \"tds2014\"
            time_base = \"10 ms/div\"
            trigger = { source = \"CH1\", level = \"200 mV\", slope = \"rise\", mode = \"normal\" }
            ch1 = { input = \"a\", scale = \"1 V/div\" }
        ";
        let scene = Scene::from_text("pressed", "pressed.toml", text).unwrap();
        let mut found = run_to_accuracy(&scene, 1e-3, 1, &mut |_| ()).unwrap().summary;
        let is_told = |notes: &[Note]| {
            notes.iter().any(|note| {
                note.code == "first_peak_undecided" && note.sentence.contains("not decided at a")
            })
        };
        let (reading, quarter) = (&found.sensors[0], 0.25 * found.sensors[0].largest_n);
        assert!(reading.first_peak.unwrap().dynamic_n > 2.0 * quarter, "{reading:?}");
        let passed = reading.passed_over.unwrap();
        assert!(passed.dynamic_n <= quarter && passed.dynamic_n > 0.67 * quarter, "{passed:?}");
        // As if the motion were known only until before that; these two runs agree on all of it.
        found.horizon_s = Some(0.5 * passed.until_s);
        // Two runs that agree to 0.4 %, and two that do not.
        for (trace, told) in [(0.004, false), (1.0, true)] {
            found.notes.clear();
            found.error_estimate.as_mut().unwrap().trace = Some(trace);
            found.note_undecided();
            assert_eq!(is_told(&found.notes), told, "{trace}: {:?}", found.notes);
        }
    }
}
