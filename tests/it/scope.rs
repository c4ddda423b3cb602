//! The oscilloscope as a whole: what scenes show through its front panel.

mod bits;

use hertzscope::experiment::{Integration, Outcome, run};
use hertzscope::recording::Capture;
use hertzscope::scene::{Scene, SceneError};
use hertzscope::scope::waveform::{HIGHEST_CODE, LOWEST_CODE};

/// Runs the default scene without noise, with `changes` to its front panel.
fn with(changes: &str) -> Outcome {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.toml");
    let noise =
        if changes.contains("scope_noise") { "" } else { "[effects]\nscope_noise = false\n" };
    std::fs::write(&file, format!("base = \"magnet-0.61g\"\n{noise}{changes}")).expect("a file");
    let scene = Scene::load(file.display().to_string()).expect("a scene");
    run(&scene, Integration::Accuracy(1e-6), 1, &mut |_| ()).expect("a run")
}

fn codes(capture: &Capture) -> Vec<i32> {
    capture.waveform.codes.iter().map(|code| i32::from(*code)).collect()
}

fn highest(capture: &Capture) -> f64 {
    let code = capture.waveform.codes.iter().max().expect("points");
    capture.waveform.volts_of(*code)
}

/// 2500 points, the trigger at a tenth of the screen, ground exact before the pulse, the peak of
/// particle 14 as its force, sensitivity and droop make it.
#[test]
fn the_record_is_as_the_instrument_makes_it() {
    let outcome = with("");
    assert_eq!(outcome.shot.captures.len(), 4);
    for capture in &outcome.shot.captures {
        let waveform = &capture.waveform;
        assert_eq!(waveform.codes.len(), 2500);
        assert_eq!(waveform.preamble.x_incr, 1e-6);
        assert_eq!(waveform.trigger_point, 250.0);
        assert!((waveform.time(250)).abs() < 1e-18);
        assert_eq!(waveform.volts(0), Some(0.0), "before the pulse");
    }
    // At the trigger the source has just passed 500 mV: the sample before lies below, this one not,
    // to half a level of 40 mV.
    let source = &outcome.shot.captures[0].waveform;
    assert!(source.volts(250).expect("a point") >= 0.48);
    assert!(source.volts(249).expect("a point") <= 0.52);
    let peak = outcome.summary.sensors[1].first_peak.expect("a peak");
    let sensitivity = 400e-12 / (0.159_375_4e-12 * 1800.0 + 710e-12 + 20e-12);
    let ideal = sensitivity * peak.dynamic_n;
    let seen = highest(&outcome.shot.captures[1]);
    // A single pulse droops by 4 to 12 % at RC of about 1 ms.
    assert!(seen < 0.97 * ideal && seen > 0.86 * ideal, "{seen} of {ideal}");
}

#[test]
fn coupling_inversion_and_offset_do_what_they_say() {
    let plain = with("");
    let changed = with(
        "[scope.ch2]\ncoupling = \"GND\"\n[scope.ch3]\ninvert = true\n[scope.ch4]\noffset = \"240 mV\"\n",
    );
    let (before, after) = (&plain.shot.captures, &changed.shot.captures);
    assert!(after[1].waveform.codes.iter().all(|code| *code == 0), "ground at 0 div");
    // Channel 3 stands at -2 div, 50 levels below the centre: turned around that line, to the
    // rounding of a level.
    let turned = codes(&before[2]).into_iter().zip(codes(&after[2]));
    assert!(turned.into_iter().all(|(a, b)| (a + 50 + b + 50).abs() <= 1));
    // 240 mV at 2 V/div are three levels.
    let shifted = codes(&before[3]).into_iter().zip(codes(&after[3]));
    assert!(shifted.into_iter().all(|(a, b)| b - a == 3));
    assert!(changed.summary.effects.contains(&"scope_offset".to_owned()));
}

/// AC coupling at 10 Hz takes a pulse's own droop a little further down: a first-order high-pass of
/// 15.9 ms.
#[test]
fn ac_coupling_droops() {
    let (dc, ac) = (with(""), with("[scope.ch2]\ncoupling = \"AC\"\n"));
    let sum = |outcome: &Outcome| codes(&outcome.shot.captures[1]).into_iter().sum::<i32>();
    assert!(sum(&ac) < sum(&dc));
    let difference = codes(&dc.shot.captures[1]).into_iter().zip(codes(&ac.shot.captures[1]));
    // 2 ms of at most 1.3 V against 15.9 ms: at most a sixth of a volt, four levels.
    assert!(difference.into_iter().all(|(a, b)| (a - b).abs() <= 4));
}

