//! A scene in motion, and what is read off its forces.

use super::{FigureRun, ForceLocation, ForceSignal, PaperError};
use crate::analysis::gate::Gate;
use crate::analysis::spectrum::{Analyser, Spectrum, SpectrumSettings, Window};
use crate::chain::ForceProbe;
use crate::experiment::bench::{Bench, Grid};
use crate::experiment::pulse::{HALF_RISE_SHARE, Peak, PulseRecorder};
use crate::experiment::{Integration, method, run};
use crate::numeric::roots::vertex;
use crate::recording::TrueSignal;
use crate::scene::Scene;
use crate::trace::Trace;

/// Sample interval of all forces: 60 samples in the fastest oscillation that travels (s).
const SAMPLE_INTERVAL: f64 = 1e-6;
/// Where a pulse starts for its width, as a share of its first peak (1).
pub(super) const WIDTH_SHARE: f64 = 0.005;
/// Highest frequency that shares and means count: the paper's audible range (Hz).
pub(super) const MAX_FREQUENCY: f64 = 20e3;
/// A maximum counts for a peak above this share of the largest force (1).
const PEAK_SHARE: f64 = 0.25;

/// Accuracy of a scene's run (1).
pub(super) fn accuracy(scene: &Scene) -> f64 {
    scene.accuracy
}

/// Forces at several places of a scene.
pub(super) struct ForceRecord {
    pub scene: Scene,
    records: Vec<(ForceLocation, Trace, PulseRecorder)>,
}

impl ForceRecord {
    /// Runs `scene` over its duration.
    pub(super) fn of(scene: &Scene, places: &[ForceLocation]) -> Result<Self, PaperError> {
        let chain = &scene.chain;
        let probes: Option<Vec<ForceProbe>> = places.iter().map(|p| p.probe(chain)).collect();
        let probes = probes.ok_or_else(|| nothing(scene, "such place"))?;
        let method = method(scene, Integration::Accuracy(accuracy(scene)))?;
        let grid = Grid { start: 0.0, interval: SAMPLE_INTERVAL };
        let velocities = &scene.initial_velocities;
        let mut bench = Bench::new(chain, velocities, method, &probes, grid, Grid::NEVER);
        bench.run_until(scene.duration, true, &mut |_| ())?;
        let records = places.iter().zip(bench.watches()).map(|(place, watch)| {
            let trace = grid.trace(&place.words(chain), "N", watch.samples.clone());
            (*place, trace, watch.pulse.clone())
        });
        Ok(Self { scene: scene.clone(), records: records.collect() })
    }

    fn at(&self, place: ForceLocation) -> Result<(&Trace, &PulseRecorder), PaperError> {
        let record = self.records.iter().find(|(there, ..)| *there == place);
        let record = record.map(|(_, trace, pulse)| (trace, pulse));
        record.ok_or_else(|| nothing(&self.scene, &format!("force at {}", place.key())))
    }

    /// The force over time.
    pub(super) fn trace(&self, place: ForceLocation) -> Result<&Trace, PaperError> {
        Ok(self.at(place)?.0)
    }

    /// The first peak.
    pub(super) fn first_peak(&self, place: ForceLocation) -> Result<Peak, PaperError> {
        let peak = self.at(place)?.1.first_peak();
        peak.ok_or_else(|| nothing(&self.scene, &format!("first peak at {}", place.key())))
    }

    /// When the force first reached half of its first peak (s).
    pub(super) fn half_rise(&self, place: ForceLocation) -> Result<f64, PaperError> {
        let level = HALF_RISE_SHARE * self.first_peak(place)?.dynamic_n;
        let reached = self.at(place)?.1.first_reach(level);
        reached.ok_or_else(|| nothing(&self.scene, &format!("half-rise at {}", place.key())))
    }

    /// When the wall's echo reaches `place`: as long after the wall as the pulse came before it,
    /// both where they begin; the scene's end at the wall, or without one (s).
    pub(super) fn echo(&self, place: ForceLocation) -> f64 {
        let begin = |place: ForceLocation| {
            let (_, pulse) = self.at(place).ok()?;
            pulse.first_reach(WIDTH_SHARE * pulse.first_peak()?.dynamic_n)
        };
        let echo =
            begin(ForceLocation::Wall).zip(begin(place)).map(|(wall, here)| 2.0 * wall - here);
        let end = self.scene.duration;
        echo.filter(|_| place != ForceLocation::Wall).map_or(end, |echo| echo.min(end))
    }

    /// Spectrum with a Hann window, for a section of a longer signal.
    pub(super) fn windowed(
        &self,
        place: ForceLocation,
        from: f64,
        to: f64,
    ) -> Result<Spectrum, PaperError> {
        let (gate, window) = (Gate { from, to }, Window::Hann);
        let settings = SpectrumSettings { window, gate, ..SpectrumSettings::default() };
        Ok(Analyser::new().spectrum(self.trace(place)?, &settings)?)
    }

    /// The force over time, and over frequency up to the wall's echo, which the paper leaves out.
    pub(super) fn signal_before_echo(
        &self,
        place: ForceLocation,
    ) -> Result<ForceSignal, PaperError> {
        let spectrum = self.spectrum(place, 0.0, self.echo(place))?;
        Ok(ForceSignal { place, trace: self.trace(place)?.clone(), spectrum })
    }

