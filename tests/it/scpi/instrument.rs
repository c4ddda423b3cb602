//! The instrument behind the commands: what the front panel does to records, by the documented
//! facts of the family.

use hertzscope::instrument::{Accepted, Instrument, Signals};
use hertzscope::scene::Scene;
use hertzscope::scope::{Deviation, Setup};
use hertzscope::scpi::{Preferences, Session};

use super::bench::{Bench, model};

/// The scene `magnet-0.61g` with changes.
fn scene(changes: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, format!("base = \"magnet-0.61g\"\n{changes}")).expect("a file");
    Scene::load(file.display().to_string()).expect("a scene")
}

/// Signals on the wanted grid, from the trigger's sample on, at channel 1 and the external input.
fn signals(bench: &Bench, volts: impl Fn(f64) -> f64, external: impl Fn(f64) -> f64) -> Signals {
    let wanted = bench.instrument.sample_window();
    // A little more than is wanted: the trigger has to see where the signal comes from.
    let before = (wanted.before / wanted.interval).round() as i32 + 10;
    let after = (wanted.after / wanted.interval).round() as i32;
    let times = || (-before..=after).map(|n| f64::from(n) * wanted.interval);
    Signals {
        time_base: Some(wanted.time_base),
        interval: wanted.interval,
        automatic: before as usize,
        volts: vec![times().map(volts).collect()],
        external: times().map(external).collect(),
        shot: 1,
    }
}

fn ready(settings: &str) -> Bench {
    let mut bench = Bench::new();
    bench.tell("TRIG:MAI:MOD NORM;LEV 0.5");
    bench.tell(settings);
    bench.tell("ACQ:STOPA SEQ;STATE RUN");
    bench.wait(100.0);
    bench
}

fn triggers(accepted: Accepted) -> bool {
    matches!(accepted, Accepted::Triggered { .. })
}

/// Levels of the channel that `DATa:SOUrce` names.
fn levels(bench: &mut Bench) -> Vec<i16> {
    bench.tell("DATA:ENC ASCI");
    bench.ask("CURVE?").split(',').map(|code| code.parse().expect("a level")).collect()
}

/// Without holdoff the scope is ready a record after a trigger; a holdoff of 10 s keeps it deaf
/// until then.
#[test]
fn holdoff_keeps_the_scope_deaf() {
    for (holdoff, ready_again) in [("5E-7", true), ("10", false)] {
        let mut bench = ready(&format!("TRIG:MAI:HOLDO:VAL {holdoff};:HOR:SCA 1E-3"));
        bench.tell("ACQ:STOPA RUNST;STATE RUN");
        bench.wait(1.0);
        let step = signals(&bench, |t| f64::from(t >= 0.0), |_| 0.0);
        assert!(triggers(bench.instrument.accept_signals(&step)));
        bench.wait(1.0);
        assert_eq!(bench.ask("ACQ:NUMACQ?"), "1");
        assert_eq!(bench.ask("TRIG:STATE?"), if ready_again { "READY" } else { "ARMED" });
        assert_eq!(triggers(bench.instrument.accept_signals(&step)), ready_again);
        bench.wait(9.5);
        assert_eq!(bench.ask("TRIG:STATE?"), "READY", "the holdoff counts from the trigger");
    }
}

/// Signals that were made for another time base are dropped; the next ones on the new grid trigger.
#[test]
fn signals_of_another_time_base_are_dropped() {
    for settings in ["HOR:SCA 5E-9", "HOR:SCA 2.5E-3", "RECA:SETU FACTORY", "*RST"] {
        let mut bench = ready("HOR:SCA 1");
        let old = signals(&bench, |t| f64::from(t >= 0.0), |_| 0.0);
        bench.tell(settings);
        bench.tell("TRIG:MAI:MOD NORM;LEV 0.5");
        bench.wait(100.0);
        assert_eq!(bench.instrument.accept_signals(&old), Accepted::OtherInterval, "{settings}");
        let new = signals(&bench, |t| f64::from(t >= 0.0), |_| 0.0);
        assert!(triggers(bench.instrument.accept_signals(&new)), "{settings}");
    }
}

