//! Which traces there are: those of the shot in volts or newtons, the math trace, the references.

use super::ScreenState;
use super::shot_traces::shot_traces;
use crate::recording::{Capture, TrueSignal};
use crate::scope::{Source, Waveform};
use crate::trace::Trace;

impl ScreenState {
    /// Makes the list of traces again.
    pub(super) fn rebuild(&mut self) {
        self.behind.iter_mut().for_each(|other| other.rebuild(self.newtons));
        let Some(shot) = self.set_shot() else {
            self.traces = self.references.clone();
            return;
        };
        let (mut traces, missing) = shot_traces(&self.set, shot, self.newtons);
        if missing.is_some() {
            self.notice = missing;
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

    /// The simulated force at the sensor of `waveform`, on the trace's own axis: as volts by the
    /// sensor's sensitivity, or newtons, without what pressed before.
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
