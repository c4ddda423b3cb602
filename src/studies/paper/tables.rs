//! Tables 1 and 2: speeds from particle 14 to 27, and the one dashpot that fits the measured ones
//! best.
//!
//! The dashpot acts in every contact and is found by minimising the sum of squared differences to
//! all eight measured half-rise speeds: a scan for the lowest valley, then golden sections (J.
//! Kiefer, Proc. Amer. Math. Soc. 4, 502 (1953)). It is one number for one experiment and no
//! material constant; a striker, spheres and the wall share it.

use super::PaperError;
use super::claims::{Claim, Expected, Typed};
use super::record::{accuracy, nothing};
use super::verdict::ClaimResult;
use crate::chain::{Chain, EndOfContact, ForceProbe, LossKind, LossSpec, PlasticModel, Plasticity};
use crate::experiment::ensemble::{Case, Ensemble};
use crate::experiment::paper_speeds::{PaperSpeed, speeds};
use crate::experiment::pulse::{HALF_RISE_SHARE, PulseRecorder};
use crate::numeric::roots::golden_section;
use crate::predict::{SampleOptions, uncertain_prediction};
use crate::quantity::Uncertain;
use crate::scene::Scene;
use crate::scene::adjust::Adjustable;

/// Particles between which speeds are taken.
const SPEED_PARTICLES: [usize; 2] = [14, 27];
/// Dashpots of the scan for the lowest valley; from about 12 on the shocks at particle 27 have no
/// peak of their own (N s/m).
const DASHPOT_SCAN: [f64; 6] = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0];
/// How well the best dashpot is known (N s/m).
const DASHPOT_STEP: f64 = 0.1;
/// Samples of each scene's uncertainty: intervals to 5 %.
const INTERVAL_SAMPLES: usize = 200;
/// Accuracy of the runs that look for it: 0.04 m/s of a speed (1).
const SEARCH_ACCURACY: f64 = 1e-4;

/// One row of Tables 1 and 2 beside what comes out here.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedRow {
    /// As printed.
    pub paper: PaperSpeed,
    /// Without losses.
    pub lossless: Speeds,
    /// With the best single dashpot.
    pub with_dashpot: Speeds,
    /// Without losses but for contacts that yield by Thornton's law.
    pub yielding: Speeds,
    /// Without losses, with the uncertainty that the scene states: by the half-rise (m/s).
    pub half_rise: Uncertain,
    /// The same by the first peak (m/s).
    pub peak: Uncertain,
}

impl SpeedRow {
    /// Normalised errors of a `printed` speed (m/s) by the half-rise and by the first peak: up to 1
    /// both sides agree within what is known. Of the printed one that is its last digit; the paper
    /// states nothing else (1).
    pub fn normalised_errors(&self, printed: f64) -> [f64; 2] {
        let printed = Uncertain { value: printed, u: 0.5 / 3f64.sqrt(), half_width: 0.5 };
        [self.half_rise, self.peak].map(|here| {
            (here.value - printed.value).abs() / here.expanded().hypot(printed.expanded())
        })
    }
}

/// A speed by two estimators of the arrival.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// By the half-rise (m/s).
    pub half_rise: f64,
    /// By the first peak (m/s).
    pub peak: f64,
    /// By the first peak over 13.5 half cells, one from half a cell above the first sensor (m/s).
    pub peak_13_5: f64,
}

/// Both tables.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedStudy {
    /// The rows.
    pub rows: Vec<SpeedRow>,
    /// The dashpot that fits the measured half-rise speeds best (N s/m).
    pub dashpot: f64,
    /// Half-rise speeds over the dashpots that were scanned, row by row (N s/m) and (m/s).
    pub scan: Vec<(f64, Vec<f64>)>,
    /// Root of the mean squared difference to the measured speeds, without losses (m/s).
    pub rms_lossless: f64,
    /// The same with the dashpot (m/s).
    pub rms_with_dashpot: f64,
}

/// `scene` with a dashpot in every contact (N s/m); none for zero.
pub(super) fn with_dashpot(scene: &Scene, dashpot: f64) -> Result<Scene, PaperError> {
    let mut scene = scene.clone();
    let loss = LossSpec::everywhere(dashpot, EndOfContact::ZeroOverlap);
    scene.spec.effects.losses[LossKind::Dashpot as usize] = (dashpot > 0.0).then_some(loss);
    scene.chain = Chain::new(&scene.spec)?;
    Ok(scene)
}

