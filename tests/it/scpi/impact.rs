//! An impact of the bench, taken by an instrument that was set by remote commands alone.

use std::fmt::Write as _;

use super::bench::Bench;
use hertzscope::experiment::{Integration, Outcome, run};
use hertzscope::instrument::{Accepted, Instrument, Signals};
use hertzscope::scene::{Scene, input_load};
use hertzscope::scope::set_up::nr3;
use hertzscope::scope::{Slope, TriggerMode};
use hertzscope::trace::Trace;

/// The commands that set the front panel as the scene does.
fn commands(scene: &Scene) -> String {
    let setup = &scene.scope;
    let mut text =
        format!("*RST;:HOR:SCA {};POS {}", nr3(setup.time_base), nr3(setup.horizontal_position));
    for (number, channel) in (1..).zip(&setup.channels) {
        let _ = write!(text, ";:SEL:CH{number} {}", u8::from(channel.is_some()));
        let Some(channel) = channel else { continue };
        let vertical = &channel.vertical;
        let _ = write!(
            text,
            ";:CH{number}:PROBE {};SCALE {};POS {};COUP {}",
            vertical.probe,
            nr3(vertical.scale),
            nr3(vertical.position),
            vertical.coupling.expect("a coupling"),
        );
    }
    let trigger = &setup.trigger;
    let slope = if trigger.slope == Slope::Rise { "RIS" } else { "FALL" };
    let mode = if trigger.mode == TriggerMode::Auto { "AUTO" } else { "NORM" };
    let _ = write!(
        text,
        ";:TRIG:MAI:MOD {mode};EDGE:SOU {};SLO {slope};:TRIG:MAI:LEV {};:ACQ:STOPA SEQ;STATE RUN",
        trigger.source,
        nr3(trigger.level),
    );
    text
}

/// Volts at each channel, from the forces that the run left as truth.
fn signals(scene: &Scene, outcome: &Outcome) -> Signals {
    let mut signals = Signals { shot: outcome.shot.number, ..Signals::default() };
    for channel in &scene.scope.channels {
        let name = channel.as_ref().and_then(|channel| channel.input.clone()).unwrap_or_default();
        let index = scene.sensors.iter().position(|placed| placed.name == name);
        let (Some(index), Some(channel)) = (index, channel.as_ref()) else {
            signals.volts.push(Vec::new());
            continue;
        };
        let truth = &outcome.shot.truth[index];
        let reading = outcome.summary.sensors.iter().find(|reading| reading.name == name);
        // What sits at the wall reads what the wall does.
        let reading = reading.or(outcome.summary.wall.as_ref());
        let static_force = reading.expect("a reading").static_n;
        let values = truth.values.iter().map(|force| force - static_force).collect();
        let force = Trace { values, ..truth.clone() };
        let load = input_load(&scene.scope.model, channel);
        signals.volts.push(scene.sensors[index].sensor.connect(load).respond(&force).values);
        signals.interval = truth.interval;
        signals.automatic = (-truth.start / truth.interval).floor() as usize + 1;
    }
    signals
}

/// The same levels as in the scene's own records, but for values that lie within round-off of a
/// step between two.
#[test]
fn an_instrument_set_by_commands_takes_the_records_of_the_scene() {
    let scene = Scene::load("magnet-0.61g").expect("the default scene");
    let outcome = run(&scene, Integration::Accuracy(1e-3), 1, &mut |_| ()).expect("a run");
    let mut bench = Bench::new();
    bench.instrument = Instrument::new(scene.scope.model.clone(), scene.scope.noise, scene.seed);
    bench.tell(&commands(&scene));
    assert_eq!(bench.ask("*ESR?"), "128", "nothing but power on");
    let wanted = bench.instrument.sample_window();
    bench.wait(wanted.before + 1e-9);
    let accepted = bench.instrument.accept_signals(&signals(&scene, &outcome));
    assert!(matches!(accepted, Accepted::Triggered { .. }), "{accepted:?}");
    bench.wait(wanted.after + 1e-9);
    assert_eq!(bench.ask("TRIG:STATE?"), "SAVE");
    assert!(!outcome.shot.captures.is_empty());
    for capture in &outcome.shot.captures {
        let waveform = &capture.waveform;
        let reply = bench.ask(&format!("DATA:SOU {};ENC ASCI;:CURVE?", waveform.source));
        let levels: Vec<i16> =
            reply.split(',').map(|level| level.parse().expect("a level")).collect();
        assert_eq!(levels.len(), waveform.codes.len());
        let differences = levels.iter().zip(&waveform.codes).filter(|(a, b)| a != b).count();
        assert!(differences <= 2, "{}: {differences} levels differ", waveform.source);
        let preamble = &waveform.preamble;
        let source = waveform.source;
        let fields: Vec<f64> = bench
            .ask(&format!("WFMP:{source}:XZE?;XIN?;YMU?;YOF?"))
            .split(';')
            .map(|field| field.parse().expect("a number"))
            .collect();
        for (found, expected) in
            fields.iter().zip([preamble.x_zero, preamble.x_incr, preamble.y_mult, preamble.y_off])
        {
            // Nine significant digits are written.
            assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{found}, {expected}");
        }
    }
}
