//! A lab's own files through the commands: a memory stick, tables of other programs, clipped
//! records, plain tables out.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use super::{files, printed, refused, says, temporary};

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let arguments = [arguments, &["--json"]].concat();
    serde_json::from_str(&printed(folder, &arguments)).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A half sine of `height` and 40 µs, arriving at `start`, in 8-bit levels of `scale`/25 whose zero
/// stands `position` divisions from the centre: clipped where the converter ends, as the firmware
/// writes it into `F<number>CH<channel>.CSV`.
fn native(channel: u8, start: f64, height: f64, (scale, position): (f64, f64)) -> String {
    use hertzscope::recording::{Capture, InstrumentIdentity, tek_csv};
    use hertzscope::scope::{PointFormat, Preamble, Source, VerticalSetup, Waveform};
    let interval = 1e-6;
    let volts = |index: i32| {
        let phase = (f64::from(index - 250) * interval - start) / 40e-6;
        if (0.0..1.0).contains(&phase) {
            height * (std::f64::consts::PI * phase).sin()
        } else {
            0.0
        }
    };
    let level =
        |index| (volts(index) / (scale / 25.0) + 25.0 * position).round().clamp(-128.0, 127.0);
    let capture = Capture {
        waveform: Waveform {
            source: Source::Channel(channel),
            codes: (0..2500).map(|index| level(index) as i16).collect(),
            as_read: Vec::new(),
            preamble: Preamble {
                x_zero: -250.0 * interval,
                x_incr: interval,
                pt_off: 0,
                x_unit: "s".to_owned(),
                y_mult: scale / 25.0,
                y_zero: 0.0,
                y_off: 25.0 * position,
                y_unit: "V".to_owned(),
                pt_fmt: PointFormat::Sample,
            },
            vertical: VerticalSetup {
                scale,
                position,
                coupling: None,
                bandwidth_limited: None,
                inverted: None,
                probe: 1.0,
            },
            horizontal_scale: 250.0 * interval,
            trigger_point: 250.0,
        },
        instrument: Some(InstrumentIdentity {
            model: "TDS2014".to_owned(),
            serial: "0".to_owned(),
            firmware: "FV:v4.12".to_owned(),
        }),
        notes: Vec::new(),
    };
    tek_csv::write(&capture).expect("writable")
}

/// Twelve shots in ALL0000 to ALL0011: the pulse takes 300 µs from CH1 to CH2, and its height falls
/// by 10 mV a shot from 2 V on.
fn stick(folder: &Path) {
    for shot in 0..12 {
        let all = folder.join(format!("stick/ALL{shot:04}"));
        std::fs::create_dir_all(&all).expect("a folder");
        let height = 2.0 - 0.01 * f64::from(shot);
        for (channel, start) in [(1, 20e-6), (2, 320e-6)] {
            let file = all.join(format!("F{shot:04}CH{channel}.CSV"));
            std::fs::write(file, native(channel, start, height, (0.5, 0.0))).expect("a file");
        }
    }
}

