//! What a sensor's file says counts: differences of temperature, tolerances of measured sensors,
//! the chain it was calibrated with.

use hertzscope::experiment::{Integration, facts::facts, run};
use hertzscope::scene::Scene;

use super::{recorded, scene, surveyed};

fn problems(base: &str, text: &str) -> String {
    let text = format!("base = \"{base}\"\n{text}");
    Scene::from_text("test", "test.toml", &text).expect_err("problems").to_string()
}

/// A change of 5 °C is one of 5 K, not of 278.15 K.
#[test]
fn a_change_of_temperature_in_degrees_is_a_difference() {
    for degrees in ["5 degC", "5 °C", "5 K"] {
        let text = format!(
            "[effects.sensor_tolerance]\nspread = 0.0\ntemperature_change = \"{degrees}\"\nd33_coefficient = \"0.002 1/K\"\n\
             permittivity_coefficient = \"0 1/K\"\n"
        );
        let found = scene("magnet-0.61g", &text).sensor_tolerance.expect("a tolerance");
        assert!((found.temperature - 5.0).abs() < 1e-9, "{degrees}: {}", found.temperature);
    }
}

fn measured(folder: &tempfile::TempDir, text: &str) -> String {
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, text).expect("a file");
    format!("[sensors.p2]\nmodel = {:?}\nparticle = 2\n", file.display().to_string())
}

const MINE: &str =
    "sensitivity = \"0.4 V/N\"\nsensitivity_u = \"2 %\"\ntau = \"1 ms\"\ntau_u = \"1 %\"\n";
const TOLERANCE: &str = "[effects.sensor_tolerance]\nspread = \"20 %\"\n";

/// A measured sensor is drawn with its own uncertainty, whatever the data sheet's tolerance is;
/// without one it is refused.
#[test]
fn measured_sensors_are_drawn_within_their_own_uncertainty() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut varied = scene("magnet-0.61g", &format!("{}{TOLERANCE}", measured(&folder, MINE)));
    let mut squares = [0.0; 2];
    for seed in 0..1000 {
        varied.seed = seed;
        let channel = varied.scope.channels[0].clone().expect("a channel");
        let found = varied.circuit(0, &channel).expect("a sensor");
        squares[0] += (found.sensitivity / 0.4 - 1.0).powi(2);
        squares[1] += (found.time_constant / 1e-3 - 1.0).powi(2);
    }
    // A standard deviation from 1000 draws is good to 2.2 %.
    for (squares, u) in squares.into_iter().zip([0.02, 0.01]) {
        let ratio = (squares / 1000.0_f64).sqrt() / u;
        assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
    }
    let bare = MINE.replace("sensitivity_u = \"2 %\"\n", "");
    let told = problems("magnet-0.61g", &format!("{}{TOLERANCE}", measured(&folder, &bare)));
    assert!(told.contains("sensitivity_u") && told.contains("p2"), "{told}");
    let warm = "temperature_change = \"5 K\"\nd33_coefficient = \"0.002 1/K\"\npermittivity_coefficient = \"0 1/K\"\n";
    let told = problems("magnet-0.61g", &format!("{}{TOLERANCE}{warm}", measured(&folder, MINE)));
    assert!(told.contains("temperature_change"), "{told}");
}

/// A sensor that was calibrated in a steel cylinder and sits in a sphere is noted.
#[test]
fn a_calibration_in_another_host_is_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    for (host, is_noted) in [("steel_cylinder", true), ("ptfe_sphere", false)] {
        let text = measured(&folder, &format!("{MINE}calibrated_host = \"{host}\"\n"));
        let scene = scene("magnet-0.61g", &text);
        let summary =
            run(&scene, Integration::Accuracy(1e-3), 1, &mut |_| ()).expect("a run").summary;
        let noted = summary.notes.iter().any(|note| {
            note.sentence.contains("was calibrated in steel_cylinder and sits in ptfe_sphere")
        });
        assert_eq!(noted, is_noted, "{host}: {:?}", summary.notes);
        let notes = surveyed(&recorded(&scene, 1e-3)).notes;
        let is_told = notes.iter().any(|note| note.contains("30 % less"));
        assert_eq!(is_told, is_noted, "{host}: {notes:?}");
    }
}

/// 3 % of the data sheet, evenly, is 3 %/sqrt(3) = 1.732 %; at another range than the chain's both
/// gains count; at the chain's none does.
#[test]
fn a_chain_is_a_chain_at_its_channel_and_range_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let errors = "[effects.scope_errors]\n";
    let gain = |chain: &str, errors: &str| {
        let sensor = measured(&folder, &format!("{MINE}{chain}"));
        let scene = scene("magnet-0.61g", &format!("{sensor}{errors}"));
        let facts = facts(&scene, Integration::Accuracy(1e-6)).expect("facts");
        facts["hertzscope:sensor/1"]["gain_u_relative"].parse::<f64>().expect("a number")
    };
    let one = 0.03 / 3f64.sqrt();
    let near = |found: f64, expected: f64| (found - expected).abs() < 1e-9;
    assert!(near(gain("", errors), one), "the sensor alone");
    let chain = |channel: u8, range: &str| {
        format!("in_chain = true\nchannel = \"CH{channel}\"\nrange = \"{range}\"\n")
    };
    assert!(near(gain(&chain(1, "1 V/div"), errors), 0.0));
    assert!(near(gain(&chain(1, "5 V/div"), errors), one * 2f64.sqrt()));
    assert!(near(gain(&chain(2, "1 V/div"), errors), one * 2f64.sqrt()));
    assert!(near(gain(&chain(1, "5 V/div"), ""), 0.0), "a bench whose scope is exact");
    let sensor = measured(&folder, &format!("{MINE}in_chain = true\n"));
    assert!(problems("magnet-0.61g", &sensor).contains("range"));
}

/// What the scene states of a sensitivity counts in forces: 3 % of each.
#[test]
fn the_scenes_uncertainty_of_a_sensitivity_counts_in_forces() {
    let stated = "[uncertainty]\n\"sensors.*.sensitivity\" = \"3 %\"\n";
    let [with, without] =
        [stated, ""].map(|text| surveyed(&recorded(&scene("magnet-0.61g", text), 1e-3)));
    for (with, without) in with.channels.iter().zip(&without.channels) {
        let (with, without) = (with.height_n.expect("a peak"), without.height_n.expect("a peak"));
        let expected = without.u.hypot(0.03 * without.value);
        assert!((with.u / expected - 1.0).abs() < 1e-6, "{} {expected}", with.u);
    }
    let is_unknown = |note: &String| note.contains("the uncertainty of the sensitivity is unknown");
    assert!(!with.notes.iter().any(is_unknown), "{:?}", with.notes);
    assert!(without.notes.iter().any(is_unknown), "{:?}", without.notes);
}
