//! `hertzscope info`, `convert` and `view`.

use std::path::Path;

use hertzscope::recording::format::open;
use serde_json::Value;

use super::{QUICK, files, hertzscope, printed, refused, says, temporary};

/// A folder with a recording `run.mcap` of four channels.
fn recorded() -> tempfile::TempDir {
    let folder = temporary();
    let run = [&["run", "-q", "-o", "run.mcap"][..], &QUICK].concat();
    assert_eq!(printed(folder.path(), &run), "");
    folder
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).expect(name)
}

#[test]
fn recordings_folders_and_files_become_one_another() {
    let folder = recorded();
    let path = folder.path();
    let curves = (1..=4).map(|n| format!("CH{n}.CSV"));
    let names: Vec<String> = curves
        .chain(["TEK.SET".to_owned(), "TEK.BMP".to_owned()])
        .map(|name| format!("out/ALL0000/F0000{name}"))
        .collect();
    let told = printed(path, &["convert", "run.mcap", "out"]);
    assert_eq!(told.lines().collect::<Vec<_>>(), names);
    assert_eq!(files(&path.join("out")), ["ALL0000"]);
    // Again: numbered on, as the scope does.
    printed(path, &["convert", "run.mcap", "out"]);
    assert_eq!(files(&path.join("out")), ["ALL0000", "ALL0001"]);
    assert_eq!(files(&path.join("out/ALL0001"))[0], "F0001CH1.CSV");

    // A folder into a recording and back: the same bytes.
    assert_eq!(printed(path, &["convert", "out/ALL0000", "back.mcap"]), "back.mcap\n");
    printed(path, &["convert", "back.mcap", "again"]);
    for number in 1..=4 {
        let name = format!("ALL0000/F0000CH{number}.CSV");
        assert_eq!(bytes(path, &format!("again/{name}")), bytes(path, &format!("out/{name}")));
    }
    // So are the set-up, and the screen that is drawn by it.
    for name in ["ALL0000/F0000TEK.SET", "ALL0000/F0000TEK.BMP"] {
        assert_eq!(bytes(path, &format!("again/{name}")), bytes(path, &format!("out/{name}")));
    }
    // One file into a recording and back into a file.
    printed(path, &["convert", "out/ALL0000/F0000CH3.CSV", "one.mcap"]);
    assert_eq!(printed(path, &["convert", "one.mcap", "one.csv", "--as", "tds"]), "one.csv\n");
    assert_eq!(bytes(path, "one.csv"), bytes(path, "out/ALL0000/F0000CH3.CSV"));
    // Several captures do not go into one file: a folder of its name.
    let told = printed(path, &["convert", "run.mcap", "all.csv", "--as", "tds"]);
    assert_eq!(told.lines().next(), Some("all/ALL0000/F0000CH1.CSV"));
    assert_eq!(printed(path, &["convert", "-q", "run.mcap", "quiet"]), "");
}

