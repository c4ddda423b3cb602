//! Tables as impact labs have them: channels counted from zero, units of shock, strain and
//! pressure, rows without values, second tables below, times without an interval or uneven. The
//! values are those that the texts are made of; whole files of each class stand in the folder that
//! the environment variable `HERTZSCOPE_IMPORTS` names.

use std::fmt::Write as _;
use std::path::PathBuf;

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::{TableColumns, read_all, read_columns, write};
use hertzscope::scope::Source;

use super::imports::is;

/// Two records of ten samples.
const V: [f64; 10] = [0.0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.0, 1.6, 1.2];
const W: [f64; 10] = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1];

const CH1: Source = Source::Channel(1);
const CH2: Source = Source::Channel(2);

fn found(text: &str) -> Vec<Capture> {
    read_all(text.as_bytes(), "table.csv").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refusal(text: &str) -> String {
    match read_all(text.as_bytes(), "table.csv") {
        Err(error) => error.to_string(),
        Ok(found) => panic!("read as {found:?}\n{text}"),
    }
}

/// With an interval of the user, or resampled.
fn with(text: &str, interval: Option<f64>, resample: bool) -> Vec<Capture> {
    let mut columns = TableColumns::default();
    (columns.interval, columns.resample) = (interval, resample);
    read_columns(text.as_bytes(), "table.csv", &columns)
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn rows(row: impl Fn(usize) -> String) -> String {
    (0..10).map(|n| row(n) + "\n").collect()
}

/// Times from 0 in steps of 1 µs, and both records.
fn two() -> String {
    rows(|n| format!("{:.6},{:.2},{:.2}", n as f64 * 1e-6, V[n], W[n]))
}

fn says(captures: &[Capture], words: &str) {
    for capture in captures {
        let notes = capture.notes.join("\n");
        assert!(notes.contains(words), "expected `{words}` in {notes}");
    }
}

const MICRO: (f64, f64) = (0.0, 1e-6);

#[test]
fn channels_counted_from_zero_keep_the_order_of_their_columns() {
    for names in [
        "Time (s),Voltage_0 (V),Voltage_1 (V)",
        "Time (s),ch0 (V),ch1 (V)",
        "Time,Channel 0,Channel 1",
        "time,CHAN0,CHAN1",
        "Time,V_0,V_1",
        "t,v,v1",
        "Time,Volt,Volt1",
        "Time,Voltage,Voltage1",
        "Time,ch 0,ch 1",
        "Time (s),CH0 Voltage,CH1 Voltage",
    ] {
        let found = found(&format!("{names}\n{}", two()));
        assert_eq!(found.len(), 2, "{names}");
        is(&found[0], CH1, MICRO, &V);
        is(&found[1], CH2, MICRO, &W);
        says(&found, "numbered from CH1 in the order of their columns");
    }
    // A row of units in which pandas numbered what occurs twice.
    let found = found(&format!("x-axis,1,2\nsecond,Volt,Volt1\n{}", two()));
    is(&found[0], CH1, MICRO, &V);
    is(&found[1], CH2, MICRO, &W);
}

/// One value in each unit of an impact lab, in SI by its definition.
#[test]
fn units_of_impact_labs_are_read_wherever_they_stand() {
    let units = [
        ("V", "V", 1.0),
        ("mV", "V", 1e-3),
        ("A", "A", 1.0),
        ("g", "g", 1.0),
        ("m/s^2", "m/s^2", 1.0),
        ("m/s²", "m/s^2", 1.0),
        ("m/s2", "m/s^2", 1.0),
        ("mm/s", "m/s", 1e-3),
        ("µε", "m/m", 1e-6),
        ("ue", "m/m", 1e-6),
        ("um/m", "m/m", 1e-6),
        ("µm/m", "m/m", 1e-6),
        ("microstrain", "m/m", 1e-6),
        ("bar", "bar", 1.0),
        ("mbar", "bar", 1e-3),
        ("kPa", "Pa", 1e3),
        ("psi", "Pa", 6_894.757_293_168),
        ("N", "N", 1.0),
        ("kN", "N", 1e3),
        ("mm", "m", 1e-3),
        ("um", "m", 1e-6),
        ("pC", "C", 1e-12),
    ];
    let plain = rows(|n| format!("{:.1},{:.2}", n as f64, V[n]));
    let tabs = plain.replace(',', "\t");
    let beside = rows(|n| format!("{:.1},us,{:.2},UNIT", n as f64, V[n]));
    let own = rows(|n| format!("{:.1} us,{:.2} UNIT", n as f64, V[n]));
    for (text, unit, factor) in units {
        for form in [
            format!("Time (us),signal (UNIT)\n{plain}"),
            format!("Time [us],signal [UNIT]\n{plain}"),
            format!("Time/us,signal/UNIT\n{plain}"),
            format!("Time in us,signal in UNIT\n{plain}"),
            format!("Time,signal\nus,UNIT\n{plain}"),
            format!("Time,signal\n(us),(UNIT)\n{plain}"),
            format!("# Time (us),signal (UNIT)\n{plain}"),
            format!("# shot 7\n# Time,signal\n# us,UNIT\n{plain}"),
            format!("us,UNIT\nTime,signal\n{plain}"),
            format!("Time\tsignal\nus\tUNIT\n{tabs}"),
            format!("Vertical Units,UNIT\nTime (us),signal\n{plain}"),
            format!("Time,,signal,,\n{beside}"),
            format!("Time,signal\n{own}"),
        ] {
            let form = form.replace("UNIT", text);
            let found = found(&form);
            assert_eq!(found.len(), 1, "{form}");
            is(&found[0], CH1, MICRO, &V.map(|value| value * factor));
            assert_eq!(found[0].waveform.preamble.y_unit, unit, "{form}");
            assert!(!found[0].notes.iter().any(|note| note.starts_with("unit of")), "{form}");
        }
    }
}

/// As `numpy.savetxt` writes a header and three columns by default.
#[test]
fn units_in_brackets_belong_to_the_names_before_them() {
    let head = "# t [us]  a [g]  eps [um/m]\n";
    let body = rows(|n| format!("{:.18e} {:.18e} {:.18e}", n as f64, V[n], W[n]));
    let found = found(&format!("{head}{body}"));
    is(&found[0], CH1, MICRO, &V);
    is(&found[1], CH2, MICRO, &W.map(|value| value * 1e-6));
    let units: Vec<&str> = found.iter().map(|c| c.waveform.preamble.y_unit.as_str()).collect();
    assert_eq!(units, ["g", "m/m"]);
}

#[test]
fn unknown_units_are_never_volts() {
    for text in [
        format!("Time (s),p (torr),CH2 (V)\n{}", two()),
        format!("Time/s,p/torr,CH2/V\n{}", two()),
        format!("Time,p,CH2\ns,torr,V\n{}", two()),
        format!("Time,CH1,CH2\nsecond,Torricelli,Volt\n{}", two()),
        format!("Vertical Units,torr,V\nTIME,CH1,CH2\n{}", two()),
        format!("Model,MDO3014\nVertical Units,VV,V\nTIME,MATH,CH2\n{}", two()),
    ] {
        let found = found(&text);
        assert_eq!(found.len(), 1, "{text}");
        is(&found[0], CH2, MICRO, &W);
        says(&found, "left out");
    }
    let error = refusal(&format!("Time,p\ns,torr\n{}", rows(|n| format!("{n}e-6,{}", V[n]))));
    assert!(error.contains("`torr`") && error.contains("--columns"), "{error}");
    let mixed = "Time,CH1\n0 s,100 mV\n1 s,1.2 V\n2 s,300 mV\n3 s,400 mV\n";
    assert!(refusal(mixed).contains("line 3"), "{}", refusal(mixed));
}

#[test]
fn spectra_and_logic_lines_are_no_traces() {
    let spectrum = rows(|n| format!("{},Hz,{:.3},dBm,", 1000 + 100 * n, V[n] - 20.0));
    let volts = rows(|n| format!("{},{:.3}", 1000 + 100 * n, V[n]));
    for text in [
        format!("Trace1,\nFreq,,Amp,,\n{spectrum}"),
        format!("Frequency (Hz),CH1 (V)\n{volts}"),
        format!("Frequency,Amplitude\n{volts}"),
        format!("Freq (kHz),CH1\n{volts}"),
    ] {
        let error = refusal(&text);
        assert!(error.contains("spectrum") || error.contains("dBm"), "{error}");
    }
    let level = rows(|n| format!("{},{:.3}", 1000 + 100 * n, V[n] - 20.0));
    let decibels = found(&format!("Frequency (Hz),MATH (dB)\n{level}"));
    assert_eq!(decibels[0].waveform.preamble.x_unit, "Hz");
    let bits = rows(|n| format!("{:.6},{},{}", n as f64 * 1e-6, n % 2, n / 5));
    let error =
        refusal(&format!("Model,MSO64\nWaveform Type,DIGITAL\nTIME,REF1_D1,REF1_D0\n{bits}"));
    assert!(error.contains("logic"), "{error}");
    for names in ["Time [s],D0,D1", "TIME,REF1_D1,REF1_D0", "Time [s],Channel 0,Channel 1"] {
        refusal(&format!("{names}\n{bits}"));
    }
}

#[test]
fn a_first_column_that_is_no_time_is_refused() {
    let body = rows(|n| format!("{:.1},{:.2}", 20.0 + 0.5 * n as f64, V[n]));
    for names in [
        "Temperature,CH1",
        "Position,CH1",
        "Displacement (mm),Force (N)",
        "depth,signal",
        "foo,bar",
    ] {
        let error = refusal(&format!("{names}\n{body}"));
        assert!(error.contains("--columns"), "{error}");
    }
    // Indices are no times, wherever they begin.
    for (start, names) in [(0, ",CH1"), (5, "Index,CH1"), (17, "Unnamed: 0,CH1"), (100, "n,CH1")] {
        let text = format!("{names}\n{}", rows(|n| format!("{},{:.2}", n + start, V[n])));
        let error = refusal(&text);
        assert!(error.contains("--interval"), "{error}");
        let found = with(&text, Some(2e-6), false);
        is(&found[0], CH1, (0.0, 2e-6), &V);
    }
    // Beside times, indices from anywhere are left out.
    let text = rows(|n| format!("{},{:.6},{:.2}", n + 512, n as f64 * 1e-6, V[n]));
    let found = found(&format!("foo,Time,CH1\n{text}"));
    is(&found[0], CH1, MICRO, &V);
}

#[test]
fn tiny_numbers_are_numbers() {
    let mut values = V.map(|value| format!("{value:.2}"));
    values[0] = "1e-36".to_owned();
    values[9] = "-3.2E-45".to_owned();
    let text = rows(|n| format!("{:.6},{}", n as f64 * 1e-6, values[n]));
    let mut expected = V;
    expected[9] = 0.0;
    is(&found(&format!("Time,CH1\n{text}"))[0], CH1, MICRO, &expected);
}

#[test]
fn rows_without_values_at_the_ends_are_left_out() {
    let cell = |n: usize, value: f64, from: usize, to: usize| {
        if (from..to).contains(&n) { format!("{value:.2}") } else { String::new() }
    };
    let text = rows(|n| format!("{n}e-6,{},{}", cell(n, V[n], 3, 10), cell(n, W[n], 0, 8)));
    let found = found(&format!("x-axis,1,2\nsecond,Volt,Volt\n{text}"));
    is(&found[0], CH1, (3e-6, 1e-6), &V[3..]);
    is(&found[1], CH2, MICRO, &W[..8]);
    says(&found[..1], "the first 3 rows have no value");
    says(&found[1..], "the last 2 rows have no value");
    // A hole in the middle is no end.
    let text =
        rows(|n| format!("{n}e-6,{}", if n == 4 { String::new() } else { V[n].to_string() }));
    assert!(refusal(&format!("Time,CH1\n{text}")).contains("line 7"), "the row below the hole");
}

#[test]
fn a_second_table_below_is_left_out_and_named() {
    let first = rows(|n| format!("{n}e-6,{:.2}", V[n]));
    let below = rows(|n| format!("{n}e3,{:.2}", W[n] - 20.0));
    let wide = rows(|n| format!("{n}e-6,{:.2},{:.2}", W[n], W[n]));
    for rest in [
        format!("x-axis,F1\nHertz,decibel\n{below}"),
        format!("\n\nTIME,MATH<CH1*CH2>\n{below}"),
        format!("TIME,CH3,CH4\n{wide}"),
        "End of file\n".to_owned(),
    ] {
        let found = found(&format!("x-axis,1\nsecond,Volt\n{first}{rest}"));
        assert_eq!(found.len(), 1, "{rest}");
        is(&found[0], CH1, MICRO, &V);
        says(&found, "are left out: a second table or remarks");
    }
    // A row of words between samples is damage, not an end.
    let torn: String = two().lines().enumerate().fold(String::new(), |mut text, (n, line)| {
        let _ = writeln!(text, "{}", if n == 5 { "garbage,here,it is" } else { line });
        text
    });
    assert!(refusal(&format!("Time,CH1,CH2\n{torn}")).contains("line 7"));
}

/// Times of an interval of 4 µs from -20 ms on, through 32-bit floats: off by up to 0.9 ns.
#[test]
fn times_in_single_precision_are_even() {
    let time = |n: usize| f64::from((-0.02 + n as f64 * 4e-6) as f32);
    let text = rows(|n| format!("{:.11},{:.2}", time(n), V[n]));
    let read = found(&format!("Source,CH1\nSecond,Volt\n{text}"));
    let waveform = &read[0].waveform;
    assert!((waveform.preamble.x_incr / 4e-6 - 1.0).abs() < 1e-4, "{}", waveform.preamble.x_incr);
    assert!((waveform.time(0) + 0.02).abs() < 4e-9);
    says(&read, "single precision");
    // Over 4,000 rows the interval is known to a millionth.
    let text = (0..4000).fold("Time,CH1\n".to_owned(), |mut text, n| {
        let _ = writeln!(text, "{:.11},{:.2}", time(n), V[n % 10]);
        text
    });
    assert!((found(&text)[0].waveform.preamble.x_incr / 4e-6 - 1.0).abs() < 1e-6);
}

#[test]
fn values_without_times_take_an_interval() {
    let both = rows(|n| format!("{:.2},{:.2}", V[n], W[n]));
    let volts = rows(|n| format!("{:.2}", V[n]));
    let levels = rows(|n| format!("{}", (V[n] * 25.0).round()));
    // Start and increment in the row of units.
    let rigol =
        found(&format!("CH1,CH2,Start,Increment,\nVolt,Volt,-2.00000e-06,1.00000e-06\n{both}"));
    is(&rigol[0], CH1, (-2e-6, 1e-6), &V);
    is(&rigol[1], CH2, (-2e-6, 1e-6), &W);
    // The interval or rate in a header.
    for head in [
        "; Sample rate: 1 MHz\n; Sample count: 10\n 0, 1\n",
        "# Sampling Rate = 1 MSa/s\nCH1,CH2\n",
        "Sampling Period,1.000e-06\nCH1,CH2\n",
        "#Time interval :1.000uS\nCH1,CH2\n",
    ] {
        let found = found(&format!("{head}{both}"));
        assert_eq!(found.len(), 2, "{head}");
        is(&found[0], CH1, MICRO, &V);
        is(&found[1], CH2, MICRO, &W);
        says(&found, "the file has no times");
    }
    // OWON: an index, and the channel in front of its unit.
    let owon = rows(|n| format!("{n},{:.1}", V[n] * 1e3));
    let owon = found(&format!(
        "Channel :,CH1\nFrequency :,?\nTime interval :,1.00000uS\nindex,CH1_Voltage(mV)\n{owon}"
    ));
    is(&owon[0], CH1, MICRO, &V);
    // Instek: levels of the digitiser.
    let instek = found(&format!(
        "Memory Length,10\nSource,CH2\nVertical Units,V\nVertical Scale,1.000e+00\nSampling Period,1.000e-06\nWaveform Data,\n{levels}"
    ));
    is(&instek[0], CH2, MICRO, &V);
    // By the user, else refused with the option.
    for (text, count) in [(format!("CH1,CH2\n{both}"), 2), (volts, 1)] {
        let error = refusal(&text);
        assert!(error.contains("--interval"), "{error}");
        let found = with(&text, Some(1e-6), false);
        assert_eq!(found.len(), count);
        is(&found[0], CH1, MICRO, &V);
    }
}

#[test]
fn settings_beside_the_samples_are_read() {
    let beside = [
        "Memory Length,10",
        "Trigger Level,1.80E+01",
        "Source,CH2",
        "Probe,1.0X",
        "Vertical Units,V",
        "Vertical Scale,5.00E-01",
        "Vertical Position,0.00E+00",
        "Horizontal Units,S",
        "Horizontal Scale,5.00E-04",
        ",",
    ];
    let text = rows(|n| {
        let next = beside.get(n + 1).copied().unwrap_or(",");
        format!("{:.2E},{:.2E},,,,{next}", n as f64 * 2e-6, V[n])
    });
    let found = found(&format!("col 1,col 2,,,,{}\n{text}", beside[0]));
    assert_eq!(found.len(), 1);
    is(&found[0], CH2, (0.0, 2e-6), &V);
    assert_eq!(found[0].waveform.vertical.scale, 0.5);
}

#[test]
fn the_channel_in_a_files_name_is_its_channel() {
    let text = format!("time,signal\n{}", rows(|n| format!("{n}e-6,{:.2}", V[n])));
    for name in ["shot7_Ch3.csv", "F0001CH3.CSV", "C3Trace00012.csv"] {
        let found = read_all(text.as_bytes(), name).expect("a table");
        is(&found[0], Source::Channel(3), MICRO, &V);
    }
}

#[test]
fn values_beyond_the_range_count_as_clipped() {
    for mark in ["∞", "inf", "9.9E+37", "Over"] {
        let text = rows(|n| {
            let value = if n == 6 { mark.to_owned() } else { V[n].to_string() };
            format!("{n}e-6,{value}")
        });
        let found = found(&format!("Time,CH1\n(s),(V)\n{text}"));
        let waveform = &found[0].waveform;
        assert_eq!(waveform.clipped_points().collect::<Vec<_>>(), [6], "{mark}");
        for n in (0..10).filter(|n| *n != 6) {
            let volts = waveform.volts(n).expect("inside");
            assert!((volts - V[n]).abs() < 1e-4, "{n}: {volts}");
        }
        // Just above all others.
        let clipped = waveform.volts(6).expect("inside");
        assert!((2.0..2.01).contains(&clipped), "{clipped}");
    }
}

/// A straight line comes through resampling as a straight line, whatever the times.
#[test]
fn uneven_times_are_refused_or_resampled() {
    let time = |n: usize| 0.00201 * n as f64 + 2e-5 * (n as f64 * 1.7).sin();
    let text =
        (0..40).fold("\"Time (s)\",\"Acceleration x (m/s^2)\"\n".to_owned(), |mut text, n| {
            let _ = writeln!(text, "{:.6},{:.6}", time(n), 3.0 * time(n) - 1.0);
            text
        });
    let error = refusal(&text);
    assert!(error.contains("--resample") && error.contains("intervals are 1.9"), "{error}");
    let found = with(&text, None, true);
    let waveform = &found[0].waveform;
    assert_eq!((waveform.codes.len(), waveform.preamble.y_unit.as_str()), (40, "m/s^2"));
    assert!((waveform.preamble.x_incr - time(39) / 39.0).abs() < 1e-7);
    for n in 0..40 {
        let expected = 3.0 * waveform.time(n) - 1.0;
        let value = waveform.volts(n).expect("inside");
        assert!((value - expected).abs() < 2e-5, "{n}: {value}, expected {expected}");
    }
    says(&found, "resampled every 2.01");
    // Even times are not touched.
    let even = format!("Time,CH1,CH2\n{}", two());
    assert_eq!(with(&even, None, true), read_all(even.as_bytes(), "table.csv").expect("even"));
    // Times that go back are refused.
    let back = "Time,CH1\n0,1\n1,2\n0.5,3\n2,4\n3,5\n";
    let mut columns = TableColumns::default();
    columns.resample = true;
    let error = read_columns(back.as_bytes(), "t.csv", &columns).expect_err("back").to_string();
    assert!(error.contains("line 4"), "{error}");
}

#[test]
fn scales_are_in_the_units_above_the_table() {
    let text = format!(
        "Record Length,Analog:10\nSample Interval,CH1:0.000002\nVertical Units,CH1:V,,,\nVertical Scale,CH1:0.50,,,\n\
         Horizontal Units,us,,,\nHorizontal Scale,20000.0,,,\nModel Number,SDS1104X-E\nSource,CH1\nSecond,Volt\n{}",
        rows(|n| format!("{:.12},{:.5}", n as f64 * 2e-6, V[n]))
    );
    let found = found(&text);
    is(&found[0], CH1, (0.0, 2e-6), &V);
    assert_eq!(found[0].waveform.horizontal_scale, 0.02);
}

/// Headers of `LabVIEW Measurement` files, with and without a column of times.
#[test]
fn labview_measurements() {
    let head = |columns: &str| {
        format!(
            "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nX_Columns\t{columns}\nDate\t2024/01/01\nTime\t12:00:00\n***End_of_Header***\t\n\t\n\
             Channels\t2\t\t\nSamples\t10\t10\t\nY_Unit_Label\tVolts\tg\t\nX_Dimension\tTime\tTime\t\nX0\t0.0\t0.0\t\nDelta_X\t0.000100\t0.000100\t\n***End_of_Header***\t\t\t\n\
             X_Value\tVoltage_0\tAcceleration_0\tComment\n"
        )
    };
    let one = rows(|n| format!("{:.6}\t{:.6}\t{:.6}", n as f64 * 1e-4, V[n], W[n]));
    let no = rows(|n| format!("\t{:.6}\t{:.6}", V[n], W[n]));
    let comma = one.replace('.', ",");
    for text in [head("One") + &one, head("No") + &no, head("One") + &comma] {
        let found = found(&text);
        assert_eq!(found.len(), 2, "{text}");
        is(&found[0], CH1, (0.0, 1e-4), &V);
        is(&found[1], CH2, (0.0, 1e-4), &W);
        assert_eq!(found[0].waveform.preamble.y_unit, "V");
        assert_eq!(found[1].waveform.preamble.y_unit, "g");
    }
}

/// The files of each class, and what is right, as its page of the folder says.
#[test]
#[ignore = "needs HERTZSCOPE_IMPORTS"]
fn files_of_each_class_are_right() {
    let folder =
        PathBuf::from(std::env::var_os("HERTZSCOPE_IMPORTS").expect("a folder")).join("today");
    let bytes = |name: &str| std::fs::read(folder.join(name)).expect(name);
    let read = |name: &str| read_all(&bytes(name), name).unwrap_or_else(|error| panic!("{error}"));
    for (name, start, step) in [
        ("names_from_zero.csv", 0.0, 1e-6),
        ("ch0_dropped.csv", 0.0, 1e-6),
        ("rigol_no_x.csv", -2e-6, 1e-6),
        ("siglent_float32_times.csv", -0.02, 4e-6),
        ("labview_header.lvm", 0.0, 1e-4),
        ("keysight_ampere.csv", -2e-6, 1e-6),
        ("keysight_second_name_row.csv", -2e-6, 1e-6),
        ("tek_math_vv.csv", -2e-6, 1e-6),
        ("rate_in_header.csv", 0.0, 1e-6),
    ] {
        let found = read(name);
        assert_eq!(found.len(), 2, "{name}");
        is(&found[0], CH1, (start, step), &V);
        is(&found[1], CH2, (start, step), &W);
    }
    let blank = read("keysight_blank_start.csv");
    is(&blank[0], CH1, (1e-6, 1e-6), &V[3..]);
    is(&blank[1], CH2, (1e-6, 1e-6), &W[3..]);
    assert_eq!(read("keysight_ampere.csv")[1].waveform.preamble.y_unit, "A");
    is(&read("keysight_fft_below.csv")[0], CH1, (-2e-6, 1e-6), &V);
    is(&read("instek_header_beside.csv")[0], CH2, (0.0, 2e-6), &V);
    let siglent = read("siglent_us.csv");
    is(&siglent[0], CH1, (0.0, 2e-6), &V);
    assert_eq!(siglent[0].waveform.horizontal_scale, 0.02);
    let strain = read("slash_strain.csv");
    is(&strain[0], CH1, (-2e-6, 1e-6), &V.map(|v| v * 1e-3));
    assert_eq!(strain[0].waveform.preamble.y_unit, "m/m");
    for (name, words) in [
        ("spectrum_freq_amp.csv", "dBm"),
        ("tek_mso6_digital.csv", "logic"),
        ("redpitaya.csv", "--interval"),
        ("uneven_phone.csv", "--resample"),
    ] {
        let error = read_all(&bytes(name), name).expect_err(name).to_string();
        assert!(error.contains(words), "{error}");
    }
    let fft = bytes("fft_tie_1GSs.csv");
    let found = read("fft_tie_1GSs.csv");
    assert_eq!(found[0].waveform.preamble.x_incr, 488_281.25);
    assert_eq!(write(&found[0]).expect("native").as_bytes(), fft);
    let mut columns = TableColumns::default();
    columns.resample = true;
    let phone = read_columns(&bytes("uneven_phone.csv"), "phone.csv", &columns).expect("resampled");
    assert_eq!(phone[0].waveform.codes.len(), 40);
    columns.interval = Some(8e-9);
    let pitaya = read_columns(&bytes("redpitaya.csv"), "redpitaya.csv", &columns).expect("spaced");
    is(&pitaya[0], CH1, (0.0, 8e-9), &V);
    is(&pitaya[1], CH2, (0.0, 8e-9), &W);
}