/// `scene` with contacts that yield by Thornton's law.
fn with_plasticity(scene: &Scene) -> Result<Scene, PaperError> {
    let mut scene = scene.clone();
    scene.spec.effects.plasticity = Some(Plasticity::new(PlasticModel::Thornton));
    scene.chain = Chain::new(&scene.spec)?;
    Ok(scene)
}

/// Computes both tables and finds the dashpot.
pub(super) fn study(progress: &mut dyn FnMut(f64)) -> Result<SpeedStudy, PaperError> {
    let printed = speeds().map_err(PaperError::Claims)?;
    let scenes: Result<Vec<Scene>, _> = printed.iter().map(|row| Scene::load(&row.scene)).collect();
    let scenes = scenes?;
    let measured: Vec<f64> = printed.iter().map(|row| row.experiment_m_per_s).collect();
    let lossless = speeds_of(&scenes, false)?;
    let plastic: Result<Vec<Scene>, _> = scenes.iter().map(with_plasticity).collect();
    let yielding = speeds_of(&plastic?, false)?;
    let with = |dashpot: f64, search: bool| {
        let lossy = scenes.iter().map(|scene| with_dashpot(scene, dashpot));
        speeds_of(&lossy.collect::<Result<Vec<_>, _>>()?, search)
    };
    let half_rises = |speeds: &[Speeds]| speeds.iter().map(|s| s.half_rise).collect::<Vec<_>>();
    let mut scan = Vec::new();
    for (done, dashpot) in (0u8..).zip(DASHPOT_SCAN) {
        scan.push((dashpot, half_rises(&with(dashpot, true)?)));
        progress(f64::from(done) / 16.0);
    }
    let costs: Vec<f64> = scan.iter().map(|(_, speeds)| rms(speeds, &measured)).collect();
    let lowest = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
    let bracket = [lowest.saturating_sub(1), (lowest + 1).min(DASHPOT_SCAN.len() - 1)]
        .map(|i| DASHPOT_SCAN[i]);
    let dashpot = golden_section::<PaperError>(bracket, DASHPOT_STEP, &mut |dashpot| {
        Ok(rms(&half_rises(&with(dashpot, true)?), &measured))
    })?;
    progress(1.0);
    let with = with(dashpot, false)?;
    let (rms_lossless, rms_with_dashpot) =
        (rms(&half_rises(&lossless), &measured), rms(&half_rises(&with), &measured));
    let mut rows = Vec::new();
    let columns = lossless.into_iter().zip(with).zip(yielding);
    for (paper, ((lossless, with_dashpot), yielding)) in printed.into_iter().zip(columns) {
        let [half_rise, peak] = intervals(&paper.scene)?;
        rows.push(SpeedRow { paper, lossless, with_dashpot, yielding, half_rise, peak });
    }
    Ok(SpeedStudy { rows, dashpot, scan, rms_lossless, rms_with_dashpot })
}

/// Speeds of `scene` by the half-rise and by the first peak with the uncertainty that it states
/// (m/s).
fn intervals(scene: &str) -> Result<[Uncertain; 2], PaperError> {
    let mut adjustable = Adjustable::load(scene)?;
    let options = SampleOptions { samples: INTERVAL_SAMPLES, ..SampleOptions::default() };
    let found = uncertain_prediction(&mut adjustable, options, false, &|_| ())?;
    let of = |estimator: &str| {
        let [from, to] = SPEED_PARTICLES;
        let name = format!("p{from} -> p{to} {estimator}");
        let output = found.outputs.iter().find(|output| output.name == name);
        let output = output.ok_or_else(|| PaperError::Nothing {
            scene: scene.to_owned(),
            what: format!("interval of {name}"),
        })?;
        Ok::<_, PaperError>(output.uncertain())
    };
    Ok([of("half-rise")?, of("peak")?])
}

fn rms(found: &[f64], measured: &[f64]) -> f64 {
    let squares: f64 = found.iter().zip(measured).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / found.len() as f64).sqrt()
}