    /// The spectrum in the paper's convention between two times (s).
    pub(super) fn spectrum(
        &self,
        place: ForceLocation,
        from: f64,
        to: f64,
    ) -> Result<Spectrum, PaperError> {
        let settings = SpectrumSettings { gate: Gate { from, to }, ..SpectrumSettings::default() };
        Ok(Analyser::new().spectrum(self.trace(place)?, &settings)?)
    }

    /// The force over time and frequency.
    pub(super) fn signal(&self, place: ForceLocation) -> Result<ForceSignal, PaperError> {
        let spectrum = self.spectrum(place, 0.0, self.scene.duration)?;
        Ok(ForceSignal { place, trace: self.trace(place)?.clone(), spectrum })
    }

    /// Time from where the first pulse reaches the share `foot` (1) of its peak to the first
    /// minimum behind it (s).
    pub(super) fn width(&self, place: ForceLocation, foot: f64) -> Result<f64, PaperError> {
        let (trace, pulse) = self.at(place)?;
        let peak = self.first_peak(place)?;
        let foot = pulse.first_reach(foot * peak.dynamic_n);
        let minimum = maxima(trace, -1.0).into_iter().find(|(time, _)| *time > peak.time_s);
        match (foot, minimum) {
            (Some(foot), Some((time, _))) => Ok(time - foot),
            _ => Err(nothing(&self.scene, &format!("end of the pulse at {}", place.key()))),
        }
    }

    /// Maxima above a quarter of the largest force: times (s) and forces (N).
    pub(super) fn peaks(&self, place: ForceLocation) -> Result<Vec<(f64, f64)>, PaperError> {
        let trace = self.trace(place)?;
        let largest = trace.values.iter().copied().fold(0.0, f64::max);
        let mut peaks = maxima(trace, 1.0);
        peaks.retain(|(_, force)| *force > PEAK_SHARE * largest);
        Ok(peaks)
    }

    /// Lowest force between two times (N).
    pub(super) fn lowest(
        &self,
        place: ForceLocation,
        from: f64,
        to: f64,
    ) -> Result<f64, PaperError> {
        let minima = maxima(self.trace(place)?, -1.0).into_iter();
        let between = minima.filter(|(time, _)| (from..to).contains(time));
        Ok(between.map(|(_, force)| force).fold(f64::INFINITY, f64::min))
    }
}

/// The error that something is not there.
pub(super) fn nothing(scene: &Scene, what: &str) -> PaperError {
    PaperError::Nothing { scene: scene.name.clone(), what: what.to_owned() }
}

/// Maxima (`sign` 1) or minima (-1): times (s) and values, by a parabola through three samples.
fn maxima(trace: &Trace, sign: f64) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for (index, window) in trace.values.windows(3).enumerate() {
        let three = [window[0], window[1], window[2]].map(|value| sign * value);
        if let Some((shift, value)) = vertex(three).filter(|(shift, _)| (-0.5..0.5).contains(shift))
        {
            found.push((trace.time(index + 1) + shift * trace.interval, sign * value));
        }
    }
    found
}

/// Sum of the squared amplitudes between two frequencies (unit).
pub(super) fn power_between(spectrum: &Spectrum, low: f64, high: f64) -> f64 {
    let bins = spectrum.amplitude.iter().enumerate();
    bins.filter(|(bin, _)| (low..high).contains(&spectrum.frequency(*bin)))
        .map(|(_, c)| c * c)
        .sum()
}

/// Share of the squared amplitudes up to [`MAX_FREQUENCY`] that lies between two frequencies (1).
pub(super) fn share_between(spectrum: &Spectrum, low: f64, high: f64) -> f64 {
    power_between(spectrum, low, high) / power_between(spectrum, 0.0, MAX_FREQUENCY)
}

/// Mean frequency up to [`MAX_FREQUENCY`], weighted with the squared amplitudes (Hz).
pub(super) fn mean_frequency(spectrum: &Spectrum) -> f64 {
    let (mut weighted, mut all) = (0.0, 0.0);
    for (bin, amplitude) in spectrum.amplitude.iter().enumerate() {
        let frequency = spectrum.frequency(bin);
        if frequency < MAX_FREQUENCY {
            weighted += frequency * amplitude * amplitude;
            all += amplitude * amplitude;
        }
    }
    weighted / all
}

/// Runs `scene` as `run` does, and puts the forces of `signals` into its truth, as long as the
/// figure shows them.
pub(super) fn record_run(scene: &Scene, signals: &[ForceSignal]) -> Result<FigureRun, PaperError> {
    let integration = Integration::Accuracy(accuracy(scene));
    let mut outcome = run(scene, integration, 1, &mut |_| ())?;
    let truth = &mut outcome.shot.truth;
    truth.retain(|trace| !matches!(TrueSignal::of(trace), Some(TrueSignal::Force(_))));
    for signal in signals.iter().rev() {
        let topic = TrueSignal::Force(signal.place.key());
        let name = format!("{topic}: dynamic force {}", signal.trace.name);
        truth.insert(0, Trace { name, ..signal.trace.clone() });
    }
    Ok(FigureRun { scene: scene.clone(), integration, outcome })
}