#[test]
fn a_memory_stick_is_one_recording_of_many_shots() {
    let folder = temporary();
    let path = folder.path();
    stick(path);
    let info = json(path, &["info", "stick"]);
    let shots = info["shots"].as_array().expect("shots");
    assert_eq!(shots.len(), 12);
    assert_eq!(shots[11]["number"], 12);
    // The files were written just now.
    assert!(
        shots.iter().all(|shot| shot["timestamp_ns"].as_u64() > Some(1_700_000_000_000_000_000))
    );
    says(
        &printed(path, &["info", "stick", "--shot", "3"]),
        &["shot 3, measured", "  date of the file: 20", " UTC"],
    );
    assert_eq!(
        json(path, &["info", "stick", "--shot", "3", "--channel", "CH2"])["shots"][0]["captures"]
            .as_array()
            .map(Vec::len),
        Some(1)
    );

    let found = json(path, &["arrivals", "stick", "--distance", "CH1-CH2=30 mm +- 0.3 mm"]);
    let speed = &found["shots"][0]["speeds"][0];
    assert!((number(&speed["m_per_s"]["value"]) / 100.0 - 1.0).abs() < 2e-3, "{speed}");
    // One per cent of the distance, an expanded uncertainty as behind every ±, outweighs what the
    // samples leave open.
    assert!((number(&speed["m_per_s"]["U95"]) - 1.0).abs() < 0.1, "{speed}");
    let statistic = |quantity: &str, channel: &str| {
        let all = found["statistics"].as_array().expect("statistics");
        all.iter()
            .find(|s| s["quantity"] == quantity && s["channel"] == channel)
            .expect("one")
            .clone()
    };
    let height = statistic("height", "CH1");
    assert_eq!((height["shots"].as_u64(), height["unit"].as_str()), (Some(12), Some("V")));
    // 2 V to 1.89 V: mean 1.945 V, standard deviation 10 mV sqrt(13), trend -10 mV a shot; a level
    // is 20 mV.
    assert!((number(&height["mean"]) - 1.945).abs() < 0.01, "{height}");
    assert!((number(&height["standard_deviation"]) - 0.036).abs() < 0.004, "{height}");
    assert!((number(&height["trend"]["value"]) + 0.01).abs() < 2e-3, "{height}");
    says(
        &printed(path, &["arrivals", "stick"]),
        &["no speeds", "--scene", "--distance", "over all shots", "drifts"],
    );

    printed(path, &["arrivals", "stick", "-o", "shots.csv"]);
    let table = std::fs::read_to_string(path.join("shots.csv")).expect("a table");
    assert!(table.starts_with("quantity,channel,to,estimator,unit,shots,mean,"), "{table}");
    // Through a recording and back into the instrument's folders: the same bytes.
    printed(path, &["convert", "-q", "stick", "stick.mcap"]);
    printed(path, &["convert", "-q", "stick.mcap", "again"]);
    assert_eq!(files(&path.join("again")).len(), 12);
    for name in ["ALL0000/F0000CH1.CSV", "ALL0011/F0011CH2.CSV"] {
        let bytes = |root: &str| std::fs::read(path.join(root).join(name)).expect(name);
        assert_eq!(bytes("again"), bytes("stick"), "{name}");
    }
}

#[test]
fn one_bad_file_does_not_refuse_the_stick() {
    let folder = temporary();
    let path = folder.path();
    stick(path);
    std::fs::write(path.join("stick/ALL0001/F0001CH2.CSV"), "rubbish\n").expect("a file");
    std::fs::write(path.join("stick/ALL0002/F0002CH1.CSV"), "").expect("a file");
    std::fs::write(path.join("stick/ALL0002/F0002CH2.CSV"), "").expect("a file");
    let info = json(path, &["info", "stick"]);
    assert_eq!(info["shots"].as_array().map(Vec::len), Some(11));
    let problems = info["problems"].to_string();
    says(&problems, &["F0001CH2.CSV", "F0002CH1.CSV"]);
    says(&printed(path, &["arrivals", "stick", "--shot", "2"]), &["problem: ", "F0001CH2.CSV"]);
    // Where nothing can be read, the first reason is told.
    says(&refused(path, &["info", "stick/ALL0002"]), &["F0002CH1.CSV"]);
}