/// Speeds of all scenes at their accuracy, or less while the best dashpot is looked for.
fn speeds_of(scenes: &[Scene], search: bool) -> Result<Vec<Speeds>, PaperError> {
    let case = |scene: &Scene| Case {
        chain: scene.chain.clone(),
        velocities: scene.initial_velocities.clone(),
        probes: SPEED_PARTICLES
            .iter()
            .filter_map(|p| ForceProbe::inside(&scene.chain, *p, 0.0))
            .collect(),
        duration: scene.duration,
    };
    let cases: Vec<Case> = scenes.iter().map(case).collect();
    let tightest = scenes.iter().map(accuracy).fold(f64::INFINITY, f64::min);
    let accuracy = if search { SEARCH_ACCURACY } else { tightest };
    let readouts = Ensemble::new(accuracy).run(&cases, &|_| ());
    let speeds = scenes.iter().zip(readouts).map(|(scene, readout)| {
        let readout = readout?;
        let [from, to] = readout.pulses.as_slice() else {
            return Err(nothing(scene, "two forces"));
        };
        let distance = scene.chain.distance(SPEED_PARTICLES[0], SPEED_PARTICLES[1]);
        let speed = |arrival: &dyn Fn(&PulseRecorder) -> Option<f64>| {
            let times = arrival(from).zip(arrival(to));
            times.map(|(from, to)| distance / (to - from))
        };
        let half_rise =
            speed(&|pulse| pulse.first_reach(HALF_RISE_SHARE * pulse.first_peak()?.dynamic_n));
        let peak = speed(&|pulse| Some(pulse.first_peak()?.time_s));
        let half_cell = 0.5 * scene.chain.distance(SPEED_PARTICLES[0], SPEED_PARTICLES[0] + 2);
        let speeds = half_rise.zip(peak).map(|(half_rise, peak)| {
            let peak_13_5 = 13.5 * half_cell / distance * peak;
            Speeds { half_rise, peak, peak_13_5 }
        });
        speeds.ok_or_else(|| nothing(scene, "arrivals at particles 14 and 27"))
    });
    speeds.collect()
}

/// The tables' rows as statements: eight calculated speeds, eight measured ones.
pub(super) fn claims(study: &SpeedStudy) -> Vec<Claim> {
    let claim = |row: &SpeedRow, column: &str, printed: f64| {
        // Both tables print whole metres per second.
        let allowed = 0.5 * Typed::of(&printed.to_string()).last_digit;
        Claim {
            item: item(row, column),
            place: format!("Table {}", row.paper.table),
            figure: None,
            says: format!("speed from particle 14 to 27, {column}, {}", row.paper.scene),
            expected: Expected::Printed { value: printed, allowed },
            unit: "m/s".to_owned(),
            scale: 1.0,
            because: String::new(),
            measured: column == "experiment",
        }
    };
    let numerics = |row| claim(row, "numerics", row.paper.numerics_m_per_s);
    let experiment = |row| claim(row, "experiment", row.paper.experiment_m_per_s);
    study.rows.iter().map(numerics).chain(study.rows.iter().map(experiment)).collect()
}

fn item(row: &SpeedRow, column: &str) -> String {
    format!("speed_{column}_{}", row.paper.scene.replace('-', "_"))
}

/// Answers to [`claims`] and to the speed-up by the magnet.
pub(super) fn answers(study: &SpeedStudy, answers: &mut Vec<ClaimResult>) {
    let convention = format!("half-rise, a dashpot of {:.1} N s/m in every contact", study.dashpot);
    for row in &study.rows {
        let SpeedRow { lossless, with_dashpot, .. } = row;
        answers.push(
            ClaimResult::to(&item(row, "numerics"))
                .or("half-rise", lossless.half_rise)
                .note(format!(
                    "the paper names neither estimator nor distance, and one reading serves all eight; peak to peak it is {:.1} m/s, over 13.5 half cells {:.1} m/s",
                    lossless.peak, lossless.peak_13_5
                )),
        );
        answers.push(
            ClaimResult::to(&item(row, "experiment"))
                .or(&convention, with_dashpot.half_rise)
                .or("half-rise, no losses", lossless.half_rise)
                .or("half-rise, contacts that yield, no other losses", row.yielding.half_rise)
                .note("the dashpot is the one that fits all eight measured speeds best"),
        );
    }
    let ratio = |of: &dyn Fn(&SpeedRow) -> f64| {
        let of_table = |table: u64| study.rows.iter().filter(move |row| row.paper.table == table);
        let ratios = of_table(1).zip(of_table(2)).map(|(with, without)| of(with) / of(without));
        let (sum, rows) = ratios.fold((0.0, 0.0), |(sum, rows), ratio| (sum + ratio, rows + 1.0));
        sum / rows - 1.0
    };
    answers.push(
        ClaimResult::to("speed_up")
            .plain("calculated, half-rise, mean of the four strikers", ratio(&|r| r.lossless.half_rise))
            .or("calculated, peak to peak", ratio(&|r| r.lossless.peak))
            .note(format!(
                "the paper's own calculated speeds give {:.0} %, its measured ones {:.0} %: the gain that it prints is that of its experiment",
                100.0 * ratio(&|r| r.paper.numerics_m_per_s),
                100.0 * ratio(&|r| r.paper.experiment_m_per_s)
            )),
    );
}