#[test]
fn what_leaves_the_converter_is_clipped_and_told() {
    let outcome = with("[scope.ch2]\nscale = \"50 mV/div\"\n");
    let found = codes(&outcome.shot.captures[1]);
    assert!(found.contains(&i32::from(HIGHEST_CODE)) && found.contains(&i32::from(LOWEST_CODE)));
    assert!(
        outcome
            .summary
            .notes
            .iter()
            .any(|note| note.sentence.starts_with("CH2") && note.sentence.contains("clipped"))
    );
}

/// A 10x probe loads the sensor with ten megohms: ten times the time constant, hardly any droop.
#[test]
fn a_probe_takes_the_droop_away() {
    let outcome = with("[scope.ch2]\nprobe = 10\n");
    let peak = outcome.summary.sensors[1].first_peak.expect("a peak");
    let sensitivity = 400e-12 / (0.159_375_4e-12 * 1800.0 + 710e-12 + 16e-12);
    let seen = highest(&outcome.shot.captures[1]);
    let ideal = sensitivity * peak.dynamic_n;
    assert!(seen > 0.97 * ideal && seen < 1.03 * ideal, "{seen} of {ideal}");
}

#[test]
fn triggers_fall_wait_and_give_up() {
    // Particle 2 swings below zero after its pulse: a falling edge through -200 mV comes later than
    // the rising one.
    let rising = with("");
    let falling = with("[scope.trigger]\nslope = \"fall\"\nlevel = \"-300 mV\"\n");
    assert!(falling.summary.trigger.crossed);
    assert!(falling.summary.trigger.time_s > rising.summary.trigger.time_s);
    let source = &falling.shot.captures[0].waveform;
    assert!(source.volts(250).expect("a point") <= -0.28);
    let waiting = with("[scope.trigger]\nlevel = \"5 V\"\n");
    assert!(!waiting.summary.trigger.recorded && waiting.shot.captures.is_empty());
    assert!(waiting.summary.notes.iter().any(|note| note.sentence.contains("not triggered")));
    let automatic = with("[scope.trigger]\nlevel = \"5 V\"\nmode = \"auto\"\n");
    assert!(automatic.summary.trigger.recorded && !automatic.summary.trigger.crossed);
    assert_eq!(automatic.shot.captures.len(), 4);
}

/// The default scene without noise, particle 2 at the external input instead of channel 1, which
/// stays open, and the trigger there.
fn on_external(source: &str, level: &str) -> Result<Scene, SceneError> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/instruments/scenes/magnet-0.61g.toml");
    let text = std::fs::read_to_string(file).expect("it ships");
    let text = text.replace("[effects.scope_noise]\nrms = \"0.02 div\"\n", "");
    let input = "input = \"p2\"";
    assert_eq!(text.matches(input).count(), 1, "one channel has particle 2");
    let text = text.replace(input, "");
    let (_, rest) = text.split_once("[scope.trigger]\n").expect("a trigger");
    let end = rest.find("\n[").unwrap_or(rest.len());
    let trigger = &rest[..end];
    let set = format!("source = \"{source}\"\nlevel = \"{level}\"\nmode = \"normal\"\n");
    let text = text.replace(trigger, &set);
    let text = format!("{text}\n[scope.external]\n{input}\n");
    Scene::from_text("external", "external.toml", &text)
}

/// The external input sees what a channel without probe would: the scope triggers at the same
/// sample, whichever of its two ranges watches. Beyond a range's reach there is no level.
#[test]
fn a_scene_triggers_on_its_external_input() {
    let on_channel = with("[scope.trigger]\nlevel = \"400 mV\"\n");
    assert!(on_channel.summary.trigger.crossed);
    for source in ["EXT", "EXT5"] {
        let external = on_external(source, "400 mV").expect("a scene");
        let external = run(&external, Integration::Accuracy(1e-6), 1, &mut |_| ()).expect("a run");
        assert_eq!(external.summary.trigger, on_channel.summary.trigger, "{source}");
        let records = |outcome: &Outcome| codes(&outcome.shot.captures[1]);
        assert_eq!(records(&external), records(&on_channel), "{source}");
        let flat = codes(&external.shot.captures[0]);
        assert!(flat.iter().all(|code| *code == flat[0]), "channel 1 is open");
    }
    for (source, level, reach) in
        [("EXT", "-1.7 V", "1.60 V at EXT"), ("EXT5", "8.1 V", "8.00 V at EXT5")]
    {
        let error = on_external(source, level).expect_err("out of reach").to_string();
        assert!(error.contains("scope.trigger.level") && error.contains(reach), "{error}");
    }
    let waiting = on_external("EXT5", "8 V").expect("a scene");
    let waiting = run(&waiting, Integration::Accuracy(1e-3), 1, &mut |_| ()).expect("a run");
    assert!(!waiting.summary.trigger.recorded && waiting.shot.captures.is_empty());
}

