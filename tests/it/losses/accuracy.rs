//! Accuracy with each loss and both ends of contact, by what `--accuracy` chooses, against runs a
//! hundred times tighter than the tightest.

use hertzscope::experiment::accuracy::run_to_accuracy;
use hertzscope::experiment::outcome::Summary;
use hertzscope::experiment::{Integration, run};
use hertzscope::motion::Method;

use super::scene_with;

/// Drift of the ledger that a run at 1e-9 may have in terms of its accuracy: what is not located
/// adds up like steps (1).
const MOST_DRIFT: f64 = 40.0;

fn readings(summary: &Summary) -> Vec<f64> {
    let places = summary.sensors.iter().chain(&summary.wall);
    let of = |r: &hertzscope::experiment::outcome::Reading| {
        let peak = r.first_peak?;
        Some([peak.dynamic_n, peak.time_s, r.half_rise_s?])
    };
    places.filter_map(of).flatten().collect()
}

fn each(base: &str) {
    let losses = [
        ("dashpot", "gamma = \"0.8 N*s/m\""),
        ("kuwabara_kono", "eta = \"2 us\""),
        ("kuwabara_kono", "eta = \"0.5 us\""),
        ("power_law_loss", "force_at_1_m_per_s = \"2 N\"\nexponent = 1.81"),
    ];
    for (loss, setting) in losses {
        for end in ["zero_overlap", "zero_force"] {
            let text = format!("[effects.{loss}]\n{setting}\nend_of_contact = \"{end}\"\n");
            let scene = scene_with(base, &text);
            let method = Method::DormandPrince853 { tolerance: 1e-13 };
            let exact = run(&scene, Integration::Method(method), 1, &mut |_| ()).expect("a run");
            let exact = readings(&exact.summary);
            for accuracy in [1e-3, 1e-6, 1e-9] {
                let found =
                    run_to_accuracy(&scene, accuracy, 1, &mut |_| ()).expect("a run").summary;
                let read = readings(&found);
                assert_eq!(read.len(), exact.len(), "{base} {text}");
                let off = read.iter().zip(&exact).map(|(a, b)| (a / b - 1.0).abs());
                let worst = off.fold(0.0, f64::max);
                let drift = found.energy.drift.abs();
                println!(
                    "{base} {loss} {setting:.12} {end} {accuracy:e}: {:.2} of it, {} {}, drift {drift:.1e}",
                    worst / accuracy,
                    found.method,
                    found.force_evaluations
                );
                assert!(worst <= accuracy, "{base} {text} {accuracy:e}: {worst:e}");
                assert!(drift <= MOST_DRIFT * accuracy, "{base} {text} {accuracy:e}: {drift:e}");
            }
        }
    }
}

#[test]
fn under_the_magnet() {
    each("magnet-0.61g");
}

#[test]
fn rattling() {
    each("gravity-2.75g");
}
