//! Has spectra, measurements and arrivals computed for the page and the side panel; only those on
//! screen, and only when their input has changed.

use super::screen_state::{DerivedPart, ScreenState};
use super::state::{Derived, DerivedKey, MeasurementReading, SidePanel, ordinate_unit};
use crate::instrument::measure::{measure, unit};
use crate::measurement::arrivals::{Survey, survey};
use crate::measurement::metadata::{self, RecordedSensor};
use crate::recording::Shot;
use crate::scope::panel::MeasurementType;
use crate::scope::{Source, Waveform};
use crate::tui::job::{Job, Queue};

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
        let mut sensors = metadata::sensors(&self.recordings.front().set).into_iter();
        sensors.find(|sensor| sensor.channel.as_ref() == Some(&name))
    }

    /// Has computed what the screen shows, unless it is or is being computed.
    pub(super) fn derive(&mut self) {
        let key = DerivedKey {
            version: self.version,
            source: self.selected,
            page: self.page.map(|page| page.0.name),
            side: self.side,
        };
        if self.derived.made_of == Some(key) {
            return;
        }
        let of_page = self.page.and_then(|page| (page.0.derive)(self));
        let of_side = (self.side == SidePanel::Measurements).then(|| self.measurements());
        // Until then that of the shot before stays, if it is of the same trace.
        let is_alike = self.derived.made_of.is_some_and(|before| before.is_alike(&key));
        if !is_alike {
            self.derived = Derived::default();
        }
        self.derived.made_of = Some(key);
        let parts: Vec<DerivedPart> = of_page.into_iter().chain(of_side).collect();
        if parts.is_empty() {
            return;
        }
        self.derived.is_pending = true;
        self.ask(Job::new(
            Queue::Reading,
            move |_| {
                let mut derived = Derived { made_of: Some(key), ..Derived::default() };
                for part in parts {
                    part(&mut derived);
                }
                Ok(derived)
            },
            move |model: &mut Self, found: Result<Derived, String>| match found {
                Ok(found) if model.derived.made_of == Some(key) => model.derived = found,
                Ok(_) => {}
                Err(problem) => model.notice = Some(problem),
            },
        ));
    }

    /// The measurements of the selected trace, and arrivals and speeds of the shot, for a thread.
    fn measurements(&self) -> DerivedPart {
        let waveform = self.selected().map(|capture| capture.waveform.clone());
        let survey = self.survey_job();
        Box::new(move |derived| {
            derived.readings = waveform.as_ref().map_or_else(Vec::new, readings);
            derived.survey = survey.map(|survey| survey());
        })
    }

    /// The survey of arrivals and speeds of the shot, for a thread.
    pub(super) fn survey_job(&self) -> Option<impl FnOnce() -> Survey + Send + 'static> {
        let shot = Shot { truth: Vec::new(), ..self.shot()?.clone() };
        let set = self.recordings.front().set.with_shot(shot.clone());
        Some(move || survey(&set, &shot))
    }
}

fn readings(waveform: &Waveform) -> Vec<MeasurementReading> {
    let reading = |(name, kind): (&'static str, MeasurementType)| MeasurementReading {
        name,
        value: measure(kind, waveform).ok(),
        unit: match unit(kind) {
            "V" => ordinate_unit(waveform).to_owned(),
            other => other.to_owned(),
        },
    };
    MEASUREMENTS.map(reading).to_vec()
}
