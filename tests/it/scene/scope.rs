//! The oscilloscope's front panel: one mistake at a time.

use super::{all_told, bench_with, load, problems};

#[test]
fn time_bases_that_are_not_on_the_instrument() {
    all_told(&[
        [
            "time_base = \"250 us/div\"",
            "time_base = ¦\"200 us/div\"",
            "scope.time_base",
            "200.0 µs/div",
            "nearest is 250 µs/div",
        ],
        [
            "time_base = \"250 us/div\"",
            "time_base = ¦\"0 s/div\"",
            "scope.time_base",
            "0 s/div",
            "above zero",
        ],
    ]);
}

/// 2 ms at 50 ms/div: a point every 200 us, ten in all. At 5 ns/div, 1 GS/s: 30 ms are 30 million
/// samples.
#[test]
fn time_bases_that_show_nothing_or_too_much() {
    all_told(&[[
        "time_base = \"250 us/div\"",
        "time_base = ¦\"50 ms/div\"",
        "scope.time_base",
        "10",
        "at least 20 samples",
    ]]);
    let text = bench_with("duration = \"2 ms\"", "duration = \"30 ms\"")
        .replace("\"250 us/div\"", "\"5 ns/div\"");
    let told = problems(&text);
    assert_eq!(told.len(), 1, "{told:#?}");
    assert_eq!(told[0].key, "scope.time_base");
    assert!(told[0].found.contains("30000000"), "{}", told[0]);
    assert!(told[0].expected.contains("at most"), "{}", told[0]);
}

/// 250 us/div: the record is 2.5 ms long, its centre at `position`.
#[test]
fn records_before_and_after_everything() {
    all_told(&[
        [
            "position = \"1 ms\"",
            "position = ¦\"-1.3 ms\"",
            "scope.position",
            "ends 51.0 µs before the trigger",
            "after the trigger",
        ],
        [
            "position = \"1 ms\"",
            "position = ¦\"3.3 ms\"",
            "scope.position",
            "starts 2.05 ms after the trigger",
            "2.00 ms",
        ],
        ["position = \"1 ms\"", "position = ¦\"1 m\"", "scope.position", "a length", "a time"],
    ]);
    for sound in ["-1.2 ms", "3.2 ms"] {
        let text = bench_with("position = \"1 ms\"", &format!("position = \"{sound}\""));
        load(&text).unwrap_or_else(|error| panic!("{sound}: {error}"));
    }
}

#[test]
fn vertical_settings_beyond_the_instrument() {
    let ch2 = "input = \"p14\"\nscale = \"1 V/div\"\nposition = \"0 div\"";
    let with = |scale: &str, rest: &str| format!("input = \"p14\"\nscale = {scale}\n{rest}");
    all_told(&[
        [
            ch2,
            &with("¦\"1 mV/div\"", ""),
            "scope.ch2.scale",
            "1.00 mV/div",
            "2.00 mV/div to 5.00 V/div",
        ],
        [ch2, &with("¦\"5.01 V/div\"", ""), "scope.ch2.scale", "5.01 V/div", "5.00 V/div"],
        [
            ch2,
            &with("¦\"10 mV/div\"", "probe = 10"),
            "scope.ch2.scale",
            "10.0 mV/div",
            "20.0 mV/div to 50.0 V/div",
        ],
        [ch2, &with("¦\"1 V\"", ""), "scope.ch2.scale", "a voltage (V)", "a vertical scale"],
        [ch2, &with("\"1 V/div\"", "probe = ¦5"), "scope.ch2.probe", "5", "1, 10, 100, 1000"],
        [
            ch2,
            &with("\"1 V/div\"", "position = ¦\"0.05 div\""),
            "scope.ch2.position",
            "0.05 div",
            "0.04 div",
        ],
        [
            ch2,
            &with("\"1 V/div\"", "position = ¦\"1 mm\""),
            "scope.ch2.position",
            "a length",
            "(div)",
        ],
    ]);
}

/// The ends of the range are settings of the instrument, through every probe.
/// Programmer manual of the TDS 2014, table 2-27: positions reach 2 V at the input up to 200
/// mV/div, 50 V above it.
#[test]
fn traces_are_not_moved_beyond_the_instruments_reach() {
    let ch2 = "input = \"p14\"\nscale = \"1 V/div\"\nposition = \"0 div\"";
    let with = |scale: &str, position: &str| {
        format!("input = \"p14\"\nscale = \"{scale}\"\nposition = {position}")
    };
    all_told(&[
        [ch2, &with("1 V/div", "¦\"1000 div\""), "scope.ch2.position", "1000 div", "within 50 div"],
        [ch2, &with("1 V/div", "¦\"-52 div\""), "scope.ch2.position", "-52 div", "within 50 div"],
        [ch2, &with("200 mV/div", "¦\"12 div\""), "scope.ch2.position", "12 div", "within 10 div"],
    ]);
    for (scale, position) in [("1 V/div", "\"50 div\""), ("200 mV/div", "\"-10 div\"")] {
        load(&bench_with(ch2, &with(scale, position))).expect("within reach");
    }
}

/// A number without a unit is only repeated in the example if it is one that would be taken.
#[test]
fn a_scale_of_zero_is_not_its_own_example() {
    let ch2 = "input = \"p14\"\nscale = \"1 V/div\"";
    all_told(&[[
        ch2,
        "input = \"p14\"\nscale = ¦0",
        "scope.ch2.scale",
        "the number 0 without a unit",
        "a vertical scale (V/div) above zero, e.g. \"500 mV/div\"",
    ]]);
}