/// EXT sees what is at the external input, EXT/5 a fifth of it against a range five times as wide.
#[test]
fn the_external_input_triggers() {
    for (source, level, triggers_at) in [
        ("EXT", "1", Some(0.0)),
        ("EXT", "5", Some(0.375e-3)),
        ("EXT5", "5", Some(2.5e-3)),
        ("CH1", "1", None),
    ] {
        let mut bench = ready("HOR:SCA 1E-3;:TRIG:MAI:EDGE:SOU CH1");
        bench.tell(&format!("TRIG:MAI:EDGE:SOU {source};:TRIG:MAI:LEV {level}"));
        bench.wait(1.0);
        // One volt at the trigger, rising by 1.6 V/ms: 1.6 V, EXT's farthest level, 0.375 ms later;
        // 5 V 2.5 ms later.
        let ramp = |t: f64| if t < 0.0 { 0.0 } else { 1.0 + 1600.0 * t };
        let slope = if source == "CH1" { 100.0 } else { 1000.0 };
        let arrived = signals(&bench, |t| if t < 0.0 { 0.0 } else { t * slope }, ramp);
        let found = bench.instrument.accept_signals(&arrived);
        assert_eq!(triggers(found), triggers_at.is_some(), "{source} {level}");
        if let Some(expected) = triggers_at {
            bench.wait(1.0);
            // Channel 1 rises by 1000 V/s: its level at the trigger tells when that was, to half a
            // level of 40 mV and one point of 4 us.
            let code = f64::from(levels(&mut bench)[1250]);
            let time = code / 25.0 / 1000.0;
            assert!((time - expected).abs() < 2.4e-5, "{source} {level}: {time} {expected}");
        }
    }
    let mut bench = ready("TRIG:MAI:EDGE:SOU EXT;:TRIG:MAI:LEV 5");
    assert_eq!(bench.ask("TRIG:MAI:LEV?"), "1.6E0");
    bench.tell("TRIG:MAI:EDGE:SOU EXT5;:TRIG:MAI:LEV 50");
    assert_eq!(bench.ask("TRIG:MAI:LEV?"), "8.0E0");
}

/// The mains go through zero upward fifty times a second, whatever is at the inputs.
#[test]
fn the_mains_trigger() {
    let mut bench = ready("HOR:SCA 1E-4;:TRIG:MAI:EDGE:SOU LINE");
    bench.tell("ACQ:STOPA RUNST;STATE RUN");
    for _ in 0..10_000 {
        bench.wait(1e-4);
    }
    let count: i32 = bench.ask("ACQ:NUMACQ?").parse().expect("a number");
    assert!((49..=50).contains(&count), "{count} records in a second");
}

/// Facts of real scan-mode files: 250 points in a row at -128 ahead of the sweep, all that the
/// first sweep has not reached, times from zero; a single sequence ends with a full screen.
#[test]
fn scan_mode_leaves_a_blank() {
    let blank = |codes: &[i16]| codes.iter().filter(|code| **code == -128).count();
    let mut bench = Bench::new();
    bench.tell("HOR:SCA 0.1");
    assert_eq!(bench.ask("TRIG:STATE?"), "SCAN");
    bench.wait(1e-3);
    bench.wait(0.4);
    let first = levels(&mut bench);
    // 0.4 s at 0.4 ms a point.
    assert_eq!((blank(&first), first[999], first[1000]), (1500, 0, -128));
    assert_eq!(bench.ask("WFMP:XZE?;PT_F?;NR_P?"), "0.0E0;Y;2500");
    bench.wait(1.0);
    let later = levels(&mut bench);
    assert_eq!(blank(&later), 250);
    assert!(later[1000..1250].iter().all(|code| *code == -128), "right ahead of the sweep");
    bench.wait(0.56);
    let wrapped = levels(&mut bench);
    assert_eq!(blank(&wrapped), 250, "the blank goes round the edge");
    assert!(wrapped[2400..].iter().chain(&wrapped[..150]).all(|code| *code == -128));
    bench.tell("ACQ:STATE STOP");
    assert_eq!(blank(&levels(&mut bench)), 250, "what is stopped stays");
    bench.tell("ACQ:STOPA SEQ;STATE RUN");
    bench.wait(1e-3);
    bench.wait(0.9);
    assert_eq!(bench.ask("BUSY?"), "1");
    bench.wait(0.2);
    assert_eq!(bench.ask("BUSY?;:TRIG:STATE?"), "0;SAVE");
    assert_eq!(blank(&levels(&mut bench)), 0);
}

