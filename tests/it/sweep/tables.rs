//! The formats of the results hold the same.

use super::{column, done, folder, read};

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