/// Bench, wiring and sensors from a scene, for files that carry none.
#[test]
fn a_scene_tells_what_the_channels_are() {
    let folder = temporary();
    let path = folder.path();
    stick(path);
    let found = json(path, &["arrivals", "stick", "--shot", "1", "--scene", "magnet-0.61g"]);
    let shot = &found["shots"][0];
    assert_eq!(shot["channels"][0]["sensor"], "p2");
    assert!(
        !shot["channels"][0]["height_n"].is_null()
            && !shot["speeds"].as_array().expect("speeds").is_empty()
    );
    let mapped = json(
        path,
        &[
            "arrivals",
            "stick",
            "--shot",
            "1",
            "--scene",
            "magnet-0.61g",
            "--map",
            "CH1=p14,CH2=p27",
        ],
    );
    assert_eq!(mapped["shots"][0]["channels"][1]["sensor"], "p27");
    let distance = |found: &Value| number(&found["shots"][0]["speeds"][0]["distance_m"]);
    assert!((distance(&found) - 0.0472).abs() < 1e-4 && (distance(&mapped) - 0.0511).abs() < 2e-4);
    // Into a recording, and read there without the option.
    printed(
        path,
        &[
            "convert",
            "-q",
            "stick",
            "lab.mcap",
            "--scene",
            "magnet-0.61g",
            "--distance",
            "CH1-CH2=47.5 mm +- 0.1 mm",
        ],
    );
    let kept = json(path, &["arrivals", "lab.mcap", "--shot", "1"]);
    assert_eq!(kept["shots"][0]["channels"][0]["sensor"], "p2");
    assert!((distance(&kept) - 0.0475).abs() < 1e-12);
    says(&printed(path, &["force", "lab.mcap"]), &["p2", "N"]);
    says(&refused(path, &["force", "stick"]), &["--sensor CH1="]);
    for (arguments, words) in [
        (["arrivals", "stick", "--map", "CH1=p2"], ["p2", "--scene"]),
        (["arrivals", "stick", "--scene", "nowhere"], ["nowhere", ""]),
        (["arrivals", "stick", "--distance", "CH1=3"], ["47.2 mm +- 0.1 mm", ""]),
        (["info", "stick", "--shot", "40"], ["no shot 40", "12"]),
        (["info", "stick", "--channel", "CH4"], ["no channel CH4", "CH1, CH2"]),
    ] {
        says(&refused(path, &arguments), &words);
    }
}

/// 145 of the public clipped file's samples stand at the ceiling; here a pulse of 12 V on 8.08 V.
#[test]
fn clipping_is_named_by_every_command_and_refused_by_calibrate() {
    let folder = temporary();
    let path = folder.path();
    std::fs::write(path.join("F0000CH1.CSV"), native(1, 20e-6, 12.0, (1.0, -3.0))).expect("a file");
    let cut = json(path, &["info", "F0000CH1.CSV"])["shots"][0]["captures"][0]["clipped"]
        .as_u64()
        .expect("a count");
    assert!(cut > 10, "{cut}");
    let cut = cut.to_string();
    for command in ["arrivals", "force", "spectrum", "spectrogram"] {
        let told = printed(path, &[command, "F0000CH1.CSV", "--scene", "magnet-0.61g"]);
        says(&told, &["CH1: ", &cut, "clipped"]);
    }
    // A statistic takes no clipped peak.
    let found = json(path, &["arrivals", "F0000CH1.CSV"]);
    assert!(
        !found["statistics"].as_array().expect("a list").iter().any(|s| s["quantity"] == "height")
    );
    let compared = super::hertzscope(path, &["compare", "F0000CH1.CSV", "magnet-0.61g"]);
    says(&compared.stdout, &[&cut, "converter's ends"]);
    std::fs::write(
        path.join("plan.toml"),
        "title = \"t\"\n[sensor]\nitem = \"plate\"\n[scope]\nin_chain = true\n[strikers.ball]\nmass = \"1 g\"\nmass_u = \"0.1 %\"\n\
         [[impacts]]\nrecording = \"F0000CH1.CSV\"\nheight = \"10 mm\"\nheight_u = \"0.1 mm\"\nrebound_speed = \"0.4 m/s\"\nrebound_speed_u = \"1 %\"\n",
    )
    .expect("a plan");
    says(&refused(path, &["calibrate", "plan.toml"]), &["saturated"]);
}

#[test]
fn tables_that_do_not_tell_take_columns() {
    let folder = temporary();
    let path = folder.path();
    let mut text = String::new();
    for n in 0..200 {
        let volts = if n > 40 && n < 80 { 400 } else { n % 3 * 4 };
        let _ = writeln!(text, "{n},{},{volts}", n - 20);
    }
    std::fs::write(path.join("odd.csv"), &text).expect("a file");
    says(
        &refused(path, &["info", "odd.csv"]),
        &["odd.csv", "evenly spaced", "--columns time=1:ms,CH1=2:V,p14=4:N"],
    );
    let columns = ["--columns", "time=2:us,p14=3:mV"];
    let info = json(path, &[&["info", "odd.csv"][..], &columns].concat());
    let capture = &info["shots"][0]["captures"][0];
    assert_eq!(number(&capture["highest"]), 0.4);
    assert!((number(&capture["x_incr"]) - 1e-6).abs() < 1e-12);
    for command in ["arrivals", "spectrum"] {
        printed(path, &[&[command, "odd.csv", "--scene", "magnet-0.61g"][..], &columns].concat());
    }
    // The label is the scene's sensor.
    let found =
        json(path, &[&["arrivals", "odd.csv", "--scene", "magnet-0.61g"][..], &columns].concat());
    assert_eq!(found["shots"][0]["channels"][0]["sensor"], "p14");
    printed(path, &[&["convert", "-q", "odd.csv", "odd.mcap"][..], &columns].concat());
    says(
        &refused(path, &["info", "odd.csv", "--columns", "CH1=2"]),
        &["lacks a column of times", "--columns time=1:ms", "--interval"],
    );
}

