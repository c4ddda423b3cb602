//! From captures, series and lines to the messages of a recording.

use super::message::{self, timestamp};
use crate::recording::{Capture, Direction, Origin, ScpiLine, Shot};
use crate::trace::Trace;

/// Bytes of a line that its text shows.
const MAX_LINE_TEXT: usize = 200;

/// A capture as a message.
pub fn capture_message(shot: &Shot, capture: &Capture) -> message::CaptureMessage {
    let waveform = &capture.waveform;
    let preamble = &waveform.preamble;
    let vertical = &waveform.vertical;
    let narrow: Option<Vec<i8>> =
        waveform.codes.iter().map(|code| i8::try_from(*code).ok()).collect();
    let codes = match narrow {
        Some(codes) => codes.into_iter().flat_map(i8::to_be_bytes).collect(),
        None => waveform.codes.iter().copied().flat_map(i16::to_be_bytes).collect(),
    };
    let instrument = capture.instrument.as_ref();
    message::CaptureMessage {
        timestamp: Some(timestamp(shot.timestamp_ns)),
        shot: shot.number,
        source: waveform.source.to_string(),
        t0_s: Some(preamble.x_zero),
        dt_s: preamble.x_incr,
        y_mult: preamble.y_mult,
        y_off: Some(preamble.y_off),
        y_zero: Some(preamble.y_zero),
        unit: preamble.y_unit.clone(),
        codes,
        volts: waveform.values().map(|value| value as f32).collect(),
        origin: match shot.origin {
            Origin::Simulated => "simulated".to_owned(),
            Origin::Measured => "measured".to_owned(),
        },
        trigger_point: Some(waveform.trigger_point),
        vertical_scale: vertical.scale,
        horizontal_scale: waveform.horizontal_scale,
        position_div: Some(vertical.position),
        probe: vertical.probe,
        coupling: vertical.coupling.map(|c| c.to_string()).unwrap_or_default(),
        bandwidth_limited: vertical.bandwidth_limited,
        inverted: vertical.inverted,
        model: instrument.map(|i| i.model.clone()).unwrap_or_default(),
        serial: instrument.map(|i| i.serial.clone()).unwrap_or_default(),
        firmware: instrument.map(|i| i.firmware.clone()).unwrap_or_default(),
        point_format: preamble.pt_fmt.to_string(),
        x_unit: preamble.x_unit.clone(),
        trigger_time_s: shot.trigger_time,
        notes: capture.notes.clone(),
        values: waveform.as_read.clone(),
    }
}

/// A series as a message.
pub fn series_message(shot: &Shot, trace: &Trace) -> message::SeriesMessage {
    message::SeriesMessage {
        timestamp: Some(timestamp(shot.timestamp_ns)),
        shot: shot.number,
        name: trace.name.clone(),
        unit: trace.unit.clone(),
        t0_s: trace.start,
        dt_s: trace.interval,
        values: trace.values.clone(),
    }
}

/// A command or a reply as a message.
pub fn line_message(line: &ScpiLine) -> message::ScpiLineMessage {
    let shown = line.bytes.get(..line.bytes.len().min(MAX_LINE_TEXT)).unwrap_or_default();
    message::ScpiLineMessage {
        timestamp: Some(timestamp(line.timestamp_ns)),
        peer: line.peer.clone(),
        direction: match line.direction {
            Direction::Command => "command".to_owned(),
            Direction::Reply => "reply".to_owned(),
        },
        text: shown.trim_ascii_end().escape_ascii().to_string(),
        bytes: line.bytes.clone(),
    }
}
