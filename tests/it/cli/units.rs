//! Channels in the units of an impact lab through every command: each keeps its unit and its name.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use super::{hertzscope, printed, refused, says, temporary};

/// A column's heading and the height of its pulse in the heading's unit; the unit in SI, that
/// height in SI, and how the height begins on a page (`499.` of `499.8 g`) with its unit there.
struct Quantity {
    heading: &'static str,
    height: f64,
    unit: &'static str,
    height_si: f64,
    shown: &'static str,
}

const fn quantity(
    heading: &'static str,
    height: f64,
    unit: &'static str,
    height_si: f64,
    shown: &'static str,
) -> Quantity {
    Quantity { heading, height, unit, height_si, shown }
}

const QUANTITIES: [Quantity; 10] = [
    quantity("a (g)", 5000.0, "g", 5000.0, " g "),
    quantity("a (m/s2)", 500.0, "m/s^2", 500.0, " m/s^2 "),
    quantity("strain (um/m)", 400.0, "m/m", 400e-6, " µm/m "),
    quantity("strain/µε", 40.0, "m/m", 40e-6, " µm/m "),
    quantity("p (bar)", 3.0, "bar", 3.0, " bar "),
    quantity("F (N)", 20.0, "N", 20.0, " N "),
    quantity("F (kN)", 2.0, "N", 2000.0, " kN "),
    quantity("w (mm)", 0.5, "m", 0.5e-3, " µm "),
    quantity("v (m/s)", 2.0, "m/s", 2.0, " m/s "),
    quantity("U (mV)", 2000.0, "V", 2.0, " V "),
];

/// Two half sines of 40 µs, at 200 µs and 400 µs, of 1 and 0.8 heights, on a small hum.
fn table(quantity: &Quantity) -> String {
    let (first, second) = (quantity.heading.replacen(' ', "1 ", 1), quantity.heading);
    let mut text = format!("Time (s),{first},other {second}\n");
    for n in 0..1000 {
        let pulse = |start: f64| {
            let phase = (f64::from(n) - start) / 40.0;
            let inside = (0.0..1.0).contains(&phase);
            if inside { (std::f64::consts::PI * phase).sin() } else { 0.0 }
        };
        let hum = 2e-3 * f64::from((n * 7919) % 101 - 50) / 50.0;
        let [a, b] = [pulse(200.0) + hum, 0.8 * pulse(400.0) - hum].map(|y| y * quantity.height);
        let _ = writeln!(text, "{:.6},{a:.5},{b:.5}", f64::from(n) * 1e-6);
    }
    text
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let arguments = [arguments, &["--json"]].concat();
    serde_json::from_str(&printed(folder, &arguments)).expect("JSON")
}

fn near(value: &Value, expected: f64, share: f64) {
    let found = value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    assert!((found / expected - 1.0).abs() < share, "{found}, expected {expected}");
}

#[test]
fn every_command_keeps_a_channels_unit() {
    let folder = temporary();
    let path = folder.path();
    for quantity in &QUANTITIES {
        let Quantity { unit, height_si, shown, heading, .. } = quantity;
        std::fs::write(path.join("lab.csv"), table(quantity)).expect("a file");

        let captures = &json(path, &["info", "lab.csv"])["shots"][0]["captures"];
        for (index, share) in [(0, 1.0), (1, 0.8)] {
            assert_eq!(captures[index]["y_unit"], **unit, "{heading}");
            near(&captures[index]["highest"], share * height_si, 0.01);
        }
        says(&format!("{} ", printed(path, &["info", "lab.csv"])), &[shown.trim_end()]);

        let channel = &json(path, &["arrivals", "lab.csv"])["shots"][0]["channels"][0];
        assert_eq!(channel["unit"], **unit, "{heading}");
        near(&channel["height"]["value"], *height_si, 0.01);
        assert_eq!(channel["height_v"].is_null(), *unit != "V", "{heading}");
        assert_eq!(channel["height_n"].is_null(), *unit != "N", "{heading}");
        says(&printed(path, &["arrivals", "lab.csv"]), &[shown, " ± "]);

        assert_eq!(json(path, &["spectrum", "lab.csv"])["unit"], **unit, "{heading}");
        says(&printed(path, &["spectrum", "lab.csv"]), &[&format!("(2009), Eq. (11), in {unit}")]);

        let between = ["transfer", "lab.csv", "--between", "CH1,CH2", "--segments", "2"];
        printed(path, &between);

        // Against itself, as a table and as a recording.
        printed(path, &["convert", "-q", "--force", "lab.csv", "lab.mcap"]);
        for other in ["lab.csv", "lab.mcap"] {
            let score = &json(path, &["compare", "lab.csv", other])["channels"][0];
            assert_eq!(score["unit"], **unit, "{heading}");
            near(&score["peak_measured"]["value"], *height_si, 0.01);
            near(&score["gain"]["value"], 1.0, 1e-9);
            assert_eq!(score["rms"], 0.0, "{heading}");
        }

        // A table of it has the unit, and is read with it.
        printed(path, &["convert", "-q", "--force", "lab.csv", "out.csv"]);
        let out = std::fs::read_to_string(path.join("out.csv")).expect("a table");
        assert!(out.starts_with(&format!("time_s,CH1_{unit},CH2_{unit}\n")), "{}", &out[..60]);
        let back = &json(path, &["info", "out.csv"])["shots"][0]["captures"][0];
        assert_eq!(
            (&back["y_unit"], &back["highest"]),
            (&captures[0]["y_unit"], &captures[0]["highest"])
        );
    }
}

