//! The formats of the results hold the same.

use super::{column, done, folder, read, told};

/// Text with commas and quotes, missing numbers, small and large ones.
const MIXED: &str = r#"
scene = "magnet-0.61g"
accuracy = 1e-2
watch = ["p2", "p14"]

[grid]
chain.top = ["free", { force = "1 N" }]
duration = "0.1 ms"
striker.speed = ["0.4 m/s", "0 m/s"]
"#;

#[test]
fn json_lines_hold_what_the_csv_holds() {
    let folder = folder(MIXED);
    done(folder.path(), &["sweep", "grid.toml", "-o", "out/a.csv", "-o", "out/a.jsonl"]);
    let (csv, json) = (read(folder.path(), "out/a.csv"), read(folder.path(), "out/a.jsonl"));
    let objects: Vec<serde_json::Value> =
        json.lines().map(|line| serde_json::from_str(line).expect("an object")).collect();
    assert_eq!(objects.len(), 4);
    assert_eq!(objects[0]["chain.top"], "free");
    assert_eq!(objects[2]["chain.top"], "{ force = \"1 N\" }");
    assert!(objects[1]["error"].as_str().expect("a reason").contains("found \"0 m/s\""));
    assert!(objects[1]["p2.peak (N)"].is_null() && objects[0]["error"].is_null());
    // Nothing has come to particle 14 by then.
    assert!(objects[0]["p14.half_rise (s)"].is_null());
    let first = json.lines().next().expect("a line");
    for name in ["run", "seed", "p2.peak (N)", "p2.peak_time (s)"] {
        let cells = column(&csv, name);
        assert_eq!(number(first, name), cells[0].parse::<f64>().expect("a number"), "{name}");
    }
}

#[cfg(not(feature = "parquet"))]
#[test]
fn without_parquet_the_user_hears_how_to_get_it() {
    let folder = folder(MIXED);
    let (code, _, stderr) = super::told(folder.path(), &["sweep", "grid.toml", "-o", "a.parquet"]);
    assert_eq!(code, 2);
    assert!(stderr.contains("--features parquet"), "{stderr}");
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_holds_what_the_csv_holds() {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;

    let folder = folder(MIXED);
    done(folder.path(), &["sweep", "grid.toml", "-o", "a.jsonl", "-o", "a.parquet"]);
    let file = std::fs::File::open(folder.path().join("a.parquet")).expect("a file");
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    let rows = reader.get_row_iter(None).expect("rows");
    let json = read(folder.path(), "a.jsonl");
    let mut lines = json.lines();
    for row in rows {
        let row = row.expect("a row");
        let line = lines.next().expect("as many lines");
        let object: serde_json::Value = serde_json::from_str(line).expect("an object");
        assert_eq!(row.len(), object.as_object().expect("an object").len());
        for (name, field) in row.get_column_iter() {
            match field {
                Field::Null => assert!(object[name].is_null(), "{name}"),
                Field::Double(value) => assert_eq!(number(line, name), *value, "{name}"),
                Field::Long(value) => assert_eq!(object[name].as_i64(), Some(*value), "{name}"),
                Field::Str(value) => assert_eq!(object[name], value.as_str(), "{name}"),
                other => panic!("{name}: {other}"),
            }
        }
    }
    assert!(lines.next().is_none());
}

/// The number called `name` in an object's text: without further ado the JSON library's numbers are
/// right to all but the last bit.
fn number(line: &str, name: &str) -> f64 {
    let (_, rest) = line.split_once(&format!("\"{name}\":")).expect(name);
    let end = rest.find([',', '}']).expect("its end");
    rest[..end].trim().parse().expect("a number")
}

/// Points of the picture are the table's: between first and last they lie at the same shares, and
/// each value of the other parameter has a line. Columns that do not exist are refused before the
/// runs.
#[test]
fn a_picture_shows_columns_of_the_table() {
    let there = folder(
        "scene = \"magnet-0.61g\"\naccuracy = 1e-2\nwatch = [\"p2\"]\n[grid]\nduration = \"0.1 ms\"\n\
         striker.speed = { from = \"0.2 m/s\", to = \"0.8 m/s\", count = 5 }\n\
         effects.magnet_preload.force = [\"1 N\", \"3 N\"]\n",
    );
    let plot = ["sweep", "grid.toml", "-q", "--plot", "s.svg", "--x", "striker.speed"];
    let (code, _, words) = told(there.path(), &[&plot[..], &["--y", "p2.size"]].concat());
    assert!(code == 2 && words.contains("p2.size") && words.contains("p2.peak"), "{words}");
    assert!(!there.path().join("grid.csv").exists());
    done(there.path(), &plot);
    let svg = std::fs::read_to_string(there.path().join("s.svg")).expect("an SVG");
    // Values that all runs share are in no line's name.
    for words in ["striker.speed (mm/s)", "p2.peak (N)", ">effects.magnet_preload.force 1.000 N"] {
        assert!(svg.contains(words), "{words}: {svg}");
    }
    let table = read(there.path(), "grid.csv");
    let forces = column(&table, "effects.magnet_preload.force (N)");
    let peaks = column(&table, "p2.peak (N)").into_iter().zip(forces);
    let peaks: Vec<f64> = peaks
        .filter(|(_, force)| force == "1")
        .map(|(peak, _)| peak.parse().expect("a number"))
        .collect();
    let path = svg.lines().find(|line| line.contains("stroke=\"#0072b2\" stroke-width=\"1.3\""));
    let path = path.and_then(|line| line.split_once("d=\"M")?.1.split('"').next()).expect("a line");
    let heights: Vec<f64> = path
        .split('L')
        .map(|point| point.split_once(' ').expect("a point").1.parse().expect("a number"))
        .collect();
    assert_eq!((heights.len(), peaks.len()), (5, 5));
    let share = |values: &[f64], at: usize| (values[at] - values[0]) / (values[4] - values[0]);
    for at in 1..4 {
        // Places are rounded to a tenth of a pixel, of about two hundred.
        let (drawn, told) = (share(&heights, at), share(&peaks, at));
        assert!((drawn - told).abs() < 2e-3, "{drawn} {told}");
    }
}