/// B3 of the readers: names with a comma moved forces between columns. The CSV is read by the
/// crate `csv`, the JSON lines by `serde_json`; the expected forces are the recording's.
#[test]
fn a_sensors_name_with_comma_quote_or_line_end_keeps_its_column() {
    let folder = temporary();
    let path = folder.path();
    let names = ["a,b", "say \"hi\"", "two\nlines"];
    let sensor = |(name, particle): (&str, u32)| {
        let name = serde_json::Value::from(name);
        format!("[sensors.{name}]\nmodel = \"pzt-5a-710pf\"\nparticle = {particle}\n")
    };
    let sensors: String = names.into_iter().zip([5, 9, 12]).map(sensor).collect();
    std::fs::write(path.join("odd.toml"), format!("base = \"magnet-0.61g\"\n{sensors}"))
        .expect("a scene");
    printed(path, &[&["run", "-q", "-o", "odd.mcap", "odd.toml"][..], &QUICK].concat());
    for file in ["odd.csv", "odd.jsonl"] {
        printed(path, &["convert", "-q", "--truth", "odd.mcap", file]);
    }
    let mut csv = csv::Reader::from_path(path.join("odd.csv")).expect("a table");
    let head: Vec<String> = csv.headers().expect("a head").iter().map(str::to_owned).collect();
    let json = std::fs::read_to_string(path.join("odd.jsonl")).expect("a table");
    let set = open(&path.join("odd.mcap")).expect("a recording");
    let shot = &set.shots[0];
    let trigger = shot.trigger_time.expect("a trigger");
    let rows: Vec<csv::StringRecord> = csv.records().map(|row| row.expect("a row")).collect();
    assert_eq!((rows.len(), json.lines().count()), (2500, 2500));
    for name in names {
        let column = format!("truth_{name}_N");
        let place = head.iter().position(|head| *head == column).expect(&column);
        let signal = hertzscope::recording::TrueSignal::Force(name.to_owned());
        let truth = shot.true_signal(&signal).expect(name);
        for (row, line) in rows.iter().zip(json.lines()).step_by(97) {
            let object: Value = serde_json::from_str(line).expect("JSON");
            let [time, force] = [0, place].map(|at| row[at].parse::<f64>().expect("a number"));
            let index = ((time + trigger - truth.start) / truth.interval).round() as usize;
            let expected = truth.values[index];
            assert!((force - expected).abs() < 1e-6 * (1.0 + expected.abs()), "{name} at {time} s");
            assert_eq!(object[&column].as_f64(), Some(force), "{name} at {time} s");
        }
    }
}

/// The levels in the files are the levels in the recording.
#[test]
fn nothing_is_lost_between_formats() {
    let folder = recorded();
    let path = folder.path();
    printed(path, &["convert", "-q", "run.mcap", "out"]);
    let recording = open(&path.join("run.mcap")).expect("a recording");
    let imported = open(&path.join("out/ALL0000")).expect("a folder");
    assert_eq!(imported.shots[0].captures.len(), 4);
    for (ours, theirs) in recording.shots[0].captures.iter().zip(&imported.shots[0].captures) {
        assert_eq!(ours.waveform.codes, theirs.waveform.codes);
        assert_eq!(ours.waveform.source, theirs.waveform.source);
        // The file has five digits of a scale and picoseconds of a time.
        let near = |a: f64, b: f64, unit: f64| (a - b).abs() <= unit;
        assert!(near(ours.waveform.preamble.y_mult, theirs.waveform.preamble.y_mult, 1e-12));
        assert!(near(ours.waveform.preamble.x_zero, theirs.waveform.preamble.x_zero, 1e-12));
    }
    // A recording into a recording: everything, the notes too.
    printed(path, &["convert", "-q", "run.mcap", "copy.mcap"]);
    let copy = open(&path.join("copy.mcap")).expect("a recording");
    assert_eq!(copy, recording);
    assert!(copy.notes[&1].energy.is_some());
    assert!(!copy.log.is_empty());
}

#[test]
fn the_input_is_never_the_output() {
    let folder = recorded();
    let before = bytes(folder.path(), "run.mcap");
    let error = refused(folder.path(), &["convert", "run.mcap", "./run.mcap"]);
    says(&error, &["run.mcap", "found the input as the output"]);
    assert_eq!(bytes(folder.path(), "run.mcap"), before);
}

#[test]
fn what_cannot_be_converted_is_refused() {
    let folder = recorded();
    let path = folder.path();
    std::fs::write(path.join("bad.csv"), "a,b\n").expect("a file");
    std::fs::write(path.join("bad.mcap"), "a,b\n").expect("a file");
    std::fs::create_dir(path.join("empty")).expect("a folder");
    for (input, output, words) in [
        ("run.mcap", "x.txt", &["x.txt", ".txt", "expected .mcap, .csv"][..]),
        ("none.mcap", "x.csv", &["none.mcap"]),
        ("bad.csv", "x.mcap", &["bad.csv"]),
        ("bad.mcap", "x.csv", &["bad.mcap", "MCAP"]),
        ("empty", "x.mcap", &["empty", "no .csv or .isf file"]),
        ("run.mcap", "bad.csv/x.mcap", &["bad.csv"]),
    ] {
        says(&refused(path, &["convert", input, output]), words);
    }
    assert_eq!(files(path), ["bad.csv", "bad.mcap", "empty", "run.mcap"]);
}