/// The scene records volts. Newtons are compared in newtons; of other units nothing says how many
/// volts they are.
#[test]
fn newtons_are_never_compared_with_volts() {
    let folder = temporary();
    let path = folder.path();
    for quantity in &QUANTITIES {
        let Quantity { unit, heading, .. } = quantity;
        std::fs::write(path.join("lab.csv"), table(quantity)).expect("a file");
        let against = ["compare", "lab.csv", "magnet-0.61g"];
        match *unit {
            "V" | "N" => {
                let done = hertzscope(path, &[&against[..], &["--json"]].concat());
                let found: Value = serde_json::from_str(&done.stdout).expect("JSON");
                assert_eq!(found["channels"][0]["unit"], **unit, "{heading}");
                let notes = found["notes"].to_string();
                let turned = notes.contains("simulated CH1 is in N by its sensor's sensitivity");
                assert_eq!(turned, *unit == "N", "{notes}");
            }
            _ => says(
                &refused(path, &against),
                &[&format!("CH1 is measured in {unit}"), "in V", "--map"],
            ),
        }
        if *unit != "V" {
            let fit = ["fit", "lab.csv", "magnet-0.61g", "--free", "striker.speed"];
            says(&refused(path, &fit), &[&format!("the record is in {unit}"), "volts"]);
        }
    }
}

/// The simulated force is that of `force`, droop undone: 4.3 N at particle 2 by the run's own
/// truth.
#[test]
fn a_scenes_newtons_are_its_sensors_forces() {
    let folder = temporary();
    let path = folder.path();
    let newtons = QUANTITIES.iter().find(|quantity| quantity.heading == "F (N)").expect("newtons");
    std::fs::write(path.join("lab.csv"), table(newtons)).expect("a file");
    let done = hertzscope(path, &["compare", "lab.csv", "magnet-0.61g", "--json"]);
    let found: Value = serde_json::from_str(&done.stdout).expect("JSON");
    near(&found["channels"][0]["peak_simulated"]["value"], 4.317, 0.02);
    near(&found["channels"][0]["peak_measured"]["value"], 20.0, 0.01);
}

/// Pictures show values by their scale, whatever the levels of the file are.
#[test]
fn a_tables_picture_shows_its_pulse_on_the_screen() {
    let folder = temporary();
    let path = folder.path();
    std::fs::write(path.join("lab.csv"), table(&QUANTITIES[1])).expect("a file");
    printed(path, &["convert", "-q", "lab.csv", "lab.svg"]);
    let set = hertzscope::recording::open(&path.join("lab.csv")).expect("a table");
    for capture in &set.shots[0].captures {
        let scale = capture.waveform.vertical.scale;
        let heights: Vec<f64> = capture.waveform.heights().collect();
        for (height, value) in heights.iter().zip(capture.waveform.values()) {
            assert!((height / 25.0 - value / scale).abs() < 1e-9 && height.abs() <= 100.0);
        }
    }
}
