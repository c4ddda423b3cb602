//! Records that the input's range cut off, in tables that do not give the range: found where that
//! is certain, and never in pulses, trains, sines, square waves, steps and levels of rest.

use super::generated_tables::Draws;
use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::read_all;

const SAMPLES: usize = 1500;

/// Volts over the number of a sample.
type Signal<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// A normal deviate, by the sum of twelve even ones (Irwin and Hall).
fn normal(draws: &mut Draws) -> f64 {
    (0..12).map(|_| draws.below(1 << 24) as f64 / f64::from(1 << 24)).sum::<f64>() - 6.0
}

/// A table of `signal`, in levels of `level` with `noise` levels of noise, cut at `ceiling` levels.
fn table(signal: &dyn Fn(f64) -> f64, (level, noise): (f64, f64), ceiling: f64) -> String {
    let draws = &mut Draws(17);
    let row = |n: usize| {
        let levels = (signal(n as f64) / level + noise * normal(draws)).round();
        format!("{n},{:.6}\n", levels.min(ceiling) * level)
    };
    "Time (us),V\n".to_owned() + &(0..SAMPLES).map(row).collect::<String>()
}

fn read(text: &str) -> Capture {
    let found = read_all(text.as_bytes(), "table.csv").unwrap_or_else(|error| panic!("{error}"));
    found.into_iter().next().expect("a channel")
}

fn says_cut(capture: &Capture) -> bool {
    capture.notes.iter().any(|note| note.contains("range ended there"))
}

/// Hertz's pulse for equal spheres, nearly, and its echo.
fn pulse(width: f64) -> impl Fn(f64) -> f64 {
    let one = move |t: f64, start: f64| {
        let phase = (t - start) / width;
        if (0.0..1.0).contains(&phase) {
            (std::f64::consts::PI * phase).sin().powf(1.5)
        } else {
            0.0
        }
    };
    move |t| one(t, 300.3) + 0.4 * one(t, 900.7)
}

#[test]
fn a_cut_pulse_counts_as_clipped_and_keeps_its_values() {
    for (width, share) in [(40.0, 0.5), (60.0, 0.5), (60.0, 0.7), (100.0, 0.8), (300.0, 0.7)] {
        for noise in [0.0, 0.3] {
            for sign in [1.0, -1.0] {
                let pulse = pulse(width);
                let level = share / 102.0;
                let text = table(&pulse, (level, noise), 102.0);
                let turned = text.lines().skip(1).fold("Time (us),V\n".to_owned(), |text, line| {
                    let (time, value) = line.split_once(',').expect("two cells");
                    text + &format!(
                        "{time},{:.6}\n",
                        sign * value.parse::<f64>().expect("a number")
                    )
                });
                let capture = read(&turned);
                let what = format!("{width} {share} {noise} {sign}: {:?}", capture.notes);
                let values: Vec<f64> = capture.waveform.values().collect();
                let end = values.iter().map(|value| sign * value).fold(0.0, f64::max);
                let cut: Vec<usize> =
                    (0..values.len()).filter(|n| sign * values[*n] == end).collect();
                assert_eq!(capture.waveform.clipped_points().collect::<Vec<_>>(), cut, "{what}");
                assert!(says_cut(&capture), "{what}");
                for (value, line) in values.iter().zip(turned.lines().skip(1)) {
                    let printed: f64 =
                        line.split_once(',').expect("cells").1.parse().expect("a number");
                    assert!((value - printed).abs() < 1e-12, "{what}: {value} for {printed}");
                }
            }
        }
    }
}

/// Both ends of the range at once: a sine cut at four fifths.
#[test]
fn a_sine_cut_at_both_ends_counts_as_clipped() {
    let sine = |t: f64| (2.0 * std::f64::consts::PI * (t + 3.3) / 250.3).sin().clamp(-0.8, 0.8);
    let capture = read(&table(&sine, (0.01, 0.0), 80.0));
    let values: Vec<f64> = capture.waveform.values().collect();
    let cut = values.iter().filter(|value| value.abs() > 0.7999).count();
    assert_eq!(capture.waveform.clipped(), cut, "{:?}", capture.notes);
}

