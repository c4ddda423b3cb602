//! Effect of viscosity on the incoming shock of Fig. 10: the text says that its oscillations get
//! faster.

use super::dispersion::cell;
use super::record::{ForceRecord, nothing};
use super::strikers::SHOCK_PERIODS;
use super::tables::with_dashpot;
use super::verdict::ClaimResult;
use super::{ForceLocation, Viscous};
use super::{IntermediateResults, PaperError};
use crate::scene::Scene;

/// Dashpots that are tried (N s/m).
const DASHPOTS: [f64; 4] = [0.0, 0.5, 1.0, 2.0];
const INCOMING: ForceLocation = ForceLocation::Inside(2);
/// Records whose lines are told beside the periods (s).
const LINE_RECORDS: [f64; 2] = [1.25e-3, 1.6e-3];
/// The paper's measured frequency (Hz).
const MEASURED_FREQUENCY: f64 = 12e3;

/// Answers of Fig. 10; `fitted` is the dashpot that was found for the measured speeds (N s/m).
pub(super) fn answers(fitted: f64, found: &mut IntermediateResults) -> Result<(), PaperError> {
    let scene = Scene::load("magnet-17.81g")?;
    let with = |dashpot: f64| viscous(&scene, dashpot);
    let all: Result<Vec<Viscous>, PaperError> = DASHPOTS.into_iter().map(with).collect();
    let all = all?;
    let lossless = all.first().map_or(f64::NAN, |viscous| viscous.frequency);
    // A dashpot that leaves no oscillation leaves no frequency either.
    let with_fitted = with(fitted).map_or(f64::NAN, |viscous| viscous.frequency);
    let growth = |pair: &[Viscous]| pair[1].frequency / pair[0].frequency;
    let smallest = all.windows(2).map(growth).fold(f64::INFINITY, f64::min);
    let words = all.iter().map(|v| format!("{:.1} kHz at {}", 1e-3 * v.frequency, v.dashpot));
    let words = words.collect::<Vec<_>>().join(", ");
    let convention = "mean over the first four periods inside particle 2";
    let needed = needed(&all).map_or_else(String::new, |dashpot| {
        format!("; the measured 12 kHz would need {dashpot:.1} N s/m")
    });
    found.answers.extend([
        ClaimResult::to("entrance_frequency").plain(convention, lossless).note(by_line(&scene)?),
        ClaimResult::to("entrance_frequency_measured")
            .plain(&format!("{convention}, without losses"), lossless)
            .or(
                &format!(
                    "{convention}, with the {fitted:.1} N s/m that fit the measured speeds best"
                ),
                with_fitted,
            )
            .note(format!("{words} N s/m{needed}")),
        ClaimResult::to("entrance_frequency_rises")
            .plain(convention, smallest)
            .note(format!("{words} N s/m")),
    ]);
    found.viscosity = all;
    Ok(())
}

/// What the spectrum says instead: its highest line in the gap, by the length of the record.
fn by_line(scene: &Scene) -> Result<String, PaperError> {
    let record = ForceRecord::of(scene, &[INCOMING])?;
    let (chain, _) = cell(scene, 2)?;
    let [short, long] = LINE_RECORDS;
    let line = |length: f64| {
        let spectrum = record.spectrum(INCOMING, 0.0, length)?;
        let highest = spectrum.highest_between(chain.gap_bottom(), chain.gap_top());
        let (bin, _) = highest.ok_or_else(|| nothing(scene, "line in the gap"))?;
        Ok::<_, PaperError>(1e-3 * spectrum.frequency(bin))
    };
    Ok(format!(
        "the spectrum's highest line in the gap stands at {:.1} kHz in a record of {:.2} ms and at {:.1} kHz in one of {:.1} ms",
        line(short)?,
        1e3 * short,
        line(long)?,
        1e3 * long
    ))
}

/// The dashpot at which the measured frequency would come out, between two that were tried (N s/m).
fn needed(all: &[Viscous]) -> Option<f64> {
    let pair =
        all.windows(2).find(|p| (p[0].frequency..p[1].frequency).contains(&MEASURED_FREQUENCY))?;
    let share = (MEASURED_FREQUENCY - pair[0].frequency) / (pair[1].frequency - pair[0].frequency);
    Some(pair[0].dashpot + share * (pair[1].dashpot - pair[0].dashpot))
}

fn viscous(scene: &Scene, dashpot: f64) -> Result<Viscous, PaperError> {
    let scene = with_dashpot(scene, dashpot)?;
    let record = ForceRecord::of(&scene, &[INCOMING])?;
    let peaks = record.peaks(INCOMING)?;
    let ends = peaks.first().zip(peaks.get(SHOCK_PERIODS));
    let ((from, _), (to, _)) = ends.ok_or_else(|| nothing(&scene, "train of peaks"))?;
    Ok(Viscous {
        dashpot,
        frequency: SHOCK_PERIODS as f64 / (to - from),
        signal: record.signal(INCOMING)?,
    })
}