#[test]
fn smallest_and_largest_scale_are_in_range() {
    let ch2 = "input = \"p14\"\nscale = \"1 V/div\"\nposition = \"0 div\"";
    for (scale, probe) in
        [("2 mV/div", 1), ("5 V/div", 1), ("20 mV/div", 10), ("50 V/div", 10), ("5 kV/div", 1000)]
    {
        let new = format!("input = \"p14\"\nscale = \"{scale}\"\nprobe = {probe}");
        let scene = load(&bench_with(ch2, &new)).unwrap_or_else(|e| panic!("{scale}: {e}"));
        assert!(scene.scope.channels[1].is_some(), "{scale}");
    }
}

#[test]
fn triggers_that_cannot_be() {
    all_told(&[
        // 1 V/div, 2 div up: 6 V is the eighth division.
        [
            "level = \"200 mV\"",
            "level = ¦\"6.01 V\"",
            "scope.trigger.level",
            "6.01 V",
            "within 8 div",
        ],
        [
            "level = \"200 mV\"",
            "level = ¦\"-10.1 V\"",
            "scope.trigger.level",
            "-10.1 V",
            "within 8 div",
        ],
        [
            "source = \"CH1\"",
            "source = ¦\"CH4\"",
            "scope.trigger.source",
            "CH4",
            "a channel that is on",
        ],
        ["source = \"CH1\"", "source = ¦\"CH5\"", "scope.trigger.source", "CH5", "\"CH4\""],
        [
            "source = \"CH1\"",
            "source = ¦\"EXT\"",
            "scope.trigger.source",
            "EXT",
            "[scope.external]",
        ],
        ["source = \"CH1\"", "source = ¦\"LINE\"", "scope.trigger.source", "LINE", "the mains"],
        [
            "source = \"CH1\"",
            "source = ¦\"MATH\"",
            "scope.trigger.source",
            "MATH",
            "\"EXT\", \"EXT5\"",
        ],
        ["slope = \"rise\"", "slope = ¦\"up\"", "scope.trigger.slope", "up", "\"rise\", \"fall\""],
        ["mode = \"normal\"", "mode = ¦\"single\"", "scope.trigger.mode", "single", "\"auto\""],
    ]);
    assert!(load(&bench_with("level = \"200 mV\"", "level = \"6 V\"")).is_ok());
}

#[test]
fn inputs_that_are_no_sensors() {
    all_told(&[
        ["input = \"p14\"", "input = ¦\"p15\"", "scope.ch2.input", "\"p15\"", "floor, p14, p3"],
        // One plate on two inputs would be loaded twice; the circuit knows one load.
        [
            "input = \"p14\"",
            "input = ¦\"p3\"",
            "scope.ch2.input",
            "\"p3\", which is at the input of CH1 already",
            "a sensor of its own",
        ],
    ]);
    let open = load(&bench_with("input = \"p14\"\n", "")).expect("an input may stay open");
    assert_eq!(open.scope.channels[1].as_ref().and_then(|c| c.input.clone()), None);
}

/// The external input takes 1.6 V either way, through its divider 8 V.
#[test]
fn levels_beyond_the_external_input_are_refused() {
    let text = |source: &str, level: &str| {
        bench_with("input = \"p14\"\n", "")
            .replace("source = \"CH1\"", &format!("source = \"{source}\""))
            .replace("level = \"200 mV\"", &format!("level = \"{level}\""))
            + "\n[scope.external]\ninput = \"p14\"\n"
    };
    for (source, within, beyond) in [("EXT", "1.60 V", "1.61 V"), ("EXT5", "8.00 V", "8.01 V")] {
        for sign in ["", "-"] {
            let level = format!("{sign}{within}");
            load(&text(source, &level)).unwrap_or_else(|error| panic!("{level}: {error}"));
            let told = problems(&text(source, &format!("{sign}{beyond}")));
            let expected = format!("within {within} at {source}");
            assert!(told.iter().any(|problem| problem.expected.contains(&expected)), "{told:#?}");
        }
    }
}

#[test]
fn a_screen_without_channels_and_a_scene_without_scope() {
    let start = super::BENCH.find("[scope.ch1]").expect("a channel");
    let told = problems(&super::BENCH[..start]);
    let keys: Vec<&str> = told.iter().map(|p| p.key.as_str()).collect();
    assert_eq!(keys, ["scope.ch1", "scope.trigger.source"], "{told:#?}");
    let start = super::BENCH.find("[scope]").expect("a scope");
    let told = problems(&super::BENCH[..start]);
    let keys: Vec<&str> = told.iter().map(|p| p.key.as_str()).collect();
    assert_eq!(keys, ["scope"], "{told:#?}");
}

/// What is wrong with a channel is told there, and not again by the trigger that watches it.
#[test]
fn a_wrong_channel_has_no_echo() {
    all_told(&[
        [
            "input = \"p3\"\nscale = \"1 V/div\"",
            "input = \"p3\"\nscale = ¦\"1 V\"",
            "scope.ch1.scale",
            "a voltage",
            "a vertical scale",
        ],
        [
            "[sensors.p3]\nmodel = \"pzt-5a-710pf\"\nparticle = 3",
            "[sensors.p3]\nmodel = \"pzt-5a-710pf\"\nparticle = ¦77",
            "sensors.p3.particle",
            "77",
            "39",
        ],
    ]);
}
