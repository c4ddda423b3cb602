//! `hertzscope calibrate` and `hertzscope force` as a user meets them.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

pub(super) fn hertzscope(folder: &Path, arguments: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("hertzscope").expect("the program");
    command.current_dir(folder).args(arguments).assert()
}

pub(super) fn out(done: &assert_cmd::assert::Assert) -> String {
    String::from_utf8_lossy(&done.get_output().stdout).into_owned()
}

pub(super) fn refused(folder: &Path, arguments: &[&str]) -> String {
    let done = hertzscope(folder, arguments).code(2);
    String::from_utf8_lossy(&done.get_output().stderr).into_owned()
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// From the design to newtons: the test's files, the certificate, the sensor's file, a recording in
/// newtons.
#[test]
fn a_sensor_is_calibrated_and_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let page = hertzscope(
        at,
        &[
            "calibrate",
            "--simulate",
            "pzt-5h-440pf",
            "--striker",
            "ptfe-capped-0.61g",
            "--repeat",
            "20",
            "-o",
            "test",
        ],
    )
    .success();
    let page = out(&page);
    assert!(page.contains("20 times blind") && page.contains("plan.toml"), "{page}");
    let json = hertzscope(at, &["calibrate", "test/plan.toml", "--json", "-o", "out"]).success();
    let found: Value = serde_json::from_str(&out(&json)).expect("JSON");
    // 600 pC/N on 3400 times 0.159375 pF and 460 pF.
    let truth = 600e-12 / (3400.0 * 0.15937538e-12 + 460e-12);
    let off = number(&found["sensitivity_v_per_n"]) / truth - 1.0;
    assert!(off.abs() < number(&found["U95_relative"]) * 1.5, "{off}");
    assert!(number(&found["U95_relative"]) < 0.02);
    assert!((number(&found["tau_s"]) / (1e6 * 600e-12 / truth) - 1.0).abs() < 0.02);
    assert_eq!(found["impacts"].as_array().expect("impacts").len(), 6);
    let shares: f64 =
        found["budget"].as_array().expect("lines").iter().map(|l| number(&l["share"])).sum();
    assert!((shares - 1.0).abs() < 1e-9);
    assert_eq!(found["monte_carlo"]["agrees_with_gum"], true);
    assert!(found["nonlinearity"].is_number());
    let certificate =
        std::fs::read_to_string(at.join("out/certificate.md")).expect("a certificate");
    let hash = found["impacts"][0]["sha256"].as_str().expect("a hash");
    let digest = <sha2::Sha256 as sha2::Digest>::digest(
        std::fs::read(at.join("test/impact-1.mcap")).expect("a file"),
    );
    let expected = digest.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat();
    assert_eq!(hash, expected);
    for told in [
        "item",
        "hertzscope 0.",
        hash,
        "expanded",
        "traceable",
        "impact-6.svg",
        "temperature",
        "not stated",
        "Monte Carlo",
        "of the same inputs: ",
        "the ends agree: ",
        "Birge ratio",
    ] {
        assert!(certificate.contains(told), "{told} in\n{certificate}");
    }
    let html = std::fs::read_to_string(at.join("out/certificate.html")).expect("a page");
    // One of all impacts, and one of each.
    assert_eq!(html.matches("<svg").count(), 7);
    used(at, &found);
}

/// The sensor's file serves recordings.
fn used(at: &Path, found: &Value) {
    let sensor = "out/pzt-5h-440pf-calibrated.toml";
    let wire = format!("CH1={sensor}");
    let json = hertzscope(
        at,
        &["force", "test/impact-1.mcap", "--sensor", &wire, "--json", "-o", "force.csv"],
    )
    .success();
    let force: Value = serde_json::from_str(&out(&json)).expect("JSON");
    let channel = &force["channels"][0];
    let values: Vec<f64> =
        channel["force_n"].as_array().expect("values").iter().map(number).collect();
    let top = values.iter().copied().fold(0.0, f64::max);
    let index = values.iter().position(|v| *v == top).expect("a peak");
    let u = number(&channel["u_n"][index]);
    let peak = number(&found["impacts"][0]["peak_force_n"]);
    assert!(
        (top - peak).abs() < 3.0 * u && u > top * number(&channel["sensitivity_u_relative"]),
        "{top} {peak} {u}"
    );
    assert_eq!(
        std::fs::read_to_string(at.join("force.csv")).expect("a file").lines().count(),
        2501
    );
    hertzscope(at, &["convert", "test/impact-1.mcap", "wired.mcap", "--sensor", &wire, "-q"])
        .success();
    let arrivals = hertzscope(at, &["arrivals", "wired.mcap", "--json"]).success();
    let arrivals: Value = serde_json::from_str(&out(&arrivals)).expect("JSON");
    let height = &arrivals["shots"][0]["channels"][0]["height_n"];
    assert!((number(&height["value"]) - peak).abs() < 4.0 * number(&height["u"]), "{height}");
}