/// What happens during a sweep stands where the sweep was, a sample a point: 2 V for 40 ms at 0.4
/// ms a point.
#[test]
fn scan_mode_shows_what_happens() {
    let mut bench = Bench::new();
    bench.tell("HOR:SCA 0.1");
    bench.wait(1e-3);
    bench.wait(0.2);
    let volts = vec![vec![2.0; 4001]];
    let pulse = Signals { interval: 1e-5, volts, ..Signals::default() };
    assert_eq!(bench.instrument.accept_signals(&pulse), Accepted::Scanned);
    bench.wait(0.2);
    let codes = levels(&mut bench);
    let high: Vec<usize> = (0..2500).filter(|n| codes[*n] == 50).collect();
    assert_eq!((high[0], high.len(), *high.last().expect("points")), (500, 101, 600));
}

/// A pulse between the points of a sweep is lost to Sample and kept by Peak Detect, as the pair of
/// its interval's extremes.
#[test]
fn scan_mode_detects_peaks() {
    for (mode, seen) in [("SAM", 0), ("PEAK", 1)] {
        let mut bench = Bench::new();
        bench.tell(&format!("HOR:SCA 0.1;:ACQ:MOD {mode}"));
        bench.wait(1e-3);
        bench.wait(0.2);
        let wanted = bench.instrument.sample_window().interval;
        assert!((wanted - if mode == "PEAK" { 4e-6 } else { 1e-6 }).abs() < 1e-12, "{wanted}");
        // 40 us long, 100 us after a point: half an interval from the next.
        let samples = (0..5000).map(|n| if (25..35).contains(&(n % 1000)) { 2.0 } else { 0.0 });
        let volts = vec![samples.collect()];
        let pulse = Signals { interval: 4e-6, volts, ..Signals::default() };
        assert_eq!(bench.instrument.accept_signals(&pulse), Accepted::Scanned);
        // An odd number of points is due in between: pairs stay together.
        bench.wait(0.4e-3 * 3.5);
        bench.wait(0.2);
        let codes = levels(&mut bench);
        let high: Vec<usize> = (0..2500).filter(|n| codes[*n] == 50).collect();
        let expected: Vec<usize> = (0..5 * seen).map(|n| 501 + 10 * n).collect();
        assert_eq!(high, expected, "{mode}");
        assert!(codes[500..1000].iter().all(|code| matches!(code, 0 | 50)), "{mode}");
        assert_eq!(bench.ask("WFMP:PT_F?"), if seen == 1 { "ENV" } else { "Y" });
    }
}

/// An average in scan mode is that of the sweeps at each point: a single sequence takes as many as
/// it averages, and a point that was high in one of four stands at a quarter.
#[test]
fn scan_mode_averages_sweeps() {
    let mut bench = Bench::new();
    bench.tell("HOR:SCA 0.1;:ACQ:MOD AVE;NUMAV 4;STOPA SEQ;STATE RUN");
    bench.wait(1e-3);
    bench.wait(1.2);
    let volts = vec![vec![4.0; 4001]];
    let pulse = Signals { interval: 1e-5, volts, ..Signals::default() };
    assert_eq!(bench.instrument.accept_signals(&pulse), Accepted::Scanned);
    let heights: Vec<i16> = (0..3)
        .map(|_| {
            bench.wait(0.9);
            levels(&mut bench)[550]
        })
        .collect();
    assert_eq!(heights, [50, 33, 25], "of 100 levels, after two, three and four sweeps");
    // The manual's page on `ACQuire:NUMACq?`: always zero in scan mode.
    assert_eq!(bench.ask("BUSY?;:ACQ:NUMACQ?"), "1;0");
    bench.wait(0.2);
    assert_eq!(bench.ask("BUSY?;:ACQ:NUMACQ?"), "0;0");
    let codes = levels(&mut bench);
    let high: Vec<usize> = (0..2500).filter(|n| codes[*n] != 0).collect();
    assert_eq!((high[0], high.len()), (500, 101), "nothing is blank at the end");
    assert!(high.iter().all(|n| codes[*n] == 25));
}