/// Newtons stay newtons in every command.
#[test]
fn a_force_trace_is_no_voltage() {
    let folder = temporary();
    let path = folder.path();
    let mut text = "t [s],F [N]\n".to_owned();
    for n in -50..200 {
        let phase = f64::from(n) / 40.0;
        let force = if (0.0..1.0).contains(&phase) {
            24.0 * (std::f64::consts::PI * phase).sin()
        } else {
            0.0
        };
        let _ = writeln!(text, "{:.6},{force:.2}", f64::from(n) * 1e-6);
    }
    std::fs::write(path.join("hammer.csv"), text).expect("a file");
    let found = json(path, &["arrivals", "hammer.csv"]);
    let channel = &found["shots"][0]["channels"][0];
    assert!(channel["height_v"].is_null(), "{channel}");
    assert!((number(&channel["height_n"]["value"]) - 24.0).abs() < 0.1, "{channel}");
    says(&printed(path, &["force", "hammer.csv"]), &["24.0", "N"]);
    let fit = ["fit", "hammer.csv", "magnet-0.61g", "--free", "striker.speed"];
    says(&refused(path, &fit), &["CH1", "in N", "volts"]);
}

#[test]
fn plain_tables_for_other_programs() {
    let folder = temporary();
    let path = folder.path();
    stick(path);
    assert_eq!(printed(path, &["convert", "stick/ALL0000", "one.csv"]), "one.csv\n");
    let one = std::fs::read_to_string(path.join("one.csv")).expect("a table");
    let rows: Vec<&str> = one.lines().collect();
    assert_eq!((rows[0], rows[1], rows.len()), ("time_s,CH1_V,CH2_V", "-0.00025,0,0", 2501));
    // Row 251 is the trigger; 20 µs later plus half of 40 µs the pulse is at its top.
    assert_eq!((rows[251], rows[291]), ("0,0,0", "4e-5,2,0"));
    // It is read back with the same values.
    let back = json(path, &["info", "one.csv"]);
    assert_eq!(number(&back["shots"][0]["captures"][0]["highest"]), 2.0);
    let twelve = printed(path, &["convert", "-q", "stick", "all.csv"]);
    assert_eq!(twelve, "");
    let all = std::fs::read_to_string(path.join("all.csv")).expect("a table");
    assert!(all.starts_with("shot,time_s,CH1_V,CH2_V\n1,-0.00025,0,0\n"), "{}", &all[..80]);
    assert_eq!(all.lines().count(), 12 * 2500 + 1);
    printed(
        path,
        &["convert", "-q", "stick", "n.csv", "--newtons", "--scene", "magnet-0.61g", "--shot", "2"],
    );
    let forces = std::fs::read_to_string(path.join("n.csv")).expect("a table");
    assert!(forces.starts_with("time_s,CH1_N,CH2_N\n"), "{}", &forces[..80]);
    // A folder is one whatever its name.
    let told = printed(path, &["convert", "stick/ALL0000", "day.1/"]);
    assert!(told.starts_with("day.1/ALL0000/F0000CH1.CSV\n"), "{told}");
    says(&refused(path, &["convert", "stick", "t.csv", "--truth"]), &["no truth"]);
    says(&refused(path, &["convert", "stick", "x.mcap", "--newtons"]), &["--newtons", "tables"]);
    printed(path, &["run", "-q", "-o", "run.mcap", "--accuracy", "1e-3"]);
    printed(path, &["convert", "-q", "run.mcap", "truth.csv", "--truth"]);
    let truth = std::fs::read_to_string(path.join("truth.csv")).expect("a table");
    assert!(truth.starts_with("time_s,CH1_V,CH2_V,CH3_V,CH4_V,truth_p2_N,"), "{}", &truth[..80]);
    // The striker and 38 particles, of which the last lies on the wall: 39 bodies, 39 contacts.
    printed(path, &["convert", "-q", "run.mcap", "whole.csv", "--truth=all"]);
    let all = std::fs::read_to_string(path.join("whole.csv")).expect("a table");
    let heading = all.lines().next().expect("a heading");
    let count = |what: &str| heading.split(',').filter(|name| name.contains(what)).count();
    assert_eq!((count("truth_contact"), count("truth_bead")), (39, 39), "{heading}");
    let row: Vec<&str> = all.lines().nth(1500).expect("a row").split(',').collect();
    assert_eq!(row.len(), 1 + 4 + 4 + 39 + 39);
    assert!(row.iter().all(|cell| cell.parse::<f64>().is_ok_and(f64::is_finite)), "{row:?}");
}

