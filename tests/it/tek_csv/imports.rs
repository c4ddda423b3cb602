//! The forms in which other instruments, programs and people save records: each is read with its
//! right values, or refused with what is missing. Values are those that the texts are made of.

use std::fmt::Write as _;

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::{TableColumns, read, read_all, read_columns, write};
use hertzscope::scope::Source;

/// A pulse in steps of 40 mV, as ten samples at 1 µs from -2 µs on.
pub(super) const PULSE: [f64; 10] = [0.0, 0.0, 0.04, 0.2, 1.0, 2.4, 1.6, 0.6, 0.12, 0.0];

pub(super) fn read_text(text: &str) -> Vec<Capture> {
    read_all(text.as_bytes(), "table.csv").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refusal(text: &str) -> String {
    match read_all(text.as_bytes(), "table.csv") {
        Err(error) => error.to_string(),
        Ok(found) => panic!("read as {found:?}\n{text}"),
    }
}

/// Rows of times from -2 µs on and the pulse, by `row`.
fn rows(row: impl Fn(usize, f64, f64) -> String) -> String {
    PULSE.iter().enumerate().map(|(n, volts)| row(n, n as f64 - 2.0, *volts) + "\n").collect()
}

fn plain() -> String {
    rows(|_, t, v| format!("{:.7},{v:.2}", t * 1e-6))
}

/// That `capture` is `values`, a `step` apart from `start` on, within a millionth of a step and a
/// ten-thousandth of the largest.
pub(super) fn is(capture: &Capture, source: Source, (start, step): (f64, f64), values: &[f64]) {
    let waveform = &capture.waveform;
    assert_eq!(waveform.source, source);
    assert_eq!(waveform.codes.len(), values.len());
    assert!((waveform.preamble.x_incr / step - 1.0).abs() < 1e-6, "{}", waveform.preamble.x_incr);
    assert!((waveform.time(0) - start).abs() < 1e-6 * step, "{} for {start}", waveform.time(0));
    let largest = values.iter().fold(0f64, |most, value| most.max(value.abs()));
    for (index, value) in values.iter().enumerate() {
        let found = waveform.volts(index).expect("inside");
        assert!((found - value).abs() <= 1e-4 * largest, "point {index}: {found} for {value}");
    }
}

const PULSE_TIMES: (f64, f64) = (-2e-6, 1e-6);

#[test]
fn a_peak_detect_column_is_left_out() {
    let head = "Model,MSO2014\nFirmware Version,1.0\n\nPoint Format,Y,\nHorizontal Units,S,\n\
        Horizontal Scale,1e-06,\nSample Interval,1e-06,\nRecord Length,10,\nProbe Attenuation,1,\nVertical Units,V,\n\
        Vertical Offset,0,\nVertical Scale,1,\nLabel,,\nTIME,CH1,CH1 Peak Detect\n";
    let found = read_text(&format!(
        "{head}{}",
        rows(|n, t, v| format!(
            "{:.5e},{v},{}",
            t * 1e-6,
            v + if n % 2 == 0 { -0.04 } else { 0.04 }
        ))
    ));
    assert_eq!(found.len(), 1);
    is(&found[0], Source::Channel(1), PULSE_TIMES, &PULSE);
    let said = "column 3 `CH1 Peak Detect` is no channel and is left out";
    assert!(found[0].notes.iter().any(|note| note == said), "{:?}", found[0].notes);
    assert_eq!(found[0].instrument.as_ref().map(|i| i.model.as_str()), Some("MSO2014"));
    // Two channels with one value of each key for a channel, and the same header without its model.
    let two = head
        .replace("Model,MSO2014\n", "")
        .replace("Scale,1,", "Scale,1,2")
        .replace("Peak Detect\n", "Peak Detect,CH2,CH2 Peak Detect\n");
    let found = read_text(&format!(
        "{two}{}",
        rows(|_, t, v| format!("{:.5e},{v},{v},{},{}", t * 1e-6, 2.0 * v, 2.0 * v))
    ));
    assert_eq!(found.len(), 2);
    is(&found[1], Source::Channel(2), PULSE_TIMES, &PULSE.map(|v| 2.0 * v));
    assert_eq!(found.iter().map(|c| c.waveform.vertical.scale).collect::<Vec<_>>(), [1.0, 2.0]);
}

/// 7.711 µs an interval, printed in whole microseconds: the end rows alone give 7.667 µs, which
/// misses no row either.
#[test]
fn rounded_times_are_even() {
    let found =
        read_text("TIME,CH1\n-0.000006,0.00\n0.000001,0.04\n0.000009,0.08\n0.000017,0.12\n");
    let interval = found[0].waveform.preamble.x_incr;
    assert!((interval - 7.711e-6).abs() < 0.35e-6, "{interval}");
    let bounds = found[0].notes.iter().find(|note| note.contains("by the printed digits"));
    // (17 - 0.5 - 1 - 0.5)/2 and 1 + 0.5 + 6 + 0.5 microseconds.
    let told = |note: &String| note.contains("between 7.500 µs and 8.000 µs");
    assert!(bounds.is_some_and(told), "{:?}", found[0].notes);
    // The same over 400 rows: five digits of the interval are known.
    let long = (0..400).fold("TIME,CH1\n".to_owned(), |mut text, n| {
        let _ =
            writeln!(text, "{:.6},{:.2}", f64::from(n) * 7.711e-6 - 6e-6, f64::from(n % 7) * 0.04);
        text
    });
    let interval = read_text(&long)[0].waveform.preamble.x_incr;
    assert!((interval / 7.711e-6 - 1.0).abs() < 4e-4, "{interval}");
    // A missing row in times as coarse as the interval is no rounding.
    let error = refusal("TIME,CH1\n0,0\n1,1\n2,2\n4,3\n5,4\n6,5\n7,6\n");
    assert!(error.contains("line 5, column 1") && error.contains("even spacing"), "{error}");
    // A row that is off by more than its digits is named.
    let error = refusal("TIME,CH1\n0.00,0\n0.01,1\n0.02,2\n0.05,3\n0.04,4\n0.05,5\n0.06,6\n");
    assert!(error.contains("line 5, column 1") && error.contains("even spacing"), "{error}");
}

#[test]
fn tables_of_other_makers() {
    let one = |separator: &str| rows(|_, t, v| format!("{:+.6E}{separator}{v:+.6E}", t * 1e-6));
    let milli = rows(|_, t, v| format!("{:.6},{:.3}", t * 1e-3, v * 1e3));
    for (what, text) in [
        ("Keysight", format!("x-axis,1\nsecond,Volt\n{}", one(","))),
        (
            "Rigol",
            format!(
                "X,CH1,Start,Increment,\nSequence,Volt,-2.0e-06,1.0e-06\n{}",
                rows(|n, _, v| format!("{n},{v:.2e},"))
            ),
        ),
        (
            "Rigol MSO",
            format!(
                "CH1V,t0 = -2.0e-06,tInc = 1.0e-06,\n{}",
                rows(|_, _, v| format!("{v:.2e},,,"))
            ),
        ),
        ("Rigol DHO", format!("Time(s),CH1V\n{}", one(","))),
        (
            "Siglent",
            format!(
                "Record Length,Analog:10\nSample Interval,Analog:0.000001000\nVertical Units,CH1:V\nVertical Scale,CH1:1.00\n\
            Vertical Offset,CH1:0.00000\nHorizontal Units,s\nHorizontal Scale,0.00025\nModel Number,SDS1202X-E\nSerial Number,SDS1\n\
            Software Version,1.3.26\nSource,CH1\nSecond,Volt\n{}",
                one(",")
            ),
        ),
        ("R&S HMO", format!("[s],CH1[V]\n{}", one(","))),
        ("R&S RTB", format!("in s,C1 in V\n{}", one(","))),
        (
            "Instek",
            format!(
                "Format,1.0B\nMemory Length,10\nTrigger Level,0.0\nSource,CH1\nProbe Ratio,1.000e+00\nVertical Units,V\n\
            Vertical Scale,1.000e+00\nHorizontal Units,S\nHorizontal Scale,2.5e-04\nSampling Period,1.000e-06\nFirmware,V1.00\nMode,Detail\nWaveform Data,\n{}",
                one(",").replace('\n', ",\n")
            ),
        ),
        (
            "LeCroy",
            format!(
                "LECROYWS434,12345,Waveform\nSegments,1,SegmentSize,10\nSegment,TrigTime,TimeSinceSegment1\n#1,01-Jan-2012 01:02:03,0\nTime,Ampl\n{}",
                one(",")
            ),
        ),
        ("PicoScope", format!("Time,Channel A\n(ms),(mV)\n\n{milli}")),
        (
            "Digilent",
            format!(
                "#Digilent WaveForms Oscilloscope Acquisition\n\nTime (s),Channel 1 (V)\n{}",
                one(",")
            ),
        ),
        ("tabs", format!("time\tch1\n{}", one("\t"))),
        ("spaces", format!("t(s)   CH1(V)\n{}", one("   "))),
        (
            "semicolons",
            format!("Zeit [ms];CH1 [mV]\n{}", milli.replace(',', ";").replace('.', ",")),
        ),
    ] {
        let found = read_text(&text);
        assert_eq!(found.len(), 1, "{what}");
        is(&found[0], Source::Channel(1), PULSE_TIMES, &PULSE);
        assert_eq!(found[0].waveform.preamble.y_unit, "V", "{what}");
    }
}

#[test]
fn what_a_file_tells_is_not_said_to_be_missing() {
    let two = |separator: &str| {
        rows(|_, t, v| format!("{:+.6E}{separator}{v:+.6E}{separator}{:+.6E}", t * 1e-6, 2.0 * v))
    };
    let one = |separator: &str| rows(|_, t, v| format!("{:+.6E}{separator}{v:+.6E}", t * 1e-6));
    let found = read_text(&format!("x-axis,1,2\nsecond,Volt,Volt\n{}", two(",")));
    assert_eq!(found.len(), 2);
    is(&found[1], Source::Channel(2), PULSE_TIMES, &PULSE.map(|v| 2.0 * v));
    let stated = "not given in the file";
    assert!(
        !found[1].notes.iter().any(|n| n.starts_with("unit") && n.ends_with(stated)),
        "{:?}",
        found[1].notes
    );
    // What a file tells of model, scale and interval is not said to be missing.
    let siglent = read_text(&format!(
        "Sample Interval,Analog:0.000001\nVertical Scale,CH1:1.00\nModel Number,SDS1\nSource,CH1\nSecond,Volt\n{}",
        one(",")
    ));
    assert!(
        !siglent[0]
            .notes
            .iter()
            .any(|n| n.contains("interval") || n.contains("scale") || n.contains("source")),
        "{:?}",
        siglent[0].notes
    );
}

#[test]
fn line_ends_and_encodings() {
    let text = format!("TIME,CH2\n{}", plain());
    let found = read_text(&text.replace('\n', "\r"));
    is(&found[0], Source::Channel(2), PULSE_TIMES, &PULSE);
    let mut wide = vec![0xFF, 0xFE];
    wide.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
    is(&read_all(&wide, "t.csv").expect("UTF-16")[0], Source::Channel(2), PULSE_TIMES, &PULSE);
    // A Latin-1 degree sign in a note above the table.
    let latin = [b"at 21 \xB0C\n".as_slice(), text.as_bytes()].concat();
    let found = read_all(&latin, "t.csv").expect("Latin-1");
    is(&found[0], Source::Channel(2), PULSE_TIMES, &PULSE);
    assert!(found[0].notes.iter().any(|note| note.contains("Latin-1")), "{:?}", found[0].notes);
}

/// The second `t2` of a public file was read as volts.
#[test]
fn captures_side_by_side_have_their_own_times() {
    let text = rows(|_, t, v| format!("{:.7},{v:.2},,{:.7},{:.2}", t * 1e-6, t * 2e-6, -v));
    for names in [
        "t1,v1,,t2,v2",
        "Time,CH1,,Time,CH2",
        "time (s),CH1 (V),,time (s).1,CH2 (V)",
        "x1,y1,,x2,y2",
    ] {
        let found = read_text(&format!("{names}\n{text}"));
        assert_eq!(found.len(), 2, "{names}");
        is(&found[0], Source::Channel(1), PULSE_TIMES, &PULSE);
        is(&found[1], Source::Channel(2), (-4e-6, 2e-6), &PULSE.map(|v| -v));
    }
    // The same channel twice: the second one has the next free number, and says so.
    let found = read_text(&format!("Time,CH1,,Time,CH1\n{text}"));
    assert_eq!(found[1].waveform.source, Source::Channel(2));
    assert!(found[1].notes.iter().any(|note| note == "a second CH1 taken as CH2"));
    // A capture that ends earlier.
    let short: String = text
        .lines()
        .enumerate()
        .map(|(n, line)| {
            if n < 6 {
                format!("{line}\n")
            } else {
                format!("{},,,\n", line.split(",,").next().unwrap())
            }
        })
        .collect();
    let found = read_text(&format!("t1,v1,,t2,v2\n{short}"));
    is(
        &found[1],
        Source::Channel(2),
        (-4e-6, 2e-6),
        &PULSE[..6].iter().map(|v| -v).collect::<Vec<_>>(),
    );
    // A math trace as a second block.
    let found = read_text(&format!("TIME,CH1,,TIME,MATH<CH1*CH2>\n{text}"));
    assert_eq!(found[1].waveform.source, Source::Math);
    // Without names it cannot be told whether the third column holds times or a ramp.
    assert!(refusal(&text).contains("columns 1 and 4 are evenly spaced"), "{}", refusal(&text));
}

#[test]
fn columns_that_count_rows_are_left_out() {
    let text = |row: fn(usize, f64, f64) -> String| rows(row);
    for (names, body) in [
        (",sec,Volt1", text(|n, t, v| format!("{n},{:.7},{v:.2}", t * 1e-6))),
        ("Unnamed: 0,Time (s),CH1", text(|n, t, v| format!("{n},{:.7},{v:.2}", t * 1e-6))),
        (
            "sample,time,ch1,ch1s",
            text(|n, t, v| format!("{},{:.7},{v:.2},{:.0}", n + 1, t * 1e-6, v * 25.0)),
        ),
        ("foo,Time (us),CH1", text(|n, t, v| format!("{n},{t},{v:.2}"))),
        ("CH1,Time,n", text(|n, t, v| format!("{v:.2},{:.7},{n}", t * 1e-6))),
        ("time,CH1,label", text(|_, t, v| format!("{:.7},{v:.2},idle", t * 1e-6))),
    ] {
        let found = read_text(&format!("{names}\n{body}"));
        assert_eq!(found.len(), 1, "{names}");
        is(&found[0], Source::Channel(1), PULSE_TIMES, &PULSE);
        assert!(
            found[0].notes.iter().any(|note| note.ends_with("left out")),
            "{names}: {:?}",
            found[0].notes
        );
    }
    // Without any name, an index and times are both even.
    let error = refusal(&rows(|n, t, v| format!("{n},{:.7},{v:.2}", t * 1e-6)));
    assert!(
        error.contains("columns 1 and 2 are evenly spaced") && error.contains("--columns"),
        "{error}"
    );
}

#[test]
fn units_of_names_are_never_taken_for_volts_or_seconds() {
    let body = plain();
    for (names, step, unit, factor) in [
        ("Time (s),CH1 (V)", 1e-6, "V", 1.0),
        ("Time (msec),CH1 (mV)", 1e-9, "V", 1e-3),
        ("t [ms],F [N]", 1e-9, "N", 1.0),
        ("t/us,F/kN", 1e-12, "N", 1e3),
        ("time_ns,Q (pC)", 1e-15, "C", 1e-12),
        ("Time (min),a (g)", 6e-5, "g", 1.0),
        ("Time (minutes),CH1 (uV)", 6e-5, "V", 1e-6),
        ("Time (µs),I (mA)", 1e-12, "A", 1e-3),
    ] {
        let found = read_text(&format!("{names}\n{body}"));
        is(&found[0], Source::Channel(1), (-2.0 * step, step), &PULSE.map(|v| v * factor));
        assert_eq!(found[0].waveform.preamble.y_unit, unit, "{names}");
        let guessed = found[0].notes.iter().any(|note| note.starts_with("unit of"));
        assert!(!guessed, "{names}: {:?}", found[0].notes);
    }
    // Units of keys above the table have prefixes, too.
    let keys = "Model,X\nHorizontal Units,ms\nVertical Units,mV\nTIME,CH1\n";
    let found = read_text(&format!("{keys}{body}"));
    is(&found[0], Source::Channel(1), (-2e-9, 1e-9), &PULSE.map(|v| v * 1e-3));
    assert!(
        refusal(&keys.replace("mV", "torr").replace("TIME,CH1\n", &format!("TIME,CH1\n{body}")))
            .contains("`torr`")
    );
    // Remarks between the names and the samples.
    let found = read_text(&format!("Time (ms),CH1 (mV)\nhammer,run 3\n{body}"));
    is(&found[0], Source::Channel(1), (-2e-9, 1e-9), &PULSE.map(|v| v * 1e-3));
    // A row of units of its own.
    let found = read_text(&format!("Time,Force\n(ms),(N)\n{body}"));
    assert_eq!(found[0].waveform.preamble.y_unit, "N");
    for (names, what) in [
        ("Time (s),p (torr)", "`torr`"),
        ("Time (fortnight),CH1 (V)", "`fortnight`"),
        ("Time (s),Force", "is no voltage"),
        ("t,F", "is no voltage"),
        ("Time (s),Temperature", "is no voltage"),
        ("Time (s),", "no name"),
    ] {
        let error = refusal(&format!("{names}\n{body}"));
        assert!(error.contains(what) && error.contains("--columns"), "{names}: {error}");
    }
    // Beside a channel, such a column is left out, and named.
    let both = rows(|_, t, v| format!("{:.7},{v:.2},{:.1}", t * 1e-6, 20.0 + v));
    let found = read_text(&format!("Time (s),CH1,T (°C)\n{both}"));
    assert_eq!(found.len(), 1);
    assert!(found[0].notes.iter().any(|note| note.contains("`°C`")), "{:?}", found[0].notes);
}

#[test]
fn channels_have_the_numbers_of_their_names() {
    let found = read_text(&format!("Time (s),Channel 3 (V)\n{}", plain()));
    is(&found[0], Source::Channel(3), PULSE_TIMES, &PULSE);
    let found = read_text(&format!(
        "TIME,CH5,CH6,CH7,CH8,MATH,REF1\n{}",
        rows(|_, t, v| format!("{:.7},{v:.2},{v:.2},{v:.2},{v:.2},{v:.2},{v:.2}", t * 1e-6))
    ));
    let sources: Vec<String> = found.iter().map(|c| c.waveform.source.to_string()).collect();
    assert_eq!(sources, ["CH5", "CH6", "CH7", "CH8", "MATH", "REFA"]);
}

/// 145 samples at the ceiling, zero three divisions below the centre: (127 + 75) 40 mV = 8.08 V.
#[test]
fn a_stated_position_shows_clipping() {
    let head = "Model,MDO3014\nFirmware Version,1.20\n\nWaveform Type,ANALOG\nPoint Format,Y\nHorizontal Units,s\n\
        Horizontal Scale,1e-04\nSample Interval,4e-07\nRecord Length,400\nGating,0.0% to 100.0%\nProbe Attenuation,10\n\
        Vertical Units,V\nVertical Offset,0\nVertical Scale,1\nVertical Position,-3\n,\nLabel,\nTIME,CH1\n";
    let volts = |n: u32| (12.0 * (f64::from(n) * 0.01).sin()).clamp(0.0, 8.08);
    let level = |n: u32| (volts(n) * 25.0).round() / 25.0;
    let text = (0..400).fold(head.to_owned(), |mut text, n| {
        let _ = writeln!(text, "{:.7e},{}", f64::from(n) * 4e-7 - 2.5e-5, level(n));
        text
    });
    let found = read_text(&text);
    let waveform = &found[0].waveform;
    let flat = (0..400).filter(|n| level(*n) >= 8.08).count();
    assert!(flat > 100);
    assert_eq!((waveform.vertical.position, waveform.clipped()), (-3.0, flat));
    assert_eq!(found[0].notes, [""; 0]);
}

#[test]
fn frames_are_counted_and_refused() {
    let text = format!(
        "Model,MSO4034\nSample Interval,1e-06\nFastFrame Count,3\nTIME,CH1\n{0}{0}{0}",
        plain()
    );
    let error = refusal(&text);
    assert!(error.contains("3 frames"), "{error}");
}

#[test]
fn what_fits_nothing_names_the_nearest_form() {
    for (text, words) in [
        ("a,b\nc,d\n".to_owned(), ["a table with a column of times", "rows of numbers"]),
        ("x-axis,1\nsecond,Volt\none,two\n".to_owned(), ["Keysight", "a column of times"]),
        ("5\n6\n7\n".to_owned(), ["a table with", "a column of times"]),
        (
            "0,001,1,5\n0,002,1,6\n0,003,1,4\n0,004,1,2\n".to_owned(),
            ["a table with", "decimal points"],
        ),
    ] {
        let error = refusal(&text);
        for word in words.into_iter().chain(["--columns time=1:ms,CH1=2:V"]) {
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}

/// Values beyond the range, which `PicoScope` writes as infinite, are in `impact_labs`.
#[test]
fn a_cell_without_a_number_is_named() {
    let body = "-5.0,1.2\n-4.9,???\n-4.8,1.3\n-4.7,1.1\n";
    let error = refusal(&format!("Time,Channel A\n(ms),(mV)\n\n{body}"));
    assert!(error.contains("line 5, column 6") && error.contains("`???`"), "{error}");
}

#[test]
fn columns_that_the_user_names() {
    let text = rows(|n, t, v| format!("{n},{t},{:.0},{v:.2}", v * 1e3));
    let columns: TableColumns = "time=2:us,CH2=3:mV,p14=4:N".parse().expect("columns");
    let found = read_columns(text.as_bytes(), "t.csv", &columns).expect("a table");
    assert_eq!(found.len(), 2);
    is(&found[0], Source::Channel(2), PULSE_TIMES, &PULSE);
    assert_eq!(found[0].waveform.preamble.y_unit, "V");
    is(&found[1], Source::Channel(1), PULSE_TIMES, &PULSE);
    assert_eq!(found[1].waveform.preamble.y_unit, "N");
    assert!(found[1].notes.iter().any(|note| note == "column 4 is p14"), "{:?}", found[1].notes);
    for (text, word) in [
        ("time=1,t=2,CH1=3", "2 columns of times"),
        ("time=1", "1 in all"),
        ("time=1,CH1", "no `=`"),
        ("time=0,CH1=2", "counted from 1"),
        ("time=1:V,CH1=2", "no unit of `time`"),
        ("time=1,CH1=2:torr", "`torr`"),
    ] {
        let error = text.parse::<TableColumns>().expect_err(text);
        assert!(error.contains(word) && error.contains("time=1:ms"), "{error}");
    }
    let error = read_columns(text.as_bytes(), "t.csv", &"time=2:us,CH1=9".parse().unwrap())
        .expect_err("no column 9");
    assert!(error.to_string().contains("a column 9"), "{error}");
    // Without a column of times, the interval must be said.
    let columns: TableColumns = "CH2=3:mV".parse().expect("columns");
    let error = read_columns(text.as_bytes(), "t.csv", &columns).expect_err("no times");
    assert!(error.to_string().contains("--interval"), "{error}");
    let mut spaced = columns;
    spaced.interval = Some(1e-6);
    let found = read_columns(text.as_bytes(), "t.csv", &spaced).expect("values");
    is(&found[0], Source::Channel(2), (0.0, 1e-6), &PULSE);
}

/// The firmware rounds 4882.8125 Hz half up, where C rounds it half to even; some models spell
/// sources otherwise.
#[test]
fn native_spectra_and_spellings_come_back_byte_for_byte() {
    use super::made_up::{fft, plain_record, ramp_after};
    for (rate, interval) in [(1e7, "4.882813e+03"), (1e8, "4.882813e+04"), (1e9, "4.882813e+05")] {
        let text =
            write(&fft(rate / 2048.0, 250.0 * rate / 2048.0, -20.9691, ramp_after(&[], 1024)))
                .expect("writable");
        assert!(text.contains(&format!("\nSample Interval,{interval},,")), "{}", &text[..200]);
        let back = read(text.as_bytes(), "F.CSV").expect("native");
        assert_eq!(back.waveform.preamble.x_incr, rate / 2048.0);
        assert_eq!(write(&back).expect("writable"), text);
        let spelled = text.replace("\nSource,MATH,", "\nSource,FFT,");
        let back = read(spelled.as_bytes(), "F.CSV").expect("native");
        assert_eq!(back.waveform.source, Source::Math);
        assert_eq!(write(&back).expect("as written"), spelled);
    }
    let text = write(&plain_record()).expect("writable").replace("\nSource,CH1,", "\nSource,REF1,");
    let back = read(text.as_bytes(), "F.CSV").expect("native");
    assert_eq!(back.waveform.source, Source::Reference('A'));
    assert_eq!(write(&back).expect("as written"), text);
}
