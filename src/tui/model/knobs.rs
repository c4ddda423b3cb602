//! The bench's knobs: where each stands in a scene, how it reads, and how far a turn takes it.

use super::live_state::TunedSettings;
use super::screen_state::ScreenState;
use crate::chain::{Carrier, Drive, End, LossKind, LossSpec, MagnetForce, PlacedAt};
use crate::experiment::outcome::effects;
use crate::quantity::{Quantity, engineering};
use crate::scene::{LOOSEST_ACCURACY, Scene, TIGHTEST_ACCURACY};
use crate::scope::Source;
use crate::tui::axis::TurnDirection;

/// Turns from one value to ten times as much, evenly by ratio.
const TURNS_PER_DECADE: f64 = 24.0;
/// Digits of a value that is typed.
const KNOB_DIGITS: usize = 3;
/// One turn of a plate's offset, and where it stops being inside its particle (1).
const OFFSET: KnobStep = KnobStep::Difference { step: 0.05, farthest: 0.5 };
/// One turn of a magnet's distance, and the farthest (m).
const DISTANCE: KnobStep = KnobStep::Difference { step: 0.1e-3, farthest: 1.0 };

/// Key of a force.
const FORCE: &str = "force";
const MAGNET_FORCE: &str = "effects.magnet_preload.force";
const MAGNET_DISTANCE: &str = "effects.magnet_preload.distance";
const FORCE_ON_TOP: &str = "chain.top.force";
const DRIVE_AMPLITUDE: &str = "drive.displacement";
const DRIVE_FREQUENCY: &str = "drive.signal.sine";

/// How a turn changes a knob.
#[derive(Debug, Clone, Copy, PartialEq)]
enum KnobStep {
    /// By an equal ratio.
    Ratio,
    /// To the next power of ten.
    Decade,
    /// By an equal difference, to either side of zero (unit).
    Difference { step: f64, farthest: f64 },
}

/// A knob of the bench.
#[derive(Debug, Clone, Copy)]
pub struct BenchKnob {
    /// Its label.
    pub label: &'static str,
    /// Where it stands in a scene; `{}` is the selected channel's sensor. Of a force on top and a
    /// magnet's distance, [`Self::path_in`] knows the last key.
    path: &'static str,
    /// Unit in which it is typed.
    unit: &'static str,
    /// That unit in SI units (unit).
    scale: f64,
    /// The effect that it belongs to, which can be switched.
    pub effect: Option<&'static str>,
    turning: KnobStep,
    read: fn(&Scene, Option<Source>) -> Option<f64>,
}