/// A pulse of 12 ns between the samples of a slow record is lost to Sample and kept by Peak Detect
/// (5 us/div to 50 s/div; this program keeps it up to 250 us/div, for want of memory).
#[test]
fn peak_detect_keeps_short_pulses() {
    for (mode, seen) in [("SAM", 0), ("PEAK", 50)] {
        for scale in ["5E-6", "2.5E-5", "1E-4"] {
            let mut bench = ready(&format!("HOR:SCA {scale};:ACQ:MOD {mode}"));
            bench.wait(1.0);
            let x: f64 = scale.parse().expect("a number");
            let late = 100.37 * x / 250.0;
            let volts = |t: f64| {
                let step = if (0.0..20.0 * x / 250.0).contains(&t) { 1.0 } else { 0.0 };
                step + if (late..late + 12e-9).contains(&t) { 2.0 } else { 0.0 }
            };
            let arrived = signals(&bench, volts, |_| 0.0);
            assert!(triggers(bench.instrument.accept_signals(&arrived)), "{mode} {scale}");
            bench.wait(1.0);
            let codes = levels(&mut bench);
            let highest = codes[1300..].iter().copied().max().expect("points");
            // The front end's 100 MHz take about an eighth of a pulse of 12 ns.
            let wanted = if seen == 0 { 0..=0 } else { 40..=50 };
            assert!(wanted.contains(&highest), "{mode} at {scale} s/div: {highest}");
            assert_eq!(bench.ask("WFMP:PT_F?"), if mode == "PEAK" { "ENV" } else { "Y" });
        }
    }
}

/// The window's record is that of its own time base and position.
#[test]
fn the_window_has_a_record_of_its_own() {
    let settings = "HOR:MAI:SCA 1E-3;:HOR:DEL:SCA 1E-4;:HOR:DEL:POS 2E-3;:HOR:VIE WINDOW";
    let mut bench = ready(settings);
    bench.wait(1.0);
    let staircase = |t: f64| if t < 0.0 { 0.0 } else { 1.0 + f64::from(t >= 2e-3) };
    let arrived = signals(&bench, staircase, |_| 0.0);
    assert!(triggers(bench.instrument.accept_signals(&arrived)));
    bench.wait(1.0);
    bench.transcript(&[
        ("WFMP:XIN?;XZE?", "4.0E-7;1.5E-3"),
        ("HOR:MAI:SCA?;:HOR:VIE?", "1.0E-3;WINDOW"),
    ]);
    let codes = levels(&mut bench);
    assert_eq!((codes[1249], codes[1250]), (25, 50), "the second step is in the centre");
}

