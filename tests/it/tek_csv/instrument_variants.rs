//! Generated files of instruments, 256 of each class: forms of different makers and models, times
//! printed with more or fewer digits, triggers on and off the grid, positions that clip. Each is
//! read with the values that it is made of.

use std::fmt::Write as _;

use hertzscope::recording::tek_csv::{read, read_all, write};
use hertzscope::scope::Source;
use proptest::prelude::*;

use super::made_up::{Setup, fft, instrument, record};
use crate::seeded;

/// A record of 8-bit levels.
#[derive(Debug, Clone)]
struct Record {
    interval: f64,
    /// Time of the first point, in intervals.
    first: f64,
    scale: f64,
    /// Divisions.
    position: f64,
    codes: Vec<i16>,
}

impl Record {
    fn volts(&self, code: i16) -> f64 {
        (f64::from(code) - 25.0 * self.position) * self.scale / 25.0
    }

    fn time(&self, point: usize) -> f64 {
        (point as f64 + self.first) * self.interval
    }

    /// Rows of times and values, each written by `cell`.
    fn rows(&self, row: impl Fn(usize, String, String) -> String, digits: usize) -> String {
        let number = |value: f64| format!("{value:.digits$e}");
        // Fewer digits of the volts than tell the levels apart are another test's.
        let volts = |code: i16| format!("{:.6e}", self.volts(code));
        self.codes.iter().enumerate().fold(String::new(), |text, (point, code)| {
            text + &row(point, number(self.time(point)), volts(*code)) + "\n"
        })
    }
}

fn records() -> impl Strategy<Value = Record> {
    let scales = vec![0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0];
    (
        prop::sample::select(vec![4e-9, 1e-8, 4e-7, 1e-6, 2.5e-5, 1e-4]),
        prop_oneof![(-40..10_i32).prop_map(f64::from), -40.0..10.0_f64],
        prop::sample::select(scales),
        prop::sample::select(vec![-3.0, -1.0, 0.0, 0.4, 2.0, 4.0]),
        proptest::collection::vec(-128_i16..=127, 20..60),
    )
        .prop_map(|(interval, first, scale, position, codes)| Record {
            interval,
            first,
            scale,
            position,
            codes,
        })
}

/// The header of a newer Tektronix model for `count` channels alike, with one value a channel or
/// one for all.
fn newer_header(record: &Record, count: usize, (each, model, peak): (bool, bool, bool)) -> String {
    let values = |value: String| vec![value; if each { count } else { 1 }].join(",");
    let mut text = if model { "Model,MDO3014\n".to_owned() } else { String::new() };
    let names: Vec<String> = (1..=count)
        .map(|n| if peak { format!("CH{n},CH{n} Peak Detect") } else { format!("CH{n}") })
        .collect();
    let _ = write!(
        text,
        "Firmware Version,1.20\n\nPoint Format,Y\nHorizontal Units,s\nHorizontal Scale,{:e}\nSample Interval,{:e}\n\
         Record Length,{}\nProbe Attenuation,{}\nVertical Units,{}\nVertical Offset,{}\nVertical Scale,{}\nVertical Position,{}\n,\n\
         Label,\nTIME,{}\n",
        record.interval * 100.0,
        record.interval,
        record.codes.len(),
        values("10".to_owned()),
        values("V".to_owned()),
        values("0".to_owned()),
        values(record.scale.to_string()),
        values(record.position.to_string()),
        names.join(",")
    );
    text
}

