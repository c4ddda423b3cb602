//! What is no good is left out by name, and stays visible.

use hertzscope::analysis::gate::Gate;
use hertzscope::calibrate::simulation::BlindCalibration;
use hertzscope::calibrate::{Calibration, CalibrationError, Draws, Exclusion, calibrate};

use super::{BENCH, bench_with, shipped_lab};

fn calibrated(blind: &BlindCalibration) -> Calibration {
    calibrate(&blind.strikes, &blind.common, Draws { seed: 0, count: 0 }).expect("a calibration")
}

/// Spoils the first impact, and looks what is said about it.
fn why(spoil: impl FnOnce(&mut BlindCalibration)) -> Exclusion {
    let mut blind = BENCH.blind(20);
    spoil(&mut blind);
    let found = calibrated(&blind);
    assert_eq!(found.impacts.len(), 6, "it stays visible");
    assert!(found.impacts[1..].iter().all(|impact| impact.exclusion.is_none()));
    let truth = BENCH.designer.circuit().expect("a circuit").sensitivity;
    assert!(
        (found.sensitivity / truth - 1.0).abs() < 4.0 * found.u / truth,
        "{}",
        found.sensitivity
    );
    found.impacts[0].exclusion.clone().expect("left out")
}

#[test]
fn each_kind_of_bad_record_has_a_name() {
    let loud = bench_with(shipped_lab(), 0.5, 1).blind(20);
    let saturated = why(|blind| blind.strikes[0].record = loud.strikes[0].record.clone());
    assert!(matches!(saturated, Exclusion::Saturated { samples } if samples > 10), "{saturated}");
    let late = why(|blind| {
        let trace = &mut blind.strikes[0].record.trace;
        trace.start = trace.time(615);
        trace.values.drain(..615);
    });
    assert!(matches!(late, Exclusion::NoPreTrigger { .. }), "{late}");
    let cut = why(|blind| blind.strikes[0].record.window = Some(Gate { from: -50e-6, to: 60e-6 }));
    assert!(matches!(cut, Exclusion::Cut { what: "window", .. }), "{cut}");
    let begun =
        why(|blind| blind.strikes[0].record.window = Some(Gate { from: 20e-6, to: 400e-6 }));
    assert!(matches!(begun, Exclusion::Cut { what: "window", .. }), "{begun}");
    let ended = why(|blind| blind.strikes[0].record.trace.values.truncate(760));
    assert!(matches!(ended, Exclusion::Cut { what: "record", .. }), "{ended}");
    let twice = why(|blind| {
        let values = &mut blind.strikes[0].record.trace.values;
        let pulse: Vec<f64> = values[550..1000].to_vec();
        values[1500..1950].iter_mut().zip(pulse).for_each(|(v, p)| *v += 0.5 * p);
    });
    assert!(matches!(twice, Exclusion::TwoImpacts { .. }), "{twice}");
    let nothing = why(|blind| blind.strikes[0].record.trace.values.fill(0.02));
    assert_eq!(nothing, Exclusion::NoPulse);
    let wrong = why(|blind| {
        blind.strikes[0].record.trace.values.iter_mut().for_each(|v| *v *= 1.1);
    });
    assert!(matches!(wrong, Exclusion::Outlier { times } if times > 5.0), "{wrong}");
    assert_eq!(
        Exclusion::TwoImpacts { time: 1e-4 }.to_string(),
        "two impacts in one record: a second pulse at 100.0 us"
    );
}

/// A window that holds the pulse is as good as the one that is found.
#[test]
fn a_good_window_changes_little() {
    let mut blind = BENCH.blind(21);
    let plain = calibrated(&blind);
    for strike in &mut blind.strikes {
        strike.record.window = Some(Gate { from: -60e-6, to: 260e-6 });
    }
    let wider = calibrated(&blind);
    assert!((wider.sensitivity / plain.sensitivity - 1.0).abs() < 1e-3);
    // Turned over it is the same sensor with the other polarity.
    for strike in &mut blind.strikes {
        strike.record.trace.values.iter_mut().for_each(|v| *v = -*v);
    }
    let turned = calibrated(&blind);
    assert!(turned.negative && (turned.sensitivity / wider.sensitivity - 1.0).abs() < 1e-12);
}

#[test]
fn too_few_impacts_are_an_error_with_all_reasons() {
    let mut blind = BENCH.blind(22);
    for strike in &mut blind.strikes[..5] {
        strike.record.clipped = 12;
    }
    let Err(error) = calibrate(&blind.strikes, &blind.common, Draws { seed: 0, count: 0 }) else {
        panic!("one impact is no calibration");
    };
    assert!(matches!(&error, CalibrationError::TooFew { used: 1, all: 6, .. }), "{error}");
    assert_eq!(error.to_string().matches("saturated: 12 samples").count(), 5, "{error}");
}
