//! The inputs of an uncertain scene, their distributions, and the scene with other values of them.
//!
//! Each input is one number, or the numbers of a group, and has a score: how far it is from the
//! middle of its distribution, in its standard uncertainties.

use serde::{Serialize, Serializer};

use super::adjust::{AdjustError, Adjustable, AdjustableNumber};
use super::{InputDistribution, Scene, SceneError, SpreadAmount, UncertainInput};
use crate::numeric::intervals::normal_quantile;
use crate::quantity::{Difference, Dimension, engineering};
use crate::scope::Deviation;

/// What is wrong with a scene's `[uncertainty]`.
#[derive(Debug, thiserror::Error)]
pub enum RandomInputsError {
    /// A path that names nothing.
    #[error("{typed}: uncertainty.{path}: {error}")]
    Path {
        /// File and line.
        typed: String,
        /// The path.
        path: String,
        /// What is wrong.
        error: AdjustError,
    },
    /// Limits that leave out the scene's own value.
    #[error("{typed}: uncertainty.{path}: the scene's own value {value} lies outside its limits")]
    Outside {
        /// File and line.
        typed: String,
        /// The path.
        path: String,
        /// The scene's value, with unit.
        value: String,
    },
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// An input as reports show it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RandomInput {
    /// Its path, or the group whose numbers vary together.
    pub name: String,
    /// Its value in the scene, in SI units (unit).
    pub value: f64,
    /// Unit in which the scene states it, and pages show it; empty for a plain number. In JSON the
    /// SI unit of the numbers.
    #[serde(serialize_with = "as_si")]
    pub unit: String,
    /// Its standard uncertainty, in SI units (unit).
    pub u: f64,
    /// Where that is known from.
    pub source: Option<String>,
}

/// Writes the SI unit of a quantity that is stated in `unit`.
fn as_si<S: Serializer>(unit: &str, serializer: S) -> Result<S::Ok, S::Error> {
    let read: Result<Difference, _> = format!("1 {unit}").parse();
    let dimension = read.map_or(Dimension::NONE, |one| one.dimension);
    let is_plain = unit.is_empty() || dimension == Dimension::NONE;
    let si = if is_plain { String::new() } else { dimension.unit() };
    serializer.serialize_str(&si)
}

/// What one input moves.
#[derive(Debug, Clone, PartialEq)]
enum Target {
    Number(AdjustableNumber, InputDistribution),
    /// Gain or zero of a channel, counted from 0, in parts of its data sheet.
    Gain(usize),
    Zero(usize),
}

impl Target {
    /// A number of the scene and its value at a score (1) (unit).
    fn at(&self, score: f64) -> Option<(&AdjustableNumber, f64)> {
        match self {
            Self::Number(number, spread) => Some((number, value_at(number, *spread, score))),
            Self::Gain(_) | Self::Zero(_) => None,
        }
    }
}

/// All inputs, independent of each other.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RandomInputs {
    list: Vec<RandomInput>,
    targets: Vec<Vec<Target>>,
}