proptest! {
    #![proptest_config(seeded(256))]

    /// Levels, position and clipping of newer models, with peak detect columns, one value of a key
    /// or one a channel.
    #[test]
    fn newer_models_keep_levels_and_position(
        record in records(),
        count in 1..5_usize,
        how in any::<(bool, bool, bool)>(),
        digits in 6..10_usize,
    ) {
        let head = newer_header(&record, count, how);
        let peak = how.2;
        let body = record.rows(|_, time, volts| {
            let columns = vec![volts; if peak { 2 * count } else { count }];
            format!("{time},{}", columns.join(","))
        }, digits);
        let text = head + &body;
        let found = read_all(text.as_bytes(), "T0000.CSV").unwrap_or_else(|error| panic!("{error}\n{text}"));
        prop_assert_eq!(found.len(), count);
        for (number, capture) in (1..).zip(&found) {
            let waveform = &capture.waveform;
            prop_assert_eq!(waveform.source, Source::Channel(number));
            prop_assert_eq!(&waveform.codes, &record.codes, "{}", text);
            prop_assert_eq!(waveform.vertical.position, record.position);
            let ends = record.codes.iter().filter(|code| matches!(code, -128 | 127)).count();
            prop_assert_eq!(waveform.clipped(), ends);
            prop_assert_eq!(waveform.vertical.probe, 10.0);
            for point in 0..record.codes.len() {
                let off = (waveform.time(point) - record.time(point)).abs();
                prop_assert!(off <= 1e-5 * record.interval * 41.0, "{}: {} of {}", point, off, record.interval);
            }
        }
    }

    /// The forms of other makers around the same rows.
    #[test]
    fn makers_forms_are_read_right(record in records(), form in 0..9_usize, digits in 6..10_usize) {
        let plain = |separator: &'static str| record.rows(move |_, time, volts| format!("{time}{separator}{volts}"), digits);
        let (interval, first) = (record.interval, record.time(0));
        let text = match form {
            0 => format!("x-axis,2\nsecond,Volt\n{}", plain(",")),
            1 => format!(
                "X,CH2,Start,Increment,\nSequence,Volt,{first:e},{interval:e}\n{}",
                record.rows(|point, _, volts| format!("{point},{volts},"), digits)
            ),
            2 => format!(
                "Record Length,Analog:{}\nSample Interval,Analog:{interval:e}\nVertical Units,CH2:V\nVertical Scale,CH2:{}\n\
                 Vertical Offset,CH2:0.0\nHorizontal Units,s\nHorizontal Scale,{:e}\nModel Number,SDS1202X-E\nSource,CH2\nSecond,Volt\n{}",
                record.codes.len(), record.scale, 100.0 * interval, plain(",")
            ),
            3 => format!("[s],CH2[V]\n{}", plain(",")),
            4 => format!("in s,C2 in V\n{}", plain(",")),
            5 => format!(
                "Format,1.0B\nMemory Length,{}\nSource,CH2\nProbe Ratio,1.0e+00\nVertical Units,V\nVertical Scale,{}\n\
                 Horizontal Units,S\nSampling Period,{interval:e}\nMode,Detail\nWaveform Data,\n{}",
                record.codes.len(), record.scale, plain(",").replace('\n', ",\n")
            ),
            6 => format!("#Digilent WaveForms Oscilloscope Acquisition\n#Device,AD2\n\nTime (s),Channel 2 (V)\n{}", plain(",")),
            7 => format!("Time,Channel B\n(s),(V)\n\n{}", plain(",")),
            _ => format!("Zeit [s]\tKanal 2 [V]\r\n{}", plain("\t").replace('.', ",").replace('\n', "\r\n")),
        };
        let found = read_all(text.as_bytes(), "lab.csv").unwrap_or_else(|error| panic!("{error}\n{text}"));
        prop_assert_eq!(found.len(), 1);
        let waveform = &found[0].waveform;
        prop_assert_eq!(waveform.source, Source::Channel(2), "{}", text);
        prop_assert_eq!((waveform.preamble.x_unit.as_str(), waveform.preamble.y_unit.as_str()), ("s", "V"));
        for (point, code) in record.codes.iter().enumerate() {
            let off = (waveform.time(point) - record.time(point)).abs();
            prop_assert!(off <= 1e-5 * interval * 41.0, "{}: {}\n{}", point, off, text);
            let volts = waveform.volts(point).unwrap();
            let largest = 5.2 * 2.0 * record.scale;
            prop_assert!((volts - record.volts(*code)).abs() <= 3e-5 * largest, "{}: {}\n{}", point, volts, text);
        }
    }

    /// Native records and spectra, with every spelling of a source: what is written is read, and
    /// written again byte for byte.
    #[test]
    fn native_variants_come_back_byte_for_byte(
        codes in proptest::collection::vec(-128_i16..=127, 2500),
        (power, digit, spectrum) in (2..10_i32, 0..3_usize, any::<bool>()),
        (scale, level, trigger) in (0..9_usize, -200..200_i32, -3000..6000_i32),
        spelling in prop::sample::select(vec!["", "FFT", "REF1", "REF2", "REF3", "REF4"]),
    ) {
        let rate = [1.0, 2.5, 5.0][digit] * 10f64.powi(power);
        let mut capture = if spectrum {
            let slow = if rate <= 1e6 { 100.0 / 99.0 } else { 1.0 };
            let interval = rate * slow / 2048.0;
            fft(interval, 250.0 * interval, -20.9691, codes[..1024].to_vec())
        } else {
            let scale = [2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.2, 0.5, 5.0][scale];
            record(&Setup { scale, probe: 10.0, position_levels: level, interval: 1.0 / rate, trigger_point: f64::from(trigger) }, codes)
        };
        capture.instrument = Some(instrument("TDS2024C", "C1", "FV:v24.18"));
        let Ok(text) = write(&capture) else { return Ok(()) };
        let source = capture.waveform.source.to_string();
        let text = match spelling {
            "" => text,
            "FFT" if !spectrum => text,
            other => text.replacen(&format!("\nSource,{source},"), &format!("\nSource,{other},"), 1),
        };
        let back = read(text.as_bytes(), "F.CSV").unwrap_or_else(|error| panic!("{error}\n{}", &text[..400]));
        prop_assert_eq!(&back.waveform.codes, &capture.waveform.codes);
        prop_assert_eq!(write(&back).expect("as written"), text);
    }
}
