//! Captures made up for the tests of this folder.

use hertzscope::recording::tek_csv::{read, write};
use hertzscope::recording::{Capture, InstrumentIdentity};
use hertzscope::scope::{PointFormat, Preamble, Source, VerticalSetup, Waveform};

pub(super) fn instrument(model: &str, serial: &str, firmware: &str) -> InstrumentIdentity {
    InstrumentIdentity {
        model: model.to_owned(),
        serial: serial.to_owned(),
        firmware: firmware.to_owned(),
    }
}

/// Settings of a made-up record.
pub(super) struct Setup {
    pub(super) scale: f64,
    pub(super) probe: f64,
    /// Steps of 1/25 division.
    pub(super) position_levels: i32,
    pub(super) interval: f64,
    pub(super) trigger_point: f64,
}

/// The Doppler file's settings.
pub(super) const PLAIN: Setup =
    Setup { scale: 2e-3, probe: 1.0, position_levels: -140, interval: 1e-4, trigger_point: 800.0 };

/// A record in volts. The preamble follows the programmer manual: `YMULT` = scale/25, `YOFF` = 25
/// times the position, `XZERO` = time of the first point.
pub(super) fn record(setup: &Setup, codes: Vec<i16>) -> Capture {
    let position = f64::from(setup.position_levels) / 25.0;
    Capture {
        waveform: Waveform {
            source: Source::Channel(1),
            codes,
            as_read: Vec::new(),
            preamble: Preamble {
                x_zero: -setup.trigger_point * setup.interval,
                x_incr: setup.interval,
                pt_off: 0,
                x_unit: "s".to_owned(),
                y_mult: setup.scale / 25.0,
                y_zero: 0.0,
                y_off: f64::from(setup.position_levels),
                y_unit: "V".to_owned(),
                pt_fmt: PointFormat::Sample,
            },
            vertical: VerticalSetup {
                scale: setup.scale,
                position,
                coupling: None,
                bandwidth_limited: None,
                inverted: None,
                probe: setup.probe,
            },
            horizontal_scale: setup.interval * 250.0,
            trigger_point: setup.trigger_point,
        },
        instrument: Some(instrument("TDS2014C", "C031611", "FV:v24.26")),
        notes: Vec::new(),
    }
}

/// An FFT; bins of `interval` hertz.
pub(super) fn fft(interval: f64, horizontal_scale: f64, y_zero: f64, codes: Vec<i16>) -> Capture {
    let mut capture = record(&PLAIN, codes);
    let waveform = &mut capture.waveform;
    waveform.source = Source::Math;
    waveform.preamble = Preamble {
        x_zero: 0.0,
        x_incr: interval,
        pt_off: 0,
        x_unit: "Hz".to_owned(),
        y_mult: 0.4,
        y_zero,
        y_off: 0.0,
        y_unit: "dB".to_owned(),
        pt_fmt: PointFormat::Sample,
    };
    waveform.vertical.scale = 10.0;
    waveform.vertical.position = 0.0;
    waveform.horizontal_scale = horizontal_scale;
    waveform.trigger_point = 0.0;
    capture
}

/// `codes`, followed by a ramp over all levels, `length` in all.
pub(super) fn ramp_after(codes: &[i16], length: usize) -> Vec<i16> {
    codes.iter().copied().chain((-128..=127).cycle()).take(length).collect()
}

pub(super) fn plain_record() -> Capture {
    record(&PLAIN, ramp_after(&[], 2500))
}

/// Writes, reads, compares; returns the text.
pub(super) fn round_trip(capture: &Capture) -> String {
    let text = write(capture).expect("the capture can be written");
    let back = read(text.as_bytes(), "test.csv").expect("what was written can be read");
    assert_eq!(back.waveform.codes, capture.waveform.codes, "levels");
    assert_eq!(back.instrument, capture.instrument);
    assert_eq!(write(&back).expect("what was read can be written"), text);
    text
}
