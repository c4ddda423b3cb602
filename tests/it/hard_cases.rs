//! The catalogue of hard cases, and the horizon that a rattling chain is given.

use hertzscope::experiment::horizon::horizon;
use hertzscope::scene::Scene;
use hertzscope::studies::hard_cases::{CaseVerdict, catalogue};

use super::chains::diatomic;

/// Judges every second case from `first`: two tests, so that they run side by side.
fn judge(first: usize) {
    for case in catalogue().iter().skip(first).step_by(2) {
        let finding = case.run();
        println!("{}: {}, {}", finding.case, finding.verdict.word(), finding.figure);
        assert_ne!(finding.verdict, CaseVerdict::Wrong, "{}: {}", finding.case, finding.figure);
        // One case alone is to be refused.
        let refused = finding.case == "just above the edge of stability";
        assert_eq!(finding.verdict == CaseVerdict::Refused, refused, "{}", finding.figure);
    }
}

#[test]
fn even_cases_are_right_or_refused() {
    judge(0);
}

#[test]
fn odd_cases_are_right_or_refused() {
    judge(1);
}

#[test]
fn chains_that_stay_closed_have_no_horizon() {
    let chain = diatomic(10, 2.38, false);
    let mut velocities = vec![0.0; 20];
    velocities[0] = 0.01;
    assert_eq!(horizon(&chain, &velocities, 2e-3, 1e-6), Ok(None));
}

/// A loss too weak to calm a rattling chain does not make it predictable; one that calms it does.
#[test]
fn chains_with_losses_have_a_horizon_where_they_rattle() {
    let lossy = |gamma: &str| {
        let text = format!(
            "base = \"gravity-0.61g\"\n[effects.dashpot]\ngamma = \"{gamma}\"\nend_of_contact = \"zero_force\"\n"
        );
        let scene = Scene::from_text("lossy", "lossy.toml", &text).expect("a scene");
        horizon(&scene.chain, &scene.initial_velocities, 14e-3, 1e-6).expect("a motion")
    };
    let found = lossy("1e-6 N s/m").expect("a horizon");
    assert!((0.5e-3..5e-3).contains(&found), "{found:e}");
    assert_eq!(lossy("0.8 N s/m"), None);
}