const fn knob(
    label: &'static str,
    path: &'static str,
    (unit, scale): (&'static str, f64),
    effect: Option<&'static str>,
    read: fn(&Scene, Option<Source>) -> Option<f64>,
) -> BenchKnob {
    BenchKnob { label, path, unit, scale, effect, turning: KnobStep::Ratio, read }
}

fn loss(spec: Option<&LossSpec>) -> Option<f64> {
    spec.filter(|spec| spec.restitution.is_none()).map(|spec| spec.value)
}

/// Name and index of the sensor at the input of `source`.
fn sensor_of(scene: &Scene, source: Option<Source>) -> Option<(usize, &str)> {
    let Source::Channel(number) = source? else { return None };
    let channel = scene.scope.channels.get(usize::from(number).checked_sub(1)?)?.as_ref()?;
    let name = channel.input.as_deref()?;
    let index = scene.sensors.iter().position(|sensor| sensor.name == name)?;
    Some((index, name))
}

fn sensitivity(scene: &Scene, source: Option<Source>) -> Option<f64> {
    let (index, name) = sensor_of(scene, source)?;
    let wired = scene.scope.channels.iter().flatten().find(|c| c.input.as_deref() == Some(name))?;
    Some(scene.circuit(index, wired)?.sensitivity)
}

fn offset(scene: &Scene, source: Option<Source>) -> Option<f64> {
    let (index, _) = sensor_of(scene, source)?;
    scene.sensors.get(index).map(|sensor| sensor.offset)
}

/// The key that says where a magnet is, and what it says (N or m).
fn magnet(scene: &Scene) -> Option<(&'static str, f64)> {
    match &scene.spec.effects.magnet_preload.as_ref()?.force {
        MagnetForce::Constant(force) => Some((FORCE, *force)),
        MagnetForce::Placed(placed) => Some(match placed.at {
            PlacedAt::Rest(distance) => ("distance", distance),
            PlacedAt::Unloaded(distance) => ("distance_unloaded", distance),
            PlacedAt::Pull { force, .. } => (FORCE, force),
        }),
    }
}

fn magnet_distance(scene: &Scene) -> Option<f64> {
    magnet(scene).filter(|(key, _)| *key != FORCE).map(|(_, distance)| distance)
}

fn drive(scene: &Scene) -> Option<&Drive> {
    scene.chain.drives().next().map(|(_, drive)| drive)
}

/// Frequency of a sine or a burst (Hz).
fn drive_frequency(scene: &Scene) -> Option<f64> {
    match drive(scene)?.signal.carrier {
        Carrier::Sine { frequency } => Some(frequency),
        _ => None,
    }
}

impl BenchKnob {
    /// All knobs, in the order of the panel.
    pub const ALL: &'static [Self] = &[
        knob("striker mass", "striker.mass", ("g", 1e-3), None, |s, _| {
            s.spec.striker.as_ref().map(|striker| striker.mass)
        }),
        knob("striker speed", "striker.speed", ("m/s", 1.0), None, |s, _| s.striker_speed()),
        knob("magnet force", MAGNET_FORCE, ("N", 1.0), Some("magnet_preload"), |s, _| {
            magnet(s).filter(|(key, _)| *key == FORCE).map(|(_, force)| force)
        }),
        Self {
            turning: DISTANCE,
            ..knob(
                "magnet distance",
                MAGNET_DISTANCE,
                ("mm", 1e-3),
                Some("magnet_preload"),
                |s, _| magnet_distance(s),
            )
        },
        knob("force on top", FORCE_ON_TOP, ("N", 1.0), None, |s, _| match s.spec.top {
            End::Force(force) => Some(force),
            End::Wall(_) => Some(s.spec.wall_preload),
            End::Free => None,
        }),
        knob("drive amplitude", DRIVE_AMPLITUDE, ("nm", 1e-9), None, |s, _| {
            drive(s).map(|drive| drive.amplitude)
        }),
        knob("drive frequency", DRIVE_FREQUENCY, ("kHz", 1e3), None, |s, _| drive_frequency(s)),
        knob("gravity", "effects.gravity.acceleration", ("m/s^2", 1.0), Some("gravity"), |s, _| {
            s.spec.effects.gravity.as_ref().map(|gravity| gravity.acceleration)
        }),
        knob("dashpot", "effects.dashpot.gamma", ("N*s/m", 1.0), Some("dashpot"), |s, _| {
            loss(s.spec.effects.loss(LossKind::Dashpot))
        }),
        knob(
            "Kuwabara-Kono",
            "effects.kuwabara_kono.eta",
            ("us", 1e-6),
            Some("kuwabara_kono"),
            |s, _| loss(s.spec.effects.loss(LossKind::KuwabaraKono)),
        ),
        Self {
            turning: KnobStep::Decade,
            ..knob("accuracy", "accuracy", ("", 1.0), None, |s, _| Some(s.accuracy))
        },
        knob(
            "scope noise",
            "effects.scope_noise.rms",
            ("div", 1.0),
            Some("scope_noise"),
            |s, _| (s.scope.noise > 0.0).then_some(s.scope.noise),
        ),
        knob("sensitivity", "sensors.{}.sensitivity", ("mV/N", 1e-3), None, sensitivity),
        Self {
            turning: OFFSET,
            ..knob("plate offset", "sensors.{}.offset", ("", 1.0), None, offset)
        },
    ];

    /// The knob's reading on `scene`, for the sensor at `source`.
    pub fn reading(&self, scene: &Scene, source: Option<Source>) -> String {
        match (self.read)(scene, source) {
            None if self.effect.is_some() => "off".to_owned(),
            None if self.turning == KnobStep::Decade => "auto".to_owned(),
            None if self.path == FORCE_ON_TOP => "free".to_owned(),
            None => "-".to_owned(),
            Some(value) if self.turning == KnobStep::Decade => format!("{value:.0e}"),
            Some(value) if self.unit == "div" => format!("{value:.3} div"),
            Some(value) if self.turning == OFFSET => format!("{value:+.2}"),
            // Masses are told in grams, which are no SI unit.
            Some(value) if self.unit == "g" => engineering(value / self.scale, "g", KNOB_DIGITS),
            Some(value) => engineering(value, self.si_unit(), KNOB_DIGITS),
        }
    }

    /// Its value on `scene`, for the sensor at `source`; none where the scene has none (unit).
    pub fn value(&self, scene: &Scene, source: Option<Source>) -> Option<f64> {
        (self.read)(scene, source)
    }

    /// Whether the panel shows it: of a magnet either its force or its distance.
    pub fn is_shown(&self, scene: &Scene) -> bool {
        let is_placed = magnet_distance(scene).is_some();
        match self.path {
            MAGNET_FORCE => !is_placed,
            MAGNET_DISTANCE => is_placed,
            DRIVE_AMPLITUDE => drive(scene).is_some(),
            DRIVE_FREQUENCY => drive_frequency(scene).is_some(),
            _ => true,
        }
    }

    /// Where the knob stands in `scene`, for the sensor at `source`; none where no sensor is there.
    pub fn path_in(&self, scene: &Scene, source: Option<Source>) -> Option<String> {
        match self.path {
            MAGNET_DISTANCE => {
                return magnet(scene).map(|(key, _)| format!("effects.magnet_preload.{key}"));
            }
            FORCE_ON_TOP if matches!(scene.spec.top, End::Wall(_)) => {
                return Some("chain.top.preload".to_owned());
            }
            DRIVE_AMPLITUDE | DRIVE_FREQUENCY if !self.is_shown(scene) => return None,
            DRIVE_AMPLITUDE if drive(scene).is_some_and(|drive| drive.stiffness.is_some()) => {
                return Some("drive.stack.stroke".to_owned());
            }
            DRIVE_FREQUENCY
                if drive(scene).is_some_and(|drive| drive.signal.length.is_finite()) =>
            {
                return Some("drive.signal.burst".to_owned());
            }
            _ => {}
        }
        let named = sensor_of(scene, source).map(|(_, name)| name);
        let is_missing = self.path.contains("{}") && named.is_none();
        (!is_missing).then(|| self.path.replace("{}", named.unwrap_or_default()))
    }

    fn si_unit(&self) -> &'static str {
        match self.unit {
            "us" => "s",
            "mm" | "nm" => "m",
            "kHz" => "Hz",
            "mV/N" => "V/N",
            other => other,
        }
    }

    /// Path and text after a turn; `tuned` are the settings of the session.
    ///
    /// # Errors
    /// Why there is nothing to turn, in words.
    pub fn turned(
        &self,
        scene: &Scene,
        tuned: &TunedSettings,
        source: Option<Source>,
        turn: TurnDirection,
    ) -> Result<(String, String), String> {
        let path = self
            .path_in(scene, source)
            .ok_or_else(|| "select a channel with a sensor first".to_owned())?;
        // What was turned and not struck yet counts; an effect that is off has nothing to turn.
        let (read, waiting) = ((self.read)(scene, source), pending(tuned, &path));
        let known = match self.effect {
            Some(_) => read.and(waiting).or(read),
            None => waiting.or(read),
        };
        let now = match (known, self.turning) {
            (Some(value), _) => value,
            (None, KnobStep::Decade) => crate::scene::DEFAULT_ACCURACY,
            (None, _) if self.effect.is_some() => {
                return Err(format!("{} is off: o switches it on", self.label));
            }
            (None, _) => {
                return Err(format!("this bench has no {}: E types a value", self.label));
            }
        };
        let value = match self.turning {
            KnobStep::Ratio => now * 10f64.powf(turn.sign() / TURNS_PER_DECADE) / self.scale,
            KnobStep::Difference { step, farthest } => {
                (now + turn.sign() * step).clamp(-farthest, farthest) / self.scale
            }
            KnobStep::Decade => {
                let decade = 10f64.powf(now.log10().round() + turn.sign());
                decade.clamp(TIGHTEST_ACCURACY, LOOSEST_ACCURACY)
            }
        };
        Ok((path, typed(value, self.unit)))
    }
}