/// What a damaged recording still holds is converted, and what it lost is told.
#[test]
fn a_damaged_recording_is_converted_with_warnings() {
    let folder = recorded();
    let path = folder.path();
    let whole = bytes(path, "run.mcap");
    // Cut in the summary behind the data: the magic at the end is gone.
    std::fs::write(path.join("cut.mcap"), &whole[..whole.len() - 8]).expect("a file");
    let done = hertzscope(path, &["convert", "cut.mcap", "out"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    says(&done.stderr, &["warning: cut.mcap:", "cut behind its data"]);
    assert_eq!(files(&path.join("out/ALL0000")).len(), 6);
    let info = printed(path, &["info", "cut.mcap"]);
    says(&info, &["problem: ", "cut behind its data"]);
}

#[test]
fn info_tells_what_is_in_every_format() {
    let folder = recorded();
    let path = folder.path();
    printed(path, &["convert", "-q", "run.mcap", "out"]);
    says(
        &printed(path, &["info", "run.mcap"]),
        &[
            "hertzscope:recording",
            "magnet-0.61g",
            "shot 1, simulated",
            "CH1",
            "CH4",
            "2500",
            "1.00 V/div",
            "250 µs/div",
            "magnet-0.61g.toml",
        ],
    );
    says(&printed(path, &["info", "out/ALL0000"]), &["shot 1, measured", "CH1", "CH4"]);
    let one = printed(path, &["info", "out/ALL0000/F0000CH2.CSV"]);
    says(&one, &["shot 1, measured", "CH2"]);
    assert!(!one.contains("CH1 "), "{one}");

    for (file, channels) in [("run.mcap", 4), ("out/ALL0000", 4), ("out/ALL0000/F0000CH2.CSV", 1)] {
        let json: Value =
            serde_json::from_str(&printed(path, &["info", "--json", file])).expect("JSON");
        let captures = json["shots"][0]["captures"].as_array().expect("a list");
        assert_eq!(captures.len(), channels, "{file}");
        for capture in captures {
            assert_eq!(capture["points"], 2500, "{file}");
            let volts = |key: &str| capture[key].as_f64().expect("volts");
            assert!(volts("lowest") <= volts("highest"), "{file}");
        }
        assert_eq!(json["problems"], serde_json::json!([]), "{file}");
    }
    let json: Value =
        serde_json::from_str(&printed(path, &["info", "--json", "run.mcap"])).expect("JSON");
    assert_eq!(json["metadata"]["hertzscope:recording"]["scene"], "magnet-0.61g");
    assert_eq!(json["attachments"][0]["name"], "magnet-0.61g.toml");
}

#[test]
fn info_refuses_what_it_cannot_read() {
    let folder = temporary();
    let path = folder.path();
    std::fs::write(path.join("x.txt"), "x").expect("a file");
    std::fs::write(path.join("x.mcap"), "x").expect("a file");
    for file in ["x.txt", "x.mcap", "absent.mcap", "absent.csv", "absent", "."] {
        let error = refused(path, &["info", file]);
        says(&error, &[file]);
        assert!(!error.contains("panicked"), "{error}");
    }
}

#[cfg(feature = "tui")]
#[test]
fn view_needs_a_terminal() {
    let folder = recorded();
    let error = refused(folder.path(), &["view", "run.mcap"]);
    says(&error, &["no terminal", "hertzscope info"]);
    says(&refused(folder.path(), &["view", "absent.mcap"]), &["absent.mcap"]);
}

/// The scope's own pictures of its screen; captures without set-up show only what they tell.
#[test]
fn screens_are_drawn_as_the_scope_does() {
    let folder = recorded();
    let path = folder.path();
    printed(path, &["convert", "run.mcap", "out"]);
    for (name, start) in [("s.bmp", &b"BM"[..]), ("s.tif", b"II*\0")] {
        assert_eq!(printed(path, &["convert", "run.mcap", name]), format!("{name}\n"));
        assert!(bytes(path, name).starts_with(start), "{name}");
    }
    assert_eq!(bytes(path, "s.bmp"), bytes(path, "out/ALL0000/F0000TEK.BMP"));
    printed(path, &["convert", "out/ALL0000/F0000CH1.CSV", "one.bmp"]);
    assert_ne!(bytes(path, "one.bmp"), bytes(path, "s.bmp"));
    // A file alone tells no front panel: curve and screen, no set-up.
    printed(path, &["convert", "out/ALL0000/F0000CH1.CSV", "alone"]);
    assert_eq!(files(&path.join("alone/ALL0000")), ["F0000CH1.CSV", "F0000TEK.BMP"]);
}

/// A file that lost its header becomes native once the user says what instrument it is from.
#[test]
fn an_instrument_can_be_supplied() {
    let folder = temporary();
    let path = folder.path();
    let rows = (0..2500)
        .map(|n| format!("{:e},{:.2}\n", f64::from(n - 250) * 1e-6, f64::from(n % 50) * 0.04));
    std::fs::write(path.join("bare.csv"), rows.collect::<String>()).expect("a file");
    let error = refused(path, &["convert", "bare.csv", "native.csv", "--as", "tds"]);
    says(&error, &["names no instrument", "--instrument MODEL"]);
    printed(path, &["convert", "bare.csv", "native.csv", "--as", "tds", "--instrument", "tds2024"]);
    let text = String::from_utf8(bytes(path, "native.csv")).expect("text");
    assert!(text.contains("\nModel Number,TDS2024,,") && text.contains("\nSerial Number,0,,"));
    assert!(
        text.starts_with("Record Length,2.500000e+03,,  -0.000250000000,   0.00000,\n"),
        "{}",
        &text[..80]
    );
    let error = refused(path, &["convert", "bare.csv", "x.csv", "--instrument", "tds9"]);
    says(&error, &["tds9", "tds2014, tds2024"]);
}

/// The bytes of a recording with `padding` bytes of a private record before its data; without the
/// checksum of all data, which this would change.
fn padded(recording: &[u8], padding: usize) -> Vec<u8> {
    const MAGIC: usize = 8;
    const PRIVATE: u8 = 0x90;
    const DATA_END: [u8; 9] = [0x0F, 4, 0, 0, 0, 0, 0, 0, 0];
    let (magic, data) = recording.split_at(MAGIC);
    let mut bytes = magic.to_vec();
    bytes.push(PRIVATE);
    bytes.extend((padding as u64).to_le_bytes());
    bytes.resize(bytes.len() + padding, 0xA5);
    bytes.extend(data);
    let end = bytes.windows(DATA_END.len()).rposition(|found| found == DATA_END);
    let end = end.expect("an end") + DATA_END.len();
    bytes[end..end + 4].fill(0);
    bytes
}

/// Every command that reads recordings gives the same for the same shots, whatever the size of the
/// file: exit code, both outputs, and every file it writes.
#[test]
#[allow(clippy::too_many_lines, reason = "one list of commands")]
fn a_large_recording_is_read_like_a_small_one() {
    let folder = recorded();
    let path = folder.path();
    let mut set = open(&path.join("run.mcap")).expect("a recording");
    let first = set.shots[0].clone();
    set.shots = (1..=3)
        .map(|number| {
            let mut shot = first.clone();
            shot.number = number;
            shot.timestamp_ns += u64::from(number) * 1_000_000_000;
            shot
        })
        .collect();
    // A channel that is missing in a shot.
    set.shots[2].captures.pop();
    set.lines = [500, 1_500_000_000, 9_500_000_000].map(line).to_vec();
    hertzscope::recording::mcap::write(&path.join("shots.mcap"), &set).expect("a recording");
    let recording = bytes(path, "shots.mcap");
    for (size, padding) in [("small", 10), ("large", 50 << 20)] {
        std::fs::create_dir(path.join(size)).expect("a folder");
        std::fs::write(path.join(size).join("x.mcap"), padded(&recording, padding))
            .expect("a recording");
    }
    let large = path.join("large/x.mcap");
    assert!(std::fs::metadata(large).expect("a file").len() > 32 << 20);
    for (arguments, code) in [
        ("info x.mcap", 0),
        ("info x.mcap --json", 0),
        ("info x.mcap --shot 2 --channel CH2", 0),
        ("info x.mcap --shot 2 --channel CH2 --json", 0),
        ("info x.mcap --shot 999", 2),
        ("info x.mcap --channel CH7", 2),
        ("arrivals x.mcap", 0),
        ("arrivals x.mcap --json -o statistics.csv", 0),
        ("arrivals x.mcap --shot 2", 0),
        ("arrivals x.mcap --shot 9", 2),
        ("arrivals x.mcap --channel CH4", 0),
        ("force x.mcap", 0),
        ("force x.mcap --shot 3", 0),
        ("spectrum x.mcap", 0),
        ("spectrogram x.mcap --shot 2", 0),
        ("transfer x.mcap --between CH1,CH2", 0),
        ("dispersion x.mcap", 0),
        ("compare x.mcap x.mcap --shot 2", 0),
        ("compare x.mcap x.mcap --shot 9", 2),
        ("convert x.mcap x.jsonl --channel CH1", 0),
        ("convert x.mcap x.csv --channel CH1 --newtons", 0),
        ("convert x.mcap both.csv", 2),
        ("convert x.mcap folders", 0),
        ("convert x.mcap res.2026.11/", 0),
        ("convert x.mcap native.csv --as tds --shot 2 --channel CH2", 0),
        ("convert x.mcap all.csv --as tds", 0),
        ("convert x.mcap none.jsonl --shot 999", 2),
        ("convert x.mcap none.isf", 2),
        ("convert x.mcap one.isf --shot 3 --channel CH1", 0),
        ("convert x.mcap x.svg", 0),
        ("convert x.mcap x.bmp --shot 2", 0),
        ("convert x.mcap copy.mcap", 0),
        ("convert x.mcap copy2.mcap --shot 2 --channel CH3", 0),
        ("convert x.mcap none.mcap --shot 9", 2),
        ("convert x.mcap x.mcap", 2),
    ] {
        let words: Vec<&str> = arguments.split(' ').collect();
        let [small, large] = ["small", "large"].map(|size| hertzscope(&path.join(size), &words));
        assert_eq!(small.code, code, "{arguments}: {}", small.stderr);
        assert_eq!(large.code, code, "{arguments}: {}", large.stderr);
        assert_eq!(small.stdout, large.stdout, "{arguments}");
        assert_eq!(small.stderr, large.stderr, "{arguments}");
    }
    let [mut small, mut large] = ["small", "large"].map(|size| contents(&path.join(size)));
    for (folder, size) in [(&mut small, 1 << 20), (&mut large, 50 << 20)] {
        assert!(folder.remove("x.mcap").expect("the recording").len() > size / 4);
    }
    assert_eq!(small.keys().collect::<Vec<_>>(), large.keys().collect::<Vec<_>>());
    for (name, bytes) in &small {
        assert!(large[name] == *bytes, "{name} differs");
    }
    // All of it is there: every sample of every shot, every shot's folder, every message.
    let rows = String::from_utf8_lossy(&small["x.jsonl"]).lines().count();
    assert_eq!(rows, 3 * first.captures[0].waveform.codes.len());
    for folder in ["folders", "res.2026.11"] {
        assert!(small.contains_key(&format!("{folder}/ALL0002/F0002CH1.CSV")), "{folder}");
    }
    let copy = open(&path.join("large/copy.mcap")).expect("a copy");
    assert!(copy.shots == set.shots && copy.lines == set.lines && copy.metadata == set.metadata);
}

fn line(timestamp_ns: u64) -> hertzscope::recording::ScpiLine {
    hertzscope::recording::ScpiLine {
        timestamp_ns,
        peer: "raw 127.0.0.1:1".to_owned(),
        direction: hertzscope::recording::Direction::Command,
        bytes: b"CURVE?".to_vec(),
    }
}

/// The contents of all files below `folder`, by their paths from it.
fn contents(folder: &Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let mut found = std::collections::BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            let inside = contents(&path).into_iter();
            found.extend(inside.map(|(file, bytes)| (format!("{name}/{file}"), bytes)));
        } else {
            found.insert(name, std::fs::read(&path).expect("a file"));
        }
    }
    found
}