/// Gain within 3 %, 4 % on the two smallest scales, zero within 0.1 div + 1 mV: data sheets of
/// sister models. Even over the range, so a few channels of a hundred seeds come near the ends;
/// without the effect nothing is off.
#[test]
fn errors_stay_within_the_data_sheet_and_come_from_the_seed() {
    let draws: Vec<Deviation> =
        (0..100).flat_map(|seed| (1..=4).map(move |n| Deviation::drawn(seed, n))).collect();
    for part in [|d: &Deviation| d.gain, |d: &Deviation| d.offset] {
        let (low, high) = draws.iter().map(part).fold((0.0_f64, 0.0_f64), |(l, h), v| {
            assert!((-1.0..=1.0).contains(&v));
            (l.min(v), h.max(v))
        });
        // 400 even draws miss the last 5 % of a side with a chance of 0.975^400, 4e-5.
        assert!(low < -0.95 && high > 0.95, "{low} {high}");
    }
    assert_eq!(Deviation::drawn(7, 2), Deviation::drawn(7, 2));
    assert_ne!(Deviation::drawn(7, 2), Deviation::drawn(8, 2));
    let exact = scene("").scope;
    assert!(exact.channels.iter().flatten().all(|c| c.deviation == Deviation::default()));
    let off = scene("[effects.scope_errors]\n").scope;
    assert!(off.channels.iter().flatten().all(|c| c.deviation != Deviation::default()));
    assert!(scene("[effects]\nscope_errors = false\n").scope == exact);
    let worst = Deviation { gain: 1.0, offset: -1.0 };
    // 2 V less 0.1 div and 1 mV; at 5 mV/div 12.5 mV less 0.5 mV and 1 mV, 25 levels to a division.
    for (scale, volts, level) in
        [(1.0, 2.0, 25.0 * (2.06 - 0.101)), (5e-3, 12.5e-3, 5e3 * (13e-3 - 1.5e-3))]
    {
        let mut setup: Setup = off.clone();
        let channel = setup.channels[0].as_mut().expect("channel 1");
        channel.deviation = worst;
        channel.vertical.scale = scale;
        channel.vertical.position = 0.0;
        setup.noise = 0.0;
        let mut bench = Bench::new();
        bench.instrument = Instrument::of(&setup, 1);
        bench.instrument.status.clear();
        bench.record("HOR:SCA 1E-4;POS 0;:TRIG:MAI:LEV 0", |_| volts);
        let found = f64::from(levels(&mut bench)[2000]);
        assert!((found - level).abs() <= 0.5, "{scale} V/div: {found}, expected {level}");
    }
}

/// `SCAle` snaps to the series, as documented, unless Volts/Div is on fine: by the bench's command,
/// or from the start with a scale between the steps (real set-up files hold 60 mV/div). A set-up
/// memory knows which.
#[test]
fn a_fine_scale_stands_between_the_steps() {
    let mut setup: Setup = scene("").scope;
    setup.channels[0].as_mut().expect("channel 1").vertical.scale = 0.06;
    let mut bench = Bench::new();
    bench.instrument = Instrument::of(&setup, 1);
    assert_eq!(bench.ask("*SAV 1;:CH1:SCA 1;SCA?;*RCL 1;:CH1:SCA?"), "1.0E0;6.0E-2");
    assert_eq!(bench.ask("CH1:SCA 0.06;SCA?"), "6.0E-2");
    let mut bench = Bench::new();
    bench.transcript(&[
        ("CH1:PRO 1;SCA 0.06;SCA?", "5.0E-2"),
        ("BENC:CH1:FIN?;FIN ON;FIN?;:BENC:CH2:FIN?", "OFF;ON;OFF"),
        // Of real files, one of them through a probe; then more digits than the knob has, and the
        // ends of its range.
        ("CH1:SCA 0.059;SCA?;SCA 0.09;SCA?", "5.9E-2;9.0E-2"),
        ("CH1:PRO 10;SCA 0.288;SCA?;PRO 1;SCA?", "2.88E-1;2.88E-2"),
        ("CH1:VOL 0.123456;VOL?;SCA 1E-9;SCA?;SCA 99;SCA?", "1.23E-1;2.0E-3;5.0E0"),
        // The position stays where it can: 2 V at 59 mV/div are 33.88 divisions, in steps of 1/25.
        ("CH1:SCA 0.059;POS 1000;POS?", "3.388E1"),
        ("CH1:SCA 0.288;:BENC:CH1:FIN OFF;:CH1:SCA?;*ESR?", "2.0E-1;0"),
    ]);
    // A record between the steps: 25 levels are a division of 0.288 V.
    bench.record("BENC:CH1:FIN ON;:CH1:SCA 0.288;POS 0;:HOR:SCA 1E-4;:TRIG:MAI:LEV 0", |_| 0.864);
    assert_eq!(levels(&mut bench)[2000], 75);
    assert_eq!(bench.ask("WFMP:YMU?"), "1.152E-2");
}