#[test]
fn what_no_range_cut_is_not_called_so() {
    let half = |t: f64, start: f64, width: f64| {
        let phase = (t - start) / width;
        if (0.0..1.0).contains(&phase) { (std::f64::consts::PI * phase).sin() } else { 0.0 }
    };
    let is_high = |t: f64, period: f64| (t / period).rem_euclid(1.0) >= 0.5;
    // An edge as a filter of first order leaves it, and one of second order.
    let edges = |t: f64, tau: f64| {
        let (since, rest) = ((t + 100.0) % 400.0, is_high(t + 100.0, 800.0));
        let risen = 1.0 - (-since / tau).exp();
        if rest { risen } else { 1.0 - risen }
    };
    let smooth = |t: f64, tau: f64| {
        let (since, rest) = ((t + 100.0) % 400.0, is_high(t + 100.0, 800.0));
        let risen = 1.0 - (-since / tau).exp() * (1.0 + since / tau);
        if rest { risen } else { 1.0 - risen }
    };
    let ramp = |t: f64| ((t - 500.0) / 5.0).clamp(0.0, 1.0);
    let signals: Vec<(&str, Signal)> = vec![
        ("short pulse", Box::new(pulse(20.0))),
        ("pulse", Box::new(pulse(60.0))),
        ("long pulse", Box::new(pulse(1000.0))),
        ("downward pulses", Box::new(move |t| -half(t, 300.3, 50.0) - 0.6 * half(t, 800.0, 50.0))),
        (
            "train above a level of rest",
            Box::new(move |t| {
                0.3 - (0..12).map(|k| half(t, 100.0 + 90.3 * f64::from(k), 60.0)).sum::<f64>()
            }),
        ),
        ("lost contacts", Box::new(move |t| (0.3 + 0.7 * (t / 40.0).sin()).max(0.0))),
        ("sine", Box::new(|t| (t / 37.1).sin())),
        ("slow sine", Box::new(|t| (t / 200.0).sin())),
        ("square wave", Box::new(move |t| f64::from(u8::from(is_high(t, 200.0))))),
        ("fast square wave", Box::new(move |t| f64::from(u8::from(is_high(t, 16.0))))),
        ("step", Box::new(|t| f64::from(u8::from(t > 700.0)))),
        ("gate", Box::new(|t| f64::from(u8::from((400.0..900.0).contains(&t))))),
        ("ramp to a level", Box::new(ramp)),
        ("triangle", Box::new(|t| ((t / 200.0).rem_euclid(1.0) - 0.5).abs())),
        ("charging", Box::new(move |t| edges(t, 20.0))),
        ("slow charging", Box::new(move |t| edges(t, 60.0))),
        ("filtered edges", Box::new(move |t| smooth(t, 8.0))),
        ("slow filtered edges", Box::new(move |t| smooth(t, 30.0))),
        ("nothing", Box::new(|_| 0.7)),
    ];
    for (name, signal) in &signals {
        for levels in [20.0, 60.0, 120.0, 250.0, 1000.0, 30_000.0] {
            for noise in [0.0, 0.3, 1.0, 2.0] {
                let capture = read(&table(signal, (1.0 / levels, noise), f64::INFINITY));
                let what = format!("{name}, {levels} levels, noise {noise}: {:?}", capture.notes);
                // Of 256 levels and a position that is a guess, the ends may be the converter's.
                let is_unsure = what.contains("whether points are clipped is not sure");
                let clipped = capture.waveform.clipped();
                assert!(!says_cut(&capture) && (clipped == 0 || is_unsure), "{what}");
            }
        }
    }
}
