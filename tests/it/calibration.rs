//! Sensors and their calibration.

mod blind;
mod command;
mod dcc;
mod droop;
mod exclusions;
mod impossible;
mod sensors;
mod uncertainty;

use std::sync::LazyLock;

use hertzscope::calibrate::design::{Designer, TestDesign};
use hertzscope::calibrate::simulation::BlindCalibration;
use hertzscope::calibrate::simulation::{ImpactTruth, setting};
use hertzscope::scene::plan::lab::{self, LabStriker, Laboratory};
use hertzscope::scope::Setup;

/// What most tests calibrate: 1.22 g with a PTFE face from 20, 10 and 5 mm, at 1 V/div and 100
/// us/div.
pub struct Bench {
    pub designer: Designer,
    pub striker: LabStriker,
    pub truths: Vec<ImpactTruth>,
    pub setup: Setup,
    pub candidate: TestDesign,
}

impl Bench {
    pub fn blind(&self, repeat: u32) -> BlindCalibration {
        let circuit = self.designer.circuit().expect("a circuit");
        self.designer.blind(&self.striker, &self.truths, circuit, (&self.setup, repeat))
    }
}

pub fn bench_with(lab: Laboratory, scale: f64, seed: u64) -> Bench {
    let designer = Designer::new("pzt-5a-710pf", lab, seed).expect("a shipped sensor");
    let candidate = TestDesign {
        striker: "ptfe-capped-1.22g".to_owned(),
        mass_kg: 1.22e-3,
        height_m: 20e-3,
        volts_per_div: scale,
        seconds_per_div: 100e-6,
        peak_force_n: 0.0,
        contact_s: 0.0,
        expanded: None,
        failed: None,
    };
    let (striker, truths, _) = designer.prepare(&candidate).expect("impacts");
    let scene = hertzscope::scene::Scene::load("momentum-test").expect("a shipped scene");
    let setup = setting(&scene, scale, candidate.seconds_per_div);
    Bench { designer, striker, truths, setup, candidate }
}

/// The laboratory that ships.
pub fn shipped_lab() -> Laboratory {
    lab::load(None).expect("the laboratory that ships")
}

pub static BENCH: LazyLock<Bench> = LazyLock::new(|| bench_with(shipped_lab(), 2.0, 1));
