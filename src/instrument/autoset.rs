//! AUTOSET: finds settings that show what is at the inputs.
//!
//! The settings follow the table "Autoset settings" of the TDS1000/2000 user manual (071-1064); how
//! large and how many cycles a signal becomes is this program's choice, within what the manual
//! describes.

use super::measure::measure;
use super::service::AutosetSignal;
use super::{Event, Instrument, Source};
use crate::scope::limits;
use crate::scope::panel::{
    Cursor, CursorFunction, DisplayFormat, MeasurementType, StopAfter, TriggerType, View,
};
use crate::scope::{AcquireMode, Coupling, EdgeCoupling, TriggerMode, TriggerSource, Waveform};

/// Share of the samples of a square wave that lie near its ends (1).
const SQUARE_SHARE: f64 = 0.9;
/// Share of the swing that counts as near an end (1).
const NEAR_END: f64 = 0.1;
/// Relative deviation of the cycle's root mean square that a sine may have (1).
const SINE_TOLERANCE: f64 = 0.05;

/// Swing that is aimed at (div).
const TARGET_SWING: f64 = 4.0;
/// Cycles on the screen that are aimed at (1).
const TARGET_CYCLES: f64 = 4.0;

impl Instrument {
    /// Scales every displayed channel to its record and the time base to the cycles of the lowest
    /// one, and triggers on that at half height.
    pub fn autoset(&mut self) {
        let shown: Vec<u8> = (1..=self.model.channels)
            .filter(|number| self.panel.displays(Source::Channel(*number)))
            .collect();
        let first = shown.first().copied().unwrap_or(1);
        let record = self.waveform(Source::Channel(first));
        self.autoset_signal = record.map_or(AutosetSignal::None, |record| kind(&record));
        let reading = |number: u8, kind| {
            let record = self.waveform(Source::Channel(number)).ok()?;
            measure(kind, &record).ok().filter(|value: &f64| *value > 0.0)
        };
        let period = reading(first, MeasurementType::Period);
        let swing = |number| reading(number, MeasurementType::PeakToPeak);
        let swings: Vec<(u8, Option<f64>)> = shown.iter().map(|n| (*n, swing(*n))).collect();
        self.centre_trigger_on(first);
        for (number, swing) in swings {
            let vertical = &mut self.panel.channel_mut(number).vertical;
            vertical.position = 0.0;
            vertical.bandwidth_limited = Some(false);
            vertical.inverted = Some(false);
            if vertical.coupling == Some(Coupling::Ground) {
                vertical.coupling = Some(Coupling::Dc);
            }
            if let Some(swing) = swing {
                let scale = limits::vertical_scale(
                    &self.model,
                    (swing / TARGET_SWING, vertical.probe),
                    false,
                );
                vertical.scale = scale;
            }
        }
        if let Some(period) = period {
            let screen = TARGET_CYCLES * period / self.model.horizontal_divisions;
            self.panel.horizontal.scale = limits::time_base(&self.model, screen);
        }
        self.panel.horizontal.position = 0.0;
        self.panel.horizontal.view = View::Main;
        self.settings_for_repeated_signals();
        self.apply_panel();
        self.run();
    }

    fn settings_for_repeated_signals(&mut self) {
        let panel = &mut self.panel;
        panel.cursor = Cursor { function: CursorFunction::Off, ..panel.cursor };
        panel.display.format = DisplayFormat::Yt;
        panel.trigger.mode = TriggerMode::Auto;
        panel.trigger_type = TriggerType::Edge;
        panel.trigger.coupling = EdgeCoupling::Dc;
        panel.trigger.holdoff = self.model.limits.holdoff.0;
        panel.stop_after = StopAfter::RunStop;
        if panel.acquire.mode == AcquireMode::Average {
            panel.acquire.mode = AcquireMode::Sample;
        }
    }

    /// Puts the trigger level half way between the extremes of its source, where there is a record.
    ///
    /// # Errors
    /// [`Event::SettingsConflict`] where the scope is stopped, and at the mains, which have no
    /// level.
    pub fn centre_trigger(&mut self) -> Result<(), Event> {
        let source = self.panel.trigger.source;
        if !self.is_running() || source == TriggerSource::Line {
            return Err(Event::SettingsConflict);
        }
        match source.channel() {
            Some(channel) => self.centre_trigger_on(channel),
            // The external input is not on the screen.
            None => self.panel.trigger.level = 0.0,
        }
        Ok(())
    }

    /// The trigger looks at channel `number`, half way between the extremes of its record, if there
    /// is one.
    fn centre_trigger_on(&mut self, number: u8) {
        self.panel.trigger.source = TriggerSource::Channel(number);
        let Ok(record) = self.waveform(Source::Channel(number)) else { return };
        let reading = |kind| measure(kind, &record).unwrap_or(0.0);
        let level =
            f64::midpoint(reading(MeasurementType::Minimum), reading(MeasurementType::Maximum));
        self.panel.trigger.level = self.panel.trigger_level(&self.model, level);
    }
}

/// What a record looks like.
fn kind(record: &Waveform) -> AutosetSignal {
    let reading = |kind| measure(kind, record);
    let (Ok(low), Ok(high)) =
        (reading(MeasurementType::Minimum), reading(MeasurementType::Maximum))
    else {
        return AutosetSignal::None;
    };
    if reading(MeasurementType::Period).is_err() {
        return AutosetSignal::Level;
    }
    let near = NEAR_END * (high - low);
    let volts = record.codes.iter().map(|code| record.volts_of(*code));
    let at_ends = volts.filter(|volts| *volts <= low + near || *volts >= high - near).count();
    let share = at_ends as f64 / record.codes.len().max(1) as f64;
    let (offset, amplitude) = (f64::midpoint(low, high), 0.5 * (high - low));
    // Root of offset squared and half the amplitude squared.
    let sine = (offset.powi(2) + 0.5 * amplitude.powi(2)).sqrt();
    let is_sine = reading(MeasurementType::CycleRms)
        .is_ok_and(|rms| (rms / sine - 1.0).abs() < SINE_TOLERANCE);
    if share > SQUARE_SHARE {
        AutosetSignal::Square
    } else if is_sine {
        AutosetSignal::Sine
    } else {
        AutosetSignal::Other
    }
}
