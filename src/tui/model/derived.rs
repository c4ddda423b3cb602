//! Computes spectra, measurements and arrivals for the pages; only those on screen, and only when
//! the input has changed.

use super::ScreenState;
use super::state::{Derived, DerivedKey, MeasurementReading, Page, SidePanel};
use crate::analysis::spectrum::Window;
use crate::analysis::spectrum::{Analyser, Spectrum, SpectrumSettings};
use crate::analysis::time_frequency::{Pieces, Spectrogram};
use crate::instrument::measure::{measure, unit};
use crate::measurement::arrivals::survey;
use crate::measurement::metadata::{self, RecordedSensor};
use crate::scope::Source;
use crate::scope::panel::MeasurementType;
use crate::trace::Trace;

/// Spectra of records longer than this are made of every second, third, ... sample: a terminal
/// shows no more.
const MAX_SPECTRUM_SAMPLES: usize = 20_000;

/// The measurements of the side panel with the names that the instrument's menu gives them.
const MEASUREMENTS: [(&str, MeasurementType); 11] = [
    ("Pk-Pk", MeasurementType::PeakToPeak),
    ("Max", MeasurementType::Maximum),
    ("Min", MeasurementType::Minimum),
    ("Mean", MeasurementType::Mean),
    ("Cyc RMS", MeasurementType::CycleRms),
    ("Period", MeasurementType::Period),
    ("Freq", MeasurementType::Frequency),
    ("Rise", MeasurementType::Rise),
    ("Fall", MeasurementType::Fall),
    ("+Width", MeasurementType::PositiveWidth),
    ("-Width", MeasurementType::NegativeWidth),
];

impl ScreenState {
    /// The computed data of the screen.
    pub fn derived(&self) -> &Derived {
        &self.derived
    }

    /// The sensor that the recording wired to `source`.
    pub fn sensor(&self, source: Source) -> Option<RecordedSensor> {
        let name = source.to_string();
        let mut sensors = metadata::sensors(self.set()).into_iter();
        sensors.find(|sensor| sensor.channel.as_ref() == Some(&name))
    }

    /// Works out what the screen shows, unless it has.
    pub(super) fn derive(&mut self) {
        let key = DerivedKey {
            version: self.version,
            source: self.selected,
            page: self.page,
            side: self.side,
        };
        if self.derived.made_of == Some(key) {
            return;
        }
        let mut derived = Derived { made_of: Some(key), ..Derived::default() };
        if matches!(self.page, Page::Spectrum | Page::Map) {
            let site = self.selected.and_then(|source| self.sensor(source)).and_then(|s| s.site());
            let scene = self.scene.as_ref();
            derived.chain = site.zip(scene).and_then(|(site, scene)| metadata::cell(scene, site));
        }
        let trace = self.selected().and_then(crate::recording::Capture::trace).map(thinned);
        let trace =
            trace.ok_or_else(|| "this is a spectrum already: select a trace over time".to_owned());
        if self.page == Page::Spectrum {
            derived.spectrum = Some(trace.clone().and_then(|trace| spectrum(&trace)));
        }
        if self.page == Page::Map {
            let gap = derived.chain.map(|chain| chain.gap_top() - chain.gap_bottom());
            derived.map = Some(trace.and_then(|trace| map(&trace, gap)));
        }
        if self.side == SidePanel::Measurements {
            derived.readings = self.readings();
            derived.survey = self.set_shot().map(|shot| survey(&self.set, shot));
        }
        self.derived = derived;
    }

    fn readings(&self) -> Vec<MeasurementReading> {
        let Some(capture) = self.selected() else { return Vec::new() };
        let reading = |(name, kind): (&'static str, MeasurementType)| MeasurementReading {
            name,
            value: measure(kind, &capture.waveform).ok(),
            unit: match unit(kind) {
                "V" => super::state::ordinate_unit(&capture.waveform).to_owned(),
                other => other.to_owned(),
            },
        };
        MEASUREMENTS.map(reading).to_vec()
    }
}

/// Every so manieth sample of a long record.
fn thinned(trace: Trace) -> Trace {
    let step = trace.values.len().div_ceil(MAX_SPECTRUM_SAMPLES).max(1);
    let interval = trace.interval * step as f64;
    Trace { interval, values: trace.values.into_iter().step_by(step).collect(), ..trace }
}

fn spectrum(trace: &Trace) -> Result<Spectrum, String> {
    let settings = SpectrumSettings { offset: mean(trace), ..SpectrumSettings::default() };
    Analyser::new().spectrum(trace, &settings).map_err(|error| error.to_string())
}

fn map(trace: &Trace, gap: Option<f64>) -> Result<Spectrogram, String> {
    let pieces = Pieces::of_record(trace.values.len(), trace.interval, gap);
    let settings = SpectrumSettings {
        offset: mean(trace),
        window: Window::Hann,
        ..SpectrumSettings::default()
    };
    Spectrogram::of(&mut Analyser::new(), trace, &settings, pieces).map_err(|e| e.to_string())
}

fn mean(trace: &Trace) -> f64 {
    trace.values.iter().sum::<f64>() / trace.values.len().max(1) as f64
}
