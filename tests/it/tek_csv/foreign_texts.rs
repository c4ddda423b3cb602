//! Texts of the foreign dialects, made from made-up records as the fact sheet's section 4.3 shows
//! them.

use std::fmt::Write as _;

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::write;

/// Key, value, time and volts of each row of the native text.
fn native_rows(capture: &Capture) -> Vec<[String; 4]> {
    let text = write(capture).expect("writable");
    let cell = |line: &str, index: usize| {
        line.split(',').nth(index).expect("six fields").trim().to_owned()
    };
    text.lines().map(|line| [0, 1, 3, 4].map(|index| cell(line, index))).collect()
}

/// A number as a spreadsheet's general format shows it.
fn shortened(text: &str) -> String {
    text.parse::<f64>().map_or(text.to_owned(), |value| (value + 0.0).to_string())
}

/// A header's number with two decimals and exponent: `2.50E+03`.
fn two_decimals(text: &str) -> String {
    let Ok(value) = text.parse::<f64>() else { return text.to_owned() };
    let text = format!("{value:.2E}");
    let (mantissa, power) = text.split_once('E').expect("an exponent");
    let power: i32 = power.parse().expect("a number");
    format!("{mantissa}E{}{:02}", if power < 0 { '-' } else { '+' }, power.abs())
}

/// X1b: re-saved by a spreadsheet, no comma at the end of a row.
pub(super) fn spreadsheet(capture: &Capture) -> String {
    native_rows(capture).iter().fold(String::new(), |mut text, [key, value, time, volts]| {
        let (value, time, volts) = (two_decimals(value), shortened(time), shortened(volts));
        let _ = writeln!(text, "{key},{value},,{time},{volts}");
        text
    })
}

/// The same where a comma is the decimal mark.
pub(super) fn with_semicolons(text: &str) -> String {
    let comma = |cell: &str| match cell.trim().parse::<f64>() {
        Ok(_) => cell.replace('.', ","),
        Err(_) => cell.to_owned(),
    };
    text.split_inclusive('\n').fold(String::new(), |rows, line| {
        rows + &line.split(',').map(comma).collect::<Vec<_>>().join(";")
    })
}

/// The same with every number in quotes, and commas on both duties.
pub(super) fn with_quotes(text: &str) -> String {
    let quoted = |cell: &str| match cell.parse::<f64>() {
        Ok(_) => format!("\"{}\"", cell.replace('.', ",")),
        Err(_) => cell.to_owned(),
    };
    text.lines().fold(String::new(), |rows, line| {
        rows + &line.split(',').map(quoted).collect::<Vec<_>>().join(",") + "\r\n"
    })
}

/// X3: samples alone.
pub(super) fn headerless(capture: &Capture) -> String {
    native_rows(capture).iter().fold(String::new(), |mut text, [_, _, time, volts]| {
        let _ = write!(text, "{},{}\r\n", shortened(time), shortened(volts));
        text
    })
}

/// A number through single precision, as D2 prints it: nine digits and an exponent that 3 divides.
fn engineering(value: f64) -> String {
    let single = f64::from(value as f32);
    if single == 0.0 {
        return "0.0".to_owned();
    }
    let power = (single.abs().log10() / 3.0).floor() as i32 * 3;
    match power {
        0 => format!("{single:.8}"),
        _ => format!("{:.9}E{power}", single / 10_f64.powi(power)),
    }
}

/// D2: channels side by side, unit words, single precision.
pub(super) fn openchoice(captures: &[Capture]) -> String {
    let mut text = String::new();
    let length = captures[0].waveform.codes.len();
    for index in 0..length {
        for capture in captures {
            let waveform = &capture.waveform;
            let zero = waveform.vertical.position * waveform.vertical.scale;
            let (key, value, unit) = match index {
                0 => ("Record Length", length.to_string(), "Points"),
                1 => ("Sample Interval", format!("{:.6E}", waveform.preamble.x_incr), "s"),
                2 => ("Trigger Point", engineering(waveform.trigger_point), "Samples"),
                6 => ("Source", waveform.source.to_string(), ""),
                7 => ("Vertical Units", "Volts".to_owned(), ""),
                8 => ("Vertical Scale", engineering(waveform.vertical.scale), ""),
                9 => ("Vertical Offset", "0".to_owned(), ""),
                10 => ("Horizontal Units", "s".to_owned(), ""),
                11 => ("Horizontal Scale", engineering(waveform.horizontal_scale), ""),
                12 => ("Pt Fmt", "Y".to_owned(), ""),
                13 => ("Yzero", engineering(zero), ""),
                14 => ("Probe Atten", "10.00000".to_owned(), ""),
                16 => ("Note", "TDS 1002B - 3:31:27 PM   3/2/2023".to_owned(), ""),
                _ => ("", String::new(), ""),
            };
            let time = engineering(waveform.time(index));
            let volts = engineering(waveform.volts(index).expect("inside"));
            let _ = write!(text, "{key},{value},{unit},{time},{volts},,");
        }
        assert_eq!(text.pop(), Some(','), "the last channel has one comma fewer");
        text.push_str("\r\n");
    }
    text
}

/// D3: a header of its own, then names and samples; `volts` are printed as given.
pub(super) fn newer(scales: &[f64], volts: &[Vec<String>]) -> String {
    let each =
        |value: &dyn Fn(usize) -> String| (0..volts.len()).map(value).collect::<Vec<_>>().join(",");
    let points = volts[0].len();
    let mut text = format!(
        "Model,TBS1102C\nFirmware Version,v1.29.38\n\nPoint Format,Y,\nHorizontal Units,S,\n\
         Horizontal Scale,4e-06,\nSample Interval,3.2e-08,\nFilter Frequency,2e+08,\nRecord Length,{points},\n\
         Gating,{},\nProbe Attenuation,{}\nVertical Units,{}\nVertical Offset,{}\nVertical Scale,{}\nLabel,,\nTIME,{}\n",
        each(&|_| "0.0% to 100.0%".to_owned()),
        each(&|channel| format!("{}", 10_u32.pow(u32::try_from(channel).expect("few")))),
        each(&|_| "V".to_owned()),
        each(&|channel| format!("{channel}")),
        each(&|channel| format!("{}", scales[channel])),
        each(&|channel| format!("CH{}", channel + 1)),
    );
    for index in 0..points {
        let time = -2.88e-6 + index as f64 * 3.2e-8;
        let cells: Vec<&str> = volts.iter().map(|channel| channel[index].as_str()).collect();
        let _ = writeln!(text, "{time:.3e},{}", cells.join(","));
    }
    text
}