impl RandomInputs {
    /// Those that `adjustable` states, and that its sensors' files and its scope's data sheet do.
    ///
    /// # Errors
    /// [`RandomInputsError`] for paths that name nothing, and limits without the value.
    pub fn of(adjustable: &mut Adjustable) -> Result<Self, RandomInputsError> {
        let scene = adjustable.scene()?;
        let mut inputs = Self::default();
        let mut stated = scene.uncertainty.clone();
        stated.extend(of_sensors(&scene));
        for input in &stated {
            let wrong = |error| {
                let (typed, path) = (input.typed.clone(), input.path.clone());
                RandomInputsError::Path { typed, path, error }
            };
            // A default that is named becomes a number of its own: an exact one stays as it is.
            let is_exact = input.distribution.standard(1.0) == 0.0;
            if is_exact || adjustable.is_switched_off(&input.path) {
                continue;
            }
            for number in adjustable.knobs(&input.path).map_err(wrong)? {
                if input.distribution.standard(number.value) > 0.0 {
                    check_limits(input, &number)?;
                    inputs.add(input, &number);
                }
            }
        }
        for (index, channel) in scene.scope.channels.iter().enumerate() {
            let Some(channel) = channel.as_ref().filter(|c| c.deviation != Deviation::default())
            else {
                continue;
            };
            let at_input = channel.vertical.scale / channel.vertical.probe;
            let accuracy = &scene.scope.model.accuracy;
            let of = |what: &str, limit: f64, unit: &str, value: f64| RandomInput {
                name: format!("{what} of CH{}", index + 1),
                value,
                unit: unit.to_owned(),
                u: limit / 3f64.sqrt(),
                source: Some(format!("data sheet of the {}", scene.scope.model.name)),
            };
            inputs.list.push(of("gain", accuracy.gain_at(at_input), "", 1.0));
            inputs.targets.push(vec![Target::Gain(index)]);
            inputs.list.push(of("zero", accuracy.offset_at(at_input), "V", 0.0));
            inputs.targets.push(vec![Target::Zero(index)]);
        }
        Ok(inputs)
    }

    fn add(&mut self, input: &UncertainInput, number: &AdjustableNumber) {
        let target = Target::Number(number.clone(), input.distribution);
        if let Some(group) = &input.group
            && let Some(place) = self.list.iter().position(|known| known.name == *group)
            && let Some(targets) = self.targets.get_mut(place)
        {
            targets.push(target);
            return;
        }
        self.list.push(RandomInput {
            name: input.group.clone().unwrap_or_else(|| number.path.clone()),
            value: number.value,
            unit: number.unit.clone(),
            u: input.distribution.standard(number.value),
            source: input.source.clone(),
        });
        self.targets.push(vec![target]);
    }

    /// Those that a fit of `freed` paths knows something of: neither freed nor a channel's gain or
    /// zero, nor a sensitivity that only the sensor's file tells, which is a gain.
    pub fn beside(mut self, freed: &[&str], scene: &Scene) -> Self {
        let is_kept = |target: &Target| match target {
            Target::Number(number, _) => {
                !freed.contains(&number.path.as_str()) && !is_gain(scene, &number.path)
            }
            Target::Gain(_) | Target::Zero(_) => false,
        };
        let pairs = self.list.into_iter().zip(self.targets);
        let kept = pairs.filter_map(|(input, mut targets)| {
            targets.retain(is_kept);
            (!targets.is_empty()).then_some((input, targets))
        });
        (self.list, self.targets) = kept.unzip();
        self
    }

    /// The number of each input, the first one of a group, and its value at `scores` (unit).
    pub fn first_values(&self, scores: &[f64]) -> Vec<(&AdjustableNumber, f64)> {
        let pairs = self.targets.iter().zip(scores);
        pairs.filter_map(|(targets, score)| targets.first()?.at(*score)).collect()
    }

    /// The scores of the scene's own numbers: 0, but for limits that lie to one side (1).
    pub fn own_scores(&self) -> Vec<f64> {
        let score = |targets: &Vec<Target>| match targets.first() {
            Some(Target::Number(number, spread)) => {
                let u = spread.standard(number.value);
                (number.value - value_at(number, *spread, 0.0)) / u
            }
            _ => 0.0,
        };
        self.targets.iter().map(score).collect()
    }

    /// Each number that the inputs move, with its value at `scores` (unit).
    pub fn values(&self, scores: &[f64]) -> Vec<(&AdjustableNumber, f64)> {
        let mut values = Vec::new();
        for (targets, score) in self.targets.iter().zip(scores) {
            values.extend(targets.iter().filter_map(|target| target.at(*score)));
        }
        values
    }

    /// The inputs.
    pub fn list(&self) -> &[RandomInput] {
        &self.list
    }

    /// Number of inputs.
    pub fn count(&self) -> usize {
        self.list.len()
    }

