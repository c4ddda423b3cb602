//! Which traces there are: those of the shot in volts or newtons, the math trace, the references.

use super::ScreenState;
use crate::measurement::force::{Forces, ForcesError, forces};
use crate::recording::{Capture, TrueSignal};
use crate::scope::{Source, VerticalSetup, Waveform};
use crate::trace::Trace;
use crate::tui::axis::Steps;

/// Levels of a force that was turned into a record: as many as sixteen bits have on one side (1).
const FORCE_LEVELS: f64 = 32000.0;

/// A force as a record: levels of sixteen bits, on a scale that leaves the trace where its volts stood.
fn as_record(volts: &Capture, forces: &Forces) -> Capture {
    let force = &forces.force;
    let largest = force.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let level = if largest > 0.0 { largest / FORCE_LEVELS } else { 1.0 };
    let codes = force.values.iter().map(|value| (value / level).round() as i16).collect();
    let recorded = &volts.waveform;
    let sensitivity = forces.sensor.sensitivity.unwrap_or(1.0);
    let scale = Steps::OneTwoFive.at_least(recorded.vertical.scale / sensitivity);
    let mut preamble = recorded.preamble.clone();
    (preamble.y_mult, preamble.y_off, preamble.y_zero) = (level, 0.0, 0.0);
    "N".clone_into(&mut preamble.y_unit);
    let vertical = VerticalSetup { scale, ..recorded.vertical };
    let waveform = Waveform { codes, preamble, vertical, ..recorded.clone() };
    Capture { waveform, ..volts.clone() }
}

impl ScreenState {
    /// Makes the list of traces again.
    pub(super) fn rebuild(&mut self) {
        let Some(shot) = self.set_shot() else {
            self.traces = self.references.clone();
            return;
        };
        let mut traces = shot.captures.clone();
        if self.newtons {
            let mut missing = None;
            for (trace, force) in traces.iter_mut().zip(forces(&self.set, shot)) {
                match force {
                    Ok(forces) => *trace = as_record(trace, &forces),
                    Err(ForcesError::NoSensor { channel }) => {
                        missing = Some(format!(
                            "no calibration for {channel}: cannot show newtons (give one with --sensor)"
                        ));
                    }
                    Err(problem) => missing = Some(format!("cannot show newtons: {problem}")),
                }
            }
            if missing.is_some() {
                self.notice = missing;
            }
        }
        if let Some(math) = self.math.trace(&traces) {
            traces.retain(|trace| trace.waveform.source != Source::Math);
            traces.push(math);
        }
        let kept = |reference: &&Capture| {
            traces.iter().all(|trace| trace.waveform.source != reference.waveform.source)
        };
        let references: Vec<Capture> = self.references.iter().filter(kept).cloned().collect();
        traces.extend(references);
        self.traces = traces;
        self.keep_selection();
        self.derive();
    }

    /// The simulated force at the sensor of `waveform`, on the trace's own axis: as volts by the sensor's sensitivity, or newtons,
    /// without what pressed before.
    pub fn truth(&self, waveform: &Waveform) -> Option<Trace> {
        if !self.truth {
            return None;
        }
        let shot = self.shot()?;
        let sensor = self.sensor(waveform.source)?;
        let felt = shot.true_signal(&TrueSignal::Force(sensor.name.clone()))?;
        let rest = felt.values.first().copied().unwrap_or(0.0);
        let gain = match waveform.preamble.y_unit.as_str() {
            "N" => 1.0,
            _ => sensor.sensitivity?,
        };
        let values = felt.values.iter().map(|force| (force - rest) * gain).collect();
        Some(Trace { start: felt.start - shot.trigger_time?, values, ..felt.clone() })
    }

    /// Keeps the selected trace as the next reference.
    pub(super) fn keep_reference(&mut self) {
        let Some(capture) = self.selected().cloned() else { return };
        if let Source::Reference(letter) = capture.waveform.source {
            self.references.retain(|kept| kept.waveform.source != capture.waveform.source);
            self.rebuild();
            self.notice = Some(format!("REF{letter} is empty again"));
            return;
        }
        let taken = |letter: &char| {
            self.traces.iter().any(|kept| kept.waveform.source == Source::Reference(*letter))
        };
        let Some(letter) = ('A'..='D').find(|letter| !taken(letter)) else {
            self.notice = Some("all four references are taken: select one and press R".to_owned());
            return;
        };
        let from = capture.waveform.source;
        let waveform = Waveform { source: Source::Reference(letter), ..capture.waveform };
        self.references.push(Capture { waveform, ..capture });
        self.rebuild();
        self.notice = Some(format!("REF{letter} keeps this {from}"));
    }
}
