//! The menu beside the graticule.

use super::readout::readout;
use crate::instrument::Instrument;
use crate::instrument::measure::{measure, unit};
use crate::scope::panel::{CursorFunction, MeasurementType};
use crate::scope::{Coupling, Source};

/// Entries of a menu.
const MEASUREMENTS: u8 = 5;

/// Title and entries: those of the measurements if there are any, else of the cursors if they are
/// on, else of the first channel on the screen.
pub fn menu(instrument: &Instrument) -> Vec<[String; 2]> {
    let measured = measurements(instrument);
    if measured.iter().any(|entry| entry[0] != "None") {
        return titled("MEASURE", measured);
    }
    match instrument.panel.cursor.function {
        CursorFunction::Off => channel(instrument),
        function => cursors(instrument, function),
    }
}

fn titled(title: &str, entries: Vec<[String; 2]>) -> Vec<[String; 2]> {
    let title = [title.to_owned(), String::new()];
    std::iter::once(title).chain(entries).collect()
}

fn entry(name: &str, value: impl Into<String>) -> [String; 2] {
    [name.to_owned(), value.into()]
}

fn measurements(instrument: &Instrument) -> Vec<[String; 2]> {
    let one = |number| {
        let slot = instrument.panel.measurement(number);
        let name = match slot.kind {
            MeasurementType::None => return entry("None", ""),
            MeasurementType::Frequency => "Freq",
            MeasurementType::Mean => "Mean",
            MeasurementType::Period => "Period",
            MeasurementType::PeakToPeak => "Pk-Pk",
            MeasurementType::CycleRms => "Cyc RMS",
            MeasurementType::Minimum => "Min",
            MeasurementType::Maximum => "Max",
            MeasurementType::Rise => "Rise",
            MeasurementType::Fall => "Fall",
            MeasurementType::PositiveWidth => "+Width",
            MeasurementType::NegativeWidth => "-Width",
        };
        let result = instrument.waveform(slot.source).and_then(|w| measure(slot.kind, &w));
        let value = result.map_or("?".to_owned(), |value| readout(value, unit(slot.kind)));
        entry(&format!("{} {name}", slot.source), value)
    };
    (1..=MEASUREMENTS).map(one).collect()
}

fn cursors(instrument: &Instrument, function: CursorFunction) -> Vec<[String; 2]> {
    let cursor = &instrument.panel.cursor;
    let (kind, unit, [first, second]) = match function {
        CursorFunction::HorizontalBars => ("Voltage", "V", cursor.horizontal),
        CursorFunction::VerticalBars | CursorFunction::Off => ("Time", "s", cursor.vertical),
    };
    let entries = vec![
        entry("Type", kind),
        entry("Source", cursor.source.to_string()),
        entry("Delta", readout((second - first).abs(), unit)),
        entry("Cursor 1", readout(first, unit)),
        entry("Cursor 2", readout(second, unit)),
    ];
    titled("CURSOR", entries)
}

fn channel(instrument: &Instrument) -> Vec<[String; 2]> {
    let model = &instrument.model;
    let shown = |number: &u8| instrument.panel.displays(Source::Channel(*number));
    let Some(number) = (1..=model.channels).find(shown) else { return Vec::new() };
    let vertical = instrument.panel.channel(number).vertical;
    let limited = vertical.bandwidth_limited == Some(true);
    let bandwidth = if limited { model.limited_bandwidth } else { model.bandwidth };
    let megahertz = format!("{} {}MHz", if limited { "On" } else { "Off" }, bandwidth / 1e6);
    let coupling = match vertical.coupling {
        Some(Coupling::Ac) => "AC",
        Some(Coupling::Ground) => "Ground",
        Some(Coupling::Dc) | None => "DC",
    };
    let at_input = vertical.scale / vertical.probe;
    let is_step = |scale: &f64| (scale / at_input - 1.0).abs() < 1e-6;
    let step = if model.vertical_scales.iter().any(is_step) { "Coarse" } else { "Fine" };
    let entries = vec![
        entry("Coupling", coupling),
        entry("BW Limit", megahertz),
        entry("Volts/Div", step),
        entry("Probe", format!("{}X", vertical.probe)),
        entry("Invert", if vertical.inverted == Some(true) { "On" } else { "Off" }),
    ];
    titled(&format!("CH{number}"), entries)
}