/// The value that was typed for `path` in this session (unit).
pub fn pending(tuned: &TunedSettings, path: &str) -> Option<f64> {
    tuned.get(path)?.parse::<Quantity>().ok().map(|quantity| quantity.value)
}

/// A value as it would be typed, with three digits.
pub fn typed(value: f64, unit: &str) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    format!("{rounded} {unit}").trim_end().to_owned()
}

/// Default settings of an effect that the scene does not name; none for effects that need more than
/// a number.
fn first_settings(effect: &str) -> Option<&'static [(&'static str, &'static str)]> {
    match effect {
        "gravity" => Some(&[("acceleration", "9.81 m/s^2")]),
        "dashpot" => Some(&[("gamma", "0.1 N*s/m"), ("end_of_contact", "zero_force")]),
        "kuwabara_kono" => Some(&[("eta", "1 us"), ("end_of_contact", "zero_force")]),
        "scope_noise" => Some(&[("rms", "0.02 div")]),
        "magnet_preload" => Some(&[("force", "1 N"), ("particle", "1")]),
        _ => None,
    }
}

/// The settings that switch `effect` to the other state; `tuned` are those of the session.
///
/// # Errors
/// Why it cannot be switched, in words.
pub fn switched(
    scene: &Scene,
    tuned: &TunedSettings,
    effect: &str,
) -> Result<Vec<(String, String)>, String> {
    let path = |key: &str| format!("effects.{effect}.{key}");
    let state = |word: &str| (path("state"), word.to_owned());
    if effects(scene).iter().any(|(name, _)| name == effect) {
        if matches!(effect, "sensor_droop" | "quantisation" | "sensor_offset" | "scope_offset") {
            return Err(format!("{effect} is part of the instruments and has no switch"));
        }
        return Ok(vec![state("off")]);
    }
    // What was switched off here has its numbers still.
    if tuned.get(&path("state")).is_some_and(|word| word == "off") {
        return Ok(vec![state("on")]);
    }
    let first = first_settings(effect)
        .ok_or_else(|| format!("{effect} needs numbers of its own: name them in the scene file"))?;
    let numbers = first.iter().map(|(key, value)| (path(key), (*value).to_owned()));
    Ok(numbers.chain([state("on")]).collect())
}