const PLAN: &str = "title = \"test\"\n[sensor]\nitem = \"plate\"\n[scope]\nin_chain = true\n[strikers.ball]\nmass = \"1 g\"\nmass_u = \"0.1 %\"\n\
    [[impacts]]\nrecording = \"none.mcap\"\nheight = \"10 mm\"\nheight_u = \"0.1 mm\"\nrebound_speed = \"0.4 m/s\"\nrebound_speed_u = \"1 %\"\n";

/// All mistakes of a plan at once, each with its line.
#[test]
fn mistakes_in_a_plan_are_told_with_their_places() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let told = |plan: &str| {
        std::fs::write(at.join("plan.toml"), plan).expect("a file");
        refused(at, &["calibrate", "plan.toml"])
    };
    let missing = told(PLAN);
    assert!(
        missing.contains(
            "plan.toml:10:13: impacts.1.recording: found \"none.mcap\", which does not exist"
        ),
        "{missing}"
    );
    std::fs::write(at.join("none.mcap"), "no recording").expect("a file");
    let unreadable = told(PLAN);
    assert!(
        unreadable.contains("plan.toml:10:13") && unreadable.contains("none.mcap"),
        "{unreadable}"
    );
    for (right, wrong, expected) in [
        (
            "mass = \"1 g\"",
            "mass = \"-1 g\"",
            "plan.toml:7:8: strikers.ball.mass: found \"-1 g\", expected a mass (kg) above zero",
        ),
        (
            "mass_u = \"0.1 %\"\n",
            "",
            "missing `strikers.ball.mass_u`: give the standard uncertainty of mass",
        ),
        ("height_u = \"0.1 mm\"", "height_u = \"0.1 g\"", "plan.toml:12:12: impacts.1.height_u"),
        ("in_chain = true", "", "gain_limit = \"3 %\" of its data sheet"),
        (
            "rebound_speed = \"0.4 m/s\"\n",
            "",
            "one of rebound_speed, rebound_height, rebound_gate_time, flight_time",
        ),
        (
            "height = ",
            "speed = \"1 m/s\"\nheight = ",
            "found 2 of them, expected one of speed, height, gate_time",
        ),
        ("title", "colour = \"red\"\ntitle", "found the unknown key `colour`"),
        (
            "height = \"10 mm\"",
            "window = [\"1 us\", \"0 us\"]\nheight = \"10 mm\"",
            "expected two times",
        ),
        (
            "height = \"10 mm\"",
            "striker = \"anvil\"\nheight = \"10 mm\"",
            "one of [strikers]: ball",
        ),
    ] {
        assert!(PLAN.contains(right));
        let told = told(&PLAN.replace(right, wrong));
        assert!(told.contains(expected), "{expected} in\n{told}");
    }
    assert!(refused(at, &["calibrate", "no.toml"]).contains("no.toml"));
    assert!(refused(at, &["calibrate", "--simulate", "no-such"]).contains("pzt-5a-710pf"));
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("recordings/gravity-0.61g.mcap")
        .display()
        .to_string();
    let plan = PLAN.replace("none.mcap", &shipped);
    let channel = told(&format!("channel = \"CH9\"\n{plan}"));
    assert!(channel.contains("CH9 over time") && channel.contains("plan.toml:11:13"), "{channel}");
    assert!(refused(at, &["force", &shipped, "--sensor", "CH7=pzt-5a-710pf"]).contains("CH1"));
    assert!(
        refused(at, &["force", &shipped, "--sensor", "pzt-5a-710pf"]).contains("CH1=sensor.toml")
    );
}

/// A real scope's file knows no sensor: without one there are no newtons.
#[test]
fn volts_without_a_sensor_stay_volts() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("recordings/gravity-0.61g.mcap")
        .display()
        .to_string();
    hertzscope(at, &["convert", &shipped, "lab", "-q"]).success();
    assert!(refused(at, &["force", "lab/ALL0000"]).contains("--sensor CH1="));
    let page = hertzscope(at, &["force", "lab/ALL0000", "--sensor", "ch2=pzt-5a-710pf"]).success();
    assert!(
        out(&page).contains("the uncertainty of the sensitivity is unknown")
            && out(&page).contains("CH1: no sensor with sensitivity"),
        "{}",
        out(&page)
    );
}
