//! Native files and tables that were changed, cut, or written by programs with habits of their own:
//! read with a note, or refused with a sentence that helps.

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::{read_all, write};

use super::made_up::plain_record;

fn one(text: &str) -> Capture {
    let mut captures = read_all(text.as_bytes(), "F.CSV").expect("readable");
    assert_eq!(captures.len(), 1);
    captures.remove(0)
}

fn refusal(text: &str) -> String {
    read_all(text.as_bytes(), "F.CSV").expect_err("not readable").to_string()
}

/// The lines of a native file, and the same as a spreadsheet saves them: without the last comma.
fn native() -> [Vec<String>; 2] {
    let text = write(&plain_record()).expect("writable");
    let lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let copy = lines.iter().map(|line| line.trim_end_matches(',').to_owned()).collect();
    [lines, copy]
}

fn joined(lines: &[String]) -> String {
    lines.iter().fold(String::new(), |text, line| text + line + "\n")
}

fn says(capture: &Capture, words: &[&str]) {
    let notes = capture.notes.join("\n");
    for word in words {
        assert!(notes.contains(word), "expected `{word}` in {notes}");
    }
}

/// One altered digit of a value: the native file is read like its copy from a spreadsheet, the
/// value by the nearest level, and the line is named.
#[test]
fn a_changed_value_is_read_with_a_note_in_native_files_and_copies() {
    let sound = one(&joined(&native()[0]));
    assert_eq!(sound.notes, [""; 0]);
    for (kind, mut lines) in native().into_iter().enumerate() {
        let row = &mut lines[811];
        let value = row.trim_end_matches(',').rsplit(',').next().expect("a value").to_owned();
        let last = value.trim_end().chars().last().expect("a digit");
        // A level is eight last digits wide: two digits on, the nearest level is the same.
        let digit = last.to_digit(10).expect("a digit");
        let changed = if digit < 8 { digit + 2 } else { digit - 2 };
        let shown = format!("{}{changed}", &value[..value.len() - 1]);
        *row = row.replace(&value, &shown);
        let found = one(&joined(&lines));
        assert_eq!(found.waveform.codes, sound.waveform.codes, "{kind}");
        assert_eq!(found.waveform.preamble, sound.waveform.preamble, "{kind}");
        says(&found, &["1 values are not levels", "line 812"]);
    }
}

/// A time that is off may be that of a missing row.
#[test]
fn a_changed_time_is_refused_in_native_files_and_copies() {
    for mut lines in native() {
        let row = &mut lines[1999];
        let at = row.rfind('.').and_then(|value| row[..value].rfind('.')).expect("a time");
        let digit = row.as_bytes()[at + 1];
        let changed = if digit == b'8' { "1" } else { "8" };
        row.replace_range(at + 1..at + 2, changed);
        let error = refusal(&joined(&lines));
        assert!(error.contains("line 2000") && error.contains("by even spacing"), "{error}");
    }
}

/// 2,400 of 2,500 rows, with and without a whole last one.
#[test]
fn a_native_file_that_was_cut_keeps_its_rows() {
    let sound = one(&joined(&native()[0]));
    for lines in native() {
        for tail in ["", ",,,"] {
            let text = joined(&lines[..2400]) + tail;
            let found = one(&text);
            assert_eq!(found.waveform.codes, sound.waveform.codes[..2400]);
            assert_eq!(found.waveform.preamble, sound.waveform.preamble);
            says(&found, &["found 2400 points, the header says 2500"]);
        }
    }
}

/// A file in which a whole column is off is not read as if a few rows were.
#[test]
fn many_changed_values_are_not_forced_onto_levels() {
    let [mut lines, _] = native();
    for row in &mut lines[100..200] {
        let cut = row.trim_end_matches(',').to_owned();
        *row = format!("{}7,", &cut[..cut.len() - 1]);
    }
    let found = one(&joined(&lines));
    assert!(!found.notes.iter().any(|note| note.contains("taken as the nearest")));
    says(&found, &["no multiples of"]);
}

/// Decimal commas as separators: a time that is printed as a whole number hides half of it.
#[test]
fn numbers_split_at_decimal_commas_are_refused() {
    for text in [
        "Zeit in ms,U in V\n0,0,012\n1,0,013\n2,0,014\n3,0,011\n",
        "Zeit in ms,U in V\n0,5,0,012\n1,0,0,013\n1,5,0,014\n2,0,0,011\n",
        "t,U\n0,-0,012\n1,-0,013\n2,0,014\n3,0,011\n",
        "0,5,0,012\n1,0,0,013\n1,5,0,014\n2,0,0,011\n",
    ] {
        let error = refusal(text);
        assert!(error.contains("commas cannot be both"), "{error}");
    }
    // An unnamed column of indices in front is not one too many.
    let indexed = ",t in us,CH1\n0,0,0.1\n1,1,0.2\n2,2,0.1\n3,3,0.3\n";
    assert_eq!(one(indexed).waveform.preamble.x_incr, 1e-6);
    // A third column with a name is a channel.
    let three = "t in ms,U in V,CH2 in V\n0,0,12\n1,0,13\n2,1,14\n3,2,11\n";
    assert_eq!(read_all(three.as_bytes(), "F.CSV").expect("two channels").len(), 2);
}

/// The row that is missing is named, with the time that belongs there in the column's own digits.
#[test]
fn a_missing_row_is_named_with_the_time_that_belongs_there() {
    let rows = |times: &[f64], decimals: usize| {
        let lines = times.iter().zip(1..).map(|(t, i)| format!("{t:.decimals$},0.{:02}\n", i % 50));
        format!("Time (s),CH1 (V)\n{}", lines.collect::<String>())
    };
    let times: Vec<f64> = (0..50).filter(|i| *i != 25).map(|i| f64::from(i) * 1e-3).collect();
    let error = refusal(&rows(&times, 3));
    assert!(error.contains("found 0.026 s, expected 0.025 s by even spacing"), "{error}");
    assert!(error.contains("line 27,"), "{error}");
}

#[test]
fn misleading_cells_and_units_are_named() {
    let thousands = "Time (s);CH1 (V)\n0.000;1,000.5\n0.001;1,001.5\n0.002;1,002.5\n";
    let error = refusal(thousands);
    assert!(error.contains("thousands separators") && error.contains("1,000.5"), "{error}");
    // Megaseconds: an interval of eleven days.
    let mega = "t (Ms),CH1 (V)\n0,0.1\n1,0.2\n2,0.1\n3,0.3\n";
    let error = refusal(mega);
    assert!(error.contains("`Ms`"), "{error}");
    // Units typed in small letters.
    let small = "Time (mS),Ch A (mv)\n0,100\n1,200\n2,100\n3,300\n";
    let found = one(small);
    assert_eq!(found.waveform.volts(1), Some(0.2));
    assert_eq!(found.waveform.preamble.x_incr, 1e-3);
}