impl ScreenState {
    /// Selects the next knob of those that the bench has.
    pub(super) fn next_knob(&mut self, turn: TurnDirection) {
        let scene = self.recordings.front().scene.clone();
        let Some(live) = self.bench() else { return };
        let count = BenchKnob::ALL.len();
        let step = match turn {
            TurnDirection::Up => 1,
            TurnDirection::Down => count - 1,
        };
        let is_shown = |place: usize| {
            let knob = BenchKnob::ALL.get(place);
            knob.zip(scene.as_ref()).is_none_or(|(knob, scene)| knob.is_shown(scene))
        };
        let places = (1..=count).map(|turns| (live.knob + turns * step) % count);
        live.knob = places.into_iter().find(|place| is_shown(*place)).unwrap_or(live.knob);
    }

    /// Turns the selected knob.
    pub(super) fn turn_knob(&mut self, turn: TurnDirection) {
        let Some(live) = self.bench() else { return };
        let knob = BenchKnob::ALL.get(live.knob).copied();
        let (Some(knob), Some(scene)) = (knob, self.recordings.front().scene.clone()) else {
            return;
        };
        let (source, tuned) = (self.selected, self.tuned());
        match knob.turned(&scene, &tuned, source, turn) {
            Ok((path, value)) => self.set_value(path, value),
            Err(problem) => self.notice = Some(problem),
        }
    }

    /// Opens the command line to type a value for the selected knob.
    pub(super) fn type_knob(&mut self) {
        let Some(knob) = self.bench().and_then(|live| BenchKnob::ALL.get(live.knob)) else {
            return;
        };
        let Some(scene) = &self.recordings.front().scene else { return };
        let is_off = knob.effect.is_some() && knob.value(scene, self.selected).is_none();
        match knob.path_in(scene, self.selected) {
            Some(_) if is_off => {
                self.notice = Some(format!("{} is off: o switches it on", knob.label));
            }
            Some(path) => self.open_prompt(&format!("set {path} ")),
            None => self.notice = Some("select a channel with a sensor first".to_owned()),
        }
    }

    /// Switches the effect of the selected knob.
    pub(super) fn switch_effect_of_knob(&mut self) {
        let live = self.recordings.front().live.as_ref();
        let effect = live.and_then(|live| BenchKnob::ALL.get(live.knob)?.effect);
        self.switch_effect(effect);
    }

    /// Switches `effect`, if there is one.
    pub(in crate::tui) fn switch_effect(&mut self, effect: Option<&str>) {
        if self.bench().is_none() {
            return;
        }
        if self.is_served() {
            let word = "effects of a served bench are set in its scene: view the scene itself";
            self.notice = Some(word.to_owned());
            return;
        }
        let Some(scene) = self.recordings.front().scene.clone() else { return };
        let Some(effect) = effect else {
            self.notice = Some("this knob belongs to no effect that could be switched".to_owned());
            return;
        };
        match switched(&scene, &self.tuned(), effect) {
            Ok(settings) => {
                let Some(((path, value), rest)) = settings.split_last() else { return };
                if let Some(live) = &mut self.recordings.front_mut().live {
                    live.settings.extend(rest.iter().cloned());
                }
                self.set_value(path.clone(), value.clone());
            }
            Err(problem) => self.notice = Some(problem),
        }
    }
}