/// Below 5 mV/div at the BNC the bandwidth is 20 MHz: a step has gone `1 - exp(-2 pi 20 MHz t)` of
/// its way after t.
#[test]
fn the_smallest_scale_is_slow() {
    for (scale, bandwidth) in [(2e-3, 20e6), (5e-3, 100e6)] {
        let settings =
            format!("CH1:PRO 1;SCA {scale};:HOR:SCA 2.5E-7;:TRIG:MAI:LEV {}", scale / 2.0);
        let mut bench = Bench::new();
        bench.record(&settings, |t| if t < 0.0 { 0.0 } else { 4.0 * scale });
        let codes = levels(&mut bench);
        let start = (0..2500).find(|n| codes[*n] > 0).expect("the step");
        // Samples of 1 ns, the step a ramp over the first: the response is that of a step half a
        // sample in.
        let gone = |n: f64| 1.0 - (-std::f64::consts::TAU * bandwidth * (n + 0.5) * 1e-9).exp();
        for n in [3_u32, 6, 12] {
            let found = f64::from(codes[start + n as usize]) / 100.0;
            assert!((found - gone(f64::from(n))).abs() < 0.02, "{scale} {n}: {found}");
        }
    }
}

/// AC coupling behind a probe of ten megohms has a tenth of the corner.
#[test]
fn a_probe_slows_ac_coupling_down() {
    for (probe, corner) in [(1, 10.0), (10, 1.0)] {
        let settings = format!("CH1:PRO {probe};SCA 1;COUP AC;:HOR:SCA 5E-3;:TRIG:MAI:LEV 1");
        let mut bench = Bench::new();
        bench.record(&settings, |t| if t < 0.0 { 0.0 } else { 4.0 });
        let codes = levels(&mut bench);
        let left = (-std::f64::consts::TAU * corner * 0.02_f64).exp();
        let found = f64::from(codes[1250 + 1000]) / 100.0;
        assert!((found - left).abs() < 0.02, "{probe}x: {found} of {left}");
    }
}

/// Autoset finds scale, time base and level of a sine of 3 V and 1 kHz, and takes back what hides a
/// signal.
#[test]
fn autoset_finds_the_signal() {
    let mut bench = Bench::new();
    let settings = "HOR:SCA 1E-3;:CH1:SCA 1;POS 2;BAN ON;:TRIG:MAI:EDGE:COUP AC;:TRIG:MAI:HOLDO:VAL 1;:CURS:FUNC HBA";
    bench.record(settings, |t| 1.5 * (std::f64::consts::TAU * 1000.0 * t).sin() + 0.5);
    bench.tell("AUTOS EXEC");
    bench.transcript(&[
        // 3 V on four divisions are 0.75 V/div, nearest 1; four cycles on ten divisions 400 us/div,
        // nearest 500.
        ("CH1:SCA?;POS?;BAN?", "1.0E0;0.0E0;OFF"),
        ("HOR:MAI:SCA?;POS?", "5.0E-4;0.0E0"),
        ("TRIG:MAI:MOD?;HOLDO:VAL?;:TRIG:MAI:EDGE:COUP?", "AUTO;5.0E-7;DC"),
        ("CURS:FUNC?;:ACQ:STOPA?;STATE?", "OFF;RUNSTOP;1"),
    ]);
    let level: f64 = bench.ask("TRIG:MAI:LEV?").parse().expect("a number");
    assert!((level - 0.5).abs() <= 0.04, "{level}");
}

/// A second model is a file: identity, rate, bandwidth and time bases come from it.
#[test]
fn another_model_is_another_file() {
    let scene = scene("[scope]\nmodel = \"tds2024\"\n");
    let mut bench = Bench::new();
    bench.instrument = Instrument::of(&scene.scope, scene.seed);
    bench.session = Session::new(Preferences::new(false));
    bench.transcript(&[
        ("*IDN?", "TEKTRONIX,TDS 2024,0,CF:91.1CT FV:v4.12 TDS2CM:CMV:v1.04"),
        ("HOR:SCA 1E-9;:HOR:SCA?", "2.5E-9"),
        ("HOR:SCA 1E-7;:HOR:RECO?", "2500"),
    ]);
    let fast = bench.instrument.sample_window().interval;
    assert!((fast - 0.5e-9).abs() < 1e-15, "2 GS/s: {fast}");
    assert_eq!((scene.scope.model.bandwidth, model().bandwidth), (200e6, 100e6));
    let mut old = Bench::new();
    old.transcript(&[("HOR:SCA 1E-9;:HOR:SCA?", "5.0E-9"), ("HOR:SCA 1E-7;:HOR:RECO?", "2500")]);
    assert!((old.instrument.sample_window().interval - 1e-9).abs() < 1e-15, "1 GS/s");
}