/// Nothing is replaced that was not named with `-o`, unless `--force` says so.
#[test]
fn files_that_exist_are_kept() {
    let folder = temporary();
    let path = folder.path();
    stick(path);
    let kept = |name: &str| std::fs::read_to_string(path.join(name)).expect("a file") == "mine";
    let commands: [(&[&str], &str); 8] = [
        (&["convert", "stick/ALL0000", "x.csv"], "x.csv"),
        (&["convert", "stick", "x.mcap"], "x.mcap"),
        (&["convert", "stick", "x.svg"], "x.svg"),
        (&["convert", "stick", "x.bmp"], "x.bmp"),
        (&["spectrum", "stick", "--plot", "p.svg"], "p.svg"),
        (&["bands", "--plot", "b.svg"], "b.svg"),
        (&["magnet", "--plot", "m.svg"], "m.svg"),
        (&["run", "-q", "-o", "r.mcap", "--bands", "--samples", "20", "--plot", "z.svg"], "z.svg"),
    ];
    for (arguments, name) in commands {
        std::fs::write(path.join(name), "mine").expect("a file");
        says(&refused(path, arguments), &[name, "exists already", "--force"]);
        assert!(kept(name), "{arguments:?}");
    }
    for (arguments, name) in &commands[..7] {
        printed(path, &[arguments, &["--force"][..]].concat());
        assert!(!kept_bytes(path, name), "{arguments:?}");
    }
    // What -o names is replaced, by a whole file.
    std::fs::write(path.join("s.csv"), "mine").expect("a file");
    printed(path, &["arrivals", "stick", "-o", "s.csv"]);
    assert!(!kept("s.csv"));
}

fn kept_bytes(path: &Path, name: &str) -> bool {
    std::fs::read(path.join(name)).expect("a file") == b"mine"
}

/// The screen on white for print, as SVG and PNG.
#[test]
fn the_screen_is_printed_on_white() {
    let folder = temporary();
    let path = folder.path();
    stick(path);
    printed(path, &["convert", "stick/ALL0000", "light.svg", "--light"]);
    let svg = std::fs::read_to_string(path.join("light.svg")).expect("a picture");
    assert!(svg.contains("fill=\"#ffffff\"") && !svg.contains("#ffd800"), "{}", &svg[..400]);
    printed(path, &["convert", "stick/ALL0000", "light.png", "--light"]);
    let png = std::fs::read(path.join("light.png")).expect("a picture");
    assert!(png.starts_with(b"\x89PNG"));
    says(&refused(path, &["convert", "stick", "x.csv", "--light"]), &["--light", ".svg"]);
}

/// Too much is refused at once, by the file's own size.
#[test]
fn large_files_are_refused_by_their_size() {
    let folder = temporary();
    let path = folder.path();
    let file = std::fs::File::create(path.join("huge.csv")).expect("a file");
    // Ten million rows of 26 bytes; nothing of it is read.
    file.set_len(260_000_000).expect("a long file");
    let started = std::time::Instant::now();
    says(&refused(path, &["info", "huge.csv"]), &["huge.csv", "260000000 bytes", "67108864"]);
    assert!(started.elapsed().as_secs() < 10, "{:?}", started.elapsed());
}
