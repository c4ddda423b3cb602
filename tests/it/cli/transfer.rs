//! `hertzscope transfer` of a scene.

use serde_json::Value;

use super::{COULD_NOT, hertzscope, printed, temporary};

/// A drive so weak that the chain is linear, and dashpots, by which the chain comes to a steady
/// state within the scene.
const LINEAR: &str = r#"
base = "driven-dimer"
duration = "10 ms"
drive.stack.stroke = "1 pm"
[effects.dashpot]
gamma = "0.8 N*s/m"
end_of_contact = "zero_overlap"
"#;

/// The ratio of forces six cells apart in the driven dimer of two independent codes, in the gap and
/// at the top of the optical branch, within four standard uncertainties.
#[test]
fn a_scene_is_measured_with_noise() {
    let folder = temporary();
    std::fs::write(folder.path().join("linear.toml"), LINEAR).expect("a file");
    let asked = ["transfer", "linear.toml", "--between", "p3,p15", "--json", "--quiet"];
    let band = ["--from", "5kHz", "--to", "20kHz"];
    let page = printed(folder.path(), &[&asked[..], &band].concat());
    let page: Value = serde_json::from_str(&page).expect("JSON");
    let step = page["step_hz"].as_f64().expect("a step");
    for (frequency, expected) in [(1e4, 3.856883598e-4), (1.5e4, 1.300442185e-3)] {
        let bin = (frequency / step).round() as usize;
        let [gain, u, coherence] =
            ["gain", "gain_u", "coherence"].map(|key| page[key][bin].as_f64().expect("a number"));
        println!("{frequency} Hz: {gain:e} ± {u:e}, coherence {coherence}");
        assert!((gain - expected).abs() < 4.0 * u && u < 0.1 * expected, "{gain} {u}");
        assert!(coherence > 0.9, "{coherence}");
    }
    assert_eq!(page["shots"], 8);
    for (more, told) in [
        (&["--from", "1ms", "--to", "2ms"][..], "--from 1kHz --to 20kHz"),
        (&["--from", "2kHz", "--to", "1kHz"], "expected more than --from"),
    ] {
        let done = hertzscope(folder.path(), &[&asked[..], more].concat());
        assert_eq!(done.code, COULD_NOT);
        assert!(done.stderr.contains(told), "{}", done.stderr);
    }
    let struck = ["transfer", "magnet-0.61g", "--between", "p2,p14", "--quiet"];
    let done = hertzscope(folder.path(), &[&struck[..], &band].concat());
    assert!(done.stderr.contains("found no [drive] in magnet-0.61g"), "{}", done.stderr);
    assert_eq!(done.code, COULD_NOT);
}