    /// The scene with `values` of other numbers (SI units) and each input at its score (1).
    ///
    /// # Errors
    /// [`SceneError`] where a value is out of its range.
    pub fn scene(
        &self,
        adjustable: &Adjustable,
        values: &[(&AdjustableNumber, f64)],
        scores: &[f64],
    ) -> Result<Scene, SceneError> {
        let mut values = values.to_vec();
        values.extend(self.values(scores));
        let mut scene = adjustable.with(&values)?;
        // Plates are what the inputs say, not drawn once more.
        scene.sensor_tolerance = None;
        for (targets, score) in self.targets.iter().zip(scores) {
            for target in targets {
                let part = score / 3f64.sqrt();
                let mut change = |index: usize, of: fn(&mut Deviation) -> &mut f64| {
                    if let Some(Some(channel)) = scene.scope.channels.get_mut(index) {
                        *of(&mut channel.deviation) = part;
                    }
                };
                match target {
                    Target::Gain(index) => change(*index, |deviation| &mut deviation.gain),
                    Target::Zero(index) => change(*index, |deviation| &mut deviation.offset),
                    Target::Number(..) => {}
                }
            }
        }
        Ok(scene)
    }

    /// The scene with its own numbers, but without the errors of gain and zero that are inputs.
    ///
    /// # Errors
    /// [`SceneError`] as the scene itself.
    pub fn without_errors(&self, adjustable: &Adjustable) -> Result<Scene, SceneError> {
        let mut scene = adjustable.with(&[])?;
        scene.sensor_tolerance = None;
        for channel in scene.scope.channels.iter_mut().flatten() {
            channel.deviation = Deviation::default();
        }
        Ok(scene)
    }

    /// The scores of inputs that are each at its share `sample` of its distribution (1).
    pub fn scores(&self, sample: &[f64]) -> Vec<f64> {
        let score = |(targets, share): (&Vec<Target>, &f64)| match targets.first() {
            Some(Target::Number(_, InputDistribution::Normal(_))) => normal_quantile(*share),
            _ => 3f64.sqrt() * (2.0 * share - 1.0),
        };
        self.targets.iter().zip(sample).map(score).collect()
    }
}

/// A number's value at a score (1) of its distribution (unit).
fn value_at(number: &AdjustableNumber, spread: InputDistribution, score: f64) -> f64 {
    let middle = match spread {
        InputDistribution::Between(low, high, _) => 0.5 * (low + high),
        InputDistribution::Normal(_) | InputDistribution::Even(_) => number.value,
    };
    middle + score * spread.standard(number.value)
}

fn check_limits(
    input: &UncertainInput,
    number: &AdjustableNumber,
) -> Result<(), RandomInputsError> {
    match input.distribution {
        InputDistribution::Between(low, high, _) if !(low..=high).contains(&number.value) => {
            Err(RandomInputsError::Outside {
                typed: input.typed.clone(),
                path: input.path.clone(),
                value: engineering(number.value, &number.unit, 4),
            })
        }
        _ => Ok(()),
    }
}

/// Whether `path` is the sensitivity of a sensor whose file alone tells its uncertainty.
fn is_gain(scene: &Scene, path: &str) -> bool {
    path.ends_with(".sensitivity") && !scene.states_uncertainty_of(path)
}

/// What the files of measured sensors state, unless the scene states it itself.
fn of_sensors(scene: &Scene) -> Vec<UncertainInput> {
    let mut found = Vec::new();
    for placed in &scene.sensors {
        let known = &placed.sensor.measured;
        let pairs = [
            ("sensitivity", known.sensitivity.and(known.sensitivity_u)),
            ("tau", known.time_constant.and(known.time_constant_u)),
        ];
        for (key, u) in pairs {
            let path = format!("sensors.{}.{key}", placed.name);
            if let Some(u) = u.filter(|_| !scene.states_uncertainty_of(&path)) {
                found.push(UncertainInput {
                    path,
                    distribution: InputDistribution::Normal(SpreadAmount::Share(u)),
                    group: None,
                    source: Some(format!("file of the sensor {}", placed.sensor.model)),
                    typed: placed.sensor.model.clone(),
                });
            }
        }
    }
    found
}