/// Turning the horizontal position by one division moves the picture by 250 points, nothing else.
#[test]
fn a_delayed_record_is_the_same_picture_further_on() {
    let (now, later) = (with(""), with("[scope]\nposition = \"1.25 ms\"\n"));
    let (now, later) = (codes(&now.shot.captures[2]), codes(&later.shot.captures[2]));
    assert_eq!(now[250..], later[..2250]);
    assert_eq!(
        with("[scope]\nposition = \"1.25 ms\"\n").shot.captures[0].waveform.trigger_point,
        0.0
    );
}

/// At 25 ns/div a record is ten times denser than 1 GS/s: sin(x)/x in between, smooth to a level.
#[test]
fn fast_time_bases_are_interpolated() {
    let outcome = with("[scope]\ntime_base = \"25 ns/div\"\nposition = \"0 s\"\n");
    let waveform = &outcome.shot.captures[0].waveform;
    assert_eq!(waveform.preamble.x_incr, 1e-10);
    let steps = waveform.codes.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    assert!(steps.into_iter().max().expect("points") <= 1);
}

/// The same seed gives the same levels, another seed others; noise of 0.02 div is half a level.
#[test]
fn noise_comes_from_the_seed() {
    let scene = |seed: u64| {
        let mut scene = Scene::load("magnet-0.61g").expect("a scene");
        scene.seed = seed;
        run(&scene, Integration::Accuracy(1e-6), 1, &mut |_| ()).expect("a run").shot
    };
    assert_eq!(scene(1).captures, scene(1).captures);
    assert_ne!(scene(1).captures, scene(2).captures);
    // Before the pulse: 200 samples of a rounded normal distribution. Rounding adds 1/12 to the
    // variance of 1/4.
    let quiet: Vec<f64> =
        codes(&scene(3).captures[1])[..200].iter().map(|code| f64::from(*code)).collect();
    let mean = quiet.iter().sum::<f64>() / 200.0;
    let variance = quiet.iter().map(|code| (code - mean).powi(2)).sum::<f64>() / 199.0;
    // Three standard errors of a variance from 200 samples are 30 %.
    assert!((variance / (0.25 + 1.0 / 12.0) - 1.0).abs() < 0.3, "{variance}");
    assert!(mean.abs() < 3.0 * (variance / 200.0).sqrt(), "{mean}");
}

/// The recording in `recordings/` is sound, and its scene still gives it.
#[test]
fn the_shipped_recording_is_what_its_scene_gives() {
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/gravity-0.61g.mcap");
    let set = hertzscope::recording::format::open(&path).expect("a recording");
    assert!(set.problems.is_empty(), "{:?}", set.problems);
    let scene = Scene::load("gravity-0.61g").expect("its scene");
    let fresh = run(&scene, Integration::Accuracy(scene.accuracy), 1, &mut |_| ()).expect("a run");
    for (kept, made) in set.shots[0].captures.iter().zip(&fresh.shot.captures) {
        assert_eq!(kept.waveform, made.waveform);
    }
    assert_eq!(set.shots[0].captures.len(), 4);
}

/// Noise crosses a low level long before the impact; a scope accepts no trigger before the part
/// ahead of it is full, so every record is alive from its first point.
#[test]
fn noise_triggers_only_once_the_record_is_full() {
    let outcome =
        with("[effects.scope_noise]\nrms = \"0.5 div\"\n[scope.trigger]\nlevel = \"0.1 V\"\n");
    let found = codes(&outcome.shot.captures[0]);
    let still = found.windows(2).take_while(|pair| pair[0] == pair[1]).count();
    assert!(still < 5, "{still} equal points at the start");
}

/// Speeds are between plates, wherever they sit in their hosts.
#[test]
fn speeds_count_from_plate_to_plate() {
    let (centred, outer) =
        (with(""), with("[sensors.p14]\noffset = -0.5\n[sensors.p27]\noffset = 0.5\n"));
    let distance = |outcome: &Outcome| {
        let speeds = &outcome.summary.speeds;
        speeds.iter().find(|s| (s.from, s.to) == (14, 27)).expect("a pair").distance_m
    };
    // Half a sphere above, half a cylinder below.
    let more = 0.5 * (4.76e-3 + 3.12e-3);
    assert!((distance(&outer) - distance(&centred) - more).abs() < 1e-15);
}
