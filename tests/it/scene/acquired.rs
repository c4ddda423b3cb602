//! How the scene's scope takes records: averages, peak detection, trigger coupling, holdoff.

use hertzscope::experiment::{Integration, run};
use hertzscope::recording::Shot;
use hertzscope::scene::Scene;
use hertzscope::scope::{AcquireMode, EdgeCoupling, PointFormat};

use super::{load, problems};

/// A steel chain, noise of half a level, and the scope with `keys` and `trigger`.
fn text(keys: &str, trigger: &str) -> String {
    format!(
        "duration = \"1 ms\"\nseed = 3\n[particles.ball]\nmaterial = \"steel_440c\"\ndiameter = \"10 mm\"\n\
         [chain]\ntop = \"free\"\nbottom = {{ wall = \"steel_440c\" }}\n[[chain.segments]]\nparticles = [\"ball\"]\nrepeat = 5\n\
         [striker]\nmaterial = \"steel_440c\"\ndiameter = \"10 mm\"\nspeed = \"0.2 m/s\"\n\
         [sensors.s]\nmodel = \"pzt-5a-710pf\"\nparticle = 2\n[effects.scope_noise]\nrms = \"0.2 div\"\n\
         [scope]\nmodel = \"tds2014\"\ntime_base = \"100 us/div\"\n{keys}\n\
         [scope.trigger]\nsource = \"CH1\"\nlevel = \"3 V\"\nmode = \"normal\"\n{trigger}\n[scope.ch1]\ninput = \"s\"\nscale = \"5 V/div\"\n"
    )
}

fn shot(keys: &str, trigger: &str) -> (Scene, Shot) {
    shot_of(&text(keys, trigger))
}

fn shot_of(text: &str) -> (Scene, Shot) {
    let scene = load(text).expect("a scene");
    let outcome = run(&scene, Integration::Accuracy(1e-4), 1, &mut |_| ()).expect("a run");
    (scene, outcome.shot)
}

/// Root mean square of the first hundred samples about their mean, in levels.
fn noise(shot: &Shot) -> f64 {
    let codes: Vec<f64> =
        shot.captures[0].waveform.codes.iter().take(100).map(|c| f64::from(*c)).collect();
    let mean = codes.iter().sum::<f64>() / 100.0;
    (codes.iter().map(|c| (c - mean).powi(2)).sum::<f64>() / 100.0).sqrt()
}

/// Noise of 0.2 div is 5 levels; of sixteen records a quarter is left, with the rounding's 0.29
/// levels on top.
#[test]
fn averages_leave_a_quarter_of_the_noise() {
    let (_, single) = shot("", "");
    let (scene, mean) = shot("acquisition = \"average\"\naverages = 16", "");
    assert_eq!(
        (scene.scope.acquisition.mode, scene.scope.acquisition.depth()),
        (AcquireMode::Average, 16)
    );
    let (single, averaged) = (noise(&single), noise(&mean));
    assert!((single / 5.0 - 1.0).abs() < 0.25, "{single}");
    let expected = (5.0f64.powi(2) / 16.0 + 1.0 / 12.0).sqrt();
    assert!((averaged / expected - 1.0).abs() < 0.25, "{averaged}, not {expected}");
    assert_eq!(mean.captures[0].notes, ["average of 16 impacts"]);
}

/// Pairs of the lowest and the highest sample: of so much noise, far apart, and around the signal.
#[test]
fn peak_detection_keeps_lowest_and_highest() {
    let (scene, shot) = shot("acquisition = \"peak detect\"", "");
    assert!(
        scene.scope.signal_interval() < scene.scope.model.signal_interval(scene.scope.time_base)
    );
    let waveform = &shot.captures[0].waveform;
    assert_eq!(waveform.preamble.pt_fmt, PointFormat::Envelope);
    assert!(waveform.codes.chunks_exact(2).all(|pair| pair[0] <= pair[1]));
    let width: i32 = waveform.codes.chunks_exact(2).map(|p| i32::from(p[1] - p[0])).sum();
    // Of twenty draws or more the range is beyond 3.7 standard deviations of 5 levels.
    assert!(width / 1250 > 15, "{}", width / 1250);
}

/// A pulse is fast: alternating coupling and the rejection of low frequencies trigger on it, the
/// rejection of high ones later.
#[test]
fn the_trigger_is_coupled() {
    // Hardly any noise: the level is to be crossed by the pulse.
    let quiet = |coupling: &str| {
        text("", &format!("coupling = \"{coupling}\"")).replace("0.2 div", "0.001 div")
    };
    let at = |coupling: &str| shot_of(&quiet(coupling)).1.trigger_time;
    let direct = at("DC").expect("a trigger");
    let later = at("HF reject").expect("a trigger");
    assert!(later > direct + 1e-6, "{later} after {direct}");
    for coupling in ["AC", "noise reject"] {
        let found = at(coupling).expect(coupling);
        assert!((found - direct).abs() < 2e-6, "{coupling}: {found}, {direct}");
    }
    let (scene, _) = shot("", "coupling = \"LF reject\"\nholdoff = \"1 ms\"");
    let trigger = scene.scope.trigger;
    assert_eq!((trigger.coupling, trigger.holdoff), (EdgeCoupling::LowFrequencyReject, 1e-3));
}

#[test]
fn what_the_scope_cannot_is_refused() {
    for (keys, trigger, found, expected) in [
        ("acquisition = \"mean\"", "", "\"mean\"", "\"peak detect\""),
        ("averages = 17", "", "17", "4, 16, 64, 128"),
        ("", "coupling = \"GND\"", "\"GND\"", "\"noise reject\""),
        ("", "holdoff = \"1 ns\"", "1.00 ns", "500 ns to 10.0 s"),
    ] {
        let problems = problems(&text(keys, trigger));
        assert_eq!(problems.len(), 1, "{problems:?}");
        let told = problems[0].to_string();
        assert!(told.contains(found) && told.contains(expected), "{told}");
    }
    let spread = text("acquisition = \"average\"", "").replace(
        "[effects.scope_noise]",
        "[effects.striker_speed_spread]\nrelative = \"1 %\"\n[effects.scope_noise]",
    );
    let told = problems(&spread)[0].to_string();
    assert!(told.contains("speeds differ") && told.contains("striker_speed_spread"), "{told}");
}