/// No line of code names a model: what a model is stands in its file.
#[test]
fn no_code_knows_a_model() {
    fn visit(folder: &std::path::Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                visit(&path, found);
            } else {
                let text = std::fs::read_to_string(&path).expect("source");
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let code = code.lines().map(|line| line.split("//").next().unwrap_or_default());
                let knows = |line: &str| {
                    let plain = line.to_ascii_uppercase().replace(' ', "");
                    ["TDS2014", "TDS2024"].iter().any(|name| plain.contains(name))
                };
                let named = code.filter(|line| knows(line));
                found.extend(named.map(|line| format!("{}: {line}", path.display())));
            }
        }
    }
    let mut found = Vec::new();
    visit(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut found);
    // The one place that needs an example of a name.
    found.retain(|line| !line.contains("the name of an oscilloscope, e.g."));
    assert_eq!(found, Vec::<String>::new());
}

/// `[scope.external]` puts a sensor at the external input: the same volts that a channel without
/// probe would get. A sensor drives one input only.
#[test]
fn a_scene_wires_the_external_input() {
    use hertzscope::experiment::inputs::{InputWindow, inputs};
    let window = InputWindow { interval: 1e-6, before: 0.0, after: 1e-4 };
    let wired =
        scene("duration = \"100 us\"\n[scope]\nposition = \"0 s\"\ntime_base = \"25 us/div\"\n");
    let mut other = wired.clone();
    other.scope.external = Some("p2".to_owned());
    other.scope.channels[0].as_mut().expect("channel 1").input = None;
    let (wired, other) = (inputs(&wired, window, 1).expect("a run"), inputs(&other, window, 1));
    let other = other.expect("a run");
    assert!(wired.external.is_empty());
    assert!(wired.volts[0].iter().any(|volts| *volts > 0.5), "particle 2 feels the striker");
    assert_eq!(other.external, wired.volts[0]);

    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.toml");
    let text = "base = \"magnet-0.61g\"\n[scope.external]\ninput = \"p2\"\n";
    std::fs::write(&file, text).expect("a file");
    let error = Scene::load(file.display().to_string()).expect_err("one input a sensor");
    assert!(error.to_string().contains("at the input of CH1"), "{error}");
}

/// At slow time bases noise is drawn at the record's points alone: as large as where it is drawn at
/// each sample, and whatever triggers.
#[test]
fn slow_records_of_silence_have_the_noise_of_fast_ones() {
    let mut bench = Bench::new();
    // Root mean square (div); a division has 25 levels.
    bench.instrument = Instrument::new(model(), 0.2, 1);
    for time_base in ["5E-4", "1E-2", "1E-1", "5"] {
        for source in ["LINE", "CH1"] {
            bench.tell(&format!("HOR:SCA {time_base};:TRIG:MAI:MOD NORM;EDGE:SOU {source}"));
            bench.tell("ACQ:STOPA SEQ;STATE RUN");
            bench.wait(100.0);
            bench.tell("TRIG FORC");
            bench.wait(100.0);
            assert_eq!(bench.ask("ACQ:STATE?"), "0", "{time_base} {source}");
            let levels = levels(&mut bench);
            let square: f64 = levels.iter().map(|level| f64::from(*level).powi(2)).sum();
            let rms = (square / levels.len() as f64).sqrt();
            // Rounding adds 1/12; the scatter of an estimate from 2500 samples is 1.4 %, of which
            // four.
            let expected = (5.0_f64.powi(2) + 1.0 / 12.0).sqrt();
            assert!((rms / expected - 1.0).abs() < 0.057, "{time_base} {source}: {rms}");
        }
    }
}
